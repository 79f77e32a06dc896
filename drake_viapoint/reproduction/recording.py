"""A trial as a Meshcat recording: one HTML file that plays in any browser, offline."""

from __future__ import annotations

import gc
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from drake_viapoint.errors import RunFolderError, ViapointError
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction.serve_page import serve_page
from drake_viapoint.reproduction.upswing_page import upswing_page
from drake_viapoint.runs.learning_run import recorded_via_points
from drake_viapoint.runs.run_folder import read_trials
from drake_viapoint.runs.task_run import read_scenario
from drake_viapoint.tasks.catalogue import build_task
from drake_viapoint.tasks.trial import FAILED, RefusedTrial

PAGES: Mapping[str, Callable[[Any, Any, ViaPoints], str]] = {
    "serve": serve_page,
    "upswing": upswing_page,
}
"""What draws a task's trials, by the task's name: from scenario, trial and via-points."""


def record_trial(run: Path, number: int | None, html: Path) -> int:
    """Execute a recorded trial once more and write its recording.

    Args:
        run: Folder of the run.
        number: Trial, from 1; the last one if None.
        html: File to write.

    Returns:
        The number of the trial.

    Raises:
        RunFolderError: There is no such run or trial, or the trial was refused or failed.
        ViapointError: The file cannot be written.
    """
    scenario = read_scenario(run)
    records = read_trials(run)
    if not records:
        raise RunFolderError(run, "holds no trial yet")
    chosen = len(records) if number is None else number
    if not 1 <= chosen <= len(records):
        raise RunFolderError(run, f"has trials 1 to {len(records)}, not {chosen}")
    record = records[chosen - 1]
    if record.get("outcome") == FAILED:
        raise RunFolderError(run, f"trial {chosen} failed: {record.get('reason')}")
    task = build_task(scenario)
    via_points = recorded_via_points(record, task.via_points.names)
    trial = task.execute(via_points, record["seed"])
    if isinstance(trial, RefusedTrial):
        raise RunFolderError(run, f"trial {chosen} was not executed: {trial.reason}")
    text = PAGES[scenario.task](scenario, trial, via_points)
    # Meshcat has to end in the thread it began in, or Drake stops the process; left to itself it
    # ends wherever garbage happens to be collected
    gc.collect()
    try:
        html.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ViapointError(f"{html}: cannot be written: {error.strerror}") from error
    return chosen
