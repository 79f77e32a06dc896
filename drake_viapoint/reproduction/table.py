"""Tables that any program reads."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING

from drake_viapoint.errors import ViapointError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


def write_table(rows: Sequence[DataclassInstance], path: Path) -> Path:
    """Write dataclasses of one kind as CSV, a column a field.

    Raises:
        ViapointError: It cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, [field.name for field in fields(rows[0])])
            table.writeheader()
            table.writerows(asdict(row) for row in rows)
    except OSError as error:
        raise ViapointError(f"{path}: cannot be written: {error.strerror}") from error
    return path
