"""Making the arm follow a joint trajectory: inverse dynamics with feedforward, torques clamped."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pydrake.math import BsplineBasis
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.controllers import InverseDynamicsController
from pydrake.systems.framework import Context, DiagramBuilder
from pydrake.systems.primitives import Demultiplexer, Saturation, TrajectorySource
from pydrake.trajectories import BsplineTrajectory
from scipy.interpolate import BSpline

from drake_viapoint.errors import RetargetingError
from drake_viapoint.robot.arm import Arm


def drake_trajectory(spline: BSpline[np.float64]) -> BsplineTrajectory:
    """The same curve as Drake's own type; knots and coefficients carry over unchanged.

    Args:
        spline: B-spline with k columns.
    """
    points = [np.array(column).reshape(-1, 1) for column in spline.c]
    return BsplineTrajectory(BsplineBasis(spline.k + 1, list(spline.t)), points)


class Tracking:
    """The controller of one arm inside a diagram.

    The torque is the inverse dynamics of the controller's own model of the arm, for the desired
    acceleration plus a spring and damper on the error, clamped at the joints' efforts. The model
    knows the arm and its tool, not what the tool carries.

    Args:
        builder: Where the controller's systems go.
        plant: The plant that moves, already in the builder.
        instance: The arm in that plant.
        arm: The controller's model.
        natural_frequency: Of the error's decay, critically damped [rad/s].
    """

    def __init__(
        self,
        builder: DiagramBuilder,
        plant: MultibodyPlant,
        instance: ModelInstanceIndex,
        arm: Arm,
        natural_frequency: float,
    ) -> None:
        k = arm.num_joints
        self.arm = arm
        stiffness = np.full(k, natural_frequency**2)
        damping = np.full(k, 2 * natural_frequency)
        hold = BSpline(np.r_[np.zeros(6), np.ones(6)], np.tile(arm.rest, (6, 1)), 5)
        self._source = builder.AddNamedSystem(
            "desired_motion", TrajectorySource(drake_trajectory(hold), 2)
        )
        split = builder.AddNamedSystem("split", Demultiplexer([2 * k, k]))
        self._controller = builder.AddNamedSystem(
            "inverse_dynamics",
            InverseDynamicsController(
                arm.plant, stiffness, np.zeros(k), damping, has_reference_acceleration=True
            ),
        )
        clamp = builder.AddNamedSystem(
            "effort_limits", Saturation(-arm.limits.effort, arm.limits.effort)
        )
        control = self._controller
        builder.Connect(self._source.get_output_port(), split.get_input_port())
        builder.Connect(split.get_output_port(0), control.get_input_port_desired_state())
        builder.Connect(split.get_output_port(1), control.get_input_port_desired_acceleration())
        builder.Connect(
            plant.get_state_output_port(instance), control.get_input_port_estimated_state()
        )
        builder.Connect(control.get_output_port_control(), clamp.get_input_port())
        builder.Connect(clamp.get_output_port(), plant.get_actuation_input_port(instance))

    def follow(self, trajectory: BSpline[np.float64]) -> None:
        """Follow this joint trajectory from now on; set the context's time afterwards.

        Drake keeps cached outputs when the trajectory changes and drops them when time is set.

        Raises:
            RetargetingError: The trajectory is not one of this arm's joints.
        """
        if trajectory.c.ndim != 2 or trajectory.c.shape[1] != self.arm.num_joints:
            raise RetargetingError(
                f"the arm has {self.arm.num_joints} joints, the trajectory {trajectory.c.shape}"
            )
        self._source.UpdateTrajectory(drake_trajectory(trajectory))

    def torque_before_clamping(self, context: Context) -> Callable[[], NDArray[np.float64]]:
        """A function of no argument that reads the torque (k,) [N m] before it is clamped.

        Args:
            context: Of the whole diagram; the function always reads this one.
        """
        own = self._controller.GetMyContextFromRoot(context)
        port = self._controller.get_output_port_control()
        return lambda: port.Eval(own)
