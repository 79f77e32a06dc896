"""The CSV convention: units, missing values, and the line of every mistake."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.demonstration.csv_table import read_csv
from drake_viapoint.errors import MarkerFileError

GOOD = """# units: mm
time,wrist_x,wrist_y,wrist_z,upper_x,upper_y,upper_z
0.000,1,2,3,4,5,6
0.004,1.5,2,3,,,
0.009,2,2,3,4,nan,6
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "serve.csv"
    path.write_text(text)
    return path


def test_reads_units_uneven_times_and_missing_values(tmp_path: Path) -> None:
    recording = read_csv(written(tmp_path, GOOD))
    assert recording.names == ("wrist", "upper")
    np.testing.assert_array_equal(recording.times, [0.0, 0.004, 0.009])
    wrist = np.array([[1, 2, 3], [1.5, 2, 3], [2, 2, 3]])
    np.testing.assert_allclose(recording.marker("wrist"), wrist / 1000)
    assert np.isnan(recording.marker("upper")[1:]).all()


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("cm", 0.01), ("MM", 0.001)])
def test_units(tmp_path: Path, unit: str, metres: float) -> None:
    recording = read_csv(written(tmp_path, GOOD.replace("units: mm", f"Units: {unit}")))
    assert recording.marker("upper")[0, 2] == pytest.approx(6 * metres)


def test_windows_line_ends_byte_order_mark_and_other_comments(tmp_path: Path) -> None:
    path = tmp_path / "serve.csv"
    text = "# recorded twice\n" + GOOD
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    np.testing.assert_array_equal(
        read_csv(path).positions, read_csv(written(tmp_path, GOOD)).positions
    )


@pytest.mark.parametrize(
    ("old", "new", "row", "message"),
    [
        ("# units: mm\n", "", None, "no unit declared"),
        ("units: mm", "units: feet", 1, "'feet'; known are m, cm, mm"),
        ("time,", "frame,", 2, "not 'time'"),
        ("wrist_y", "wrist_z", 2, "'wrist_z' stands where 'wrist_y'"),
        (",upper_z", "", 2, "three a marker"),
        ("upper", "wrist", None, "appears 2 times"),
        ("0.004,1.5", "0.004,abc", 4, "'abc' is not a number"),
        ("0.004,1.5", "0.004,inf", 4, "infinite"),
        ("0.004", "0.000", 4, "do not increase"),
        ("0.004", "", 4, "time is missing"),
        ("4,nan,6", "4,na", 5, "6 cells where the header has 7"),
        (GOOD[12:], "", None, "no header"),
        (GOOD[65:], "", None, "two samples"),
    ],
)
def test_mistakes_name_file_and_line(
    tmp_path: Path, old: str, new: str, row: int | None, message: str
) -> None:
    assert old in GOOD
    path = written(tmp_path, GOOD.replace(old, new))
    with pytest.raises(MarkerFileError, match=message) as caught:
        read_csv(path)
    assert caught.value.row == row
    assert caught.value.path == path


@given(st.integers(0, len(GOOD) - 1), st.text(max_size=3), st.integers(0, 5))
def test_any_edit_gives_a_recording_or_a_file_error(
    tmp_path_factory: pytest.TempPathFactory, at: int, text: str, cut: int
) -> None:
    path = tmp_path_factory.getbasetemp() / "edited.csv"
    path.write_bytes((GOOD[:at] + text + GOOD[at + cut :]).encode("utf-8", "replace"))
    try:
        recorded, message = read_csv(path), ""
    except MarkerFileError as error:
        recorded, message = None, str(error)
    assert "\n" not in message
    assert recorded is None or len(recorded.times) >= 2


@given(st.binary(max_size=300))
def test_any_bytes_give_a_file_error(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.getbasetemp() / "bytes.csv"
    path.write_bytes(content)
    with pytest.raises(MarkerFileError):
        read_csv(path)
