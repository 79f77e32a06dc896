"""A serve executed event by event: Drake integrates the arm, events are found as roots.

Once the ball has left the cup nothing couples it to the arm: the arm goes on without its weight,
and the ball flies, is struck and lands by its own equations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.arm_motion import ArmMotion
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.disturbance import Disturbance
from drake_viapoint.tasks.flight import Flight, drag_per_metre, fly
from drake_viapoint.tasks.racket import Face, RacketStates
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.serve_swing import Swing, SwingIntegration
from drake_viapoint.tasks.serve_trial import BallEvent, ServeOutcome, ServeTrial
from drake_viapoint.tasks.struck_ball import Encounter, first_encounter, strike


@dataclass(frozen=True)
class HeldRacket:
    """The racket as a moving arm holds it."""

    arm: Arm
    motion: ArmMotion

    @property
    def start(self) -> float:
        """Beginning of the motion [s]."""
        return self.motion.start

    @property
    def end(self) -> float:
        """End of the motion [s]."""
        return self.motion.end

    def __call__(self, times: ArrayLike) -> RacketStates:
        """See ``RacketMotion``."""
        states = self.motion.tool(self.arm, times)
        return RacketStates(*(np.array(field) for field in zip(*states, strict=True)))


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
        learning = scenario.learning
        self._tolerances = learning.meeting_tolerance, learning.landing_tolerance

    def execute(self, movement: JointMovement, seed: int = 0) -> ServeTrial:
        """Simulate a serve and follow the ball; the seed is that of its disturbance."""
        return self.follow(movement, self.swing(movement), seed)

    def swing(self, movement: JointMovement) -> Swing:
        """Move the arm up to the ball's release and on. No disturbance changes this."""
        return self._swing(movement)

    def follow(self, movement: JointMovement, swing: Swing, seed: int) -> ServeTrial:
        """What becomes of the ball while the arm swings through a movement."""
        scene = self._scene
        motion, release, clamped = swing
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
        goal = np.array(scene.ring[:2])
        near = np.linalg.norm(wanted - meeting) < self._tolerances[0]
        inside = landing is not None and np.linalg.norm(landing - goal) < self._tolerances[1]
        return ServeTrial(
            ending=_ending(thrown, met, landed),
            events=tuple(events),
            hit_time=self._hit_time,
            meeting=meeting,
            desired_meeting=wanted,
            landing=landing,
            goal=goal,
            success=bool(near and inside),
            saturated=scene.arm.named(clamped),
            beyond_limits=scene.arm.named(motion.beyond(scene.arm.limits)),
            tracking_error=motion.strayed(movement.trajectory),
            disturbed=disturbed,
            motion=motion,
            carried=lambda t: scene.cup.ball(racket, t).position,
            flights=tuple(flights),
        )


def _ending(thrown: bool, met: Encounter | None, landed: float | None) -> ServeOutcome:
    if not thrown:
        return ServeOutcome.NOT_RELEASED
    if met is None:
        return ServeOutcome.MISSED
    if met.from_behind:
        return ServeOutcome.CAUGHT_BEHIND
    return ServeOutcome.FELL_SHORT if landed is None else ServeOutcome.LANDED


def _event(name: str, time: float, flight: Flight, racket: HeldRacket) -> BallEvent:
    state = racket([min(time, racket.end)])  # the arm stands still after its movement
    return BallEvent(
        name,
        time,
        flight.position(time),
        flight.velocity(time),
        state.position[0],
        state.velocity[0],
    )
