"""Algebraic laws of the regularised inverse."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.generalized_inverse import generalized_inverse

matrices = st.tuples(st.integers(1, 6), st.integers(1, 6)).flatmap(
    lambda shape: arrays(np.float64, shape, elements=st.floats(-10, 10).map(lambda x: round(x, 3)))
)
regularizations = st.floats(1e-6, 1e3)


def random_matrix(seed: int, m: int, k: int, rank: int) -> NDArray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(m, rank)) @ rng.normal(size=(rank, k))


@given(matrices, regularizations)
def test_both_forms_of_the_papers_equation_agree(a: NDArray, lam: float) -> None:
    """A^T (A A^T + lambda I)^-1 = (A^T A + lambda I)^-1 A^T."""
    m, k = a.shape
    inverse = generalized_inverse(a, lam)
    assert inverse.shape == (k, m)
    # where lambda is small, the two forms themselves lose digits
    tolerance = 1e-13 * (1 + np.linalg.norm(a) ** 2 / lam) * (1 + 1 / np.sqrt(lam))
    left = a.T @ np.linalg.inv(a @ a.T + lam * np.eye(m))
    right = np.linalg.inv(a.T @ a + lam * np.eye(k)) @ a.T
    np.testing.assert_allclose(inverse, left, rtol=0, atol=tolerance)
    np.testing.assert_allclose(inverse, right, rtol=0, atol=tolerance)


@pytest.mark.parametrize("lam", [0.0, 1e-14])
@pytest.mark.parametrize(
    ("m", "k", "rank"), [(3, 6, 3), (2, 3, 2), (6, 3, 3), (4, 4, 2), (3, 5, 1)]
)
@pytest.mark.parametrize("seed", range(5))
def test_penrose_conditions_as_lambda_goes_to_zero(
    seed: int, m: int, k: int, rank: int, lam: float
) -> None:
    a = random_matrix(seed, m, k, rank)
    x = generalized_inverse(a, lam)
    tolerance = 1e-8 if lam == 0 else 1e-5  # the smallest singular value is far above 1e-7
    np.testing.assert_allclose(a @ x @ a, a, atol=tolerance)
    np.testing.assert_allclose(x @ a @ x, x, atol=tolerance * max(1, np.abs(x).max() ** 2))
    np.testing.assert_allclose((a @ x).T, a @ x, atol=tolerance)
    np.testing.assert_allclose((x @ a).T, x @ a, atol=tolerance)


@pytest.mark.parametrize("seed", range(5))
def test_without_regularization_it_is_the_moore_penrose_inverse(seed: int) -> None:
    a = random_matrix(seed, 3, 6, 3)
    np.testing.assert_allclose(generalized_inverse(a, 0.0), np.linalg.pinv(a), atol=1e-10)


@given(matrices, regularizations)
def test_no_step_is_larger_than_lambda_allows(a: NDArray, lam: float) -> None:
    gain = np.linalg.norm(generalized_inverse(a, lam), 2)
    assert gain <= 1 / (2 * np.sqrt(lam)) * (1 + 1e-9)


def test_the_bound_is_reached_where_a_singular_value_is_the_root_of_lambda() -> None:
    assert generalized_inverse([[0.1]], 0.01)[0, 0] == pytest.approx(1 / (2 * 0.1))


@given(matrices, regularizations, regularizations)
def test_more_regularization_means_smaller_steps(a: NDArray, lam: float, more: float) -> None:
    error = np.ones(a.shape[0])
    steps = [
        np.linalg.norm(generalized_inverse(a, value) @ error) for value in sorted((lam, lam + more))
    ]
    assert steps[1] <= steps[0] * (1 + 1e-9) + 1e-12


@given(matrices, regularizations, st.integers(0, 10**6))
def test_a_step_is_the_best_compromise_of_error_and_size(a: NDArray, lam: float, seed: int) -> None:
    """It minimises |A s - e|^2 + lambda |s|^2: no other step costs less."""
    rng = np.random.default_rng(seed)
    e = rng.normal(size=a.shape[0])
    step = generalized_inverse(a, lam) @ e

    def cost(s: NDArray) -> float:
        return float(np.sum((a @ s - e) ** 2) + lam * np.sum(s**2))

    for _ in range(5):
        other = step + rng.normal(size=step.size) * 10.0 ** rng.uniform(-4, 0)
        assert cost(other) >= cost(step) - 1e-9


@given(matrices, regularizations)
def test_the_inverse_of_the_transpose_is_the_transpose(a: NDArray, lam: float) -> None:
    np.testing.assert_allclose(
        generalized_inverse(a.T, lam),
        generalized_inverse(a, lam).T,
        atol=1e-13 * (1 + np.linalg.norm(a)) / lam,
    )


@given(matrices, st.floats(1e-3, 10), st.floats(0.01, 100))
def test_lambda_is_in_units_of_the_matrix_squared(a: NDArray, lam: float, unit: float) -> None:
    np.testing.assert_allclose(
        generalized_inverse(unit * a, unit**2 * lam) * unit,
        generalized_inverse(a, lam),
        atol=1e-12 * (1 + np.linalg.norm(a)) / lam,
    )


@pytest.mark.parametrize("lam", [0.0, 1e-3])
def test_nothing_moves_where_nothing_responds(lam: float) -> None:
    np.testing.assert_array_equal(generalized_inverse(np.zeros((2, 3)), lam), np.zeros((3, 2)))


@pytest.mark.parametrize("a", [[1.0, 2.0], [[np.nan, 1.0]], [[np.inf]], 3.0, [[[1.0]]]])
def test_what_is_no_finite_matrix_is_refused(a: object) -> None:
    with pytest.raises(LearningError, match="finite matrix"):
        generalized_inverse(a, 1.0)


@pytest.mark.parametrize("lam", [-1e-9, np.nan])
def test_a_negative_lambda_is_refused(lam: float) -> None:
    with pytest.raises(LearningError, match="must not be negative"):
        generalized_inverse([[1.0]], lam)
