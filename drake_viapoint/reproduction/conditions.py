"""Section 3.2: the three conditions as a sweep, and our Fig. 10 of any sweep of the serve."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import pandas as pd

from drake_viapoint.errors import ViapointError
from drake_viapoint.reproduction import figure10
from drake_viapoint.reproduction.disturbed_serve import (
    condition_results,
    paired,
    paired_summary,
    summary,
)
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.shipped_study import sweep_first
from drake_viapoint.reproduction.style import save
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.runs.study_table import read_table

STUDY = "package://drake_viapoint/studies/three_conditions.yaml"
"""The study that is shipped."""

TITLES = {
    "undisturbed": "condition 1, no disturbance",
    "kept": "condition 2, disturbed, Jacobians kept as first explored",
    "recorded": "condition 3, disturbed, Jacobians estimated anew from the last trials",
}
"""What section 3.2 calls the conditions of the shipped study."""


def reproduce_conditions(out: Path, runs: int, progress: Progress) -> list[str]:
    """Learn the serve under the three conditions of section 3.2, and draw our Fig. 10.

    Args:
        out: Folder of the figure, the tables and the sweep.
        runs: Of each condition; at most as many as the shipped study has.
        progress: Shows what goes on.

    Returns:
        Lines that say what was found and where it is.

    Raises:
        ViapointError: The folder cannot be written or holds another study.
    """
    folder = out / "three_conditions"
    sweep_first(STUDY, runs, folder, "disturbing the ball", progress)
    return study_conditions(folder, out)


def study_conditions(folder: Path, out: Path) -> list[str]:
    """Draw the learning curves of a sweep of the serve, and compare its conditions.

    Args:
        folder: Of the sweep.
        out: Folder of the picture and the tables.

    Returns:
        Lines that say what was found and where it is.

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
    picture = save(figure, out / "figure10.png")
    results = condition_results(table)
    write_table(results, out / "conditions.csv")
    pairs = [
        paired(table, later, earlier, _keys(table))
        for earlier, later in combinations([result.condition for result in results], 2)
    ]
    lines = [summary(result) for result in results] + [paired_summary(pair) for pair in pairs]
    if pairs:
        write_table(pairs, out / "conditions_paired.csv")
    return [*lines, f"picture in {picture}, tables in {out}/conditions*.csv"]


def _keys(table: pd.DataFrame) -> list[str]:
    """Columns of what varies beside the condition: they stand between it and the counts."""
    columns = list(table.columns)
    return columns[columns.index("condition") + 1 : columns.index("learned_at")]
