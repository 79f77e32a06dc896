"""The pendulum as a body in Drake: a rod without mass and a bob, on an axle without friction."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Cylinder, Sphere
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, RevoluteJoint, SpatialInertia, UnitInertia

from drake_viapoint.tasks.pendulum import HANGING
from drake_viapoint.tasks.upswing_scenario import UpswingPendulum

PENDULUM = "pendulum"
"""Name of the pendulum's model instance, its body and its joint."""

_ROD, _BOB, _AXLE = 0.006, 0.028, 0.008  # [m] radii
_AXLE_LENGTH = 0.07  # [m] from the hand to the plane of the pendulum
_DARK = np.array([0.16, 0.17, 0.20, 1.0])
_RED = np.array([0.80, 0.16, 0.14, 1.0])


def hang_pendulum(plant: MultibodyPlant, hinge: Frame, pendulum: UpswingPendulum) -> RevoluteJoint:
    """Hang a pendulum into a plant that is not yet finalised.

    Its joint's angle is theta: 0 where the bob is along the hinge's z, anticlockwise when looked at
    along the hinge's y, and hanging by default.

    Args:
        plant: The plant; looks are added if it has a scene to show them in.
        hinge: Frame whose y is the axis.
        pendulum: Its measures.

    Returns:
        The joint, in a model instance of its own called ``PENDULUM``.
    """
    length, mass = pendulum.length, pendulum.mass
    instance = plant.AddModelInstance(PENDULUM)
    point = UnitInertia(length**2, length**2, 0.0)
    body = plant.AddRigidBody(
        PENDULUM, instance, SpatialInertia(mass, np.array([0.0, 0.0, length]), point)
    )
    joint = plant.AddJoint(
        RevoluteJoint(
            PENDULUM,
            hinge,
            body.body_frame(),
            np.array([0.0, -1.0, 0.0]),
            damping=pendulum.damping * mass * length**2,
        )
    )
    joint.set_default_angle(HANGING)
    if plant.geometry_source_is_registered():
        forward = RollPitchYaw(np.pi / 2, 0.0, 0.0)
        axle = RigidTransform(forward, np.array([0.0, -_AXLE_LENGTH / 2, 0.0]))
        rod = RigidTransform(np.array([0.0, 0.0, length / 2]))
        bob = RigidTransform(np.array([0.0, 0.0, length]))
        look = plant.RegisterVisualGeometry
        look(body, axle, Cylinder(_AXLE, _AXLE_LENGTH), "axle", _DARK)
        look(body, rod, Cylinder(_ROD, length), "rod", _DARK)
        look(body, bob, Sphere(_BOB), "bob", _RED)
    return joint
