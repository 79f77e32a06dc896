"""Friction in an arm's joints, of which its controller knows nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import MatrixGain, Saturation

_RUB = 0.05  # [rad/s] below this speed Coulomb friction fades, so that it can be integrated


def add_viscous_friction(
    plant: MultibodyPlant, instance: ModelInstanceIndex, viscous: NDArray[np.float64]
) -> None:
    """Brake each joint of an arm by a torque ``-viscous v``; before the plant is finalised.

    Args:
        plant: The plant that moves.
        instance: The arm in it.
        viscous: (k,) for each moving joint, in the order of the model [N m s/rad].
    """
    joints = [plant.get_joint(index) for index in plant.GetJointIndices(instance)]
    moving = [joint for joint in joints if joint.num_velocities() == 1]
    for joint, value in zip(moving, viscous, strict=True):
        joint.set_default_damping_vector([value])


def add_coulomb_friction(
    builder: DiagramBuilder,
    plant: MultibodyPlant,
    instance: ModelInstanceIndex,
    coulomb: NDArray[np.float64],
) -> None:
    """Brake each joint of an arm by a torque that knows only the sign of its speed.

    Args:
        builder: Where its systems go.
        plant: The plant that moves, finalised, in the builder.
        instance: The arm in it.
        coulomb: (k,) [N m].
    """
    k, all_of_them = len(coulomb), plant.num_velocities()
    speeds = np.hstack([np.zeros((k, k)), np.eye(k)])  # of the arm's state
    columns = plant.GetVelocitiesFromArray(instance, np.arange(all_of_them)).astype(int)
    opposed = np.zeros((all_of_them, k))
    opposed[columns, np.arange(k)] = -1.0
    rubbing = builder.AddNamedSystem("rubbing", MatrixGain((coulomb / _RUB)[:, None] * speeds))
    bounded = builder.AddNamedSystem("coulomb_friction", Saturation(-coulomb, coulomb))
    braking = builder.AddNamedSystem("braking", MatrixGain(opposed))
    builder.Connect(plant.get_state_output_port(instance), rubbing.get_input_port())
    builder.Connect(rubbing.get_output_port(), bounded.get_input_port())
    builder.Connect(bounded.get_output_port(), braking.get_input_port())
    builder.Connect(braking.get_output_port(), plant.get_applied_generalized_force_input_port())
