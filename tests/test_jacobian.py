"""What becomes of a Jacobian: kept, explored again when told to, estimated from what was tried."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.ask_tell import Outcome, Purpose
from drake_viapoint.learning.gain import ConstantGain
from drake_viapoint.learning.jacobian import (
    ExploredJacobian,
    KeptJacobian,
    Observation,
    RecordedJacobian,
)
from drake_viapoint.learning.learner import Learner
from drake_viapoint.learning.subtask import Subtask
from drake_viapoint.motion.via_points import ViaPoints

SIZE = 0.05
SUBTASK = Subtask(
    "swing",
    ("x2", "x3", "x4"),
    "T",
    (SIZE,) * 3,
    ConstantGain(0.5),
    regularization=1e-9,
    reached=0.0,
    one_sided=True,
)


def observations(
    jacobian: NDArray, count: int, seed: int = 0, scale: float = 1.0
) -> list[Observation]:
    """Trials of a linear task: the error falls by J times the change of S."""
    s = np.random.default_rng(seed).normal(scale=scale, size=(count, jacobian.shape[1]))
    return [Observation(row, 3.0 - jacobian @ row) for row in s]


def true_jacobian(seed: int = 1) -> NDArray:
    return np.random.default_rng(seed).normal(size=(2, 3))


def test_kept_is_kept() -> None:
    j = true_jacobian()
    assert KeptJacobian().revised(j, observations(np.zeros((2, 3)), 5)) is j
    assert not any(KeptJacobian().explores_again(trial, 0) for trial in range(100))


@given(count=st.integers(4, 12), seed=st.integers(0, 2**31))
def test_enough_differences_give_the_jacobian_of_a_linear_task(count: int, seed: int) -> None:
    j = true_jacobian(seed)
    recorded = RecordedJacobian(12, 0.0).revised(np.zeros((2, 3)), observations(j, count, seed))
    np.testing.assert_allclose(recorded, j, atol=1e-6)


def test_recorded_is_ridge_regression_of_the_differences() -> None:
    """Against the normal equations of Eq. 12, written out."""
    j, regularization = true_jacobian(), 0.7
    seen = observations(j, 9, scale=0.5)
    x = np.array([b.control - a.control for a, b in pairwise(seen)])
    t = np.array([a.error - b.error for a, b in pairwise(seen)])
    expected = np.linalg.solve(x.T @ x + regularization * np.eye(3), x.T @ t).T
    recorded = RecordedJacobian(20, regularization).revised(j, seen)
    np.testing.assert_allclose(recorded, expected, atol=1e-12)
    assert np.linalg.norm(recorded) < np.linalg.norm(j)  # regularization makes it smaller


def test_recorded_looks_at_the_last_differences_only() -> None:
    old, new = true_jacobian(1), true_jacobian(2)
    seen = [*observations(old, 30), *observations(new, 13)]
    np.testing.assert_allclose(RecordedJacobian(12, 0.0).revised(old, seen), new, atol=1e-9)
    mixed = RecordedJacobian(13, 0.0).revised(old, seen)  # one difference spans both worlds
    assert np.abs(mixed - new).max() > 1e-3


def test_averages_noise_where_it_looks_at_many_differences() -> None:
    """What section 3.2 wants it for: the larger K, the nearer in spite of noise."""
    j = true_jacobian()

    def worst(window: int) -> float:
        errors = []
        for seed in range(40):
            rng = np.random.default_rng(seed)
            seen = [
                Observation(o.control, o.error + rng.normal(scale=0.3, size=2))
                for o in observations(j, 41, seed)
            ]
            errors.append(np.linalg.norm(RecordedJacobian(window, 0.0).revised(j, seen) - j))
        return float(np.median(errors))

    assert worst(40) < 0.5 * worst(5)


def test_with_fewer_than_two_trials_there_is_nothing_to_estimate_from() -> None:
    j = true_jacobian()
    assert RecordedJacobian(12, 1.0).revised(j, observations(j, 1)) is j


def test_a_window_and_a_regularization_have_bounds() -> None:
    with pytest.raises(LearningError, match="at least 1 difference, got 0"):
        RecordedJacobian(0, 1.0)
    for bad in (-1.0, np.nan):
        with pytest.raises(LearningError, match="must not be negative"):
            RecordedJacobian(12, bad)


def test_explored_again_at_each_trial_named_and_once() -> None:
    way = ExploredJacobian((10, 20))
    assert not way.explores_again(9, 7)
    assert way.explores_again(10, 7)
    assert way.explores_again(12, 7)  # trials 10 and 11 gave no error to explore around
    assert not way.explores_again(17, 16)
    assert way.explores_again(20, 16)
    assert not ExploredJacobian((3,)).explores_again(8, 7)  # it was an exploration itself


@dataclass
class Bent:
    """A task whose slope changes as it is learned: T = J s + c (j0 s)^2."""

    j: NDArray  # (2, 3)
    bend: float = 0.0
    goal: tuple[float, float] = (0.6, -0.4)

    def __call__(self, s: NDArray) -> Outcome:
        t = self.j @ s + self.bend * np.array([(self.j[0] @ s) ** 2, 0.0])
        goal = np.array(self.goal)
        return Outcome({"T": t}, {"T": goal}, bool(np.linalg.norm(goal - t) < 0.01))


def run(world: Bent, way: KeptJacobian, trials: int) -> tuple[Learner, list[tuple[str, NDArray]]]:
    via_points = ViaPoints(np.arange(5.0), np.zeros((5, 1)), ("x",))
    learner = Learner(via_points, (replace(SUBTASK, jacobian=way),), successes_to_learn=0)
    made = []
    for _ in range(trials):
        proposal = learner.ask()
        s = proposal.via_points.select(SUBTASK.control)
        made.append((str(proposal.purpose), s))
        learner.tell(world(s))
    return learner, made


def test_one_sided_exploration_takes_a_trial_a_component_after_the_first() -> None:
    world = Bent(true_jacobian())
    learner, made = run(world, KeptJacobian(), 4)
    assert [purpose for purpose, _ in made] == ["learning"] + 3 * ["exploration"]
    np.testing.assert_array_equal([s for _, s in made[1:]], SIZE * np.eye(3))
    np.testing.assert_allclose(learner.jacobians["swing"], world.j, atol=1e-9)
    assert learner.ask().purpose is Purpose.LEARNING
    step = learner.ask().via_points.select(SUBTASK.control)
    np.testing.assert_allclose(world.j @ step, 0.5 * np.array(world.goal), atol=1e-5)


def test_explored_again_around_the_trial_just_made() -> None:
    world = Bent(true_jacobian(), bend=0.5)
    learner, made = run(world, ExploredJacobian((6,)), 10)
    assert [p for p, _ in made].count("exploration") == 6
    around = made[5][1]
    moved = np.array([s for p, s in made[6:9] if p == "exploration"])
    np.testing.assert_allclose(moved - around, SIZE * np.eye(3), atol=1e-12)
    slope = (world.j[0] @ around) * 2 * world.bend * world.j[0]
    expected = world.j + np.array([slope, np.zeros(3)])
    np.testing.assert_allclose(learner.jacobians["swing"], expected, atol=0.1)
    kept, _ = run(world, KeptJacobian(), 10)
    assert np.abs(kept.jacobians["swing"] - expected).max() > 0.15


def test_recorded_follows_the_bend_without_another_trial() -> None:
    world = Bent(true_jacobian(), bend=0.5)
    learner, made = run(world, RecordedJacobian(6, 1e-3), 25)
    assert [p for p, _ in made].count("exploration") == 3
    assert learner.learned_at is None  # told to go on whatever succeeds
    assert world(made[-1][1]).success


def test_a_fourth_way_is_one_small_class() -> None:
    """Broyden's, as in the literature: the least change that explains the last difference."""

    @dataclass(frozen=True)
    class Broyden(KeptJacobian):
        def revised(self, jacobian: NDArray, observations: Sequence[Observation]) -> NDArray:
            before, last = observations[-2:]
            ds, dt = last.control - before.control, before.error - last.error
            return jacobian + np.outer(dt - jacobian @ ds, ds) / max(ds @ ds, 1e-12)

    world = Bent(true_jacobian(), bend=0.3)
    _, made = run(world, Broyden(), 20)
    assert world(made[-1][1]).success


