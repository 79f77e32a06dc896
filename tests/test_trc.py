"""TRC files: header, units, missing values, and files cut short."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.demonstration.trc import read_trc
from drake_viapoint.errors import MarkerFileError

GOOD = (
    "PathFileType\t4\t(X/Y/Z)\tserve.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
    "OrigNumFrames\n"
    "250.00\t250.00\t3\t2\tmm\t250.00\t1\t3\n"
    "Frame#\tTime\twrist\t\t\tupper\t\t\t\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\t\n"
    "\n"
    "1\t0.000\t1\t2\t3\t4\t5\t6\t\n"
    "2\t0.004\t1.5\t2\t3\t\t\t\t\n"
    "3\t0.008\t2\t2\t3\t4\t5\t6\n"
)


def written(folder: Path, text: str) -> Path:
    path = folder / "serve.trc"
    path.write_text(text)
    return path


def test_reads_millimetres_and_missing_values(tmp_path: Path) -> None:
    recording = read_trc(written(tmp_path, GOOD))
    assert recording.names == ("wrist", "upper")
    np.testing.assert_array_equal(recording.times, [0.0, 0.004, 0.008])
    np.testing.assert_allclose(recording.marker("upper")[[0, 2]], [[0.004, 0.005, 0.006]] * 2)
    assert np.isnan(recording.marker("upper")[1]).all()
    assert not np.isnan(recording.marker("wrist")).any()


def test_metres_and_no_blank_line(tmp_path: Path) -> None:
    text = GOOD.replace("\tmm\t", "\tm\t").replace("Z2\t\n\n", "Z2\n")
    np.testing.assert_allclose(read_trc(written(tmp_path, text)).marker("wrist")[0], [1, 2, 3])


@pytest.mark.parametrize(
    ("old", "new", "row", "message"),
    [
        ("PathFileType", "# units: mm", 1, "not a TRC file"),
        ("\tmm\t", "\tinches\t", 3, "'inches'"),
        ("\tUnits\t", "\tLength\t", 3, "does not give Units"),
        ("\t3\t2\tmm", "\tx\t2\tmm", 3, "not a count"),
        ("\t3\t2\tmm", "\t3\t3\tmm", 4, "2 markers where the header says 3"),
        ("wrist\t\t\tupper", "wrist\t\tupper\t", 4, "three columns apart"),
        ("Frame#", "Sample", 4, "Frame#"),
        ("0.004\t1.5\t2", "0.004\t1.5\t?", 8, "'[?]' is not a number"),
        ("0.008", "0.003", 9, "do not increase"),
        ("\t4\t5\t6\n", "\t4\t5", 9, "7 cells"),
        ("3\t0.008\t2\t2\t3\t4\t5\t6\n", "", None, "2 samples where the header says 3"),
        (GOOD[80:], "", 2, "cut short"),
    ],
)
def test_mistakes_name_file_and_line(
    tmp_path: Path, old: str, new: str, row: int | None, message: str
) -> None:
    assert old in GOOD
    with pytest.raises(MarkerFileError, match=message) as caught:
        read_trc(written(tmp_path, GOOD.replace(old, new)))
    assert caught.value.row == row


@given(st.integers(0, len(GOOD) - 6))
def test_cut_short_anywhere_is_an_error(
    tmp_path_factory: pytest.TempPathFactory, length: int
) -> None:
    path = tmp_path_factory.getbasetemp() / "cut.trc"
    path.write_text(GOOD[:length])
    with pytest.raises(MarkerFileError):
        read_trc(path)


@given(st.integers(0, len(GOOD) - 1), st.text(max_size=3), st.integers(0, 5))
def test_any_edit_gives_a_recording_or_a_file_error(
    tmp_path_factory: pytest.TempPathFactory, at: int, text: str, cut: int
) -> None:
    path = tmp_path_factory.getbasetemp() / "edited.trc"
    path.write_bytes((GOOD[:at] + text + GOOD[at + cut :]).encode("utf-8", "replace"))
    try:
        recorded, message = read_trc(path), ""
    except MarkerFileError as error:
        recorded, message = None, str(error)
    assert "\n" not in message
    assert recorded is None or len(recorded.times) >= 2
