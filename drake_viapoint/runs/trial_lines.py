"""A run's trials as lines of JSON: how a record is written, and which lines are whole."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from drake_viapoint.errors import RunFolderError

TRIALS = "trials.jsonl"

_KEYS = frozenset(
    {"trial", "purpose", "subtask", "outcome", "success", "via_points", "seed"}
)  # of every line, whatever the task; its task variables come on top


def whole_lines(path: Path, content: bytes) -> tuple[list[dict[str, Any]], int]:
    """Records of the undamaged lines, and the number of bytes they take."""
    lines = content.split(b"\n")
    records: list[dict[str, Any]] = []
    length = 0
    for number, line in enumerate(lines, start=1):
        rest_is_empty = number >= len(lines) - 1 and not any(lines[number:])
        try:
            record = json.loads(line)
            whole = isinstance(record, dict) and record.keys() >= _KEYS
            whole = whole and record["trial"] == number
        except ValueError:
            whole = False
        if whole and number < len(lines):  # a line without its newline was cut short
            records.append(record)
            length += len(line) + 1
        elif rest_is_empty:
            break
        else:
            raise RunFolderError(
                path, f"{TRIALS}, line {number} is damaged, and lines after it are not"
            )
    return records, length


def as_read_back(value: Any) -> Any:
    """A record as its line is read back: without tuples, and None for what is not finite."""
    if isinstance(value, dict):
        return {key: as_read_back(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [as_read_back(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def trial_line(record: dict[str, Any]) -> bytes:
    """A record as a line of a run's trials."""
    return json.dumps(as_read_back(record), allow_nan=False).encode() + b"\n"
