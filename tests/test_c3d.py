"""C3D: round trips, the same bytes every time, and damage that never reaches the library."""

from __future__ import annotations

import struct
from pathlib import Path

import ezc3d
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_viapoint.demonstration.c3d import read_c3d, write_c3d
from drake_viapoint.demonstration.markers import MarkerRecording
from drake_viapoint.errors import MarkerFileError, RecordingError


def recording(frames: int = 50, rate: float = 250.0, start: float = 0.4) -> MarkerRecording:
    positions = np.random.default_rng(3).normal(size=(frames, 3, 3))
    positions[5:9, 1] = np.nan
    names = ("racket_upper", "racket_lower", "wrist")
    return MarkerRecording(names, start + np.arange(frames) / rate, positions)


@pytest.mark.parametrize("unit", ["m", "mm"])
@pytest.mark.parametrize("rate", [50.0, 119.88, 250.0])
def test_round_trip(tmp_path: Path, unit: str, rate: float) -> None:
    before = recording(rate=rate, start=20 / rate)
    write_c3d(tmp_path / "a.c3d", before, unit)
    after = read_c3d(tmp_path / "a.c3d")
    assert after.names == before.names
    assert after.source == tmp_path / "a.c3d"
    np.testing.assert_allclose(after.times, before.times, rtol=1e-6)
    np.testing.assert_allclose(after.positions, before.positions, rtol=1e-6, equal_nan=True)


def test_same_recording_same_bytes(tmp_path: Path) -> None:
    write_c3d(tmp_path / "a.c3d", recording())
    write_c3d(tmp_path / "b.c3d", recording())
    assert (tmp_path / "a.c3d").read_bytes() == (tmp_path / "b.c3d").read_bytes()


def test_the_library_reads_what_is_written(tmp_path: Path) -> None:
    write_c3d(tmp_path / "a.c3d", recording(), "mm")
    c3d = ezc3d.c3d(str(tmp_path / "a.c3d"))
    assert c3d["parameters"]["POINT"]["LABELS"]["value"] == list(recording().names)
    assert c3d["header"]["points"]["frame_rate"] == 250.0
    assert c3d["header"]["points"]["first_frame"] == 100
    residuals = c3d["data"]["meta_points"]["residuals"][0]
    np.testing.assert_array_equal(residuals < 0, np.isnan(recording().positions[..., 0]).T)
    expected = 1000 * recording().positions[:, 2].T
    np.testing.assert_allclose(c3d["data"]["points"][:3, 2], expected, rtol=1e-6)


def test_reads_what_the_library_writes(tmp_path: Path) -> None:
    c3d = ezc3d.c3d()
    c3d["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    c3d["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    c3d["parameters"]["POINT"]["LABELS"]["value"] = ["a", "b"]
    points = np.ones((4, 2, 30))
    points[:3] = np.random.default_rng(0).normal(size=(3, 2, 30))
    c3d["data"]["points"] = points
    residuals = np.zeros((1, 2, 30))
    residuals[0, 1, 4] = -1.0
    c3d["data"]["meta_points"]["residuals"] = residuals
    c3d.write(str(tmp_path / "a.c3d"))
    read = read_c3d(tmp_path / "a.c3d")
    assert read.rate == pytest.approx(100.0)
    np.testing.assert_allclose(read.marker("a"), points[:3, 0].T / 1000, rtol=1e-6)
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(read.marker("b")[:, 0])), [4])


@pytest.mark.parametrize("length", [1, 100, 511, 513, 600, 1023, 1024, 1500, 3000])
def test_cut_short(tmp_path: Path, length: int) -> None:
    path = tmp_path / "a.c3d"
    write_c3d(path, recording())
    content = path.read_bytes()
    assert len(content) > length
    path.write_bytes(content[:length])
    with pytest.raises(MarkerFileError):
        read_c3d(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (struct.pack("<HH", 101, 150), struct.pack("<HH", 101, 60000), "of 59900 frames"),
        (b"\x01\x02mm\x00", b"\x01\x02in\x00", "unknown length unit 'in'"),
        (b"UNITS", b"UNITZ", "does not give POINT:UNITS"),
        (struct.pack("<f", 250.0) + b"\x00\x0a", struct.pack("<f", -1.0) + b"\x00\x0a", "-1 Hz"),
        (b"wrist       ", b"racket_lower", "appears 2 times"),
        (bytes((1, 0x50, 1, 84)), bytes((1, 0x50, 1, 99)), "processor type 99"),
        (bytes((1, 0x50, 1, 84)), bytes((1, 0x50, 200, 84)), "cut short in its parameters"),
        (b"\x02P\x03\x00", b"\x02P\x04\x00", "4 markers in the header, 3 in the parameters"),
        (b"\x02P\x03\x00", b"\x02P\x00\x00", "no markers"),
    ],
)
def test_damage_is_named(tmp_path: Path, old: bytes, new: bytes, message: str) -> None:
    path = tmp_path / "a.c3d"
    write_c3d(path, recording())
    content = path.read_bytes()
    assert old in content
    path.write_bytes(content.replace(old, new, 1))
    with pytest.raises(MarkerFileError, match=message):
        read_c3d(path)


@settings(max_examples=200)
@given(st.lists(st.tuples(st.integers(0, 1023), st.integers(0, 255)), min_size=1, max_size=8))
def test_any_damaged_header_gives_a_recording_or_a_file_error(
    tmp_path_factory: pytest.TempPathFactory, damage: list[tuple[int, int]]
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.c3d"
    write_c3d(path, recording())
    content = bytearray(path.read_bytes())
    for at, value in damage:
        content[at] = value
    path.write_bytes(content)
    try:
        recorded, message = read_c3d(path), ""
    except MarkerFileError as error:
        recorded, message = None, str(error)
    assert "\n" not in message
    assert recorded is None or len(recorded.times) >= 2


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (np.array([0.0, 0.004, 0.009]), "even times"),
        (np.array([-0.004, 0.0, 0.004]), "even times"),
        (np.array([0.002, 0.006, 0.010]), "even times"),
        (np.array([300.0, 300.004, 300.008]), "holds 65534 frames"),
    ],
)
def test_what_the_format_cannot_hold_is_refused(
    tmp_path: Path, times: np.ndarray, message: str
) -> None:
    with pytest.raises(RecordingError, match=message):
        write_c3d(tmp_path / "a.c3d", MarkerRecording(("a",), times, np.zeros((3, 1, 3))))
    assert not list(tmp_path.iterdir())


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(MarkerFileError, match="No such file"):
        write_c3d(tmp_path / "absent" / "a.c3d", recording())


def test_names_that_are_no_text(tmp_path: Path) -> None:
    path = tmp_path / "a.c3d"
    write_c3d(path, recording())
    labels = b"LABELS" + struct.pack("<H", 2 + 2 + 2 + 36 + 1)
    content = path.read_bytes()
    assert labels + b"\xff" in content
    path.write_bytes(content.replace(labels + b"\xff", labels + b"\x01"))
    with pytest.raises(MarkerFileError, match="LABELS is not text"):
        read_c3d(path)
