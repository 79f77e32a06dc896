"""A trial of the upswing: how hand and pendulum moved, and where the pendulum ended."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.tasks.pendulum import HANGING, PendulumMotion
from drake_viapoint.tasks.trial import recorded_vector
from drake_viapoint.tasks.upswing_tracked import CarriedUpswing

END_STATE = "T"
"""Task variable: angle theta [rad] and speed omega [rad/s] at the end."""


class UpswingOutcome(StrEnum):
    """How an upswing can end."""

    INVERTED = "inverted"
    WENT_OVER = "went_over"
    FELL_SHORT = "fell_short"
    TOO_FAST = "too_fast"


def upswing_outcome(record: dict[str, Any]) -> Outcome:
    """What the learner is told of a recorded upswing."""
    desired = record.get("Td")
    return Outcome(
        {END_STATE: recorded_vector(record, END_STATE)},
        {} if desired is None else {END_STATE: np.array(desired, float)},
        record["success"],
    )


@dataclass(frozen=True)
class UpswingTrial:
    """Record of one upswing.

    Attributes:
        motion: How hand and pendulum moved.
        desired: Td, the demonstration's angle and speed at the end (2,) [rad, rad/s].
        tolerance: A success is nearer than this (2,) [rad, rad/s].
        carried: What the arm that carried the pendulum did; None where none did.
    """

    motion: PendulumMotion
    desired: NDArray[np.float64]
    tolerance: NDArray[np.float64]
    carried: CarriedUpswing | None = None

    @property
    def end_state(self) -> NDArray[np.float64]:
        """T: angle and speed at the end (2,) [rad, rad/s]."""
        return np.array([self.motion.angle[-1], self.motion.speed[-1]])

    @property
    def error(self) -> NDArray[np.float64]:
        """Td - T (2,) [rad, rad/s]."""
        return self.desired - self.end_state

    @property
    def success(self) -> bool:
        """Whether angle and speed are within their tolerances."""
        return bool(np.all(np.abs(self.error) < self.tolerance))

    @property
    def ending(self) -> UpswingOutcome:
        """How it ended, seen from where the pendulum hung at first."""
        if self.success:
            return UpswingOutcome.INVERTED
        if abs(self.error[0]) < self.tolerance[0]:
            return UpswingOutcome.TOO_FAST
        way = np.sign(self.desired[0] - HANGING)
        over = way * self.error[0] < 0
        return UpswingOutcome.WENT_OVER if over else UpswingOutcome.FELL_SHORT

    def record(self) -> dict[str, Any]:
        """What a line of the run's trials keeps."""
        return {
            "outcome": str(self.ending),
            "success": self.success,
            END_STATE: self.end_state.tolist(),
            "Td": self.desired.tolist(),
            **self._arm(),
        }

    def summary(self) -> str:
        """The same in a few words."""
        angle, speed = -self.error
        parts = [
            f"{str(self.ending).replace('_', ' ')}, off by {angle:+.2f} rad, {speed:+.2f} rad/s"
        ]
        for key, words in (("saturated", "torque clamped"), ("beyond_limits", "beyond limits")):
            if joints := self._arm().get(key):
                parts.append(f"{words}: {' '.join(joints)}")
        return ", ".join(parts)

    def _arm(self) -> dict[str, Any]:
        if self.carried is None:
            return {}
        return {
            "saturated": list(self.carried.saturated),
            "beyond_limits": list(self.carried.beyond_limits),
            "tracking_error": self.carried.tracking_error,
            "hand_error": self.carried.hand_error,
        }
