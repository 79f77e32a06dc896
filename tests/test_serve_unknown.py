"""What is drawn of the robot and of a trial: reproducible, spread as asked, independent."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from drake_viapoint.robot.arm import Arm
from drake_viapoint.runs.learning_run import trial_seed
from drake_viapoint.tasks.serve_robot_scenario import ServeUnknown
from drake_viapoint.tasks.serve_unknown import Unknown, spawned

SEEDS = [trial_seed(7, number) for number in range(1, 2001)]
MOUNT, RESTITUTION = 0.02, 0.1
seeds = st.integers(0, 2**32 - 1)

Drawing = Callable[..., Unknown]


@pytest.fixture(scope="module")
def unknown(arm: Arm) -> Drawing:
    """Makes the robot of a run's seed."""
    plant = arm.plant
    robot = [plant.GetModelInstanceByName(name) for name in ("arm", "racket")]

    def make(
        seed: int = 0, mount: float = MOUNT, restitution: float = RESTITUTION, inertia: float = 0.2
    ) -> Unknown:
        config = ServeUnknown(inertia=inertia, mount=mount, restitution=restitution)
        return Unknown(config, plant, robot, seed)

    return make


def masses(unknown: Unknown) -> NDArray:
    return np.array([inertia.get_mass() for inertia in unknown.inertias.values()])


@pytest.fixture(scope="module")
def trials(unknown: Drawing) -> NDArray:
    """Mount and restitution (n, 4) of the trials of a run."""
    robot = unknown()
    return np.array([np.append(*robot.draw(seed)) for seed in SEEDS])


def test_a_seed_makes_a_robot_and_another_seed_another(unknown: Drawing) -> None:
    one, same, other = masses(unknown(5)), masses(unknown(5)), masses(unknown(6))
    assert one.size == 10
    np.testing.assert_array_equal(one, same)
    assert np.all(one != other)


def test_a_robot_differs_as_much_as_asked(arm: Arm, unknown: Drawing) -> None:
    modelled = np.array(
        [arm.plant.get_body(i).default_spatial_inertia().get_mass() for i in unknown().inertias]
    )
    deviations = np.array([masses(unknown(seed)) / modelled - 1 for seed in range(50)])
    assert 0.19 < np.max(np.abs(deviations)) < 0.2 + 1e-12
    np.testing.assert_allclose(masses(unknown(inertia=0.0)), modelled, rtol=1e-15)


def test_the_mount_gives_way_about_each_axis_with_its_standard_deviation(trials: NDArray) -> None:
    mount = trials[:, :3] / MOUNT
    # of n normal draws mean and standard deviation stray by 1/sqrt(n) and 1/sqrt(2n)
    n = len(SEEDS)
    assert np.all(np.abs(mount.mean(axis=0)) < 5 / np.sqrt(n))
    assert np.all(np.abs(mount.std(axis=0) - 1) < 5 / np.sqrt(2 * n))
    within = np.mean(np.abs(mount) < 1, axis=0)  # 68 %, where an even draw would have 58 %
    assert np.all(np.abs(within - 0.6827) < 5 * np.sqrt(0.6827 * 0.3173 / n))


def test_restitution_is_even_within_its_range(trials: NDArray) -> None:
    deviation = (trials[:, 3] - 1) / RESTITUTION
    n = len(SEEDS)
    assert np.all(np.abs(deviation) <= 1 + 1e-12)
    assert abs(deviation.mean()) < 5 / np.sqrt(3 * n)
    assert abs(deviation.var() - 1 / 3) < 5 * np.sqrt(4 / 45 / n)


def test_nothing_drawn_follows_anything_else(trials: NDArray) -> None:
    """Neither within a trial, nor from trial to trial."""
    bound = 5 / np.sqrt(len(SEEDS))
    pairs = np.corrcoef(trials[1:].T, trials[:-1].T) - np.eye(8)
    assert pairs.shape == (8, 8)
    assert np.all(np.abs(pairs) < bound)


@given(seeds)
def test_what_is_known_is_exact(unknown: Drawing, seed: int) -> None:
    drawn = unknown(mount=0.0, restitution=0.0).draw(seed)
    assert drawn.mount.tolist() == [0.0, 0.0, 0.0]
    assert drawn.restitution == 1.0


@given(seeds)
@settings(max_examples=30)
def test_each_spread_scales_its_own_draw(unknown: Drawing, seed: int) -> None:
    """The same direction of the mount, the same roughness of the ball, by as much as asked."""
    drawn = unknown().draw(seed)
    looser = unknown(mount=2 * MOUNT).draw(seed)
    np.testing.assert_allclose(looser.mount, 2 * drawn.mount, rtol=1e-14)
    assert looser.restitution == drawn.restitution
    rougher = unknown(restitution=RESTITUTION / 2).draw(seed)
    np.testing.assert_array_equal(rougher.mount, drawn.mount)
    assert rougher.restitution - 1 == pytest.approx((drawn.restitution - 1) / 2, abs=1e-15)


def test_trials_are_drawn_from_their_own_seed_alone(unknown: Drawing) -> None:
    """Whatever the robot, and whatever trials came before; and they leave the robot alone."""
    robot, other = unknown(1), unknown(2)
    before = masses(robot)
    first = np.append(*robot.draw(SEEDS[0]))
    for seed in SEEDS[1:5]:
        assert np.all(np.append(*robot.draw(seed)) != first)
    np.testing.assert_array_equal(np.append(*robot.draw(SEEDS[0])), first)
    np.testing.assert_array_equal(np.append(*other.draw(SEEDS[0])), first)
    np.testing.assert_array_equal(masses(robot), before)


def test_a_robot_tells_nothing_of_its_trials(unknown: Drawing) -> None:
    """Over the first trials of many runs."""
    n = 300
    drawn = []
    for run in range(n):
        robot = unknown(run)
        drawn.append(np.concatenate([masses(robot), *map(np.atleast_1d, robot.draw(first(run)))]))
    correlations = np.corrcoef(np.array(drawn).T)[:10, 10:]
    assert correlations.shape == (10, 4)
    assert np.all(np.abs(correlations) < 5 / np.sqrt(n))


def first(run: int) -> int:
    return trial_seed(run, 1)


@given(seeds, st.integers(0, 100), st.integers(0, 100))
def test_a_seeds_children_differ_and_come_again(seed: int, one: int, other: int) -> None:
    draws = [spawned(seed, child).uniform(size=4).tolist() for child in (one, one, other)]
    assert draws[0] == draws[1]
    assert (draws[0] == draws[2]) is (one == other)
    assert draws[0] != np.random.default_rng(seed).uniform(size=4).tolist()


def test_a_seeds_children_are_independent() -> None:
    n = 1000
    drawn = np.array([[spawned(seed, child).uniform() for child in (0, 1)] for seed in range(n)])
    across = np.corrcoef(drawn.T)[0, 1]
    from_seed_to_seed = np.corrcoef(drawn[1:, 0], drawn[:-1, 0])[0, 1]
    assert max(abs(across), abs(from_seed_to_seed)) < 5 / np.sqrt(n)
