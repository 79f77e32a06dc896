"""Friction in the joints: the torques it adds, and to which joints."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import QuaternionFloatingJoint, SpatialInertia
from pydrake.systems.framework import DiagramBuilder

from drake_viapoint.packages import package_map, resolve
from drake_viapoint.robot.joint_friction import add_coulomb_friction, add_viscous_friction

COULOMB = np.array([7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0])  # each joint its own
VISCOUS = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
FADES = 0.05  # [rad/s]


class Rig:
    """An arm, which nothing drives, and a crate that flies about."""

    def __init__(
        self, viscous: NDArray | None = None, coulomb: NDArray | None = None, *, crate_first: bool
    ) -> None:
        builder = DiagramBuilder()
        plant = builder.AddNamedSystem("plant", MultibodyPlant(0.0))
        crate = plant.AddRigidBody("crate", SpatialInertia.SolidBoxWithMass(2.0, 0.1, 0.2, 0.3))
        if crate_first:  # with a joint of its own it takes the first columns, without the last
            plant.AddJoint(
                QuaternionFloatingJoint("flies", plant.world_frame(), crate.body_frame())
            )
        parser = Parser(plant)
        parser.package_map().AddMap(package_map())
        parser.AddModels(str(resolve("package://drake_viapoint/arm_with_racket.dmd.yaml")))
        self.instance = plant.GetModelInstanceByName("arm")
        if viscous is not None:
            add_viscous_friction(plant, self.instance, viscous)
        plant.Finalize()
        if coulomb is not None:
            add_coulomb_friction(builder, plant, self.instance, coulomb)
        self.plant = plant
        self.columns = plant.GetVelocitiesFromArray(self.instance, np.arange(13.0)).astype(int)
        self._diagram = builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        self._own = plant.GetMyMutableContextFromRoot(self._context)

    def acceleration(self, q: NDArray, v: NDArray, crate: NDArray) -> NDArray:
        """Of all joints, at the arm's angles and speeds and the crate's velocity."""
        everything = np.zeros(13)
        everything[np.setdiff1d(np.arange(13), self.columns)] = crate
        everything[self.columns] = v
        self.plant.SetPositions(self._own, self.instance, q)
        self.plant.SetVelocities(self._own, everything)
        return self.plant.get_generalized_acceleration_output_port().Eval(self._own)

    def mass_matrix(self) -> NDArray:
        return self.plant.CalcMassMatrix(self._own)


class Compared:
    """The same arm with friction and without."""

    def __init__(
        self,
        viscous: NDArray | None = None,
        coulomb: NDArray | None = None,
        crate_first: bool = False,
    ) -> None:
        self.free = Rig(crate_first=crate_first)
        self.braked = Rig(viscous, coulomb, crate_first=crate_first)

    def torque(self, v: NDArray, seed: int = 0) -> tuple[NDArray, NDArray]:
        """What friction adds: to the arm's joints (7,), and to the crate (6,)."""
        rng = np.random.default_rng(seed)
        state = rng.uniform(-1.0, 1.0, 7), v, rng.uniform(-3.0, 3.0, 6)
        difference = self.braked.acceleration(*state) - self.free.acceleration(*state)
        torque = self.free.mass_matrix() @ difference
        arm = self.free.columns
        return torque[arm], np.delete(torque, arm)


@pytest.fixture(scope="module")
def rubbing() -> Compared:
    return Compared(coulomb=COULOMB)


@pytest.fixture(scope="module")
def oiled() -> Compared:
    return Compared(viscous=VISCOUS)


def signed(seed: int, least: float, most: float) -> NDArray:
    rng = np.random.default_rng(seed)
    return rng.uniform(least, most, 7) * rng.choice([-1.0, 1.0], 7)


@pytest.mark.parametrize("seed", range(5))
def test_coulomb_friction_opposes_motion_with_its_full_size(rubbing: Compared, seed: int) -> None:
    v = signed(seed, FADES, 5.0)
    torque, _ = rubbing.torque(v, seed)
    np.testing.assert_allclose(torque, -COULOMB * np.sign(v), atol=1e-9)


@given(st.lists(st.floats(-FADES, FADES), min_size=7, max_size=7).map(np.array))
@settings(max_examples=30)
def test_coulomb_friction_fades_linearly_to_rest(rubbing: Compared, v: NDArray) -> None:
    torque, _ = rubbing.torque(v)
    np.testing.assert_allclose(torque, -COULOMB * v / FADES, atol=1e-9)


@given(st.lists(st.floats(-5.0, 5.0), min_size=7, max_size=7).map(np.array))
@settings(max_examples=30)
def test_viscous_friction_is_linear_in_the_speeds(oiled: Compared, v: NDArray) -> None:
    torque, _ = oiled.torque(v)
    np.testing.assert_allclose(torque, -VISCOUS * v, atol=1e-9)


@pytest.mark.parametrize("crate_first", [False, True])
def test_nothing_but_the_arm_is_braked(crate_first: bool) -> None:
    both = Compared(VISCOUS, COULOMB, crate_first)
    expected = np.arange(6, 13) if crate_first else np.arange(7)
    np.testing.assert_array_equal(both.free.columns, expected)
    v = signed(1, 0.1, 5.0)
    on_arm, on_crate = both.torque(v)
    np.testing.assert_allclose(on_arm, -VISCOUS * v - COULOMB * np.sign(v), atol=1e-9)
    np.testing.assert_allclose(on_crate, 0.0, atol=1e-9)


@pytest.mark.parametrize("joint", range(7))
def test_a_joint_brakes_itself_alone(rubbing: Compared, oiled: Compared, joint: int) -> None:
    v = np.zeros(7)
    v[joint] = -2.0
    for compared, size in ((rubbing, COULOMB), (oiled, 2.0 * VISCOUS)):
        torque, _ = compared.torque(v)
        np.testing.assert_allclose(torque, size * np.eye(7)[joint], atol=1e-9)
