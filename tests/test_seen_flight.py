"""Flights found in samples: exactly without noise, as well as regression can with it, robustly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from drake_viapoint.tasks.cameras import Cameras, Samples
from drake_viapoint.tasks.flight import Parabola
from drake_viapoint.tasks.seen_flight import find_flights, fit_flight

BOUNCE = 0.95  # [s]
PLACE = np.array([0.4, 0.5, 1.3])
THROWN = Parabola(BOUNCE, PLACE, np.array([0.1, 0.3, -2.4]))
STRUCK = Parabola(BOUNCE, PLACE, np.array([-0.3, 4.7, 0.8]))
RING = 0.5  # [m]
LANDING = STRUCK.fall_through(RING) or 0.0
RATE, NOISE = 60.0, 0.005
MANY = 12  # samples of the throw that are looked at: 0.2 s


def served(
    times: NDArray, thrown: Parabola = THROWN, struck: Parabola = STRUCK, bounce: float = BOUNCE
) -> NDArray:
    """Where a ball is that was held, thrown, and struck."""
    flying = np.maximum(times, bounce - 0.45)[:, None]
    before, after = thrown.position(flying[:, 0]), struck.position(times)
    return np.where(times[:, None] < bounce, before, after)


def pictures(phase: float, rate: float = RATE, end: float = LANDING) -> NDArray:
    return np.arange(phase / rate, end, 1 / rate)


def variance(times: NDArray, at: float) -> float:
    """Of a line's value at a time, fitted to samples of unit variance at times (n,)."""
    off = times - times.mean()
    return float(1 / times.size + (at - times.mean()) ** 2 / (off @ off))


velocities = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-3.0, -1.0))
changes = st.tuples(st.floats(-1.0, 1.0), st.floats(2.0, 6.0), st.floats(1.0, 4.0))


@given(
    st.floats(0.0, 1.0, exclude_max=True),
    st.floats(-0.1, 0.1),
    st.sampled_from([60.0, 120.0]),
    velocities.map(np.array),
    changes.map(np.array),
)
@settings(max_examples=40)
def test_without_noise_both_flights_are_found_whenever_pictures_are_taken(
    phase: float, late: float, rate: float, velocity: NDArray, change: NDArray
) -> None:
    """And when the ball is struck somewhat before or after it should be."""
    thrown, struck = Parabola(BOUNCE, PLACE, velocity), Parabola(BOUNCE, PLACE, velocity + change)
    times = pictures(phase, rate, BOUNCE + 0.35)
    ball = Samples(times, served(times, thrown, struck))
    seen = find_flights(ball, BOUNCE - late, 0.0, 0.0, rate)
    assert seen.thrown is not None
    assert seen.struck is not None
    # a picture so near to the bounce that both flights pass it tells nothing
    around = BOUNCE + np.array([-0.2, 0.0, 0.3])
    np.testing.assert_allclose(seen.thrown.position(around), thrown.position(around), atol=1e-6)
    np.testing.assert_allclose(seen.struck.position(around), struck.position(around), atol=1e-6)
    np.testing.assert_allclose(seen.struck.velocity(around), struck.velocity(around), atol=1e-5)


def test_with_noise_the_error_is_that_of_linear_regression() -> None:
    """A little more, as fits are robust; and neither flight is off to one side."""
    n = 200
    errors = np.empty((2, n, 3))
    cameras = Cameras(RATE, NOISE)
    for seed in range(n):
        rng = np.random.default_rng(seed)
        times = cameras.moments(LANDING, rng)
        seen = find_flights(cameras.sample(served, times, rng), BOUNCE, NOISE, RING, RATE)
        assert seen.thrown is not None
        assert seen.struck is not None
        before, after = times[times < BOUNCE][-MANY:], times[times >= BOUNCE]
        errors[0, seed] = (seen.thrown.position(BOUNCE) - PLACE) / np.sqrt(variance(before, BOUNCE))
        errors[1, seed] = (seen.struck.position(LANDING) - STRUCK.position(LANDING)) / np.sqrt(
            variance(after, LANDING)
        )
    for flight in errors / NOISE:
        # of 3 n numbers, their standard deviation strays by 3 %; a robust fit costs some 5 %
        assert 0.9 < np.sqrt(np.mean(flight**2)) < 1.2
        assert np.all(np.abs(flight.mean(axis=0)) < 5 / np.sqrt(n))


