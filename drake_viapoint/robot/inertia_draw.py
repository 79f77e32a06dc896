"""Bodies whose masses differ from what their model says, as a robot's do from its data sheet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, SpatialInertia, UnitInertia
from pydrake.systems.framework import Context


def draw_inertias(
    plant: MultibodyPlant,
    instances: Sequence[ModelInstanceIndex],
    spread: float,
    rng: np.random.Generator,
) -> Mapping[BodyIndex, SpatialInertia]:
    """What bodies may really weigh.

    A body's mass, and its moments a mass about its centre of mass, are each scaled by a factor
    drawn evenly between 1 - spread and 1 + spread; its centre of mass stays. So what was a possible
    body stays one.

    Args:
        plant: With the bodies as modelled.
        instances: Models whose bodies differ.
        spread: In [0, 1).
        rng: Draws two numbers a body.
    """
    drawn = {}
    for instance in instances:
        for index in plant.GetBodyIndices(instance):
            heavier, wider = 1.0 + spread * rng.uniform(-1.0, 1.0, size=2)
            drawn[index] = _scaled(plant.get_body(index).default_spatial_inertia(), heavier, wider)
    return drawn


def apply_inertias(
    plant: MultibodyPlant, context: Context, inertias: Mapping[BodyIndex, SpatialInertia]
) -> None:
    """Give bodies these inertias in a plant's context."""
    for index, inertia in inertias.items():
        plant.get_body(index).SetSpatialInertiaInBodyFrame(context, inertia)


def _scaled(inertia: SpatialInertia, heavier: float, wider: float) -> SpatialInertia:
    centre = inertia.get_com()
    about_centre = inertia.Shift(centre).get_unit_inertia()
    moments, products = about_centre.get_moments() * wider, about_centre.get_products() * wider
    central = SpatialInertia(
        inertia.get_mass() * heavier, np.zeros(3), UnitInertia(*moments, *products)
    )
    scaled: SpatialInertia = central.Shift(-centre)
    return scaled
