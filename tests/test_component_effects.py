"""What each component does: exact on linear tasks, and a named gap where nothing can be seen."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.learning.component_effects import component_effects
from drake_viapoint.motion.via_points import ViaPoints

VIA_POINTS = ViaPoints(np.arange(3.0), np.zeros((3, 2)), ("x", "phi"))
SIZES = {"x": 0.05, "phi": 0.1}


class World:
    """T_H and T_G are linear in all six components; beyond a bound of one, T_G is lost."""

    def __init__(self, seed: int = 0, bound: float = np.inf, curve: float = 0.0) -> None:
        rng = np.random.default_rng(seed)
        self.h, self.g = rng.normal(size=(3, 6)), rng.normal(size=(2, 6))
        self.bound, self.curve = bound, curve
        self.executed: list[NDArray] = []

    def __call__(self, via_points: ViaPoints) -> Outcome:
        s = via_points.values.ravel()
        self.executed.append(s)
        lost = s[2] > self.bound
        t_g = None if lost else self.g @ s + self.curve * np.sum(s**2)
        return Outcome({"T_H": self.h @ s, "T_G": t_g}, {}, False)


@given(seed=st.integers(0, 2**31))
def test_columns_of_a_linear_task_are_its_jacobian(seed: int) -> None:
    world = World(seed)
    effects = component_effects(world, VIA_POINTS, SIZES, ("T_H", "T_G"))
    sizes = np.tile([0.05, 0.1], 3)
    for name, jacobian in (("T_H", world.h), ("T_G", world.g)):
        assert effects[name].components == VIA_POINTS.components
        np.testing.assert_allclose(effects[name].columns, jacobian * sizes, atol=1e-12)
        np.testing.assert_allclose(
            effects[name].norms, np.linalg.norm(jacobian, axis=0) * sizes, atol=1e-12
        )
        assert not effects[name].gaps


def test_differences_are_central_so_a_bend_does_not_show() -> None:
    bent = component_effects(World(curve=5.0), VIA_POINTS, SIZES, ("T_G",))["T_G"]
    straight = component_effects(World(), VIA_POINTS, SIZES, ("T_G",))["T_G"]
    np.testing.assert_allclose(bent.columns, straight.columns, atol=1e-12)


def test_one_component_at_a_time_and_every_trial_is_told() -> None:
    world, told = World(), []
    component_effects(world, VIA_POINTS, SIZES, ("T_H",), lambda: told.append(1))
    assert len(told) == len(world.executed) == 13
    assert [int(np.count_nonzero(s)) for s in world.executed] == [0] + [1] * 12


def test_what_loses_the_task_variable_is_a_gap_with_a_name() -> None:
    effects = component_effects(World(bound=0.02), VIA_POINTS, SIZES, ("T_H", "T_G"))
    assert dict(effects["T_G"].gaps) == {"x2": "x2 moved by +0.05 does not reach T_G"}
    assert np.isnan(effects["T_G"].norms).tolist() == [False, False, True, False, False, False]
    assert not effects["T_H"].gaps
    never = World(bound=-1.0)
    with pytest.raises(LearningError, match="does not reach T_G"):
        component_effects(never, VIA_POINTS, SIZES, ("T_G",))


def test_a_number_that_is_none_is_a_gap_too() -> None:
    def execute(via_points: ViaPoints) -> Outcome:
        s = via_points.values.ravel()
        value = np.nan if s[5] != 0 else s[0]
        return Outcome({"T": np.array([value])}, {}, False)

    effects = component_effects(execute, VIA_POINTS, SIZES, ("T",))["T"]
    assert dict(effects.gaps) == {"phi3": "phi3 moved by +0.1 and -0.1 does not reach T"}


@pytest.mark.parametrize("sizes", [{"x": 0.05}, {"x": 0.05, "phi": 0.0}, {"x": 0.05, "phi": -1.0}])
def test_every_dimension_needs_a_perturbation(sizes: dict[str, float]) -> None:
    with pytest.raises(LearningError, match="no positive perturbation for phi"):
        component_effects(World(), VIA_POINTS, sizes, ("T_H",))
