"""The arm through a serve: it carries the ball until the cup would have to pull it, then goes on.

At the release the integration stops, is taken back by a step and repeated up to the root. From
then on the arm moves without the ball's weight.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import Context, EventStatus
from scipy.optimize import brentq

from drake_viapoint.robot.arm_motion import ArmMotion, MotionSegment
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.serve_scene import ServeScene

_RELEASE_TOLERANCE = 1e-10  # [s]
_MOST_HALVINGS = 4  # of the step; a torque that is clamped makes kinks that no step resolves


class Swing(NamedTuple):
    """What the arm did."""

    motion: ArmMotion
    release: float | None  # [s] when the ball left the cup; None if it stayed
    clamped: NDArray[np.bool_]  # (k,) whether a joint's torque was clamped at a step


class _StepLog:
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


class SwingIntegration:
    """Integrates the arm through serves in one diagram, each as if it were the first.

    Args:
        scene: The diagram.
        config: Integrator, accuracy and longest step.
    """

    def __init__(self, scene: ServeScene, config: SimulatorConfig) -> None:
        self._scene = scene
        self._config = config
        self._simulator = Simulator(scene.diagram)
        self._rejected = 0

    def __call__(self, movement: JointMovement) -> Swing:
        """Integrate the arm through a movement.

        The steps are the longest allowed if the integrator accepts all of them, else half as long,
        and so on: after a step that Drake (1.51) rejects for its error it starts the next one with
        what it had cached at the rejected step's end, at the cost of a hundred times the error.
        """
        for halvings in range(_MOST_HALVINGS + 1):
            self._rejected = 0
            swing = self._swing(movement, self._config.max_step_size / 2**halvings)
            if not self._rejected:
                break
        return swing

    def _swing(self, movement: JointMovement, longest_step: float) -> Swing:
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

        carrying = _StepLog(scene, context)
        release = self._carry(carrying, end)
        if release is None:
            return Swing(ArmMotion([carrying.segment()]), None, carrying.clamped())
        swinging = _StepLog(scene, context)
        scene.unload_ball(own)
        self._advance(swinging, end)
        # released at the very beginning or end, it has but one
        segments = [log.segment() for log in (carrying, swinging) if len(log.times) > 1]
        return Swing(ArmMotion(segments), release, carrying.clamped() | swinging.clamped())

    def _advance(self, log: _StepLog, end: float) -> None:
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

    def _carry(self, log: _StepLog, end: float) -> float | None:
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
