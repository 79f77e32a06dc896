"""Marker recordings as a table of comma-separated values.

The convention, all of it:

    # units: mm
    time,wrist_x,wrist_y,wrist_z,racket_upper_x,racket_upper_y,racket_upper_z
    0.000,312.1,20.5,1204.9,,,
    0.004,312.4,20.5,1205.3,305.0,22.1,1830.2

Comment lines start with "#" and stand before the header; one of them declares the unit of length
(m, cm or mm). The header's first column is "time", in seconds; each marker has three columns side
by side, ending in _x, _y, _z. A blank cell or "nan" is a missing value. Times need not be even.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.demonstration.marker_file import (
    metres_per_unit,
    parse_row,
    read_lines,
    recording_from_file,
)
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.errors import MarkerFileError


def read_csv(path: str | Path) -> MarkerRecording:
    """Read a table in the convention of this module.

    Args:
        path: The file.

    Returns:
        Its markers, in metres and seconds.

    Raises:
        MarkerFileError: The file is absent, not text, or breaks the convention.
    """
    path = Path(path)
    lines = read_lines(path)
    header_row = next((i for i, line in enumerate(lines) if not line.startswith("#")), len(lines))
    metres = _declared_unit(path, lines[:header_row])
    if header_row == len(lines):
        raise MarkerFileError(path, "no header line 'time,<marker>_x,<marker>_y,<marker>_z,...'")
    names = _marker_names(path, lines[header_row], header_row + 1)
    table: list[NDArray[np.float64]] = []
    rows: list[int] = []
    for row, line in enumerate(lines[header_row + 1 :], start=header_row + 2):
        cells = line.split(",")
        if len(cells) != 1 + 3 * len(names):
            wanted = 1 + 3 * len(names)
            raise MarkerFileError(path, f"{len(cells)} cells where the header has {wanted}", row)
        table.append(parse_row(path, row, cells, time_column=0))
        rows.append(row)
    numbers = np.array(table).reshape(len(table), 1 + 3 * len(names))
    positions = metres * numbers[:, 1:].reshape(len(table), len(names), 3)
    return recording_from_file(path, names, numbers[:, 0], positions, rows)


def _declared_unit(path: Path, comments: list[str]) -> float:
    for row, comment in enumerate(comments, start=1):
        key, _, value = comment.lstrip("#").partition(":")
        if key.strip().lower() == "units":
            return metres_per_unit(path, value, row)
    raise MarkerFileError(path, "no unit declared; begin the file with a line '# units: mm'")


def _marker_names(path: Path, header: str, row: int) -> list[str]:
    columns = [column.strip() for column in header.split(",")]
    if columns[0].lower() != "time":
        raise MarkerFileError(path, f"the first column is {columns[0]!r}, not 'time'", row)
    names = [column.removesuffix("_x") for column in columns[1::3]]
    expected = [f"{name}_{axis}" for name in names for axis in "xyz"]
    for found, wanted in zip(columns[1:], expected, strict=False):
        if found != wanted:
            raise MarkerFileError(path, f"column {found!r} stands where {wanted!r} should", row)
    if len(columns) - 1 != len(expected) or not names:
        raise MarkerFileError(path, "the columns are not three a marker: _x, _y, _z", row)
    return names