@pytest.mark.parametrize(
    "way", [KeptJacobian(), ExploredJacobian((7,)), RecordedJacobian(6, 0.01)], ids=str
)
def test_the_unit_of_a_component_does_not_matter(way: KeptJacobian) -> None:
    """Metres or millimetres: with perturbations to match, the same trials are made."""
    j = true_jacobian()

    def path(unit: float) -> NDArray:
        subtask = replace(SUBTASK, perturbation=(SIZE * unit,) * 3, jacobian=way)
        via_points = ViaPoints(np.arange(5.0), np.zeros((5, 1)), ("x",))
        learner = Learner(via_points, (subtask,), successes_to_learn=0)
        made = []
        for _ in range(14):
            s = learner.ask().via_points.select(SUBTASK.control) / unit
            made.append(s)
            learner.tell(Bent(j, 0.3)(s))
        return np.array(made)

    np.testing.assert_allclose(path(1000.0), path(1.0), atol=1e-9)


def test_a_trial_that_is_not_a_number_leaves_no_mark() -> None:
    world = Bent(true_jacobian())
    way = RecordedJacobian(6, 1e-3)
    _, made = run(world, way, 12)
    via_points = ViaPoints(np.arange(5.0), np.zeros((5, 1)), ("x",))
    learner = Learner(via_points, (replace(SUBTASK, jacobian=way),), successes_to_learn=0)
    for number, (_, s) in enumerate(made, start=1):
        if number in (3, 8):
            learner.ask()
            bad = Outcome({"T": np.full(2, np.nan)}, {"T": np.zeros(2)}, False)
            with pytest.raises(LearningError, match=f"trial {learner.trials + 1}: T is not finite"):
                learner.tell(bad)
        np.testing.assert_array_equal(learner.ask().via_points.select(SUBTASK.control), s)
        learner.tell(world(s))
    assert learner.trials == 14
