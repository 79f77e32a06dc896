"""Hunt and Crossley's bounce against a converged integration, and a ball pressed like a spring."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp

from drake_viapoint.tasks.hunt_crossley import dissipation, restitution, sphere_modulus

MASS, SPEED = 0.058, 4.0
speeds = st.floats(0.1, 10.0)


def linear(depth: float) -> float:
    return 2e4 * depth


def quadratic(depth: float) -> float:
    return 5e6 * depth**2


@given(st.floats(0.001, 1.0), speeds)
def test_the_dissipation_gives_the_restitution(e: float, speed: float) -> None:
    assert restitution(dissipation(e, speed), speed) == pytest.approx(e, rel=1e-9)


@given(st.floats(0.0, 1e3), speeds)
def test_the_restitution_tells_the_dissipation(d: float, speed: float) -> None:
    """As well as 1 - e can: it is all that tells of little dissipation."""
    e = restitution(d, speed)
    assert 0 < e <= 1
    assert dissipation(e, speed) == pytest.approx(d, rel=1e-6, abs=1e-14)


@pytest.mark.parametrize("force", [linear, quadratic])
@pytest.mark.parametrize(
    ("lost", "speed"), [(1e-4, 4.0), (0.01, 0.5), (0.083, 4.0), (0.5, 1.0), (0.5, 6.0), (10.0, 2.0)]
)
def test_restitution_of_an_integrated_bounce(
    force: Callable[[float], float], lost: float, speed: float
) -> None:
    """Whatever the elastic force."""

    def slope(_: float, y: NDArray) -> list[float]:
        return [y[1], -force(y[0]) * (1 + lost * y[1]) / MASS]

    def apart(_: float, y: NDArray) -> float:
        return float(y[0])

    apart.terminal = True
    apart.direction = -1.0
    scale = np.array([1e-3, speed])
    fit = solve_ivp(
        slope, (0, 1.0), [0.0, speed], "DOP853", rtol=1e-10, atol=1e-12 * scale, events=apart
    )
    assert fit.status == 1
    away = -fit.y_events[0][0, 1]
    assert restitution(lost, speed) == pytest.approx(away / speed, rel=1e-7)


@given(st.floats(1e-3, 10.0), speeds, st.floats(1.01, 3.0))
def test_a_faster_ball_loses_more(lost: float, speed: float, faster: float) -> None:
    """As much as at its own speed if the dissipation were greater."""
    assert restitution(lost, speed * faster) < restitution(lost, speed)
    assert restitution(lost * faster, speed) == pytest.approx(
        restitution(lost, speed * faster), rel=1e-13
    )


@pytest.mark.parametrize("lost", [0.02, 0.01, 0.005])
def test_slow_balls_lose_two_thirds_of_d_v(lost: float) -> None:
    """1 / (1 + 2 d v / 3) is right to third order, and no further: 4 / 135 of it is missing."""
    missing = 1 / (1 + 2 * lost / 3) - restitution(lost, 1.0)
    assert missing == pytest.approx(4 / 135 * lost**3, rel=3 * lost)


def test_no_dissipation_loses_nothing() -> None:
    assert dissipation(1.0, SPEED) == 0.0
    assert restitution(0.0, SPEED) == 1.0


@pytest.mark.parametrize(
    ("stiffness", "radius", "speed"), [(2e4, 0.033, 4.0), (5e3, 0.05, 1.0), (1e5, 0.02, 9.0)]
)
def test_a_ball_pressed_as_deep_as_by_the_spring_holds_its_energy(
    stiffness: float, radius: float, speed: float
) -> None:
    modulus = sphere_modulus(stiffness, MASS, radius, speed)

    def force(depth: float) -> float:
        """Of the pressure at the flat, over the disc that the flat cuts out of the ball."""
        near = radius - depth
        rim = np.sqrt(radius**2 - near**2)

        def ring(r: float) -> float:
            return 2 * np.pi * r * modulus * (1 - np.hypot(r, near) / radius)

        return quad(ring, 0.0, rim, epsrel=1e-11)[0]

    depth = speed * np.sqrt(MASS / stiffness)
    held = quad(force, 0.0, depth, epsrel=1e-10)[0]
    assert held == pytest.approx(0.5 * MASS * speed**2, rel=1e-8)
    assert held == pytest.approx(0.5 * stiffness * depth**2, rel=1e-8)
