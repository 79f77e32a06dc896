"""TRC files, as written by Motion Analysis and read by OpenSim.

    PathFileType  4            (X/Y/Z)    serve.trc
    DataRate      CameraRate   NumFrames  NumMarkers  Units  ...
    250           250          1350       3           mm     ...
    Frame#        Time         wrist                  racket_upper  ...
                               X1         Y1     Z1   X2            ...

    1             0.000        312.1      20.5   ...

Cells are separated by tabs; a blank cell is a missing value. The blank line before the samples is
optional.
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

HEADER_LINES = 5


def read_trc(path: str | Path) -> MarkerRecording:
    """Read a TRC file; its Time column gives the times, its header the unit.

    Args:
        path: The file.

    Returns:
        Its markers, in metres and seconds.

    Raises:
        MarkerFileError: The file is absent, not a TRC file, or has fewer or more samples or
            markers than its header says.
    """
    path = Path(path)
    lines = read_lines(path)
    if not lines[0].startswith("PathFileType"):
        raise MarkerFileError(path, "not a TRC file: it does not begin with 'PathFileType'", 1)
    if len(lines) < HEADER_LINES:
        raise MarkerFileError(path, "the header is cut short", len(lines))
    header = _header(path, lines[1], lines[2])
    metres = metres_per_unit(path, header["Units"], 3)
    names = _marker_names(path, lines[3])
    if len(names) != _count(path, header["NumMarkers"]):
        wanted = header["NumMarkers"]
        raise MarkerFileError(path, f"{len(names)} markers where the header says {wanted}", 4)
    width = 2 + 3 * len(names)
    table: list[NDArray[np.float64]] = []
    rows: list[int] = []
    for row, line in enumerate(lines[HEADER_LINES:], start=HEADER_LINES + 1):
        if not table and not line.strip():
            continue
        cells = line.split("\t")
        if len(cells) < width or any(cell.strip() for cell in cells[width:]):
            raise MarkerFileError(path, f"{len(cells)} cells where there should be {width}", row)
        table.append(parse_row(path, row, cells[:width], time_column=1))
        rows.append(row)
    if len(table) != _count(path, header["NumFrames"]):
        wanted = header["NumFrames"]
        raise MarkerFileError(path, f"{len(table)} samples where the header says {wanted}")
    numbers = np.array(table).reshape(len(table), width)
    positions = metres * numbers[:, 2:].reshape(len(table), len(names), 3)
    return recording_from_file(path, names, numbers[:, 1], positions, rows)


def _header(path: Path, keys: str, values: str) -> dict[str, str]:
    header = dict(zip(keys.split(), values.split(), strict=False))
    for key in ("NumFrames", "NumMarkers", "Units"):
        if key not in header:
            raise MarkerFileError(path, f"the header does not give {key}", 3)
    return header


def _count(path: Path, text: str) -> int:
    if not text.isascii() or not text.isdigit() or len(text) > 9:
        raise MarkerFileError(path, f"{text!r} is not a count", 3)
    return int(text)


def _marker_names(path: Path, line: str) -> list[str]:
    cells = [cell.strip() for cell in line.rstrip("\t ").split("\t")]
    if len(cells) < 3 or cells[0].lower() != "frame#" or cells[1].lower() != "time":
        raise MarkerFileError(path, "the columns do not begin with Frame#, Time and a marker", 4)
    between = [cell for k, cell in enumerate(cells[2:]) if k % 3]
    if any(between):
        raise MarkerFileError(path, "the markers do not stand three columns apart", 4)
    return cells[2::3]
