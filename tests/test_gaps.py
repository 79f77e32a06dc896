"""Gaps: short ones bridged on the path, long or open ones refused by name and time."""

from __future__ import annotations

import numpy as np
import pytest

from drake_viapoint.demonstration.gaps import fill_gaps
from drake_viapoint.demonstration.markers import MarkerRecording
from drake_viapoint.errors import GapError, MarkerMissingError


def with_gap(
    first: int, count: int, rate: float = 250.0, noise: float = 0.0, frames: int = 250
) -> tuple[MarkerRecording, np.ndarray]:
    """A recording whose marker b misses `count` samples, and the noise-free path of b [m]."""
    times = 2.0 + np.arange(frames) / rate
    path = 0.2 * np.sin(2 * np.pi * 1.5 * times[:, None] + np.array([0.0, 1.0, 2.0]))
    values = np.stack([path, path], axis=1)
    values = values + noise * np.random.default_rng(0).normal(size=values.shape)
    values[first : first + count, 1] = np.nan
    return MarkerRecording(("a", "b"), times, values), path


@pytest.mark.parametrize("rate", [50.0, 250.0, 1000.0])
def test_short_gap_is_bridged_on_the_path(rate: float) -> None:
    recording, path = with_gap(100, round(0.1 * rate), rate)
    filled = fill_gaps(recording, ("b",))
    np.testing.assert_allclose(filled.marker("b"), path, atol=1e-3)
    seen = ~np.isnan(recording.marker("b"))
    np.testing.assert_array_equal(filled.marker("b")[seen], recording.marker("b")[seen])


def test_noise_is_not_amplified() -> None:
    for first in range(40, 190, 15):
        recording, path = with_gap(first, 25, noise=1e-3)
        error = (
            fill_gaps(recording, ("b",)).marker("b")[first : first + 25] - path[first : first + 25]
        )
        assert np.abs(error).max() < 5e-3


@pytest.mark.parametrize("first", [1, 2, 248])
def test_single_sample_gap_near_an_end(first: int) -> None:
    recording, path = with_gap(first, 1)
    np.testing.assert_allclose(fill_gaps(recording, ("b",)).marker("b"), path, atol=1e-5)


def test_two_known_samples_make_a_line() -> None:
    values = np.full((3, 1, 3), np.nan)
    values[[0, 2], 0] = [[0, 0, 0], [2, 4, 6]]
    recording = MarkerRecording(("a",), np.array([0.0, 0.01, 0.02]), values)
    np.testing.assert_allclose(fill_gaps(recording, ("a",)).marker("a")[1], [1, 2, 3])


def test_nothing_missing_nothing_changed() -> None:
    recording, _ = with_gap(0, 0)
    filled = fill_gaps(recording, ("a", "b"))
    np.testing.assert_array_equal(filled.positions, recording.positions)


def test_other_markers_may_have_any_gap() -> None:
    recording, _ = with_gap(0, 250)
    assert np.isnan(fill_gaps(recording, ("a",)).marker("b")).all()


def test_too_long_gap_names_marker_and_times() -> None:
    recording, _ = with_gap(100, 26)
    with pytest.raises(GapError, match=r"'b' is missing from 2.400 s to 2.504 s") as caught:
        fill_gaps(recording, ("a", "b"))
    error = caught.value
    assert (error.marker, error.longest) == ("b", 0.1)
    assert error.start == pytest.approx(2.4)
    assert error.end == pytest.approx(2.504)
    assert not np.isnan(fill_gaps(recording, ("b",), longest=0.11).positions).any()


@pytest.mark.parametrize(
    ("first", "count", "start", "end", "reason"),
    [
        (0, 3, 2.0, 2.012, "starts without it"),
        (247, 3, 2.988, 2.996, "ends without it"),
        (0, 250, 2.0, 2.996, "never seen"),
    ],
)
def test_open_gaps_are_not_extrapolated(
    first: int, count: int, start: float, end: float, reason: str
) -> None:
    recording, _ = with_gap(first, count)
    with pytest.raises(GapError, match=reason) as caught:
        fill_gaps(recording, ("b",))
    assert caught.value.start == pytest.approx(start)
    assert caught.value.end == pytest.approx(end)


def test_samples_left_out_of_the_file_are_a_gap_too() -> None:
    recording, _ = with_gap(0, 0)
    kept = np.r_[0:100, 140:250]
    holed = MarkerRecording(recording.names, recording.times[kept], recording.positions[kept])
    with pytest.raises(GapError, match=r"from 2.400 s to 2.560 s"):
        fill_gaps(holed, ("a",))


def test_absent_marker() -> None:
    with pytest.raises(MarkerMissingError):
        fill_gaps(with_gap(0, 0)[0], ("c",))
