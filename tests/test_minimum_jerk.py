import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from drake_viapoint.errors import ViaPointsError
from drake_viapoint.motion.minimum_jerk import EndMotion, jerk_cost, minimum_jerk


def random_points(seed: int, n: int = 8, d: int = 3) -> tuple[NDArray, NDArray]:
    rng = np.random.default_rng(seed)
    return np.cumsum(rng.uniform(0.08, 0.3, n)), rng.normal(size=(n, d))


def test_two_points_give_the_quintic_of_flash_and_hogan() -> None:
    s = np.linspace(0, 1, 101)
    path = minimum_jerk([0.0, 2.0], [[1.0], [4.0]])(2.0 * s)[:, 0]
    np.testing.assert_allclose(path, 1 + 3 * (10 * s**3 - 15 * s**4 + 6 * s**5), atol=1e-13)


@pytest.mark.parametrize("seed", range(5))
def test_solution_of_the_quadratic_program(seed: int) -> None:
    """Minimise jerk over piecewise quintics as a constrained quadratic program; same path."""
    times, values = random_points(seed, n=5, d=1)
    pieces = len(times) - 1
    jerk_powers = np.array([0, 0, 0, 6, 24, 60])

    def row(piece: int, t: float, order: int) -> NDArray:
        out = np.zeros(6 * pieces)
        for power in range(order, 6):
            factor = np.prod(np.arange(power - order + 1, power + 1))
            out[6 * piece + power] = factor * t ** (power - order)
        return out

    hessian = np.zeros((6 * pieces, 6 * pieces))
    rows, right = [], []
    for i, h in enumerate(np.diff(times)):
        for a in range(3, 6):
            for b in range(3, 6):
                exponent = a + b - 5
                hessian[6 * i + a, 6 * i + b] = (
                    jerk_powers[a] * jerk_powers[b] * h**exponent / exponent
                )
        rows += [row(i, 0, 0), row(i, h, 0)]
        right += [values[i, 0], values[i + 1, 0]]
        if i + 1 < pieces:  # only velocity and acceleration are asked to be continuous
            rows += [row(i, h, k) - row(i + 1, 0, k) for k in (1, 2)]
            right += [0.0, 0.0]
    last = np.diff(times)[-1]
    rows += [row(0, 0, 1), row(0, 0, 2), row(pieces - 1, last, 1), row(pieces - 1, last, 2)]
    right += [0.0] * 4
    a = np.array(rows)
    kkt = np.block([[hessian, a.T], [a, np.zeros((len(a), len(a)))]])
    solution = np.linalg.lstsq(kkt, np.r_[np.zeros(6 * pieces), right], rcond=None)[0]
    coefficients = solution[: 6 * pieces].reshape(pieces, 6)

    spline = minimum_jerk(times, values)
    for i in range(pieces):
        t = np.linspace(0, times[i + 1] - times[i], 20)
        by_program = np.polynomial.polynomial.polyval(t, coefficients[i])
        np.testing.assert_allclose(spline(times[i] + t)[:, 0], by_program, atol=1e-7)


def test_passes_through_its_points_at_rest_at_the_ends() -> None:
    times, values = random_points(1)
    spline = minimum_jerk(times, values)
    np.testing.assert_allclose(spline(times), values, atol=1e-12)
    for order in (1, 2):
        np.testing.assert_allclose(spline.derivative(order)(times[[0, -1]]), 0, atol=1e-8)


def test_a_segment_with_its_end_motion_is_the_whole() -> None:
    times, values = random_points(2)
    whole = minimum_jerk(times, values)
    v, a = whole.derivative(1), whole.derivative(2)
    ends = EndMotion(v(times[2]), a(times[2]), v(times[6]), a(times[6]))
    part = minimum_jerk(times[2:7], values[2:7], ends)
    t = np.linspace(times[2], times[6], 200)
    # a part of an optimal path is optimal
    np.testing.assert_allclose(part(t), whole(t), atol=1e-10)


def test_linear_in_values_and_equivariant_in_time() -> None:
    times, values = random_points(3)
    other = random_points(4)[1]
    t = np.linspace(times[0], times[-1], 50)
    mixed = minimum_jerk(times, 2 * values - 3 * other)(t)
    separate = 2 * minimum_jerk(times, values)(t) - 3 * minimum_jerk(times, other)(t)
    np.testing.assert_allclose(mixed, separate, atol=1e-11)
    stretched = minimum_jerk(5 + 2 * times, values)(5 + 2 * t)
    np.testing.assert_allclose(stretched, minimum_jerk(times, values)(t), atol=1e-11)


def test_no_perturbation_of_the_path_costs_less() -> None:
    times, values = random_points(5, d=1)
    spline = minimum_jerk(times, values)
    least = jerk_cost(spline)[0]
    rng = np.random.default_rng(0)
    knots = np.sort(np.r_[times, (times[:-1] + times[1:]) / 2])
    for _ in range(20):
        bump = rng.normal(size=(knots.size, 1)) * 0.01 * ~np.isin(knots, times)[:, None]
        assert jerk_cost(minimum_jerk(knots, spline(knots) + bump))[0] > least


def test_jerk_cost_against_dense_quadrature() -> None:
    times, values = random_points(6)
    spline: BSpline = minimum_jerk(times, values)
    t = np.linspace(times[0], times[-1], 200_001)
    dense = np.trapezoid(spline.derivative(3)(t) ** 2, t, axis=0)
    np.testing.assert_allclose(jerk_cost(spline), dense, rtol=1e-6)


def test_bad_shapes_and_times() -> None:
    with pytest.raises(ViaPointsError, match="via-point 2 does not"):
        minimum_jerk([1.0, 0.0], [[0.0], [1.0]])
    with pytest.raises(ViaPointsError, match="n >= 2"):
        minimum_jerk([1.0], [[0.0]])
