"""An arm and the tool it holds: joints, limits and kinematics, read from a model file."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable, Joint, ModelInstanceIndex

from drake_viapoint.errors import ModelFileError
from drake_viapoint.robot.directives import add_directives


class ToolPose(NamedTuple):
    """Where the tool is."""

    rotation: NDArray[np.float64]  # (3, 3) world from tool
    position: NDArray[np.float64]  # (3,) [m]


class ToolMotion(NamedTuple):
    """Where the tool is and how it moves, in the world."""

    rotation: NDArray[np.float64]  # (3, 3) world from tool
    position: NDArray[np.float64]  # (3,) [m]
    angular_velocity: NDArray[np.float64]  # (3,) [rad/s]
    velocity: NDArray[np.float64]  # (3,) [m/s] of the tool's origin


class JointLimits(NamedTuple):
    """Bounds of each joint, in the order of ``Arm.joint_names``."""

    lower: NDArray[np.float64]  # (k,) [rad]
    upper: NDArray[np.float64]  # (k,) [rad]
    speed: NDArray[np.float64]  # (k,) [rad/s]
    effort: NDArray[np.float64]  # (k,) [N m]


class Arm:
    """An arm of k actuated joints, alone with its tool.

    Args:
        directives: Model directives that hold the arm and its tool, and nothing that moves else.
        tool_frame: Name of the frame whose pose matters.

    Raises:
        ModelFileError: The models cannot be read, a joint has no actuator, no frame has the name.
    """

    def __init__(self, directives: Path, tool_frame: str) -> None:
        self.plant = load_plant(directives)
        plant = self.plant
        if plant.num_actuators() != plant.num_velocities() or plant.num_actuators() == 0:
            raise ModelFileError(
                str(directives),
                f"an arm needs an actuator a joint: {plant.num_velocities()} degrees of freedom, "
                f"{plant.num_actuators()} actuators",
            )
        if not plant.HasFrameNamed(tool_frame):
            raise ModelFileError(str(directives), f"no frame named {tool_frame!r}")
        self._tool = plant.GetFrameByName(tool_frame)
        self._context = plant.CreateDefaultContext()
        self._joints = moving_joints(plant)
        self.joint_names: tuple[str, ...] = tuple(joint.name() for joint in self._joints)
        self.limits = JointLimits(
            plant.GetPositionLowerLimits(),
            plant.GetPositionUpperLimits(),
            plant.GetVelocityUpperLimits(),
            plant.GetEffortUpperLimits(),
        )
        self.rest: NDArray[np.float64] = plant.GetPositions(self._context)  # (k,) [rad]
        self.rest.flags.writeable = False

    @property
    def num_joints(self) -> int:
        """Number of joints k."""
        return len(self.joint_names)

    def named(self, chosen: NDArray[np.bool_]) -> tuple[str, ...]:
        """Names of the joints chosen (k,)."""
        return tuple(name for name, c in zip(self.joint_names, chosen, strict=True) if c)

    def tool_pose(self, q: ArrayLike) -> ToolPose:
        """Pose of the tool at joint angles q (k,) [rad]."""
        self.plant.SetPositions(self._context, q)
        pose = self._tool.CalcPoseInWorld(self._context)
        return ToolPose(pose.rotation().matrix(), pose.translation())

    def joint_positions(self, q: ArrayLike) -> NDArray[np.float64]:
        """Where the joints and the tool are (k + 1, 3) [m] at q (k,) [rad]: the stick figure."""
        self.plant.SetPositions(self._context, q)
        frames = [*(joint.frame_on_child() for joint in self._joints), self._tool]
        places = [frame.CalcPoseInWorld(self._context).translation() for frame in frames]
        return np.array(places)

    def tool_motion(self, q: ArrayLike, v: ArrayLike) -> ToolMotion:
        """Pose and velocity of the tool at q (k,) [rad] and v (k,) [rad/s]."""
        self.plant.SetPositions(self._context, q)
        self.plant.SetVelocities(self._context, v)
        pose = self._tool.CalcPoseInWorld(self._context)
        velocity = self._tool.CalcSpatialVelocityInWorld(self._context)
        return ToolMotion(
            pose.rotation().matrix(),
            pose.translation(),
            velocity.rotational(),
            velocity.translational(),
        )

    def tool_jacobian(self, q: ArrayLike) -> NDArray[np.float64]:
        """Jacobian (6, k) of the tool's spatial velocity: angular first, in the world."""
        self.plant.SetPositions(self._context, q)
        world = self.plant.world_frame()
        jacobian: NDArray[np.float64] = self.plant.CalcJacobianSpatialVelocity(
            self._context,
            JacobianWrtVariable.kV,
            self._tool,
            np.zeros(3),
            world,
            world,
        )
        return jacobian


def moving_joints(plant: MultibodyPlant, instance: ModelInstanceIndex | None = None) -> list[Joint]:
    """Joints that move, of a model or of all; in the order of the angles, once finalised.

    Args:
        plant: What has them.
        instance: The model; all if None.
    """
    indices = plant.GetJointIndices() if instance is None else plant.GetJointIndices(instance)
    moving = [joint for joint in map(plant.get_joint, indices) if joint.num_velocities()]
    if plant.is_finalized():
        moving.sort(key=lambda joint: joint.velocity_start())
    return moving


def load_plant(directives: Path, time_step: float = 0.0) -> MultibodyPlant:
    """A finalised plant of the models that a directives file names.

    Raises:
        ModelFileError: The file or a model it names cannot be read.
    """
    plant = MultibodyPlant(time_step)
    add_directives(plant, directives)
    plant.Finalize()
    return plant
