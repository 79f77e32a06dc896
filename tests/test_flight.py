"""Free flight against closed forms, an independent integration and the laws of drag."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from drake_viapoint.tasks.flight import GRAVITY, DraggedFlight, Parabola, drag_per_metre, fly

DOWN = np.array([0.0, 0.0, -GRAVITY])
metres = st.floats(-5, 5)
speeds = st.floats(-8, 8)
vectors = st.tuples(speeds, speeds, speeds).map(np.array)
points = st.tuples(metres, metres, st.floats(0, 3)).map(np.array)
DRAG = drag_per_metre(0.507, 0.033, 0.058)


@given(st.floats(-2, 2), points, vectors, st.floats(0, 2))
def test_a_parabola_in_closed_form(
    start: float, position: NDArray, velocity: NDArray, dt: float
) -> None:
    flight = fly(start, position, velocity)
    t = start + dt
    dt = t - start
    np.testing.assert_allclose(
        flight.position(t), position + velocity * dt + DOWN * dt**2 / 2, atol=1e-12
    )
    np.testing.assert_allclose(flight.velocity(t), velocity + DOWN * dt, atol=1e-12)


@given(points, vectors, st.floats(0, 2))
def test_energy_and_sideways_velocity_stay(position: NDArray, velocity: NDArray, dt: float) -> None:
    flight = fly(0.0, position, velocity)

    def energy(t: float) -> float:
        return float(flight.velocity(t) @ flight.velocity(t) / 2 + GRAVITY * flight.position(t)[2])

    assert energy(dt) == pytest.approx(energy(0.0), abs=1e-9)
    np.testing.assert_array_equal(flight.velocity(dt)[:2], velocity[:2])


@given(points, vectors, st.floats(0, 3), st.sampled_from([0.0, DRAG]))
@example(np.array([0.0, 0.0, 0.015625]), np.array([0.0, 0.0, 0.015625]), 0.015625, DRAG)
def test_it_falls_through_a_height_once_and_downwards(
    position: NDArray, velocity: NDArray, height: float, drag: float
) -> None:
    flight = fly(0.3, position, velocity, drag)
    time = flight.fall_through(height)
    path = flight.position(np.linspace(0.3, 3.0, 2000))
    if time is None:
        assert path[1:, 2].max() <= height + 1e-5
        return
    assert time >= 0.3
    assert flight.position(time)[2] == pytest.approx(height, abs=1e-9)
    assert flight.velocity(time)[2] <= 1e-6
    after = np.linspace(time, time + 0.5, 50)[1:]
    assert np.all(flight.position(after)[:, 2] < height)


def test_the_fall_in_closed_form() -> None:
    """From 1.14 m with 0.7 m/s upwards, through the ring at 0.5 m."""
    flight = fly(0.93, np.array([0.5, 0.4, 1.14]), np.array([0.4, 4.7, 0.7]))
    fall = (0.7 + np.sqrt(0.7**2 + 2 * GRAVITY * 0.64)) / GRAVITY
    time = flight.fall_through(0.5)
    assert time == pytest.approx(0.93 + fall, abs=1e-12)
    np.testing.assert_allclose(flight.position(time)[:2], [0.5 + 0.4 * fall, 0.4 + 4.7 * fall])


@pytest.mark.parametrize("drag", [0.0, DRAG])
def test_a_height_never_reached(drag: float) -> None:
    flight = fly(0.0, np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 2.0]), drag)
    assert flight.fall_through(1.3) is None
    assert flight.fall_through(1.15) is not None
    falling = fly(0.0, np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, -2.0]), drag)
    assert falling.fall_through(1.0001) is None


@pytest.mark.parametrize("drag", [0.0, DRAG])
def test_times_of_any_shape(drag: float) -> None:
    flight = fly(0.0, np.array([0.0, 0.0, 1.0]), np.array([1.0, 2.0, 3.0]), drag)
    times = np.linspace(0, 0.5, 6)
    assert flight.position(0.1).shape == (3,)
    assert flight.position(times).shape == (6, 3)
    assert flight.velocity(times.reshape(2, 3)).shape == (2, 3, 3)
    np.testing.assert_array_equal(flight.position(times.reshape(2, 3))[1, 2], flight.position(0.5))


def test_drag_against_an_independent_integration() -> None:
    position, velocity = np.array([0.5, 0.4, 1.14]), np.array([0.4, 12.0, 5.0])
    flight = fly(0.0, position, velocity, DRAG)

    def slope(_: float, y: NDArray) -> NDArray:
        return np.r_[y[3:], DOWN - DRAG * np.sqrt(y[3] ** 2 + y[4] ** 2 + y[5] ** 2) * y[3:]]

    fit = solve_ivp(
        slope, (0, 1.2), np.r_[position, velocity], method="Radau", rtol=1e-11, atol=1e-12
    )
    np.testing.assert_allclose(flight.position(fit.t), fit.y[:3].T, atol=1e-9)
    np.testing.assert_allclose(flight.velocity(fit.t), fit.y[3:].T, atol=1e-9)


def test_a_fall_from_rest_in_closed_form() -> None:
    """v = v_t tanh(g t / v_t) and z = v_t^2 / g ln cosh(g t / v_t): it tends to v_t."""
    terminal = np.sqrt(GRAVITY / DRAG)
    flight = fly(0.0, np.zeros(3), np.zeros(3), DRAG)
    t = np.linspace(0.0, 9.9, 100)
    s = GRAVITY * t / terminal
    np.testing.assert_allclose(flight.velocity(t)[:, 2], -terminal * np.tanh(s), atol=1e-9)
    depth = terminal**2 / GRAVITY * np.log(np.cosh(s))
    np.testing.assert_allclose(flight.position(t)[:, 2], -depth, atol=1e-8)
    assert flight.velocity(9.9)[2] == pytest.approx(-terminal, rel=1e-3)


def test_a_fast_ball_slows_by_the_closed_form_of_drag_alone() -> None:
    """Straight and fast, v = v0 / (1 + k v0 t): gravity has no time to count."""
    speed, drag = 1e4, 0.5
    flight = fly(0.0, np.zeros(3), np.array([0.0, speed, 0.0]), drag)
    t = np.linspace(0, 1e-3, 20)
    np.testing.assert_allclose(flight.velocity(t)[:, 1], speed / (1 + drag * speed * t), rtol=1e-6)


@pytest.mark.parametrize("drag", [1e-3, 1e-5, 1e-7])
def test_without_drag_it_tends_to_the_parabola(drag: float) -> None:
    """To first order the difference is proportional to drag, and below drag v^2 t^2."""
    position, velocity = np.array([0.0, 0.0, 1.0]), np.array([0.4, 4.7, 0.7])
    t = np.linspace(0, 0.5, 50)
    straight, dragged = fly(0.0, position, velocity), fly(0.0, position, velocity, drag)
    assert isinstance(straight, Parabola)
    assert isinstance(dragged, DraggedFlight)
    difference = np.linalg.norm(dragged.position(t) - straight.position(t), axis=1).max()
    bound = drag * (4.8 + 5) ** 2 * 0.5**2
    assert 0.01 * bound < difference + 1e-12 < bound + 1e-9


def test_drag_of_a_tennis_ball() -> None:
    """rho C A / (2 m), and the few centimetres by which it shortens the shot."""
    assert pytest.approx(0.5 * 1.2 * 0.507 * np.pi * 0.033**2 / 0.058) == DRAG
    position, velocity = np.array([0.5, 0.4, 1.14]), np.array([0.4, 4.7, 0.7])
    falls = []
    for drag in (0.0, DRAG):
        flight = fly(0.0, position, velocity, drag)
        time = flight.fall_through(0.5)
        assert time is not None
        falls.append(flight.position(time)[1])
    assert 0.02 < falls[0] - falls[1] < 0.06