@pytest.mark.parametrize("phase", np.linspace(0.0, 0.9, 7))
@pytest.mark.parametrize(
    "spoilt", [(0.05, 0.0, 0.0), (0.0, 0.05, 0.0), (0.0, -0.05, 0.0), (0.0, 0.0, 0.02)]
)
def test_a_sample_spoilt_at_the_bounce_does_less_than_the_noise(
    phase: float, spoilt: tuple[float, float, float]
) -> None:
    """As the strings do, on which the ball stays for a while; 5 cm are ten times the noise."""
    times = pictures(phase)
    positions = served(times)
    positions[np.argmin(np.abs(times - BOUNCE))] += spoilt
    seen = find_flights(Samples(times, positions), BOUNCE, NOISE, RING, RATE)
    assert seen.thrown is not None
    assert seen.struck is not None
    before, after = times[times < BOUNCE][-MANY:], times[times >= BOUNCE]
    moved = np.linalg.norm(seen.thrown.position(BOUNCE) - PLACE)
    assert moved < NOISE * np.sqrt(3 * variance(before, BOUNCE))
    moved = np.linalg.norm(seen.struck.position(LANDING) - STRUCK.position(LANDING))
    assert moved < NOISE * np.sqrt(3 * variance(after, LANDING))


@pytest.mark.parametrize("number", range(MANY))
@pytest.mark.parametrize("axis", range(3))
def test_a_spoilt_sample_bends_no_flight(number: int, axis: int) -> None:
    """Wherever in it, and however badly spoilt: farther off it pulls no harder."""
    times = BOUNCE - (MANY - np.arange(MANY)) / RATE
    for size in (-1.0, -0.05, 0.05, 1.0):
        positions = THROWN.position(times)
        positions[number, axis] += size
        flight = fit_flight(Samples(times, positions), NOISE)
        moved = np.linalg.norm(flight.position(BOUNCE) - PLACE)
        assert moved < NOISE * np.sqrt(3 * variance(times, BOUNCE))


@pytest.mark.parametrize("noise", [0.0, NOISE])
def test_a_ball_that_nobody_strikes_flies_on(noise: float) -> None:
    cameras = Cameras(RATE, noise)
    for seed in range(30):
        rng = np.random.default_rng(seed)
        times = cameras.moments(BOUNCE + 0.2, rng)
        ball = cameras.sample(lambda t: served(t, struck=THROWN), times, rng)
        seen = find_flights(ball, BOUNCE, noise, 0.0, RATE)
        assert seen.struck is None
        assert seen.thrown is not None
        # samples from after the time are looked at, too, so it is seen better than from before
        worst = np.sqrt(variance(times[times < BOUNCE][-MANY:], BOUNCE))
        off = np.linalg.norm(seen.thrown.position(BOUNCE) - PLACE)
        assert off < 1e-9 + 4 * noise * worst


def at_rest(times: NDArray) -> NDArray:
    return np.tile(PLACE, (times.size, 1))


def carried(times: NDArray) -> NDArray:
    return PLACE + np.outer(times - BOUNCE, [0.5, 2.0, 1.0])


def swung(times: NDArray) -> NDArray:
    """Through the lowest place of a circle of 0.6 m."""
    turn = 3.0 * (times - BOUNCE)
    return PLACE + 0.6 * np.stack([0.0 * turn, np.sin(turn), 1 - np.cos(turn)], axis=1)


