"""Cameras: pictures at an even rate that wait for nobody, and noise of the size asked for."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from drake_viapoint.tasks.cameras import Cameras, Samples

seeds = st.integers(0, 2**32 - 1)
rates = st.floats(1.0, 500.0)
ends = st.floats(0.0, 3.0)


def circle(times: NDArray) -> NDArray:
    return np.stack([np.cos(times), np.sin(times), 0.1 * times], axis=1)


@given(seeds, rates, ends)
def test_pictures_are_a_period_apart_and_none_is_left_out(
    seed: int, rate: float, end: float
) -> None:
    times = Cameras(rate, 0.0).moments(end, np.random.default_rng(seed))
    rounding = 1e-12
    np.testing.assert_allclose(np.diff(times), 1 / rate, rtol=0, atol=rounding)
    # with both ends of the span added, no gap is longer than a period
    assert np.all(np.diff([0.0, *times, end]) <= 1 / rate + rounding)
    assert np.all((times >= 0) & (times <= end + rounding))


def test_the_first_picture_is_taken_anywhere_in_the_first_period() -> None:
    n, rate = 2000, 60.0
    cameras = Cameras(rate, 0.0)
    first = [cameras.moments(1.0, np.random.default_rng(seed))[0] for seed in range(n)]
    phases = np.sort(first) * rate
    assert phases[0] >= 0
    assert phases[-1] < 1
    # Kolmogorov and Smirnov: even draws stray farther than this once in 10^5 times
    assert np.max(np.abs(phases - (np.arange(n) + 0.5) / n)) < 2.5 / np.sqrt(n)


def test_noise_has_its_standard_deviation_in_each_coordinate_of_each_sample() -> None:
    n, noise = 5000, 0.005
    times = np.linspace(0.0, 2.0, n)
    seen = Cameras(60.0, noise).sample(circle, times, np.random.default_rng(1))
    assert seen.positions.shape == (n, 3)
    off = (seen.positions - circle(times)) / noise
    assert np.all(np.abs(off.mean(axis=0)) < 5 / np.sqrt(n))
    assert np.all(np.abs(off.std(axis=0) - 1) < 5 / np.sqrt(2 * n))
    assert np.all(np.abs(np.corrcoef(off.T) - np.eye(3)) < 5 / np.sqrt(n))
    after = np.mean(off[1:] * off[:-1], axis=0)  # from sample to sample
    assert np.all(np.abs(after) < 5 / np.sqrt(n))


@given(seeds, rates, ends)
def test_without_noise_things_are_seen_where_they_are(seed: int, rate: float, end: float) -> None:
    cameras, rng = Cameras(rate, 0.0), np.random.default_rng(seed)
    times = cameras.moments(end, rng)
    seen = cameras.sample(circle, times, rng)
    np.testing.assert_array_equal(seen.times, times)
    np.testing.assert_array_equal(seen.positions, circle(times))


@given(st.lists(st.booleans(), max_size=20))
def test_chosen_samples_keep_their_times_places_and_order(chosen: list[bool]) -> None:
    times = np.arange(len(chosen)) / 60.0
    samples = Samples(times, circle(times))
    some = samples.within(np.array(chosen, dtype=bool))
    expected = [t for t, c in zip(times, chosen, strict=True) if c]
    assert some.times.tolist() == expected
    np.testing.assert_array_equal(some.positions, circle(np.array(expected)))
