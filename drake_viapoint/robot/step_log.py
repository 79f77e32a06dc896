"""What moved at the integrator's steps, read while it moves.

What a log asks the plant for, the integrator needs for its next step anyway.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context

from drake_viapoint.robot.arm_motion import MotionSegment
from drake_viapoint.robot.tracking import Tracking


class StepLog:
    """Joint states of one model at the integrator's steps.

    Args:
        plant: The plant that moves.
        instance: The model in it.
        context: The simulator's, which all steps change in place.
    """

    def __init__(
        self, plant: MultibodyPlant, instance: ModelInstanceIndex, context: Context
    ) -> None:
        self._root = context
        self._own = plant.GetMyContextFromRoot(context)
        self._state = plant.get_state_output_port(instance)
        self._acceleration = plant.get_generalized_acceleration_output_port(instance)
        self.times: list[float] = []
        self._states: list[NDArray[np.float64]] = []

    def add(self) -> None:
        """Write down the state in which the context is."""
        self.times.append(self._root.get_time())
        self._states.append(
            np.concatenate([self._state.Eval(self._own), self._acceleration.Eval(self._own)])
        )

    def drop_last(self) -> None:
        """Strike out the last step."""
        self.times.pop()
        self._states.pop()

    def segment(self) -> MotionSegment:
        """All steps so far."""
        q, v, acceleration = np.split(np.array(self._states), 3, axis=1)
        return MotionSegment(np.array(self.times), q, v, acceleration)


class ArmLog(StepLog):
    """Joint states and torques of an arm that is made to follow a trajectory.

    Args:
        plant: The plant that moves.
        instance: The arm in it.
        tracking: Its controller.
        context: The simulator's, which all steps change in place.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        instance: ModelInstanceIndex,
        tracking: Tracking,
        context: Context,
    ) -> None:
        super().__init__(plant, instance, context)
        self._torque = tracking.torque_before_clamping(context)
        self._effort = tracking.arm.limits.effort
        self._torques: list[NDArray[np.float64]] = []

    def add(self) -> None:
        """See ``StepLog``."""
        super().add()
        self._torques.append(self._torque())

    def drop_last(self) -> None:
        """See ``StepLog``."""
        super().drop_last()
        self._torques.pop()

    def clamped(self) -> NDArray[np.bool_]:
        """Whether a joint's torque was clamped at a step (k,)."""
        wanted: NDArray[np.bool_] = np.any(np.abs(self._torques) > self._effort, axis=0)
        return wanted
