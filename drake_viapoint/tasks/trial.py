"""What every task hands to those above it: a trial's record and a task that executes trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.learning.subtask import Subtask
from drake_viapoint.motion.via_points import ViaPoints

UNREACHABLE = "unreachable"
"""Outcome of a movement that the robot cannot make."""

FAILED = "failed"
"""Outcome of a trial that broke off, or whose results are not numbers."""


class Trial(Protocol):
    """One execution of a movement and what came out of it."""

    def record(self) -> dict[str, Any]:
        """What is kept of it: plain numbers, strings and lists, ready for JSON."""
        ...

    def summary(self) -> str:
        """The same in a few words for a progress line."""
        ...


@dataclass(frozen=True)
class RefusedTrial:
    """A trial of which nothing came: the robot cannot make the movement, or it broke off.

    Attributes:
        reason: Why, as one line.
        missing: Names of the results it did not reach.
        outcome: ``UNREACHABLE``, ``FAILED`` if trying again may help, or a word of the task's own.
    """

    reason: str
    missing: tuple[str, ...]
    outcome: str = UNREACHABLE

    def record(self) -> dict[str, Any]:
        """See ``Trial``."""
        nothing = dict.fromkeys(self.missing)
        return {"outcome": str(self.outcome), "success": False, "reason": self.reason, **nothing}

    def summary(self) -> str:
        """See ``Trial``."""
        return self.reason


def recorded_vector(record: dict[str, Any], name: str) -> NDArray[np.float64] | None:
    """A task variable as recorded: None if it was not reached, NaN where it was no number."""
    value = record[name]  # a line of a run has None where there was no number
    return None if value is None else np.array(value, dtype=np.float64)


class Task(Protocol):
    """A task: where learning starts, what is learned, and how a trial is executed.

    A trial is a pure function of the task's scenario, the via-points and the seed.
    """

    @property
    def name(self) -> str:
        """What the command line calls it."""
        ...

    @property
    def via_points(self) -> ViaPoints:
        """Of the first trial."""
        ...

    @property
    def subtasks(self) -> Sequence[Subtask]:
        """In the order in which the movement meets them."""
        ...

    @property
    def successes(self) -> int:
        """So many successful trials in a row and the task is learned."""
        ...

    @property
    def repeats(self) -> int:
        """So many further trials of what was learned."""
        ...

    def execute(self, via_points: ViaPoints, seed: int) -> Trial:
        """Execute one trial; whatever comes of it, it is a trial and no exception."""
        ...

    def outcome(self, record: dict[str, Any]) -> Outcome:
        """What the learner is told of a trial, live or read back from its record."""
        ...
