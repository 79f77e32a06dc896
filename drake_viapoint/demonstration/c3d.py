"""C3D files, the exchange format of motion capture (c3d.org).

Reading is done by ezc3d, after the layout was checked. Writing is done here: ezc3d writes its own
version into every file, and a shipped demonstration has to come out the same, byte for byte.
"""

from __future__ import annotations

import struct
from pathlib import Path

import ezc3d
import numpy as np

from drake_viapoint.demonstration.c3d_layout import BLOCK, MAGIC, check_layout
from drake_viapoint.demonstration.marker_file import (
    metres_per_unit,
    read_bytes,
    recording_from_file,
)
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.errors import MarkerFileError, RecordingError

LARGEST_FRAME = 65534
"""Last frame number the header's two bytes hold (65535 means more)."""
LARGEST_COUNT = 255
"""Largest length of a parameter's dimension, so of a name and of the list of names."""


def read_c3d(path: str | Path) -> MarkerRecording:
    """Read the markers of a C3D file.

    Frame 1 is at time 0, so a file cut from a longer recording keeps that recording's times. A
    sample whose residual is negative is invalid.

    Args:
        path: The file.

    Returns:
        Its markers, in metres and seconds.

    Raises:
        MarkerFileError: The file is absent, not C3D, cut short, damaged, or declares no unit, no
            rate or no markers.
    """
    path = Path(path)
    layout = check_layout(path, read_bytes(path))
    try:
        c3d = ezc3d.c3d(str(path))
        point = c3d["parameters"]["POINT"]
        points = np.asarray(c3d["data"]["points"], dtype=np.float64)  # (4, m, n)
        residuals = np.asarray(c3d["data"]["meta_points"]["residuals"], dtype=np.float64)[
            0
        ]  # (m, n)
        units, rates = point["UNITS"]["value"], point["RATE"]["value"]
        names: list[str] = []
        for key in ("LABELS", *(f"LABELS{k}" for k in range(2, 10))):
            names += list(point[key]["value"]) if key in point else []
    except (OSError, LookupError, RuntimeError, ValueError, MemoryError, TypeError) as error:
        reason = " ".join(str(error).split())
        raise MarkerFileError(path, f"damaged C3D file: {reason}") from error
    if points.shape != (4, layout.points, layout.frames):
        raise MarkerFileError(path, f"damaged C3D file: samples of shape {points.shape}")
    if not len(units) or not len(rates):
        missing = "RATE" if len(units) else "UNITS"
        raise MarkerFileError(path, f"the C3D file does not give POINT:{missing}")
    if not all(isinstance(text, str) for text in (units[0], *names)):
        raise MarkerFileError(path, "damaged C3D file: POINT:UNITS or POINT:LABELS is not text")
    rate = float(rates[0])
    if not np.isfinite(rate) or rate <= 0.0:
        raise MarkerFileError(path, f"the C3D file gives a frame rate of {rate:g} Hz")
    metres = metres_per_unit(path, units[0])
    if len(names) < layout.points:
        raise MarkerFileError(path, f"{len(names)} names for {layout.points} markers")
    positions = metres * np.moveaxis(points[:3], 0, 2)  # (m, n, 3)
    positions[residuals < 0.0] = np.nan
    times = (layout.first_frame - 1 + np.arange(layout.frames)) / rate
    return recording_from_file(
        path, [name.strip() for name in names[: layout.points]], times, positions.swapaxes(0, 1)
    )


