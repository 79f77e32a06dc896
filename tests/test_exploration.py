"""Central differences: exact on linear and quadratic maps, whatever is lost on the way."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.exploration import Exploration
from drake_viapoint.learning.gain import ConstantGain
from drake_viapoint.learning.subtask import Subtask


def exploration(sizes: tuple[float, ...]) -> Exploration:
    control = tuple(f"x{i + 1}" for i in range(len(sizes)))
    return Exploration(Subtask("s", control, "T", sizes, ConstantGain(1.0), 0.0, 0.1))


@given(
    st.integers(0, 10**6),
    st.integers(1, 4),
    st.lists(st.floats(1e-3, 0.1), min_size=1, max_size=6),
)
def test_exact_on_linear_and_quadratic_maps(seed: int, m: int, sizes: list[float]) -> None:
    """The curvature cancels between the two trials of a pair."""
    rng = np.random.default_rng(seed)
    k = len(sizes)
    slope, bend = rng.normal(size=(m, k)), rng.normal(size=(m, k, k))
    explored = exploration(tuple(sizes))
    trials = 0
    while not explored.complete:
        s = explored.next_change()
        assert np.count_nonzero(s) == 1
        result = slope @ s + np.einsum("mij,i,j->m", bend, s, s)
        explored.record(0.3 - result)  # Td - T
        trials += 1
    assert trials == 2 * k
    np.testing.assert_allclose(explored.jacobian, slope, atol=1e-10)


def test_up_then_down_component_by_component() -> None:
    explored = exploration((0.01, 0.02))
    changes = []
    while not explored.complete:
        changes.append(explored.next_change().tolist())
        explored.record(np.zeros(1))
    assert changes == [[0.01, 0.0], [-0.01, 0.0], [0.0, 0.02], [0.0, -0.02]]


def test_asking_twice_changes_nothing() -> None:
    explored = exploration((0.01,))
    np.testing.assert_array_equal(explored.next_change(), explored.next_change())


def test_a_pair_that_lost_the_result_starts_again_at_half_the_size() -> None:
    explored = exploration((0.04, 0.04))
    explored.record(np.array([1.0]))
    explored.shrink()
    assert explored.next_change().tolist() == [0.02, 0.0]
    explored.record(np.array([1.0]))
    explored.record(np.array([1.2]))
    assert explored.next_change().tolist() == [0.0, 0.04]  # the next component is not to blame
    explored.record(np.array([0.0]))
    explored.record(np.array([0.0]))
    np.testing.assert_allclose(explored.jacobian, [[5.0, 0.0]])  # and not of the larger pair


def test_a_restarted_pair_keeps_its_size() -> None:
    explored = exploration((0.04,))
    explored.shrink()
    explored.record(np.array([7.0]))
    explored.restart()
    assert explored.next_change().tolist() == [0.02]
    explored.record(np.array([1.0]))
    explored.record(np.array([1.4]))
    np.testing.assert_allclose(explored.jacobian, [[10.0]])


def test_wasted_trials_are_counted_where_a_pair_starts_again() -> None:
    explored = exploration((0.04, 0.04))
    assert explored.shrink() == 1  # the trial up itself
    explored.record(np.array([1.0]))
    assert explored.restart() == 2  # down, and the one up it was to be compared with
    assert explored.restart() == 1
    explored.record(np.array([1.0]))
    assert explored.shrink() == 2


def test_what_no_perturbation_reaches_is_an_error_that_names_it() -> None:
    explored = exploration((0.01, 0.016))
    explored.record(np.zeros(1))
    explored.record(np.zeros(1))
    for _ in range(4):
        explored.shrink()
    assert explored.next_change().tolist() == [0.0, 0.001]
    with pytest.raises(
        LearningError, match=r"no slope of T along x2: even a perturbation of 0\.001"
    ):
        explored.shrink()


def test_jacobian_is_rows_of_results_by_columns_of_components() -> None:
    explored = exploration((1.0, 1.0))
    results: list[NDArray] = []
    while not explored.complete:
        s = explored.next_change()
        results.append(np.array([s[0], 2 * s[0] + 3 * s[1], -s[1]]))
        explored.record(-results[-1])
    np.testing.assert_allclose(explored.jacobian, [[1, 0], [2, 3], [0, -1]])
