"""A serve executed event by event: Drake integrates the arm, events are found as roots.

Once the ball has left the cup nothing couples it to the arm: the arm goes on without its weight,
and the ball flies, is struck and lands by its own equations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.disturbance import Disturbance
from drake_viapoint.tasks.flight import Flight, drag_per_metre, fly
from drake_viapoint.tasks.held_racket import HeldRacket
from drake_viapoint.tasks.racket import Face
from drake_viapoint.tasks.serve_results import judged
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.serve_swing import Swing, SwingIntegration
from drake_viapoint.tasks.serve_trial import BallEvent, ServeOutcome, ServeTrial, ball_event
from drake_viapoint.tasks.struck_ball import Encounter, first_encounter, strike


@dataclass(frozen=True)
class CarriedThenFlown:
    """Where the ball is: in the cup, then in flight after flight."""

    carried: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    flights: tuple[Flight, ...]

    def __call__(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Centre of the ball (n, 3) [m] at times (n,) [s]."""
        starts = [flight.start for flight in self.flights]
        stage = np.searchsorted(starts, times, side="right")
        path = np.empty((times.size, 3))
        in_cup = stage == 0
        if in_cup.any():
            path[in_cup] = self.carried(times[in_cup])
        for number, flight in enumerate(self.flights, start=1):
            path[stage == number] = flight.position(times[stage == number])
        return path


class EventExecution:
    """Executes serves in one diagram, reused; each trial as if it were the first.

    Args:
        scenario: What is simulated and how accurately.
        scene: The diagram.
        hit_time: t_HIT, when the ball should be hit [s].
    """

    def __init__(self, scenario: ServeScenario, scene: ServeScene, hit_time: float) -> None:
        self._scene = scene
        self._hit_time = hit_time
        self._swing = SwingIntegration(scene, scenario.simulator)
        ball = scenario.ball
        self._radius, self._restitution = ball.radius, ball.restitution
        self._drag = drag_per_metre(ball.drag_coefficient, ball.radius, ball.mass)
        self._disturbance = Disturbance(scenario.disturbance.release, scenario.disturbance.bounce)
        self._face = Face(scenario.robot.half_width, scenario.robot.half_length)
        self._learning = scenario.learning
        self._last: tuple[JointMovement, Swing] | None = None

    def execute(self, movement: JointMovement, seed: int = 0) -> ServeTrial:
        """Simulate a serve and follow the ball; the seed is that of its disturbance."""
        scene = self._scene
        motion, release, clamped = self._swung(movement)
        disturbed = self._disturbance.draw(seed)
        racket = HeldRacket(scene.arm, motion)
        events: list[BallEvent] = []
        flights: list[Flight] = []
        met: Encounter | None = None
        landed: float | None = None
        if release is not None:
            carried = scene.cup.ball(racket, [release])
            velocity = carried.velocity[0] * disturbed.release
            flights.append(fly(release, carried.position[0], velocity, self._drag))
            events.append(_event("release", release, flights[-1], racket))
            met = first_encounter(flights[0], racket, self._face, self._radius)
        if met is not None and met.from_behind:
            events.append(_event("caught_behind", met.time, flights[0], racket))
        elif met is not None:
            ball = self._radius, self._restitution, self._drag
            flights.append(strike(flights[0], racket, met.time, *ball, disturbed.bounce))
            events.append(_event("hit", met.time, flights[-1], racket))
            landed = flights[-1].fall_through(float(scene.ring[2]))
            if landed is not None:
                events.append(_event("landing", landed, flights[-1], racket))

        state = racket([self._hit_time])
        thrown = bool(flights) and flights[0].start <= self._hit_time
        meeting = (
            flights[0].position(self._hit_time)
            if thrown
            else scene.cup.ball(racket, [self._hit_time]).position[0]
        )
        wanted = state.position[0] + self._radius * state.normal[0]
        landing = flights[-1].position(landed)[:2] if landed is not None else None
        return ServeTrial(
            ending=_ending(thrown, met, landed),
            events=tuple(events),
            hit_time=self._hit_time,
            happened=judged(self._learning, meeting, wanted, landing, np.array(scene.ring[:2])),
            saturated=scene.arm.named(clamped),
            beyond_limits=scene.arm.named(motion.beyond(scene.arm.limits)),
            tracking_error=motion.strayed(movement.trajectory),
            disturbed=disturbed,
            motion=motion,
            racket=racket,
            path=CarriedThenFlown(lambda t: scene.cup.ball(racket, t).position, tuple(flights)),
            flights=tuple(flights),
        )

    def _swung(self, movement: JointMovement) -> Swing:
        """What the arm does. No disturbance changes that, so it is not done again in repeats."""
        if self._last is None or self._last[0] is not movement:
            self._last = movement, self._swing(movement)
        return self._last[1]


def _ending(thrown: bool, met: Encounter | None, landed: float | None) -> ServeOutcome:
    if not thrown:
        return ServeOutcome.NOT_RELEASED
    if met is None:
        return ServeOutcome.MISSED
    if met.from_behind:
        return ServeOutcome.CAUGHT_BEHIND
    return ServeOutcome.FELL_SHORT if landed is None else ServeOutcome.LANDED


def _event(name: str, time: float, flight: Flight, racket: HeldRacket) -> BallEvent:
    return ball_event(name, time, flight.position(time), flight.velocity(time), racket)
