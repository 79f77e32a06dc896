"""A recording checks itself, finds its markers, and is read by the reader its suffix names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_viapoint.demonstration.markers import MarkerRecording, read_markers
from drake_viapoint.errors import MarkerFileError, MarkerMissingError, RecordingError

TIMES = np.array([0.0, 0.1, 0.2])


def positions(markers: int = 2) -> np.ndarray:
    return np.arange(9.0 * markers).reshape(3, markers, 3)


def test_markers_by_name_and_rate() -> None:
    recording = MarkerRecording(("a", "b"), TIMES, positions())
    np.testing.assert_array_equal(recording.marker("b"), positions()[:, 1])
    assert recording.rate == pytest.approx(10.0)


def test_absent_marker_lists_those_present() -> None:
    recording = MarkerRecording(("a", "b"), TIMES, positions())
    with pytest.raises(MarkerMissingError, match="'wrist' is absent; present: a, b") as caught:
        recording.marker("wrist")
    assert caught.value.present == ("a", "b")


def test_subject_prefix_may_be_left_out_unless_ambiguous() -> None:
    recording = MarkerRecording(("Ann:a", "Ann:b", "Bob:b"), TIMES, positions(3))
    np.testing.assert_array_equal(recording.marker("a"), positions(3)[:, 0])
    np.testing.assert_array_equal(recording.marker("Bob:b"), positions(3)[:, 2])
    with pytest.raises(MarkerMissingError, match="ambiguous"):
        recording.marker("b")


def test_partly_missing_sample_is_missing_whole() -> None:
    values = positions()
    values[1, 0, 2] = np.nan
    recording = MarkerRecording(("a", "b"), TIMES, values)
    assert np.isnan(recording.positions[1, 0]).all()
    assert np.isnan(recording.positions).sum() == 3


def test_arrays_are_copied_and_read_only() -> None:
    values = positions()
    recording = MarkerRecording(("a", "b"), TIMES, values)
    values[:] = 7.0
    assert recording.positions[0, 0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        recording.positions[0, 0, 0] = 1.0


@pytest.mark.parametrize(
    ("names", "times", "values", "message"),
    [
        ((), TIMES, positions(0), "no markers"),
        (("a", "a"), TIMES, positions(), "'a' appears 2 times"),
        (("a", " "), TIMES, positions(), "no name"),
        (("a",), TIMES, positions(), "shape"),
        (("a", "b"), TIMES[:1], positions()[:1], "two samples"),
        (("a", "b"), TIMES[:, None], positions(), "two samples"),
        (
            ("a", "b"),
            TIMES[::-1],
            positions(),
            "sample 1: times do not increase: 0.1 s after 0.2 s",
        ),
        (("a", "b"), TIMES * 0.0, positions(), "do not increase"),
        (("a", "b"), TIMES * np.nan, positions(), "not a number"),
        (("a", "b"), TIMES, positions() + np.inf, "infinite"),
    ],
)
def test_contradictions_are_refused(names, times, values, message) -> None:
    with pytest.raises(RecordingError, match=message):
        MarkerRecording(names, times, values)


@pytest.mark.parametrize("suffix", [".c3d", ".TRC", ".csv"])
@pytest.mark.parametrize("kind", ["missing", "empty", "folder", "garbage", "zeros"])
def test_unreadable_files_give_one_line(tmp_path: Path, suffix: str, kind: str) -> None:
    path = tmp_path / f"serve{suffix}"
    if kind == "folder":
        path.mkdir()
    elif kind != "missing":
        content = {"empty": 0, "garbage": 4000, "zeros": 4000}[kind]
        noise = np.random.default_rng(1).bytes(content)
        path.write_bytes(bytes(content) if kind == "zeros" else noise)
    with pytest.raises(MarkerFileError) as caught:
        read_markers(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_unknown_suffix_lists_the_known() -> None:
    with pytest.raises(MarkerFileError, match=r"\.c3d, \.trc, \.csv"):
        read_markers("serve.mp4")
