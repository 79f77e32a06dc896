"""What the marker file formats share: opening a file, its unit, its cells."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.errors import MarkerFileError, RecordingError

METRES_PER_UNIT = {"m": 1.0, "cm": 0.01, "mm": 0.001}
"""Length units a file may declare [m]."""


def read_bytes(path: Path) -> bytes:
    """The whole file.

    Raises:
        MarkerFileError: It is absent, a folder, not readable, or empty.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise MarkerFileError(path, error.strerror or str(error)) from error
    except ValueError as error:  # a null character in the name
        raise MarkerFileError(path, str(error)) from error
    if not content:
        raise MarkerFileError(path, "the file is empty")
    return content


def read_lines(path: Path) -> list[str]:
    """The lines of a text file, without their ends; blank lines at the end are dropped.

    Raises:
        MarkerFileError: It cannot be read, or is not text.
    """
    try:
        text = read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise MarkerFileError(path, f"not a text file (byte {error.start})") from error
    if "\0" in text:
        raise MarkerFileError(path, "not a text file (it holds null bytes)")
    # Not splitlines(): it also breaks lines at form feeds and other characters a name may hold.
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    while lines and not lines[-1].strip():
        lines.pop()
    if not lines:
        raise MarkerFileError(path, "the file is empty")
    return lines


def metres_per_unit(path: Path, unit: str, row: int | None = None) -> float:
    """Metres in a declared length unit.

    Raises:
        MarkerFileError: The unit is not one of `METRES_PER_UNIT`.
    """
    metres = METRES_PER_UNIT.get(unit.strip().lower())
    if metres is None:
        known = ", ".join(METRES_PER_UNIT)
        raise MarkerFileError(path, f"unknown length unit {unit.strip()!r}; known are {known}", row)
    return metres


def parse_row(path: Path, row: int, cells: list[str], time_column: int) -> NDArray[np.float64]:
    """Numbers of one line; a blank cell, "nan" or "NaN" is a missing value.

    Args:
        path: The file, for errors.
        row: Its line, from 1, for errors.
        cells: The cells.
        time_column: Where the time stands, which may not be missing.

    Raises:
        MarkerFileError: A cell is no number or infinite, or the time is missing.
    """
    numbers = np.full(len(cells), np.nan)
    for column, cell in enumerate(cells):
        if not cell.strip():
            continue
        try:
            numbers[column] = float(cell)
        except ValueError:
            raise MarkerFileError(path, f"{cell.strip()!r} is not a number", row) from None
    if np.isinf(numbers).any():
        raise MarkerFileError(path, "a value is infinite", row)
    if np.isnan(numbers[time_column]):
        raise MarkerFileError(path, "the time is missing", row)
    return numbers


def recording_from_file(
    path: Path,
    names: list[str],
    times: NDArray[np.float64],
    positions: NDArray[np.float64],
    rows: list[int] | None = None,
) -> MarkerRecording:
    """A recording whose errors name the file and the line.

    Args:
        path: The file.
        names: (m,) markers.
        times: (n,) [s].
        positions: (n, m, 3) [m].
        rows: (n,) line of each sample, from 1, in a text file.

    Raises:
        MarkerFileError: The recording contradicts itself.
    """
    try:
        return MarkerRecording(tuple(names), times, positions, path)
    except RecordingError as error:
        if rows is None or error.sample is None:
            raise MarkerFileError(path, str(error)) from error
        raise MarkerFileError(path, error.reason, rows[error.sample]) from error
