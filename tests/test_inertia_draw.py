"""Bodies as they may really be: within range of the model's, possible, and only in a context."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, SpatialInertia, UnitInertia

from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.inertia_draw import apply_inertias, draw_inertias

seeds = st.integers(0, 2**32 - 1)
spreads = st.floats(0.0, 0.99)


@pytest.fixture(scope="module")
def plant(arm: Arm) -> MultibodyPlant:
    return arm.plant


@pytest.fixture(scope="module")
def robot(plant: MultibodyPlant) -> list[ModelInstanceIndex]:
    return [plant.GetModelInstanceByName(name) for name in ("arm", "racket")]


def central(inertia: SpatialInertia) -> NDArray:
    """Moments and products about the centre of mass, of a unit mass (6,)."""
    unit = inertia.Shift(inertia.get_com()).get_unit_inertia()
    return np.concatenate([unit.get_moments(), unit.get_products()])


@given(seeds, spreads)
@settings(max_examples=50)
def test_masses_and_moments_are_scaled_within_the_range(
    plant: MultibodyPlant, robot: list[ModelInstanceIndex], seed: int, spread: float
) -> None:
    """All moments of a body by one factor; its centre of mass stays."""
    drawn = draw_inertias(plant, robot, spread, np.random.default_rng(seed))
    for index, inertia in drawn.items():
        modelled = plant.get_body(index).default_spatial_inertia()
        heavier = inertia.get_mass() / modelled.get_mass()
        wider = central(inertia)[:3].sum() / central(modelled)[:3].sum()
        rounding = 1e-9
        assert abs(heavier - 1) <= spread + rounding
        assert abs(wider - 1) <= spread + rounding
        np.testing.assert_allclose(central(inertia), wider * central(modelled), atol=1e-12)
        np.testing.assert_allclose(inertia.get_com(), modelled.get_com(), atol=1e-14)


def test_factors_are_even_and_independent(
    plant: MultibodyPlant, robot: list[ModelInstanceIndex]
) -> None:
    """Mass and moments of ten bodies, over a few hundred robots."""
    bodies = [index for instance in robot for index in plant.GetBodyIndices(instance)]
    modelled = [plant.get_body(index).default_spatial_inertia() for index in bodies]
    n = 300
    deviations = np.empty((n, len(bodies), 2))
    for seed in range(n):
        drawn = draw_inertias(plant, robot, 0.2, np.random.default_rng(seed))
        for number, (index, model) in enumerate(zip(bodies, modelled, strict=True)):
            heavier = drawn[index].get_mass() / model.get_mass()
            wider = central(drawn[index])[0] / central(model)[0]
            deviations[seed, number] = (heavier - 1) / 0.2, (wider - 1) / 0.2
    deviations = deviations.reshape(n, -1)
    # of n uniform draws the mean and the variance stray by 1/sqrt(3n) and sqrt(4/45/n)
    assert np.all(np.abs(deviations.mean(axis=0)) < 5 / np.sqrt(3 * n))
    assert np.all(np.abs(deviations.var(axis=0) - 1 / 3) < 5 * np.sqrt(4 / 45 / n))
    correlations = np.corrcoef(deviations.T) - np.eye(2 * len(bodies))
    assert np.all(np.abs(correlations) < 5 / np.sqrt(n))


def test_a_possible_body_stays_possible(
    plant: MultibodyPlant, robot: list[ModelInstanceIndex]
) -> None:
    for seed in range(200):
        drawn = draw_inertias(plant, robot, 0.95, np.random.default_rng(seed))
        assert all(inertia.IsPhysicallyValid() for inertia in drawn.values())


def test_a_barely_possible_body_stays_possible() -> None:
    """A rod, a plate and a point, whose moments add up to no more than they must; and nothing."""
    plant = MultibodyPlant(0.0)
    odd = plant.AddModelInstance("odd")
    away = np.array([0.1, -0.2, 0.3])
    bodies = {
        "rod": (1.0, UnitInertia.ThinRod(0.5, [0, 0, 1]), away),
        "plate": (2.0, UnitInertia(0.1, 0.2, 0.3), away),
        "point": (0.1, UnitInertia(0.0, 0.0, 0.0), away),
        "nothing": (0.0, UnitInertia(0.0, 0.0, 0.0), np.zeros(3)),
    }
    for name, (mass, unit, centre) in bodies.items():
        inertia = SpatialInertia(mass, np.zeros(3), unit).Shift(-centre)
        plant.AddRigidBody(name, odd, inertia)
    plant.Finalize()
    for seed in range(200):
        drawn = draw_inertias(plant, [odd], 0.9, np.random.default_rng(seed))
        assert len(drawn) == len(bodies)
        assert all(inertia.IsPhysicallyValid() for inertia in drawn.values())


def test_the_same_generator_draws_the_same_and_another_another(
    plant: MultibodyPlant, robot: list[ModelInstanceIndex]
) -> None:
    one, same, other = (
        draw_inertias(plant, robot, 0.2, np.random.default_rng(seed)) for seed in (3, 3, 4)
    )
    for index, inertia in one.items():
        matrix = inertia.CopyToFullMatrix6()
        np.testing.assert_array_equal(matrix, same[index].CopyToFullMatrix6())
        assert inertia.get_mass() != other[index].get_mass()


def test_without_spread_bodies_are_as_modelled(
    plant: MultibodyPlant, robot: list[ModelInstanceIndex]
) -> None:
    for index, inertia in draw_inertias(plant, robot, 0.0, np.random.default_rng(0)).items():
        modelled = plant.get_body(index).default_spatial_inertia().CopyToFullMatrix6()
        np.testing.assert_allclose(inertia.CopyToFullMatrix6(), modelled, rtol=1e-12, atol=1e-15)


def test_bodies_of_the_chosen_models_differ_and_no_others(
    plant: MultibodyPlant, robot: list[ModelInstanceIndex]
) -> None:
    for chosen in (robot, robot[1:], []):
        drawn = draw_inertias(plant, chosen, 0.2, np.random.default_rng(0))
        assert set(drawn) == {i for instance in chosen for i in plant.GetBodyIndices(instance)}


def test_they_differ_in_one_context_and_not_in_the_plant(
    plant: MultibodyPlant, robot: list[ModelInstanceIndex]
) -> None:
    context, untouched = plant.CreateDefaultContext(), plant.CreateDefaultContext()
    mass = plant.CalcTotalMass(untouched)
    drawn = draw_inertias(plant, robot, 0.2, np.random.default_rng(0))
    modelled = defaults(plant, drawn)
    apply_inertias(plant, context, drawn)
    for index, inertia in drawn.items():
        found = plant.get_body(index).CalcSpatialInertiaInBodyFrame(context).CopyToFullMatrix6()
        np.testing.assert_allclose(found, inertia.CopyToFullMatrix6(), rtol=1e-13, atol=1e-15)
        assert not np.allclose(found, modelled[index], rtol=1e-4)
    total = sum(inertia.get_mass() for inertia in drawn.values())
    assert plant.CalcTotalMass(context) == pytest.approx(total)
    for other in (untouched, plant.CreateDefaultContext()):
        assert plant.CalcTotalMass(other) == mass != total
    for index, matrix in defaults(plant, drawn).items():
        np.testing.assert_array_equal(matrix, modelled[index])


def defaults(plant: MultibodyPlant, bodies: Iterable[BodyIndex]) -> dict[BodyIndex, NDArray]:
    return {
        index: plant.get_body(index).default_spatial_inertia().CopyToFullMatrix6()
        for index in bodies
    }
