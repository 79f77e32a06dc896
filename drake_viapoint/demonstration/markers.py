"""Read a marker file, whatever its format."""

from __future__ import annotations

from pathlib import Path

from drake_viapoint.demonstration.c3d import read_c3d
from drake_viapoint.demonstration.csv_table import read_csv
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.demonstration.trc import read_trc
from drake_viapoint.errors import MarkerFileError

__all__ = ["READERS", "MarkerRecording", "read_markers"]

READERS = {".c3d": read_c3d, ".trc": read_trc, ".csv": read_csv}
"""Reader of each file suffix, in lower case."""


def read_markers(path: str | Path) -> MarkerRecording:
    """Read a C3D, TRC or CSV file; the suffix says which.

    Args:
        path: The file.

    Returns:
        Its markers, in metres and seconds.

    Raises:
        MarkerFileError: The suffix is none of these, or the file cannot be read as what it says.
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        known = ", ".join(READERS)
        raise MarkerFileError(path, f"not a marker file by its suffix; known are {known}")
    return reader(path)
