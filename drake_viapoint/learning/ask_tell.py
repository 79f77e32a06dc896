"""What passes between a learner and whoever executes its trials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.errors import OutcomeError, OutcomeNotFiniteError
from drake_viapoint.motion.via_points import ViaPoints


class Purpose(StrEnum):
    """Why a trial is executed."""

    EXPLORATION = "exploration"
    LEARNING = "learning"
    REPEAT = "repeat"


@dataclass(frozen=True)
class Proposal:
    """What to execute next, and why."""

    via_points: ViaPoints
    purpose: Purpose
    subtask: str


@dataclass(frozen=True)
class Outcome:
    """What came out of a trial.

    Attributes:
        realized: T of each task variable, None where the trial did not reach it.
        desired: Td of each task variable; it may differ from trial to trial, as the place of the
            racket does that the ball should meet.
        success: Whether this trial met the bar of the whole task.
        broken_off: Whether the trial broke off and so says nothing, as when a camera fails. It
            counts, and the same via-points are asked for again.
    """

    realized: Mapping[str, NDArray[np.float64] | None]
    desired: Mapping[str, NDArray[np.float64]]
    success: bool
    broken_off: bool = False

    def error(self, task_variable: str) -> NDArray[np.float64] | None:
        """Td - T, or None where the trial did not reach it.

        Raises:
            OutcomeError: The variable or its desired value is missing, or their shapes differ.
            OutcomeNotFiniteError: The variable is not finite.
        """
        if task_variable not in self.realized:
            raise OutcomeError(
                f"the outcome has no task variable {task_variable!r}; it has "
                f"{', '.join(sorted(self.realized)) or 'none'}"
            )
        realized = self.realized[task_variable]
        if realized is None:
            return None
        if not np.all(np.isfinite(realized)):
            raise OutcomeNotFiniteError(task_variable, np.asarray(realized).tolist())
        if task_variable not in self.desired:
            raise OutcomeError(f"the outcome does not say what {task_variable} should have been")
        desired = np.asarray(self.desired[task_variable], dtype=np.float64)
        if not np.all(np.isfinite(desired)):
            raise OutcomeNotFiniteError(f"desired {task_variable}", desired.tolist())
        if desired.ndim != 1 or desired.shape != np.shape(realized):
            raise OutcomeError(
                f"{task_variable} and its desired value must be vectors of the same length, got "
                f"shapes {np.shape(realized)} and {desired.shape}"
            )
        return desired - realized
