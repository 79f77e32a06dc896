"""A sweep's table: one row a run, for any program that reads Parquet or CSV."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from drake_viapoint.errors import StudyError
from drake_viapoint.runs.study import canonical

TABLE = "table.parquet"
CSV = "table.csv"

_STUDY = "study"  # attribute of the frame, in the file's metadata
_COUNTS = ("learned_at", "first_success", "trials", "wasted")
_WORDS = ("run", "condition", "error", "folder")


def table_of(
    rows: Sequence[Mapping[str, Any]], columns: Sequence[str], study: Mapping[str, Any]
) -> pd.DataFrame:
    """Rows as a table.

    Args:
        rows: Plain data, with a value a column.
        columns: In the order of the table.
        study: Identity of the study, which the table carries as ``frame.attrs["study"]``.

    Returns:
        A frame with a row a run. Counts are whole numbers that may be missing; a tabulated field is
        a list a run, or text (JSON) where its values are of kinds that no one type can hold.
    """
    frame = pd.DataFrame({name: _column(name, [row[name] for row in rows]) for name in columns})
    frame.attrs = {_STUDY: json.loads(canonical(study))}
    return frame


def write_table(frame: pd.DataFrame, folder: Path, csv: bool = False) -> Path:
    """Write ``table.parquet``, and ``table.csv`` if asked; what was there gives way at once.

    Returns:
        Path of the Parquet file.

    Raises:
        StudyError: It cannot be written.
    """
    path = folder / TABLE
    begun = folder / f".{TABLE}"
    try:
        frame.to_parquet(begun, index=False)
        begun.replace(path)
        if csv:
            begun = folder / f".{CSV}"
            _flat(frame).to_csv(begun, index=False)
            begun.replace(folder / CSV)
    except OSError as error:
        reason = error.strerror or str(error)
        raise StudyError(path, f"cannot be written: {reason}") from error
    return path


def read_table(path: Path) -> pd.DataFrame:
    """Read a sweep's table.

    Args:
        path: The Parquet file, or the sweep's folder.

    Raises:
        StudyError: It cannot be read, or is no sweep's.
    """
    file = path / TABLE if path.is_dir() else path
    if not file.is_file():
        raise StudyError(path, f"holds no sweep: there is no {file.name}")
    try:
        frame = pd.read_parquet(file)
    except (OSError, pa.ArrowException, ValueError) as error:
        raise StudyError(file, f"cannot be read as Parquet: {error}") from error
    if not isinstance(frame.attrs.get(_STUDY), dict):
        raise StudyError(file, "is a table, but not of a sweep")
    return frame


def check_table(folder: Path, study: Mapping[str, Any]) -> None:
    """Check that a folder's table, if there is one, may give way to this study's.

    Raises:
        StudyError: It is another study's, or no study's at all.
    """
    file = folder / TABLE
    if not file.exists():
        return
    try:
        metadata = pq.read_schema(file).metadata or {}
        attributes = json.loads(metadata.get(b"PANDAS_ATTRS", b"{}"))
    except (OSError, pa.ArrowException, ValueError) as error:
        raise StudyError(file, f"is not a sweep's table: {error}") from error
    if attributes.get(_STUDY) != json.loads(canonical(study)):
        raise StudyError(file, "holds another study; name another folder")


def never_given(frame: pd.DataFrame, fields: Sequence[str]) -> list[str]:
    """Which tabulated fields no trial of any run gave: most likely misspelt."""
    return [name for name in fields if all(_is_empty(cell) for cell in frame[name])]


def _is_empty(cell: Any) -> bool:
    return not hasattr(cell, "__len__") or all(value is None for value in cell)


def condition_summaries(frame: pd.DataFrame, max_trials: int) -> list[str]:
    """What came of each condition, a line each."""
    lines = []
    width = max((len(name) for name in frame["condition"]), default=0)
    for condition, rows in frame.groupby("condition", sort=False):
        learned = rows["learned_at"].dropna()
        learned = learned[learned <= max_trials]
        median = f", those by trial {learned.median():g} (median)" if len(learned) else ""
        errors = int(rows["error"].notna().sum())
        ended = f", {errors} ended with an error" if errors else ""
        lines.append(
            f"{condition:<{width}}  learned {len(learned)} of {len(rows)} within {max_trials} "
            f"trials{median}{ended}"
        )
    return lines


def _column(name: str, values: list[Any]) -> pd.Series[Any]:
    if name in _COUNTS:
        return pd.Series(values, dtype="Int64")
    if name in _WORDS:
        return pd.Series(values, dtype="string")
    try:
        pa.array(values, from_pandas=True)
    except (pa.ArrowInvalid, pa.ArrowTypeError):  # a field that is now a number, now a list
        values = [json.dumps(value) for value in values]
    is_list = any(isinstance(value, list) for value in values)
    return pd.Series(values, dtype=object) if is_list else pd.Series(values)


def _flat(frame: pd.DataFrame) -> pd.DataFrame:
    """A frame without lists, for CSV."""
    lists = {
        name: column.map(json.dumps)
        for name, column in frame.items()
        if any(isinstance(value, list) for value in column)
    }
    return frame.assign(**{str(name): column for name, column in lists.items()})
