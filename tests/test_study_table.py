"""The table of a sweep: tidy, typed, whole, and never written over another study's."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from drake_viapoint.errors import StudyError
from drake_viapoint.runs.study_table import (
    CSV,
    TABLE,
    check_table,
    condition_summaries,
    never_given,
    read_table,
    table_of,
    write_table,
)

STUDY = {"task": "upswing"}
COLUMNS = ("run", "condition", "seed", "learned_at", "trials", "T", "success", "error", "seconds")


def row(number: int, **values: Any) -> dict[str, Any]:
    return {
        "run": f"run{number}",
        "condition": "ab"[number % 2],
        "seed": number,
        "learned_at": None if number == 2 else 10 + number,
        "trials": 12,
        "T": [[0.1, 0.2], None, [0.3, None]],
        "success": [False, True],
        "error": None,
        "seconds": 0.5,
        **values,
    }


def table(*rows: dict[str, Any]) -> pd.DataFrame:
    return table_of(rows, COLUMNS, STUDY)


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    written = table(row(0), row(1), row(2, error="RuntimeError: x", T=[], success=[]))
    path = write_table(written, tmp_path)
    assert path == tmp_path / TABLE
    for place in (tmp_path, path):
        read = read_table(place)
        assert tuple(read.columns) == COLUMNS
        assert read["learned_at"].tolist() == [10, 11, pd.NA]
        assert read["learned_at"].dtype == "Int64"
        assert read["error"].isna().tolist() == [True, True, False]
        assert [list(values) for values in read["success"]] == [[False, True]] * 2 + [[]]
        first = read["T"][0]
        assert list(first[0]) == [0.1, 0.2]
        assert first[1] is None
        assert np.isnan(first[2][1])
    assert {entry.name for entry in tmp_path.iterdir()} == {TABLE}


def test_csv_holds_lists_as_json(tmp_path: Path) -> None:
    write_table(table(row(0), row(1)), tmp_path, csv=True)
    read = pd.read_csv(tmp_path / CSV)
    assert tuple(read.columns) == COLUMNS
    assert json.loads(read["T"][1]) == row(1)["T"]
    assert read["learned_at"].tolist() == [10, 11]


def test_fields_of_no_one_type_become_text(tmp_path: Path) -> None:
    write_table(table(row(0, T=[1.0]), row(1, T=["far", [2.0]])), tmp_path)
    assert [json.loads(text) for text in read_table(tmp_path)["T"]] == [[1.0], ["far", [2.0]]]


@pytest.mark.parametrize("rows", [[], [row(2, T=[None], success=[], error="x", seconds=None)]])
def test_tables_of_next_to_nothing(tmp_path: Path, rows: list[dict[str, Any]]) -> None:
    write_table(table(*rows), tmp_path, csv=True)
    assert len(read_table(tmp_path)) == len(rows)


def test_a_table_of_another_study_is_left_alone(tmp_path: Path) -> None:
    check_table(tmp_path / "nowhere", STUDY)
    write_table(table(row(0)), tmp_path)
    check_table(tmp_path, STUDY)
    with pytest.raises(StudyError, match=r"table.parquet: holds another study"):
        check_table(tmp_path, {"task": "serve"})
    pd.DataFrame({"a": [1]}).to_parquet(tmp_path / TABLE)
    with pytest.raises(StudyError, match="holds another study"):
        check_table(tmp_path, STUDY)
    with pytest.raises(StudyError, match="not of a sweep"):
        read_table(tmp_path)
    (tmp_path / TABLE).write_text("thesis")
    with pytest.raises(StudyError, match="not a sweep's table"):
        check_table(tmp_path, STUDY)
    with pytest.raises(StudyError, match="cannot be read"):
        read_table(tmp_path)
    with pytest.raises(StudyError, match=r"nowhere: holds no sweep: there is no nowhere"):
        read_table(tmp_path / "nowhere")
    (tmp_path / TABLE).unlink()
    with pytest.raises(StudyError, match=r"holds no sweep: there is no table.parquet"):
        read_table(tmp_path)


def test_a_table_that_cannot_be_written(tmp_path: Path) -> None:
    write_table(table(row(0)), tmp_path)
    before = (tmp_path / TABLE).read_bytes()
    (tmp_path / f".{TABLE}").mkdir()
    with pytest.raises(StudyError, match=r"table.parquet: cannot be written"):
        write_table(table(row(0), row(1)), tmp_path)
    assert (tmp_path / TABLE).read_bytes() == before


def test_a_field_that_no_trial_gave_is_named() -> None:
    columns = ("good", "late", "never", "text")
    made = [
        {"good": [1.0], "late": None, "never": [None], "text": [[1], 2]},
        {"good": [None], "late": [None, 2.0], "never": [], "text": []},
        {"good": None, "late": [None], "never": None, "text": None},
    ]
    assert never_given(table_of(made, columns, STUDY), columns) == ["never"]


def test_a_line_a_condition() -> None:
    rows = [row(0), row(2), row(4), row(1, error="x"), row(3, learned_at=13)]
    assert condition_summaries(table(*rows), 12) == [
        "a  learned 1 of 3 within 12 trials, those by trial 10 (median)",
        "b  learned 1 of 2 within 12 trials, those by trial 11 (median), 1 ended with an error",
    ]
