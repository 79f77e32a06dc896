"""Section 3.2: the three conditions as a sweep, and our Fig. 10 of any sweep of the serve."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from drake_viapoint.errors import ViapointError
from drake_viapoint.reproduction import figure10
from drake_viapoint.reproduction.captions import captioned
from drake_viapoint.reproduction.disturbed_serve import (
    ConditionResult,
    PairedResult,
    condition_results,
    paired,
    paired_summary,
    summary,
)
from drake_viapoint.reproduction.findings import Findings
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.serve_comparison import conditions_comparison
from drake_viapoint.reproduction.shipped_study import sweep_first
from drake_viapoint.reproduction.style import save
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.runs.study_table import read_table

STUDY = "package://drake_viapoint/studies/three_conditions.yaml"
"""The study that is shipped: explored by 5 cm and 5 degrees, as in section 2.2."""

SMALL_STUDY = "package://drake_viapoint/studies/three_conditions_small.yaml"
"""The same explored by 1 cm and 1 degree, as in section 2.1."""

TITLES = {
    "undisturbed": "condition 1, no disturbance",
    "kept": "condition 2, disturbed, Jacobians kept as first explored",
    "recorded": "condition 3, disturbed, Jacobians estimated anew from the last trials",
}
"""What section 3.2 calls the conditions of the shipped studies."""


class ConditionsStudied(NamedTuple):
    """What came of each condition, of each pair of them, what is said of it, and where."""

    results: list[ConditionResult]
    pairs: list[PairedResult]
    lines: list[str]
    where: str


def reproduce_conditions(out: Path, runs: int, progress: Progress) -> Findings:
    """Learn the serve under the three conditions of section 3.2, and draw our Fig. 10.

    Args:
        out: Folder of the figure, the tables and the sweep.
        runs: Of each condition; at most as many as the shipped study has.
        progress: Shows what goes on.

    Raises:
        ViapointError: The folder cannot be written or holds another study.
    """
    return _reproduce(STUDY, "", "5 cm, 5°", out, runs, progress)


def reproduce_small_conditions(out: Path, runs: int, progress: Progress) -> Findings:
    """The same, explored by less. See ``reproduce_conditions``."""
    return _reproduce(SMALL_STUDY, "_small", "1 cm, 1°", out, runs, progress)


def _reproduce(
    study: str, suffix: str, explored: str, out: Path, runs: int, progress: Progress
) -> Findings:
    folder = out / f"three_conditions{suffix}"
    sweep_first(study, runs, folder, f"disturbing the ball, {explored}", progress)
    results, pairs, lines, where = study_conditions(folder, out, suffix)
    return Findings(
        lines=tuple(lines),
        where=(where,),
        pictures=captioned(f"figure10{suffix}.png"),
        comparisons=conditions_comparison(results, pairs, explored),
        tables=(f"conditions{suffix}.csv", f"conditions_paired{suffix}.csv"),
        seeds=f"0 to {results[0].runs - 1}, each with a virtual person of its own",
    )


def study_conditions(folder: Path, out: Path, suffix: str = "") -> ConditionsStudied:
    """Draw the learning curves of a sweep of the serve, and compare its conditions.

    Args:
        folder: Of the sweep.
        out: Folder of the picture and the tables.
        suffix: Of their names.

    Returns:
        What came of it, with lines that say so and where it is.

    Raises:
        ViapointError: The sweep is not of the serve, lacks a column, or something cannot be
            written.
    """
    table = read_table(folder)
    study = table.attrs["study"]
    if study["task"] != "serve":
        raise ViapointError(f"{folder}: holds runs of the {study['task']}, not of the serve")
    learning = study["scenario"]["learning"]
    tolerances = learning["meeting_tolerance"], learning["landing_tolerance"]
    figure = figure10.draw(table, study["max_trials"], *tolerances, TITLES)
    picture = save(figure, out / f"figure10{suffix}.png")
    results = condition_results(table)
    write_table(results, out / f"conditions{suffix}.csv")
    pairs = [
        paired(table, later, earlier, _keys(table))
        for earlier, later in combinations([result.condition for result in results], 2)
    ]
    lines = [summary(result) for result in results] + [paired_summary(pair) for pair in pairs]
    if pairs:
        write_table(pairs, out / f"conditions_paired{suffix}.csv")
    where = f"picture in {picture}, tables in {out}/conditions*{suffix}.csv"
    return ConditionsStudied(results, pairs, lines, where)


def _keys(table: pd.DataFrame) -> list[str]:
    """Columns of what varies beside the condition: they stand between it and the counts."""
    columns = list(table.columns)
    return columns[columns.index("condition") + 1 : columns.index("learned_at")]
