"""A trial of the serve: what happened, when and where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.robot.arm_motion import ArmMotion
from drake_viapoint.tasks.disturbance import VelocityFactors
from drake_viapoint.tasks.flight import Flight
from drake_viapoint.tasks.trial import recorded_vector

THROW = "T_H"
"""Task variable of subtask 1: where the ball is when it should be hit [m]."""

STRIKE = "T_G"
"""Task variable of subtask 2: where the ball falls through the height of the ring [m]."""


class ServeOutcome(StrEnum):
    """How a serve can end."""

    NOT_RELEASED = "not_released"
    MISSED = "missed"
    CAUGHT_BEHIND = "caught_behind"
    FELL_SHORT = "fell_short"
    LANDED = "landed"


def serve_outcome(record: dict[str, Any]) -> Outcome:
    """What the learner is told of a recorded serve.

    A ball still in the cup at t_HIT says nothing of the throw, nor does a refused movement.
    """
    thrown = record["outcome"] != ServeOutcome.NOT_RELEASED
    realized = {name: recorded_vector(record, name) for name in (THROW, STRIKE)}
    desired = {THROW: record.get("T_Hd"), STRIKE: record.get("T_Gd")}
    return Outcome(
        {**realized, THROW: realized[THROW] if thrown else None},
        {name: np.array(value, float) for name, value in desired.items() if value is not None},
        record["success"],
    )


@dataclass(frozen=True)
class BallEvent:
    """Something that happens to the ball."""

    name: str
    time: float  # [s]
    ball_position: NDArray[np.float64]  # (3,) [m]
    ball_velocity: NDArray[np.float64]  # (3,) [m/s] just after
    racket_position: NDArray[np.float64]  # (3,) [m]
    racket_velocity: NDArray[np.float64]  # (3,) [m/s]

    def record(self) -> dict[str, Any]:
        """As plain numbers and lists."""
        return {
            "name": self.name,
            "time": self.time,
            "ball_position": self.ball_position.tolist(),
            "ball_velocity": self.ball_velocity.tolist(),
            "racket_position": self.racket_position.tolist(),
            "racket_velocity": self.racket_velocity.tolist(),
        }


@dataclass(frozen=True)
class ServeTrial:
    """Record of one serve.

    Attributes:
        ending: How it ended.
        events: Release, hit and fall through the ring's height, as far as they happened.
        hit_time: t_HIT, when the ball should be hit [s].
        meeting: T_H, where the ball is at t_HIT on its undisturbed way (3,) [m].
        desired_meeting: T_Hd, a ball's radius in front of the face's centre at t_HIT (3,) [m].
        landing: T_G, where it falls through the ring's height (2,) [m]; None if it does not.
        goal: T_Gd, the ring's centre (2,) [m].
        success: Whether d and the landing error are within their tolerances.
        saturated: Joints whose torque was clamped at their effort.
        beyond_limits: Joints that left their range of angles or speeds at a step.
        tracking_error: Largest distance of a joint from its desired angle at a step [rad].
        disturbed: What the disturbance made of the ball's velocity.
        motion: How the arm moved.
        carried: Centre of the ball in the cup (n, 3) [m] at times (n,) [s].
        flights: The ball's flights: thrown, struck.
    """

    ending: ServeOutcome
    events: tuple[BallEvent, ...]
    hit_time: float
    meeting: NDArray[np.float64]
    desired_meeting: NDArray[np.float64]
    landing: NDArray[np.float64] | None
    goal: NDArray[np.float64]
    success: bool
    saturated: tuple[str, ...]
    beyond_limits: tuple[str, ...]
    tracking_error: float
    disturbed: VelocityFactors
    motion: ArmMotion
    carried: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    flights: tuple[Flight, ...]

    @property
    def d(self) -> float:
        """Distance of the ball from where the face should meet it, at t_HIT [m]."""
        return float(np.linalg.norm(self.desired_meeting - self.meeting))

    @property
    def landing_error(self) -> float | None:
        """Distance of the landing point from the goal's centre [m]."""
        return None if self.landing is None else float(np.linalg.norm(self.landing - self.goal))

    @property
    def end(self) -> float:
        """When there is nothing more to see: the motion or the ball's flight is over [s]."""
        return max(self.motion.end, *(event.time for event in self.events), 0.0)

    def ball_path(self, times: ArrayLike) -> NDArray[np.float64]:
        """Centre of the ball (n, 3) [m] at times (n,) [s]: carried, thrown, struck."""
        t = np.atleast_1d(np.asarray(times, dtype=np.float64))
        starts = [flight.start for flight in self.flights]
        stage = np.searchsorted(starts, t, side="right")
        path = np.empty((t.size, 3))
        in_cup = stage == 0
        if in_cup.any():
            path[in_cup] = self.carried(t[in_cup])
        for number, flight in enumerate(self.flights, start=1):
            path[stage == number] = flight.position(t[stage == number])
        return path

    def record(self) -> dict[str, Any]:
        """What a line of the run's trials keeps."""
        return {
            "outcome": str(self.ending),
            "success": self.success,
            "d": self.d,
            "landing_error": self.landing_error,
            THROW: self.meeting.tolist(),
            "T_Hd": self.desired_meeting.tolist(),
            STRIKE: None if self.landing is None else self.landing.tolist(),
            "T_Gd": self.goal.tolist(),
            "events": [event.record() for event in self.events],
            "saturated": list(self.saturated),
            "beyond_limits": list(self.beyond_limits),
            "tracking_error": self.tracking_error,
            "disturbed": {
                "release": self.disturbed.release.tolist(),
                "bounce": self.disturbed.bounce.tolist(),
            },
        }

    def summary(self) -> str:
        """The same in a few words."""
        error = self.landing_error
        landing = "" if error is None else f", {100 * error:.1f} cm from the goal's centre"
        clamped = f", torque clamped: {' '.join(self.saturated)}" if self.saturated else ""
        beyond = f", beyond limits: {' '.join(self.beyond_limits)}" if self.beyond_limits else ""
        ending = str(self.ending).replace("_", " ")
        return f"{ending}, d = {100 * self.d:.1f} cm{landing}{clamped}{beyond}"
