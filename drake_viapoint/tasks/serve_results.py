"""The task variables of a serve, as they were or as they were seen, and whether that was enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.tasks.serve_scenario import ServeLearning

THROW = "T_H"
"""Task variable of subtask 1: where the ball is when it should be hit [m]."""

STRIKE = "T_G"
"""Task variable of subtask 2: where the ball falls through the height of the ring [m]."""


@dataclass(frozen=True)
class ServeResults:
    """What came of a serve.

    Attributes:
        meeting: T_H, where the ball is at t_HIT on its undisturbed way (3,) [m]; None if not seen.
        desired_meeting: T_Hd, a ball's radius in front of the face's centre at t_HIT (3,) [m]; None
            if not seen.
        landing: T_G, where it falls through the ring's height (2,) [m]; None if it does not.
        goal: T_Gd, the ring's centre (2,) [m]; None if not seen.
        success: Whether d and the landing error are within their tolerances.
    """

    meeting: NDArray[np.float64] | None
    desired_meeting: NDArray[np.float64] | None
    landing: NDArray[np.float64] | None
    goal: NDArray[np.float64] | None
    success: bool

    @property
    def d(self) -> float | None:
        """Distance of the ball from where the face should meet it, at t_HIT [m]."""
        return _distance(self.meeting, self.desired_meeting)

    @property
    def landing_error(self) -> float | None:
        """Distance of the landing point from the goal's centre [m]."""
        return _distance(self.landing, self.goal)

    def record(self) -> dict[str, Any]:
        """As plain numbers and lists."""
        return {
            "success": self.success,
            "d": self.d,
            "landing_error": self.landing_error,
            THROW: _listed(self.meeting),
            "T_Hd": _listed(self.desired_meeting),
            STRIKE: _listed(self.landing),
            "T_Gd": _listed(self.goal),
        }


def judged(
    learning: ServeLearning,
    meeting: NDArray[np.float64] | None,
    desired_meeting: NDArray[np.float64] | None,
    landing: NDArray[np.float64] | None,
    goal: NDArray[np.float64] | None,
) -> ServeResults:
    """Results, with success as a scenario defines it."""
    d, error = _distance(meeting, desired_meeting), _distance(landing, goal)
    met = d is not None and d < learning.meeting_tolerance
    inside = error is not None and error < learning.landing_tolerance
    return ServeResults(meeting, desired_meeting, landing, goal, met and inside)


def _distance(
    there: NDArray[np.float64] | None, wanted: NDArray[np.float64] | None
) -> float | None:
    if there is None or wanted is None:
        return None
    return float(np.linalg.norm(wanted - there))


def _listed(value: NDArray[np.float64] | None) -> list[float] | None:
    return None if value is None else value.tolist()
