"""Rounded times of even samples: what they were, and all others left alone to the bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from synthetic_swing import NAMES, random_swing

from drake_viapoint.demonstration.even_times import COARSEST, EVEN, unrounded
from drake_viapoint.demonstration.markers import MarkerRecording, read_markers
from drake_viapoint.demonstration.racket_pose import even_marker_paths, racket_pose
from drake_viapoint.packages import resolve

RATES = st.floats(20.0, 2000.0)
COUNTS = st.integers(5, 500)
STARTS = st.floats(0.0, 1e4)


def rate_of(times: NDArray) -> float:
    return MarkerRecording(("a",), times, np.zeros((len(times), 1, 3))).rate


@given(RATES, COUNTS, STARTS, st.integers(2, 6))
def test_rounded_even_times_are_even_again(
    rate: float, count: int, start: float, decimals: int
) -> None:
    last = 10.0**-decimals
    assume(rate * last < 0.9)
    even = start + np.arange(count) / rate
    rounded = np.round(even, decimals)
    found = unrounded(rounded)
    period = np.median(np.diff(found))
    periods = np.diff(found) / period
    if rate * last < 0.45:  # else steps of one last decimal and of two may be gaps as well
        np.testing.assert_allclose(periods, 1.0, atol=EVEN + 1e-6)
        assert abs(1 / rate_of(rounded) - 1 / rate) < max(1.5 * last / (count - 1), EVEN / rate)
    np.testing.assert_allclose(found, rounded, atol=last * (1 + 1e-6))


@given(RATES, COUNTS, STARTS)
def test_times_with_all_their_digits_keep_their_bits(rate: float, count: int, start: float) -> None:
    times = start + np.arange(count) / rate
    np.testing.assert_array_equal(unrounded(times), times)
    assert rate_of(times) == 1 / np.median(np.diff(times))


@given(st.sampled_from([50, 100, 125, 200, 250, 500, 1000]), COUNTS, st.integers(0, 2**32 - 1))
def test_times_that_need_no_rounding_keep_their_bits(rate: int, count: int, seed: int) -> None:
    """Nor do missing samples change them."""
    kept = np.random.default_rng(seed).random(count) < 0.9
    kept[:2] = True
    times = np.round(np.arange(count) / rate, 3)[kept]
    assume(np.median(np.diff(times)) < 1.1 / rate)  # else of few samples most are missing
    np.testing.assert_array_equal(unrounded(times), times)


@given(st.integers(0, 2**32 - 1), st.integers(20, 300), st.integers(3, 5))
def test_a_slack_clock_is_left_alone(seed: int, count: int, decimals: int) -> None:
    """Samples early or late by up to a third of their period, as the file says with all it has."""
    rng = np.random.default_rng(seed)
    times = (np.arange(count) + rng.uniform(-1 / 3, 1 / 3, count)) / 60
    np.testing.assert_array_equal(unrounded(times), times)
    rounded = np.round(times, decimals)
    np.testing.assert_array_equal(unrounded(rounded), rounded)


@given(st.integers(0, 2**32 - 1), st.integers(2, 30), st.integers(0, 9))
def test_no_time_is_moved_further_than_its_last_decimal(
    seed: int, count: int, decimals: int
) -> None:
    steps = np.random.default_rng(seed).integers(1, 40, count)
    times = np.cumsum(steps) * 10.0**-decimals
    found = unrounded(times)
    assert np.max(np.abs(found - times)) <= 10.0**-decimals * (1 + 1e-6)
    assert np.all(np.diff(found) > 0)
    np.testing.assert_allclose(unrounded(found), found, rtol=1e-12)


@given(st.floats(20.0, 200.0), st.integers(60, 400), st.integers(0, 2**32 - 1))
def test_samples_missing_from_the_file_are_counted(rate: float, count: int, seed: int) -> None:
    assume(rate * 1e-3 * COARSEST < 0.95)
    kept = np.random.default_rng(seed).random(count) < 0.95
    even = (np.arange(count) / rate)[kept]
    assert rate_of(np.round(even, 3)) == pytest.approx(rate, rel=5e-3)


@pytest.mark.parametrize(
    ("rate", "decimals"), [(120.0, 3), (60.0, 3), (60.0, 2), (240.0, 3), (119.88, 3), (120.0, 4)]
)
def test_a_table_in_milliseconds_shows_the_movement_it_is_of(
    tmp_path: Path, rate: float, decimals: int
) -> None:
    """Its samples are not resampled, and the pose is the one of times with all their digits."""
    swing = random_swing(6, rate=rate, noise=0.0, jump=None)
    times = swing.recording.times
    header = ",".join(f"{name}_{axis}" for name in NAMES for axis in "xyz")
    lines = [
        ",".join([f"{time:.{decimals}f}", *(f"{value:.9f}" for value in row.ravel())])
        for time, row in zip(times, swing.recording.positions, strict=True)
    ]
    path = tmp_path / "swing.csv"
    path.write_text("\n".join(["# units: m", f"time,{header}", *lines]))
    recording = read_markers(path)
    written = [float(line.partition(",")[0]) for line in lines]
    np.testing.assert_array_equal(recording.times, written)
    assert recording.rate == pytest.approx(rate, rel=1e-3)
    np.testing.assert_array_equal(even_marker_paths(recording, NAMES)[1], recording.positions)
    seen, truth = racket_pose(recording), racket_pose(swing.recording)
    np.testing.assert_allclose(seen.times, truth.times, atol=10.0**-decimals)
    np.testing.assert_allclose(seen.values, truth.values, atol=5e-4)


@pytest.mark.parametrize("task", ["serve", "upswing"])
def test_the_shipped_demonstrations_keep_their_bits(task: str) -> None:
    recording = read_markers(resolve(f"package://drake_viapoint/demonstrations/{task}.c3d"))
    assert unrounded(recording.times) is recording.times
    assert recording.rate == 1 / np.median(np.diff(recording.times))
