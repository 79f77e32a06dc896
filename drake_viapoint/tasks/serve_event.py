"""A serve executed event by event: Drake integrates the arm, events are found as roots.

The arm carries the ball until the cup would have to pull it; there the integration stops, is taken
back by a step and repeated up to the root. From then on nothing couples the ball to the arm: the
arm goes on without its weight, and the ball flies, is struck and lands by its own equations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator
from pydrake.systems.framework import Context, EventStatus
from scipy.interpolate import BSpline
from scipy.optimize import brentq

from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.arm_motion import ArmMotion, MotionSegment
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.flight import GRAVITY, Flight, drag_per_metre, fly
from drake_viapoint.tasks.racket import Face, RacketStates
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.serve_trial import BallEvent, ServeOutcome, ServeTrial
from drake_viapoint.tasks.struck_ball import Encounter, first_encounter, strike

_RELEASE_TOLERANCE = 1e-10  # [s]
_MOST_HALVINGS = 4  # of the step; a torque that is clamped makes kinks that no step resolves


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


class _Log:
    """Joint states at the integrator's steps, read by the simulator's monitor.

    What it asks the plant for, the integrator needs for its next step anyway.

    Args:
        scene: The diagram.
        context: The simulator's, which all steps change in place.
    """

    def __init__(self, scene: ServeScene, context: Context) -> None:
        plant = scene.plant
        self._root = context
        self._own = plant.GetMyContextFromRoot(context)
        self._state = plant.get_state_output_port(scene.instance)
        self._acceleration = plant.get_generalized_acceleration_output_port(scene.instance)
        self._torque = scene.tracking.torque_before_clamping(context)
        self._effort = scene.arm.limits.effort
        self.times: list[float] = []
        self._states: list[NDArray[np.float64]] = []
        self._torques: list[NDArray[np.float64]] = []

    def add(self) -> None:
        self.times.append(self._root.get_time())
        self._states.append(
            np.concatenate([self._state.Eval(self._own), self._acceleration.Eval(self._own)])
        )
        self._torques.append(self._torque())

    def drop_last(self) -> None:
        for rows in (self.times, self._states, self._torques):
            rows.pop()

    def segment(self) -> MotionSegment:
        q, v, acceleration = np.split(np.array(self._states), 3, axis=1)
        return MotionSegment(np.array(self.times), q, v, acceleration)

    def clamped(self) -> NDArray[np.bool_]:
        wanted: NDArray[np.bool_] = np.any(np.abs(self._torques) > self._effort, axis=0)
        return wanted


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
        self._config = scenario.simulator
        ball = scenario.ball
        self._radius, self._restitution = ball.radius, ball.restitution
        self._drag = drag_per_metre(ball.drag_coefficient, ball.radius, ball.mass)
        self._face = Face(scenario.robot.half_width, scenario.robot.half_length)
        learning = scenario.learning
        self._tolerances = learning.meeting_tolerance, learning.landing_tolerance
        self._simulator = Simulator(scene.diagram)
        self._rejected = 0

    def execute(self, movement: JointMovement) -> ServeTrial:
        """Simulate a serve and follow the ball."""
        motion, release, clamped = self.move_arm(movement)
        return self._follow(movement.trajectory, motion, release, clamped)

    def move_arm(
        self, movement: JointMovement
    ) -> tuple[ArmMotion, float | None, NDArray[np.bool_]]:
        """Integrate the arm through the movement.

        The steps are the longest allowed if the integrator accepts all of them, else half as long,
        and so on: after a step that Drake (1.51) rejects for its error it starts the next one with
        what it had cached at the rejected step's end, at the cost of a hundred times the error.

        Returns:
            The motion, the time at which the ball leaves the cup (None if it stays) and which
            joints were clamped (k,).
        """
        for halvings in range(_MOST_HALVINGS + 1):
            self._rejected = 0
            moved = self._move_arm(movement, self._config.max_step_size / 2**halvings)
            if not self._rejected:
                break
        return moved

    def _move_arm(
        self, movement: JointMovement, longest_step: float
    ) -> tuple[ArmMotion, float | None, NDArray[np.bool_]]:
        scene, simulator = self._scene, self._simulator
        scene.tracking.follow(movement.trajectory)
        context = simulator.get_mutable_context()
        scene.diagram.SetDefaultContext(context)
        context.SetTime(float(movement.times[0]))
        own = scene.plant.GetMyMutableContextFromRoot(context)
        scene.plant.SetPositions(own, scene.instance, movement.angles[0])
        scene.load_ball(own)
        # an integrator keeps the step it adapted to in the trial before; this makes it forget
        ApplySimulatorConfig(self._config, simulator)
        simulator.get_mutable_integrator().set_maximum_step_size(longest_step)
        end = float(movement.times[-1])

        carrying = _Log(scene, context)
        release = self._carry(carrying, end)
        if release is None:
            return ArmMotion([carrying.segment()]), None, carrying.clamped()
        swinging = _Log(scene, context)
        scene.unload_ball(own)
        self._advance(swinging, end)
        # released at the very beginning or end, it has but one
        segments = [log.segment() for log in (carrying, swinging) if len(log.times) > 1]
        return ArmMotion(segments), release, carrying.clamped() | swinging.clamped()

    def _advance(self, log: _Log, end: float) -> None:
        simulator = self._simulator

        nothing = EventStatus.DidNothing()

        def record(_: Context) -> EventStatus:
            log.add()
            return nothing

        simulator.set_monitor(record)
        simulator.Initialize()  # also reports the first state to the monitor
        self._advance_to(end)
        simulator.clear_monitor()

    def _advance_to(self, time: float) -> None:
        """Let the simulator advance, and count the steps it rejected since its initialisation."""
        self._simulator.AdvanceTo(time)
        integrator = self._simulator.get_integrator()
        self._rejected += integrator.get_num_step_shrinkages_from_error_control()

    def _carry(self, log: _Log, end: float) -> float | None:
        """Move until the cup would have to pull the ball; the context is left at that time."""
        simulator = self._simulator
        context = simulator.get_mutable_context()
        own = self._scene.plant.GetMyContextFromRoot(context)
        pushes: list[float] = []
        before: list[NDArray[np.float64]] = []

        nothing = EventStatus.DidNothing()

        def record(_: Context) -> EventStatus:
            log.add()
            pushes.append(self._push(own))
            if pushes[-1] < 0:
                return EventStatus.ReachedTermination(self._scene.diagram, "the cup would pull")
            before[:] = [context.get_continuous_state_vector().CopyToVector()]
            return nothing

        simulator.set_monitor(record)
        simulator.Initialize()
        if pushes[-1] >= 0:
            self._advance_to(end)
        simulator.clear_monitor()
        if pushes[-1] >= 0:
            return None
        if len(pushes) == 1:
            return float(context.get_time())
        last, over = log.times[-2], log.times[-1]
        known = {last: pushes[-2], over: pushes[-1]}

        def push_at(time: float) -> float:
            if time not in known:
                self._integrate(last, before[0], time)
                known[time] = self._push(own)
            return known[time]

        release = float(brentq(push_at, last, over, xtol=_RELEASE_TOLERANCE))
        self._integrate(last, before[0], release)
        log.drop_last()
        if release > last:
            log.add()
        return release

    def _integrate(self, start: float, state: NDArray[np.float64], end: float) -> None:
        """Bring the context from a known state to a time near after it."""
        context = self._simulator.get_mutable_context()
        context.SetTime(start)
        context.SetContinuousState(state)
        self._simulator.Initialize()
        self._advance_to(end)

    def _push(self, own: Context) -> float:
        """Push of the cup along its opening, per mass of the ball [m/s2], in a plant's context."""
        plant, scene = self._scene.plant, self._scene
        acceleration = plant.EvalBodySpatialAccelerationInWorld(own, scene.ball).translational()
        # the ball sits in the cup with the cup's own orientation: its z is the opening
        opening = plant.EvalBodyPoseInWorld(own, scene.ball).rotation().col(2)
        return float(opening @ (acceleration + [0.0, 0.0, GRAVITY]))

    def _follow(
        self,
        desired: BSpline[np.float64],
        motion: ArmMotion,
        release: float | None,
        clamped: NDArray[np.bool_],
    ) -> ServeTrial:
        scene = self._scene
        racket = HeldRacket(scene.arm, motion)
        times = np.concatenate([segment.times for segment in motion.segments])
        strayed = np.max(np.abs(motion.q(times) - desired(times)))
        events: list[BallEvent] = []
        flights: list[Flight] = []
        met: Encounter | None = None
        landed: float | None = None
        if release is not None:
            carried = scene.cup.ball(racket, [release])
            flights.append(fly(release, carried.position[0], carried.velocity[0], self._drag))
            events.append(_event("release", release, flights[-1], racket))
            met = first_encounter(flights[0], racket, self._face, self._radius)
        if met is not None and met.from_behind:
            events.append(_event("caught_behind", met.time, flights[0], racket))
        elif met is not None:
            flights.append(
                strike(flights[0], racket, met.time, self._radius, self._restitution, self._drag)
            )
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
            saturated=_named(scene.arm, clamped),
            beyond_limits=_named(scene.arm, _beyond(scene.arm, motion)),
            tracking_error=float(strayed),
            motion=motion,
            carried=lambda t: scene.cup.ball(racket, t).position,
            flights=tuple(flights),
        )


def _named(arm: Arm, chosen: NDArray[np.bool_]) -> tuple[str, ...]:
    return tuple(name for name, c in zip(arm.joint_names, chosen, strict=True) if c)


def _beyond(arm: Arm, motion: ArmMotion) -> NDArray[np.bool_]:
    """Which joints (k,) left their range of angles or speeds at a step."""
    q = np.concatenate([segment.q for segment in motion.segments])
    v = np.concatenate([segment.v for segment in motion.segments])
    limits = arm.limits
    outside = (q < limits.lower) | (q > limits.upper) | (np.abs(v) > limits.speed)
    beyond: NDArray[np.bool_] = outside.any(axis=0)
    return beyond


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
