"""A trial of the serve: what happened, when and where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.robot.arm_motion import ArmMotion
from drake_viapoint.tasks.cameras import Samples
from drake_viapoint.tasks.disturbance import VelocityFactors
from drake_viapoint.tasks.flight import Flight
from drake_viapoint.tasks.racket import RacketMotion
from drake_viapoint.tasks.seen_flight import SeenFlights
from drake_viapoint.tasks.serve_results import STRIKE as STRIKE
from drake_viapoint.tasks.serve_results import THROW as THROW
from drake_viapoint.tasks.serve_results import ServeResults
from drake_viapoint.tasks.serve_unknown import TrialDraw
from drake_viapoint.tasks.trial import FAILED, recorded_vector


class ServeOutcome(StrEnum):
    """How a serve can end."""

    SPILT = "spilt"  # it did not rest in the cup, and nothing was executed
    NOT_RELEASED = "not_released"
    MISSED = "missed"
    CAUGHT_BEHIND = "caught_behind"
    FELL_SHORT = "fell_short"
    LANDED = "landed"


def serve_outcome(record: dict[str, Any]) -> Outcome:
    """What the learner is told of a recorded serve.

    A ball still in the cup at t_HIT says nothing of the throw, nor does a refused movement, nor a
    ball that was not seen to fly. A trial that broke off says nothing at all.
    """
    seen = "happened" in record
    thrown = seen or record["outcome"] != ServeOutcome.NOT_RELEASED
    realized = {name: recorded_vector(record, name) for name in (THROW, STRIKE)}
    desired = {THROW: record.get("T_Hd"), STRIKE: record.get("T_Gd")}
    return Outcome(
        {**realized, THROW: realized[THROW] if thrown else None},
        {name: np.array(value, float) for name, value in desired.items() if value is not None},
        record["success"],
        broken_off=record["outcome"] == FAILED and realized[THROW] is None,
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


def ball_event(
    name: str,
    time: float,
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    racket: RacketMotion,
) -> BallEvent:
    """An event of the ball, with what the racket does then."""
    state = racket([min(time, racket.end)])  # the arm stands still after its movement
    return BallEvent(name, time, position, velocity, state.position[0], state.velocity[0])


class SeenServe(NamedTuple):
    """A serve as cameras saw it."""

    results: ServeResults
    ball: Samples
    racket: Samples  # centre of its face
    goal: Samples  # centre of its ring
    flights: SeenFlights


@dataclass(frozen=True)
class ServeTrial:
    """Record of one serve.

    Attributes:
        ending: How it ended.
        events: Release, hit and fall through the ring's height, as far as they happened.
        hit_time: t_HIT, when the ball should be hit [s].
        happened: The task variables as they were.
        saturated: Joints whose torque was clamped at their effort.
        beyond_limits: Joints that left their range of angles or speeds at a step.
        tracking_error: Largest distance of a joint from its desired angle at a step [rad].
        disturbed: What was drawn for this trial, and so differs from trial to trial.
        motion: How the arm moved.
        racket: How the racket moved.
        path: Centre of the ball (n, 3) [m] at times (n,) [s].
        flights: The ball's flights: thrown, struck.
        seen: What cameras saw, if it was they who told the learner.
    """

    ending: ServeOutcome
    events: tuple[BallEvent, ...]
    hit_time: float
    happened: ServeResults
    saturated: tuple[str, ...]
    beyond_limits: tuple[str, ...]
    tracking_error: float
    disturbed: VelocityFactors | TrialDraw
    motion: ArmMotion
    racket: RacketMotion
    path: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    flights: tuple[Flight, ...]
    seen: SeenServe | None = None

    @property
    def told(self) -> ServeResults:
        """The task variables as the learner is told them."""
        return self.happened if self.seen is None else self.seen.results

    @property
    def end(self) -> float:
        """When there is nothing more to see: the motion or the ball's flight is over [s]."""
        return max(self.motion.end, *(event.time for event in self.events), 0.0)

    def ball_path(self, times: ArrayLike) -> NDArray[np.float64]:
        """Centre of the ball (n, 3) [m] at times (n,) [s]: carried, thrown, struck."""
        return self.path(np.atleast_1d(np.asarray(times, dtype=np.float64)))

    def record(self) -> dict[str, Any]:
        """What a line of the run's trials keeps."""
        drawn = self.disturbed._asdict()
        record = {
            "outcome": str(self.ending),
            **self.told.record(),
            "events": [event.record() for event in self.events],
            "saturated": list(self.saturated),
            "beyond_limits": list(self.beyond_limits),
            "tracking_error": self.tracking_error,
            "disturbed": {name: np.asarray(value).tolist() for name, value in drawn.items()},
        }
        return record if self.seen is None else {**record, "happened": self.happened.record()}

    def summary(self) -> str:
        """The same in a few words."""
        told, error = self.told, self.told.landing_error
        landing = "" if error is None else f", {100 * error:.1f} cm from the goal's centre"
        throw = "throw not seen" if told.d is None else f"d = {100 * told.d:.1f} cm"
        clamped = f", torque clamped: {' '.join(self.saturated)}" if self.saturated else ""
        beyond = f", beyond limits: {' '.join(self.beyond_limits)}" if self.beyond_limits else ""
        ending = str(self.ending).replace("_", " ")
        return f"{ending}, {throw}{landing}{clamped}{beyond}"
