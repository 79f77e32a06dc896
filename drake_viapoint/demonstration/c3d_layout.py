"""The layout of a C3D file, walked before its samples are read.

A damaged file can make a C3D library allocate gigabytes or crash, so its header and parameter
section are checked first, in plain Python: every length in them must stay inside the file.
Layout: the C3D file format user guide (c3d.org), sections "header", "parameter section", "data".
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from math import prod
from pathlib import Path

from drake_viapoint.errors import MarkerFileError

BLOCK = 512
"""Bytes in a block, the unit of a C3D file's addresses."""
MAGIC = 0x50
"""Second byte of every C3D file, and fourth-last of the parameter section's head."""
BYTE_ORDER = {84: "<", 85: "<", 86: ">"}
"""struct's byte order of the processors Intel, DEC and MIPS."""
MANY_FRAMES = 65535
"""Last frame in a header whose two bytes do not hold the true one."""


@dataclass(frozen=True)
class C3DLayout:
    """The sizes a C3D file declares, known to fit into it.

    Attributes:
        points: Number of markers.
        first_frame: Number of the first frame, from 1.
        frames: Number of frames.
    """

    points: int
    first_frame: int
    frames: int


def check_layout(path: Path, content: bytes) -> C3DLayout:
    """Check that a file is C3D and whole.

    Args:
        path: The file, for errors.
        content: All its bytes.

    Raises:
        MarkerFileError: It is not C3D, holds no markers, or is cut short or damaged.
    """
    if len(content) < 2 or content[1] != MAGIC:
        raise MarkerFileError(path, "not a C3D file: its second byte is not 0x50")
    start = (content[0] - 1) * BLOCK
    if len(content) < BLOCK or start < BLOCK or start + 4 > len(content):
        raise MarkerFileError(path, "the C3D file is cut short before its parameters")
    blocks, processor = content[start + 2], content[start + 3]
    if processor not in BYTE_ORDER:
        raise MarkerFileError(path, f"damaged C3D file: unknown processor type {processor}")
    order = BYTE_ORDER[processor]
    end = start + blocks * BLOCK
    if end > len(content):
        raise MarkerFileError(path, "the C3D file is cut short in its parameters")
    parameters = _walk_parameters(path, content[start:end], order)

    points, analog, first, last, _ = struct.unpack_from(f"{order}5H", content, 2)
    (
        data_block,
        _,
    ) = struct.unpack_from(f"{order}2H", content, 16)
    floats = content[15 if order == "<" else 12] & 0x80  # sign of the scale at bytes 12-15
    used = _integer(parameters.get("POINT:USED"), order)
    if not points or not used:
        raise MarkerFileError(path, "the C3D file holds no markers")
    if used != points:
        raise MarkerFileError(
            path, f"damaged C3D file: {points} markers in the header, {used} in the parameters"
        )
    frames = last - first + 1
    declared = _integer(parameters.get("POINT:FRAMES"), order)
    if last == MANY_FRAMES and declared:
        frames = declared
    if first < 1 or frames < 1:
        raise MarkerFileError(path, f"damaged C3D file: frames {first} to {last}")
    frame_bytes = (4 * points + analog) * (4 if floats else 2)
    needed = (data_block - 1) * BLOCK + frames * frame_bytes
    if (data_block - 1) * BLOCK < end:
        raise MarkerFileError(path, f"damaged C3D file: samples at block {data_block}")
    if needed > len(content):
        held = max(0, len(content) - (data_block - 1) * BLOCK) // frame_bytes
        raise MarkerFileError(path, f"the C3D file is cut short: {held} of {frames} frames")
    return C3DLayout(points, first, frames)


def _walk_parameters(path: Path, section: bytes, order: str) -> dict[str, bytes]:
    """The data of every parameter, by "GROUP:NAME"; the section starts with its four-byte head."""
    groups: dict[int, str] = {}
    found: list[tuple[int, str, bytes]] = []
    at = 4
    try:
        while at + 2 <= len(section):
            length, number = struct.unpack_from("2b", section, at)
            if length == 0 or number == 0:
                break
            name = section[at + 2 : at + 2 + abs(length)].decode("latin-1").upper()
            at += 2 + abs(length)
            (step,) = struct.unpack_from(f"{order}H", section, at)
            if number < 0:
                groups[-number] = name
                end = at + 2
            else:
                kind, dimensions = struct.unpack_from("bB", section, at + 2)
                sizes = struct.unpack_from(f"{dimensions}B", section, at + 4)
                begin = at + 4 + dimensions
                end = begin + abs(kind) * prod(sizes)
                known = kind in (1, 2, 4) or (kind == -1 and dimensions > 0)
                if not known or dimensions > 7 or end > len(section):
                    raise MarkerFileError(path, f"damaged C3D file: parameter {name!r}")
                found.append((number, name, section[begin:end]))
            end += 1 + section[end]  # a description follows, its length first
            if end > len(section) or step not in (0, end - at):
                raise MarkerFileError(path, f"damaged C3D file: description of {name!r}")
            if step == 0:
                break
            at += step
        else:
            raise MarkerFileError(path, "damaged C3D file: its parameters do not end")
    except (struct.error, IndexError):
        raise MarkerFileError(path, "damaged C3D file: its parameters overrun") from None
    return {f"{groups.get(number, '?')}:{name}": data for number, name, data in found}


def _integer(data: bytes | None, order: str) -> int:
    """An integer parameter, or 0; more than 32767 frames are written as a float or unsigned."""
    if data is None or len(data) not in (2, 4):
        return 0
    if len(data) == 2:
        return int(struct.unpack(f"{order}H", data)[0])
    value = struct.unpack(f"{order}f", data)[0]
    return int(value) if 0 <= value < 1e9 else 0