@pytest.mark.parametrize("path", [at_rest, carried, swung])
@pytest.mark.parametrize("noise", [0.0, NOISE])
@pytest.mark.parametrize("end", [0.7, 1.4])
def test_a_ball_that_is_carried_along_does_not_fly(
    path: Callable[[NDArray], NDArray], noise: float, end: float
) -> None:
    """Whether it is seen to the end or lost before it should have been struck."""
    cameras = Cameras(RATE, noise)
    for seed in range(15):
        rng = np.random.default_rng(seed)
        ball = cameras.sample(path, cameras.moments(end, rng), rng)
        assert find_flights(ball, BOUNCE, noise, RING, RATE) == (None, None)


@pytest.mark.parametrize("count", [0, 1, 3])
def test_too_few_samples_show_no_flight(count: int) -> None:
    """Wherever they are: before the bounce, across it or after it."""
    for start in (BOUNCE - 0.1, BOUNCE - 0.02, BOUNCE + 0.01):
        times = start + np.arange(count) / RATE
        seen = find_flights(Samples(times, served(times)), BOUNCE, NOISE, RING, RATE)
        assert seen == (None, None)


def test_four_samples_are_a_flight() -> None:
    times = BOUNCE - 0.1 + np.arange(4) / RATE
    thrown = find_flights(Samples(times, served(times)), BOUNCE, NOISE, RING, RATE).thrown
    assert thrown is not None
    np.testing.assert_allclose(thrown.position(BOUNCE), PLACE, atol=1e-6)


@pytest.mark.parametrize(("above", "found"), [(0, False), (3, False), (4, True), (9, True)])
def test_a_struck_ball_must_be_seen_above_the_ring_often_enough(above: int, found: bool) -> None:
    falling = Parabola(BOUNCE, PLACE, np.array([-0.3, 4.7, -0.5]))
    times = pictures(0.3)
    positions = served(times, struck=falling)
    heights = positions[times >= BOUNCE, 2]
    ring = heights[above] + 1e-4
    assert np.sum(heights > ring) == above
    seen = find_flights(Samples(times, positions), BOUNCE, 0.0, ring, RATE)
    assert seen.thrown is not None
    np.testing.assert_allclose(seen.thrown.position(BOUNCE), PLACE, atol=1e-6)
    assert (seen.struck is not None) is found
    if seen.struck is not None:
        np.testing.assert_allclose(seen.struck.position(LANDING), falling.position(LANDING))


def test_below_the_ring_nothing_is_looked_at() -> None:
    """There the ball may have touched the goal, or lie on the floor."""
    cameras, rng = Cameras(RATE, NOISE), np.random.default_rng(0)
    ball = cameras.sample(served, cameras.moments(LANDING + 0.3, rng), rng)
    below = (ball.positions[:, 2] < RING) & (ball.times > BOUNCE)
    assert below.sum() > 10
    lying = np.where(below[:, None], [7.0, 8.0, 0.03], ball.positions)
    results = [
        find_flights(samples, BOUNCE, NOISE, RING, RATE)
        for samples in (ball, Samples(ball.times, lying), ball.within(~below))
    ]
    for seen in results:
        for flight, first in zip(seen, results[0], strict=True):
            assert flight is not None
            assert first is not None
            np.testing.assert_array_equal(flight.position(1.0), first.position(1.0))
            np.testing.assert_array_equal(flight.velocity(1.0), first.velocity(1.0))


@given(st.integers(2, 40), st.floats(-1.0, 3.0))
@settings(max_examples=30)
def test_samples_of_a_parabola_lie_on_the_one_found(count: int, start: float) -> None:
    times = start + np.arange(count) / RATE
    flight = fit_flight(Samples(times, THROWN.position(times)), NOISE)
    np.testing.assert_allclose(flight.position(times), THROWN.position(times), atol=1e-9)
    np.testing.assert_allclose(flight.velocity(times), THROWN.velocity(times), atol=1e-7)
