"""A ball in free flight: gravity, and quadratic drag if asked for.

A ball that touches nothing needs no robot simulator: without drag its path is a parabola in closed
form, with drag an ordinary differential equation of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import OdeSolution, solve_ivp
from scipy.optimize import brentq

GRAVITY = 9.81
"""Acceleration of gravity [m/s2], as Drake's multibody plant has it."""

AIR_DENSITY = 1.2
"""Density of air [kg/m3] at 20 degrees Celsius."""

_LONGEST_FLIGHT = 10.0  # [s] no throw of an arm stays up longer


class Flight(Protocol):
    """A flight from ``start`` on."""

    @property
    def start(self) -> float:
        """When it begins [s]."""
        ...

    def position(self, t: ArrayLike) -> NDArray[np.float64]:
        """Centre of the ball (..., 3) [m] at times t (...) [s]."""
        ...

    def velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """Velocity (..., 3) [m/s] at times t (...) [s]."""
        ...

    def fall_through(self, height: float) -> float | None:
        """The time [s] at which the ball falls through a height [m]; None if it never does."""
        ...


@dataclass(frozen=True)
class Parabola:
    """Flight without drag."""

    start: float  # [s]
    position_0: NDArray[np.float64]  # (3,) [m]
    velocity_0: NDArray[np.float64]  # (3,) [m/s]

    def position(self, t: ArrayLike) -> NDArray[np.float64]:
        """See ``Flight``."""
        dt = np.asarray(t, dtype=np.float64)[..., None] - self.start
        fall = np.array([0.0, 0.0, -GRAVITY / 2])
        return self.position_0 + self.velocity_0 * dt + fall * dt**2

    def velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """See ``Flight``."""
        dt = np.asarray(t, dtype=np.float64)[..., None] - self.start
        return self.velocity_0 + np.array([0.0, 0.0, -GRAVITY]) * dt

    def fall_through(self, height: float) -> float | None:
        """See ``Flight``."""
        up = self.velocity_0[2]
        square = up**2 + 2 * GRAVITY * (self.position_0[2] - height)
        if square < 0:
            return None
        after = (up + np.sqrt(square)) / GRAVITY
        return float(self.start + after) if after >= 0 else None


@dataclass(frozen=True)
class DraggedFlight:
    """Flight with drag proportional to the square of the speed."""

    start: float  # [s]
    solution: OdeSolution  # of (position, velocity), (6,)

    def position(self, t: ArrayLike) -> NDArray[np.float64]:
        """See ``Flight``."""
        return self._state(t)[..., :3]

    def velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """See ``Flight``."""
        return self._state(t)[..., 3:]

    def fall_through(self, height: float) -> float | None:
        """See ``Flight``."""
        times = np.linspace(self.start, self.solution.t_max, 2001)
        state = self._state(times)
        above = state[:, 2] >= height
        falls = np.nonzero(above[:-1] & ~above[1:])[0]
        if not falls.size:
            return None
        start, end = times[falls[0]], times[falls[0] + 1]
        if state[falls[0], 5] > 0:  # it rises first: at the height itself, that is no fall
            start = brentq(lambda t: float(self._state(t)[5]), start, end, xtol=1e-13)
        return float(brentq(lambda t: float(self._state(t)[2]) - height, start, end, xtol=1e-13))

    def _state(self, t: ArrayLike) -> NDArray[np.float64]:
        times = np.asarray(t, dtype=np.float64)
        state: NDArray[np.float64] = np.moveaxis(
            self.solution(times.ravel()).reshape(6, *times.shape), 0, -1
        )
        return state


def fly(
    start: float, position: NDArray[np.float64], velocity: NDArray[np.float64], drag: float = 0.0
) -> Flight:
    """Flight of a ball let go.

    Args:
        start: When [s].
        position: Where its centre is (3,) [m].
        velocity: How it moves (3,) [m/s].
        drag: Deceleration over speed squared [1/m], see ``drag_per_metre``.
    """
    if drag == 0.0:
        return Parabola(start, position, velocity)

    def slope(_: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        v = state[3:]
        return np.concatenate([v, -drag * np.linalg.norm(v) * v - [0.0, 0.0, GRAVITY]])

    fit = solve_ivp(
        slope,
        (start, start + _LONGEST_FLIGHT),
        np.concatenate([position, velocity]),
        method="DOP853",
        rtol=1e-11,
        atol=1e-12,
        dense_output=True,
    )
    return DraggedFlight(start, cast(OdeSolution, fit.sol))


def drag_per_metre(coefficient: float, radius: float, mass: float) -> float:
    """Deceleration over speed squared [1/m] of a sphere: rho C A / (2 m)."""
    return AIR_DENSITY * coefficient * np.pi * radius**2 / (2 * mass)
