"""A sweep: all runs of a study, on as many workers as there are; what is done is never done again.

``results.jsonl`` gets a line a run as it lands, on the disk before anything else happens. The table
is its image, written anew now and then, at the end, and when the sweep is interrupted.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from drake_viapoint.errors import StudyError
from drake_viapoint.runs.run_folder import write_run
from drake_viapoint.runs.study import Study
from drake_viapoint.runs.study_log import StudyLog
from drake_viapoint.runs.study_run import RUNS, StudyWork
from drake_viapoint.runs.study_table import check_table, table_of, write_table
from drake_viapoint.runs.task_run import versions
from drake_viapoint.runs.workers import LocalWorkers, Workers, results_despite_deaths

RESULTS = "results.jsonl"

_SHORTEST = 30.0  # [s] between two writings of the table
_SHARE = 20.0  # and so many times as long as the last one took


def sweep(
    study: Study,
    out: Path,
    workers: Workers,
    *,
    folders: bool = True,
    csv: bool = False,
    on_rows: Callable[[Sequence[Mapping[str, Any]]], None] = lambda _: None,
) -> pd.DataFrame:
    """Execute the runs of a study that are missing from a folder.

    Args:
        study: What is run.
        out: Folder of results, table and runs.
        workers: What executes the runs.
        folders: Whether every run gets a folder of its own, with all its trials.
        csv: Whether to write the table as CSV, too.
        on_rows: Told the rows that were there, then each new one.

    Returns:
        The table: a row a run, in the order of the study.

    Raises:
        StudyError: The folder or its table holds another study, or cannot be written.
        RunFolderError: The same of the results, or of a run's folder.
        ClusterError: A worker is of other versions, or the cluster is gone.
    """
    identity = study.identity(versions())
    check_table(out, identity)
    local = isinstance(workers, LocalWorkers)
    work = StudyWork(
        study.without_runs(),
        identity["versions"],
        folder=str((out / RUNS).absolute()) if folders and local else None,
        send_trials=folders and not local,
        asker=os.getpid() if local else None,
    )
    with StudyLog(out / RESULTS, identity) as log:
        runs = {run.name: run for run in study.runs()}
        order = {name: number for number, name in enumerate(runs)}
        _check_rows(log, order)
        on_rows(log.rows)
        done = {row["run"] for row in log.rows}
        image = _Image(study, log, order, identity, csv)
        missing = [run for name, run in runs.items() if name not in done]
        results = results_despite_deaths(workers, work, missing)
        try:
            with contextlib.closing(results):
                for result in results:
                    if result.trials is not None and result.row["folder"]:
                        write_run(out / result.row["folder"], result.scenario, result.trials)
                    log.append(result.row)
                    on_rows([result.row])
                    image.write_in_time()
        finally:
            frame = image.write()
    return frame


def _check_rows(log: StudyLog, order: Mapping[str, int]) -> None:
    strangers = [str(row.get("run")) for row in log.rows if row.get("run") not in order]
    if strangers:
        more = f" and {len(strangers) - 3} more" if len(strangers) > 3 else ""
        raise StudyError(
            log.path,
            f"holds runs that are not in this study: {', '.join(strangers[:3])}{more}; a study "
            "may grow, but not shrink or change",
        )


class _Image:
    """The table of a log: written whole, but not so often that writing is what takes the time."""

    def __init__(
        self,
        study: Study,
        log: StudyLog,
        order: Mapping[str, int],
        identity: Mapping[str, Any],
        csv: bool,
    ) -> None:
        self._study = study
        self._log = log
        self._order = order
        self._identity = identity
        self._csv = csv
        self._next = time.monotonic() + _SHORTEST

    def write_in_time(self) -> None:
        if time.monotonic() >= self._next:
            self.write()

    def write(self) -> pd.DataFrame:
        start = time.monotonic()
        rows = sorted(self._log.rows, key=lambda row: self._order[row["run"]])
        frame = table_of(rows, self._study.columns(), self._identity)
        write_table(frame, self._log.path.parent, self._csv)
        end = time.monotonic()
        self._next = end + max(_SHORTEST, _SHARE * (end - start))
        return frame
