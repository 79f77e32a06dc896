"""The movement of least jerk through given points at given times.

With interior velocity and acceleration free, the path that minimises the integral of jerk squared
is a quintic spline that is four times continuously differentiable at its via-points (the
many-point generalisation of Flash & Hogan, 1985). It is linear in the values it passes through.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline, make_interp_spline

from drake_viapoint.errors import ViaPointsError


class EndMotion(NamedTuple):
    """Velocity and acceleration at both ends of a movement, for one cut out of a longer one."""

    start_velocity: ArrayLike  # (d,)
    start_acceleration: ArrayLike  # (d,)
    end_velocity: ArrayLike  # (d,)
    end_acceleration: ArrayLike  # (d,)


def minimum_jerk(
    times: ArrayLike, values: ArrayLike, end_motion: EndMotion | None = None
) -> BSpline[np.float64]:
    """Minimum-jerk trajectory through points.

    Args:
        times: (n,) strictly increasing times [s], n >= 2.
        values: (n, d) points, in any units.
        end_motion: Velocity [units/s] and acceleration [units/s2] at the ends; at rest if None.

    Returns:
        A quintic spline: call it with times, differentiate it with ``.derivative()``.

    Raises:
        ViaPointsError: The shapes disagree or the times do not increase.
    """
    t = np.asarray(times, dtype=np.float64)
    y = np.asarray(values, dtype=np.float64)
    if t.ndim != 1 or y.ndim != 2 or t.size != y.shape[0] or t.size < 2:
        raise ViaPointsError(f"need times (n,) and values (n, d), n >= 2; got {t.shape}, {y.shape}")
    if not np.all(np.diff(t) > 0):
        row = int(np.argmin(np.diff(t))) + 2
        raise ViaPointsError(f"times of via-points must increase: via-point {row} does not")
    rest = np.zeros(y.shape[1])
    ends = end_motion or EndMotion(rest, rest, rest, rest)
    start = [(1, np.asarray(ends.start_velocity)), (2, np.asarray(ends.start_acceleration))]
    end = [(1, np.asarray(ends.end_velocity)), (2, np.asarray(ends.end_acceleration))]
    # scipy takes derivative lists at each end; its stubs know only the named conditions
    spline: BSpline[np.float64] = make_interp_spline(
        t,
        y,
        k=5,
        bc_type=(start, end),  # type: ignore[arg-type]
    )
    return spline


def jerk_cost(trajectory: BSpline[np.float64]) -> NDArray[np.float64]:
    """Integral of jerk squared over the whole movement, one value a dimension [units2/s5].

    Jerk of a quintic is a quadratic on each piece, its square a quartic: three Gauss points a
    piece integrate it exactly.
    """
    knots = np.unique(trajectory.t)
    nodes, weights = np.polynomial.legendre.leggauss(3)
    half = np.diff(knots)[:, None] / 2
    times = knots[:-1, None] + half * (nodes + 1)
    jerk = trajectory.derivative(3)(times)  # (pieces, 3, d)
    cost: NDArray[np.float64] = np.einsum("pg,pgd->d", half * weights, jerk**2)
    return cost