def write_c3d(path: str | Path, recording: MarkerRecording, unit: str = "mm") -> None:
    """Write a recording as a C3D file: 32-bit floats, Intel byte order.

    The same recording gives the same bytes, on any machine and with any version of any library.
    Missing samples get a residual of -1 and the position zero.

    Args:
        path: The file.
        recording: Evenly sampled; its first time is a whole number of sampling periods, not
            negative.
        unit: Unit of length in the file: m, cm or mm.

    Raises:
        RecordingError: The format cannot hold the recording.
        MarkerFileError: The file cannot be written, or the unit is unknown.
    """
    path = Path(path)
    scale = 1.0 / metres_per_unit(path, unit)
    rate = (len(recording.times) - 1) / float(recording.times[-1] - recording.times[0])
    # Rates are whole numbers far more often than not; the difference quotient above is not exact.
    rate = round(rate, 6)
    first = round(float(recording.times[0]) * rate) + 1
    frames, markers = len(recording.times), len(recording.names)
    grid = (first - 1 + np.arange(frames)) / rate
    if np.max(np.abs(grid - recording.times)) * rate > 1e-3 or first < 1:
        raise RecordingError("C3D needs even times, on a grid that starts at zero")
    if first + frames - 1 > LARGEST_FRAME:
        raise RecordingError(f"C3D holds {LARGEST_FRAME} frames, not up to {first + frames - 1}")
    names = [name.encode() for name in recording.names]
    if markers > LARGEST_COUNT or max(map(len, names)) > LARGEST_COUNT:
        raise RecordingError(f"C3D holds {LARGEST_COUNT} markers and letters a name")

    parameters = _parameters(names, rate, frames, unit, data_block=0)
    blocks = -(-len(parameters) // BLOCK)
    data_block = 2 + blocks
    parameters = _parameters(names, rate, frames, unit, data_block)
    header = struct.pack(
        "<BBHHHHHfHHf",
        2,
        MAGIC,
        markers,
        0,
        first,
        first + frames - 1,
        0,
        -1.0,
        data_block,
        0,
        rate,
    )
    missing = np.isnan(recording.positions[..., 0])
    samples = np.zeros((frames, markers, 4), dtype="<f4")
    samples[..., :3] = np.where(missing[..., None], 0.0, scale * recording.positions)
    samples[..., 3] = np.where(missing, -1.0, 0.0)
    content = (
        header.ljust(BLOCK, b"\0") + parameters.ljust(blocks * BLOCK, b"\0") + samples.tobytes()
    )
    try:
        path.write_bytes(content.ljust(-(-len(content) // BLOCK) * BLOCK, b"\0"))
    except OSError as error:
        raise MarkerFileError(path, error.strerror or str(error)) from error


def _parameters(names: list[bytes], rate: float, frames: int, unit: str, data_block: int) -> bytes:
    """The parameter section: the group POINT, and an ANALOG that is empty."""
    width = max(map(len, names))
    labels = b"".join(name.ljust(width) for name in names)
    length = unit.strip().lower().encode()
    records = [
        _group(1, b"POINT"),
        _parameter(1, b"USED", 2, (), struct.pack("<H", len(names))),
        _parameter(1, b"SCALE", 4, (), struct.pack("<f", -1.0)),
        _parameter(1, b"RATE", 4, (), struct.pack("<f", rate)),
        _parameter(1, b"DATA_START", 2, (), struct.pack("<H", data_block)),
        _parameter(1, b"FRAMES", 2, (), struct.pack("<H", frames)),
        _parameter(1, b"UNITS", -1, (len(length),), length),
        _parameter(1, b"LABELS", -1, (width, len(names)), labels),
        _parameter(1, b"DESCRIPTIONS", -1, (1, len(names)), b" " * len(names)),
        _group(2, b"ANALOG"),
        _parameter(2, b"USED", 2, (), struct.pack("<H", 0)),
    ]
    body = b"".join(records) + b"\0\0"
    blocks = -(-(4 + len(body)) // BLOCK)
    if blocks > LARGEST_COUNT:
        raise RecordingError("the names of the markers are too long for a C3D file")
    return bytes((1, MAGIC, blocks, 84)) + body


def _group(number: int, name: bytes) -> bytes:
    return struct.pack("<bb", len(name), -number) + name + struct.pack("<HB", 3, 0)


def _parameter(number: int, name: bytes, kind: int, sizes: tuple[int, ...], data: bytes) -> bytes:
    body = struct.pack("<bB", kind, len(sizes)) + bytes(sizes) + data + b"\0"
    return struct.pack("<bb", len(name), number) + name + struct.pack("<H", 2 + len(body)) + body
