"""The upswing with an arm that carries the pendulum and feels it, in Drake's full dynamics.

The hand's line becomes a movement of the joints, which the arm follows by a controller that knows
the arm but not the pendulum: so the hand strays, and the pendulum is swung by where it really is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.robot.arm_motion import ArmMotion, MotionSegment
from drake_viapoint.robot.inverse_kinematics import InverseKinematics
from drake_viapoint.robot.retargeting import JointMovement, Retargeting
from drake_viapoint.robot.step_log import ArmLog, StepLog
from drake_viapoint.robot.stepping import Stepping
from drake_viapoint.tasks.pendulum import PendulumMotion
from drake_viapoint.tasks.upswing_line import LineCheck
from drake_viapoint.tasks.upswing_plant import at_times, check_places, sampling_times
from drake_viapoint.tasks.upswing_scenario import UpswingScenario
from drake_viapoint.tasks.upswing_scene import UpswingScene


@dataclass(frozen=True)
class CarriedUpswing:
    """What arm and pendulum did.

    Attributes:
        motion: Hand and pendulum, where they really were.
        arm_motion: The joints of the arm.
        saturated: Joints whose torque was clamped.
        beyond_limits: Joints that left their range of angles or speeds.
        tracking_error: Largest angle of a joint from its desired one [rad].
        hand_error: Largest distance of the hand from its place on the line, at the motion's
            times [m].
    """

    motion: PendulumMotion
    arm_motion: ArmMotion
    saturated: tuple[str, ...]
    beyond_limits: tuple[str, ...]
    tracking_error: float
    hand_error: float


class _Steps(NamedTuple):
    """What the integrator gives."""

    arm: MotionSegment
    pendulum: MotionSegment
    clamped: NDArray[np.bool_]  # (k,)


class TrackedExecution:
    """Executes upswings of an arm in one diagram, reused; each trial as if it were the first.

    Args:
        scenario: What swings and how accurately it is integrated.
        scene: The diagram.
        times: (n,) of the via-points [s].
        first: (n,) places of the first movement's via-points [m]; it decides where supplemental
            via-points are needed.

    Attributes:
        scene: The diagram.
        times: Times of the motions it gives, a ``time_step`` apart or a little less [s].
        retargeting: From via-points to joint movements.

    Raises:
        UnreachableError: The first movement is out of reach.
        RetargetingError: The arm cannot stay as near to the line as asked.
    """

    def __init__(
        self, scenario: UpswingScenario, scene: UpswingScene, times: ArrayLike, first: ArrayLike
    ) -> None:
        self.scene = scene
        self._via_times = np.asarray(times, dtype=np.float64)
        self.times = sampling_times(self._via_times, scenario.time_step)
        self._hand = minimum_jerk(self._via_times, np.eye(self._via_times.size))(self.times)
        self._check = LineCheck(scene.line, self._via_times)
        places = check_places(first, self._via_times.size)
        self._check(places)
        self.retargeting = Retargeting(
            InverseKinematics(scene.arm, scene.arm.rest),
            scene.line.via_points(self._via_times, places),
            position_threshold=scenario.robot.position_threshold,
            rotation_threshold=scenario.robot.rotation_threshold,
        )
        self._stepping = Stepping(scene.diagram, scenario.simulator)

    def __call__(self, x: ArrayLike) -> CarriedUpswing:
        """Move the hand through via-points (n,) [m] and see what arm and pendulum do.

        Raises:
            ScenarioError: Not as many via-points as times.
            UnreachableError: A via-point is out of the arm's reach, or the path between two.
        """
        return self.execute(self.movement(x), x)

    def movement(self, x: ArrayLike) -> JointMovement:
        """The movement of the joints that takes the hand through via-points (n,) [m].

        Raises:
            ScenarioError: Not as many via-points as times.
            UnreachableError: A via-point is out of the arm's reach, or the path between two.
        """
        places = check_places(x, self._via_times.size)
        self._check(places)
        return self.retargeting(self.scene.line.via_points(self._via_times, places))

    def execute(self, movement: JointMovement, x: ArrayLike) -> CarriedUpswing:
        """Simulate a movement that should take the hand through via-points (n,) [m]."""
        scene = self.scene
        scene.tracking.follow(movement.trajectory)
        steps = self._stepping.until_accepted(lambda: self._swing(movement))
        arm_motion = ArmMotion([steps.arm])
        motion, off = self._watched(arm_motion, steps.pendulum, self._hand @ np.asarray(x))
        return CarriedUpswing(
            motion=motion,
            arm_motion=arm_motion,
            saturated=scene.arm.named(steps.clamped),
            beyond_limits=scene.arm.named(arm_motion.beyond(scene.arm.limits)),
            tracking_error=arm_motion.strayed(movement.trajectory),
            hand_error=off,
        )

    def _swing(self, movement: JointMovement) -> _Steps:
        scene, stepping = self.scene, self._stepping
        stepping.reset(float(movement.times[0]))
        own = scene.plant.GetMyMutableContextFromRoot(stepping.context)
        scene.plant.SetPositions(own, scene.instance, movement.angles[0])
        arm = ArmLog(scene.plant, scene.instance, scene.tracking, stepping.context)
        pendulum = StepLog(scene.plant, scene.joint.model_instance(), stepping.context)

        def record() -> bool:
            arm.add()
            pendulum.add()
            return False

        stepping.advance(float(movement.times[-1]), record)
        return _Steps(arm.segment(), pendulum.segment(), arm.clamped())

    def _watched(
        self, arm_motion: ArmMotion, swung: MotionSegment, places: NDArray[np.float64]
    ) -> tuple[PendulumMotion, float]:
        """The motion as seen from the front, and how far the hand was from its places (n,)."""
        line = self.scene.line
        hand = arm_motion.tool(self.scene.arm, self.times)
        off = np.array([tool.position for tool in hand]) - line.places(places)
        turn = np.array([tool.rotation for tool in hand]) @ line.rotation.T
        spin = np.array([tool.angular_velocity for tool in hand])
        angle, speed = at_times(swung, self.times)
        angle, speed = seen_from_the_front(angle, speed, turn, spin)
        return (
            PendulumMotion(self.times, places + off[:, 0], angle, speed),
            float(np.max(np.linalg.norm(off, axis=1))),
        )


def seen_from_the_front(
    angle: NDArray[np.float64],
    speed: NDArray[np.float64],
    turn: NDArray[np.float64],
    spin: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A pendulum's angle and speed in the world's x-z plane, from those in a hand that turns.

    Args:
        angle: (n,) in the hand [rad].
        speed: (n,) in the hand [rad/s].
        turn: (n, 3, 3) of the hand from where it should be.
        spin: (n, 3) angular velocity of the hand in the world [rad/s].

    Returns:
        Angle (n,) [rad], unwrapped as the hand's is, and speed (n,) [rad/s].
    """
    none = np.zeros_like(angle)
    along = np.stack([-np.sin(angle), none, np.cos(angle)], axis=-1)
    ahead = np.stack([-np.cos(angle), none, -np.sin(angle)], axis=-1) * speed[:, None]
    rod = np.einsum("nij,nj->ni", turn, along)
    moving = np.einsum("nij,nj->ni", turn, ahead) + np.cross(spin, rod)
    sine, cosine = -rod[:, 0], rod[:, 2]
    tilt = np.arctan2(sine, cosine) - angle
    tilt -= 2 * np.pi * np.round(tilt / (2 * np.pi))
    rate = (-moving[:, 0] * cosine - sine * moving[:, 2]) / (sine**2 + cosine**2)
    return angle + tilt, rate
