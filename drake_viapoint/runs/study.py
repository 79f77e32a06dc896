"""A study: many runs of one task, each with its own changes to one scenario."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

ONLY_CONDITION = "all"
"""Condition of every run of a study that names none."""

MOST = 1_000_000
"""Runs of a study, trials and repeats of a run: more is a slip of the finger."""

REPEATED = "repeated_"
"""What a column of the final movement's repeats begins with."""

_LONGEST_SLUG = 80
_DIGITS = 8  # of the digest in a run's name


@dataclass(frozen=True)
class StudyRun:
    """One run of a study.

    Attributes:
        condition: Name of its condition.
        values: What varies, by full keys of the scenario.
        changes: To the study's scenario: the condition's, then the values.
        name: Of its folder and its row. It says condition and values, and ends with a digest of
            the changes, so a study that grows keeps the names of its runs.
    """

    condition: str
    values: Mapping[str, Any]
    changes: Mapping[str, Any]
    name: str = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", _run_name(self.condition, self.values, self.changes))


@dataclass(frozen=True)
class Study:
    """What is run, and what is kept of it.

    Attributes:
        task: Name of the task.
        scenario: Every value of the scenario that the runs change, as YAML has them.
        conditions: Changes of each condition, by its name.
        vary: Values of what varies, by full keys of the scenario; every combination is run.
        max_trials: Of each run.
        repeats: The final movement is executed so many times more, learned or not.
        tabulate: Fields of the trials' records that become columns.
        together: Values that change in step, by full keys, as many for each.
    """

    task: str
    scenario: Mapping[str, Any]
    conditions: Mapping[str, Mapping[str, Any]]
    vary: Mapping[str, tuple[Any, ...]]
    max_trials: int
    repeats: int
    tabulate: tuple[str, ...]
    together: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)

    def __len__(self) -> int:
        """Number of runs."""
        steps = [len(values) for values in self.together.values()][:1]
        return math.prod(map(len, [self.conditions, *self.vary.values()]), start=math.prod(steps))

    @property
    def varied(self) -> tuple[str, ...]:
        """Keys of everything that varies beside the condition."""
        return (*self.together, *self.vary)

    def runs(self) -> Iterator[StudyRun]:
        """Every combination; the conditions of one person and seed are neighbours."""
        in_step = zip(*self.together.values(), strict=True) if self.together else [()]
        for step, *combination in itertools.product(in_step, *self.vary.values()):
            values = dict(zip(self.varied, (*step, *combination), strict=True))
            for condition, changes in self.conditions.items():
                yield StudyRun(condition, values, {**changes, **values})

    def without_runs(self) -> Study:
        """The same without what varies: a message to a worker is not to grow with the study."""
        return replace(self, vary={}, together={})

    def identity(self, versions: Mapping[str, str]) -> dict[str, Any]:
        """What every row depends on beside the changes of its own run.

        Conditions and values are not part of it: a study may grow.

        Args:
            versions: Of what executes the runs.
        """
        return {
            "task": self.task,
            "scenario": self.scenario,
            "max_trials": self.max_trials,
            "repeats": self.repeats,
            "tabulate": list(self.tabulate),
            "versions": dict(versions),
        }

    def columns(self) -> tuple[str, ...]:
        """Of the table, in their order."""
        repeated = [REPEATED + name for name in self.tabulate] if self.repeats else []
        counts = ("learned_at", "first_success", "trials", "wasted")
        ending = ("error", "seconds", "folder")
        return ("run", "condition", *self.varied, *counts, *self.tabulate, *repeated, *ending)


def digest(data: object) -> str:
    """Of plain data: the same whatever the order of its keys."""
    return hashlib.sha256(canonical(data).encode()).hexdigest()


def canonical(data: object) -> str:
    """Plain data as JSON, with one text for equal data.

    Raises:
        TypeError: Something in it is not plain.
        ValueError: A number in it is not finite.
    """
    return json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)


def _run_name(condition: str, values: Mapping[str, Any], changes: Mapping[str, Any]) -> str:
    words = [condition, *(f"{key.split('.')[-1]}{_word(value)}" for key, value in values.items())]
    slug = "-".join(re.sub(r"[^A-Za-z0-9._+]+", "_", word).strip("._") or "_" for word in words)
    return f"{slug[:_LONGEST_SLUG]}-{digest(dict(changes))[:_DIGITS]}"


def _word(value: object) -> str:
    return "_".join(map(str, value)) if isinstance(value, list) else str(value)
