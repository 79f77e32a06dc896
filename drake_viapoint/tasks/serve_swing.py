"""The arm through a serve: it carries the ball until the cup would have to pull it, then goes on.

At the release the integration stops, is taken back by a step and repeated up to the root. From
then on the arm moves without the ball's weight.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import SimulatorConfig
from pydrake.systems.framework import Context
from scipy.optimize import brentq

from drake_viapoint.robot.arm_motion import ArmMotion
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.robot.step_log import ArmLog
from drake_viapoint.robot.stepping import Stepping
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.serve_scene import ServeScene

_RELEASE_TOLERANCE = 1e-10  # [s]


class Swing(NamedTuple):
    """What the arm did."""

    motion: ArmMotion
    release: float | None  # [s] when the ball left the cup; None if it stayed
    clamped: NDArray[np.bool_]  # (k,) whether a joint's torque was clamped at a step


class SwingIntegration:
    """Integrates the arm through serves in one diagram, each as if it were the first.

    Args:
        scene: The diagram.
        config: Integrator, accuracy and longest step.
    """

    def __init__(self, scene: ServeScene, config: SimulatorConfig) -> None:
        self._scene = scene
        self._stepping = Stepping(scene.diagram, config)

    def __call__(self, movement: JointMovement) -> Swing:
        """Integrate the arm through a movement."""
        self._scene.tracking.follow(movement.trajectory)
        return self._stepping.until_accepted(lambda: self._swing(movement))

    def _swing(self, movement: JointMovement) -> Swing:
        scene, stepping = self._scene, self._stepping
        stepping.reset(float(movement.times[0]))
        own = scene.plant.GetMyMutableContextFromRoot(stepping.context)
        scene.plant.SetPositions(own, scene.instance, movement.angles[0])
        scene.load_ball(own)
        end = float(movement.times[-1])

        carrying = self._log()
        release = self._carry(carrying, end)
        if release is None:
            return Swing(ArmMotion([carrying.segment()]), None, carrying.clamped())
        swinging = self._log()
        scene.unload_ball(own)

        def record() -> bool:
            swinging.add()
            return False

        stepping.advance(end, record)
        # released at the very beginning or end, it has but one
        segments = [log.segment() for log in (carrying, swinging) if len(log.times) > 1]
        return Swing(ArmMotion(segments), release, carrying.clamped() | swinging.clamped())

    def _log(self) -> ArmLog:
        scene = self._scene
        return ArmLog(scene.plant, scene.instance, scene.tracking, self._stepping.context)

    def _carry(self, log: ArmLog, end: float) -> float | None:
        """Move until the cup would have to pull the ball; the context is left at that time."""
        stepping = self._stepping
        own = self._scene.plant.GetMyContextFromRoot(stepping.context)
        pushes: list[float] = []
        before: list[NDArray[np.float64]] = []

        def record() -> bool:
            log.add()
            pushes.append(self._push(own))
            if pushes[-1] < 0:
                return True
            before[:] = [stepping.context.get_continuous_state_vector().CopyToVector()]
            return False

        stepping.advance(end, record)
        if pushes[-1] >= 0:
            return None
        if len(pushes) == 1:
            return float(stepping.context.get_time())
        last, over = log.times[-2], log.times[-1]
        known = {last: pushes[-2], over: pushes[-1]}

        def push_at(time: float) -> float:
            if time not in known:
                stepping.go(last, before[0], time)
                known[time] = self._push(own)
            return known[time]

        release = float(brentq(push_at, last, over, xtol=_RELEASE_TOLERANCE))
        stepping.go(last, before[0], release)
        log.drop_last()
        if release > last:
            log.add()
        return release

    def _push(self, own: Context) -> float:
        """Push of the cup along its opening, per mass of the ball [m/s2], in a plant's context."""
        plant, scene = self._scene.plant, self._scene
        acceleration = plant.EvalBodySpatialAccelerationInWorld(own, scene.ball).translational()
        # the ball sits in the cup with the cup's own orientation: its z is the opening
        opening = plant.EvalBodyPoseInWorld(own, scene.ball).rotation().col(2)
        return float(opening @ (acceleration + [0.0, 0.0, GRAVITY]))
