"""A task of ten lines: the pointer's tip is to be at a place at a moment."""

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.packages import resolve
from drake_viapoint.robot.arm import Arm
from drake_viapoint.tasks.arm_scene import ArmScene
from drake_viapoint.tasks.arm_task import ArmTask
from drake_viapoint.tasks.arm_trial import Result
from drake_viapoint.tasks.arm_unknown import UnknownArm

WITH_POINTER = "package://drake_viapoint/six_joint_arm_with_pointer.dmd.yaml"
ROBOT = UnknownArm(inertia=0.2, viscous_friction=0.02, shift=0.006)
SOFT = 10.0  # [rad/s] natural frequency of a controller that gives way
MOMENT = 0.8  # [s]
TIMES = np.linspace(0.0, 1.6, 201)  # [s]
AHEAD = np.array([0.12, 0.22, 0.10])  # [m] from where the tip rests
NOISE = 0.001  # [m] a coordinate, of what sees the tip


def pointer_arm() -> Arm:
    return Arm(resolve(WITH_POINTER), "tip")


def reach(start: NDArray[np.float64]) -> NDArray[np.float64]:
    """There and back, at rest at both ends: places (n, 3) [m]."""
    share = np.clip(TIMES / MOMENT, 0.0, 2.0)
    share = np.where(share > 1, 2 - share, share)
    return start + np.outer(share**3 * (10 - 15 * share + 6 * share**2), AHEAD)


class Touch(ArmTask):
    """The tip is at a place at a moment."""

    name = "touch"

    def __init__(self, scene: ArmScene, beside: tuple[float, float, float] = (0.0, 0.0, 0.0)):
        start = scene.arm.tool_pose(scene.arm.rest).position
        self.place = start + AHEAD + beside
        super().__init__(scene, TIMES, reach(start), via_points=5)

    def learns(self):
        return [self.correction("T", self.nearest(MOMENT), tolerance=0.005)]

    def measure(self, tool, rng):
        seen = tool(MOMENT).position + rng.normal(scale=NOISE, size=3)
        return {"T": Result(seen, self.place)}


def touch(seed: int = 0, unknown: UnknownArm = ROBOT, **given: object) -> Touch:
    scene = ArmScene(WITH_POINTER, "tip", unknown=unknown, seed=seed, natural_frequency=SOFT)
    return Touch(scene, **given)
