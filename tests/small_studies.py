"""Studies of the upswing in its equation: a run takes a few hundredths of a second."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import yaml

from drake_viapoint.runs.study import Study
from drake_viapoint.runs.study_file import read_study

SMALL: dict[str, Any] = {
    "task": "upswing",
    "conditions": {
        "fixed": {"learning.jacobian.way": "fixed"},
        "recorded": {"learning.jacobian.way": "recorded"},
    },
    "vary": {"demonstration.person": {"from": 0, "to": 2}, "seed": [0, 7]},
    "max_trials": 12,
    "repeats": 2,
    "tabulate": ["T", "success", "purpose"],
}


def study_file(path: Path, **changes: Any) -> Path:
    """The small study with other keys, in a file; a key that is None is left out."""
    data = {key: value for key, value in {**SMALL, **changes}.items() if value is not None}
    path.write_text(yaml.safe_dump(data, sort_keys=False))
    return path


def small_study(folder: Path, **changes: Any) -> Study:
    """The same, read."""
    return read_study(study_file(folder / "study.yaml", **changes))


def rows_in(out: Path) -> dict[str, dict[str, Any]]:
    """Rows of a sweep's results by their runs, without what no other sweep has: the seconds."""
    rows = [json.loads(line) for line in (out / "results.jsonl").read_text().splitlines()[1:]]
    assert len({row["run"] for row in rows}) == len(rows), "a run was done twice"
    return {row["run"]: {k: v for k, v in row.items() if k != "seconds"} for row in rows}


def files_in(out: Path) -> dict[str, bytes]:
    """Every file of the runs' folders."""
    runs = out / "runs"
    return {str(p.relative_to(runs)): p.read_bytes() for p in runs.rglob("*") if p.is_file()}
