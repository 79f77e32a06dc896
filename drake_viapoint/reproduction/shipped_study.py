"""Sweeping a study that ships with the package, or the first runs of it."""

from __future__ import annotations

import contextlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
from joblib import cpu_count

from drake_viapoint.packages import resolve
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.runs.study import Study
from drake_viapoint.runs.study_file import read_study
from drake_viapoint.runs.sweep import RESULTS, sweep
from drake_viapoint.runs.task_run import versions
from drake_viapoint.runs.workers import LocalWorkers


def sweep_first(
    address: str, values: int, folder: Path, label: str, progress: Progress
) -> pd.DataFrame:
    """Execute the runs of a shipped study that a folder lacks, on every core.

    Args:
        address: Of the study in the package.
        values: So many, the first ones, of whatever varies; more if the folder holds more.
        folder: Of the sweep.
        label: Of the progress bar.
        progress: Shows what goes on.

    Returns:
        The sweep's table.

    Raises:
        ViapointError: The folder cannot be written or holds another study.
    """
    study = read_study(resolve(address))
    fewer = _first(study, values)
    done = _done(folder)
    for more in range(values + 1, _most(study) + 1):
        if done <= {run.name for run in fewer.runs()}:
            break
        fewer = _first(study, more)  # a study does not shrink
    workers = LocalWorkers(cpu_count())
    with progress(label, len(fewer)) as bar:
        return sweep(fewer, folder, workers, on_rows=lambda rows: bar.update(len(rows)))


def study_identity(address: str) -> dict[str, Any]:
    """What every run of a shipped study depends on, versions among it."""
    return read_study(resolve(address)).identity(versions())


def _first(study: Study, values: int) -> Study:
    return replace(
        study,
        vary={key: listed[:values] for key, listed in study.vary.items()},
        together={key: listed[:values] for key, listed in study.together.items()},
    )


def _most(study: Study) -> int:
    return max(len(listed) for listed in (*study.vary.values(), *study.together.values()))


def _done(folder: Path) -> set[str]:
    """Names of the runs that a sweep's folder holds; a line that cannot be read is left to it."""
    names = set()
    with contextlib.suppress(OSError):
        for line in (folder / RESULTS).read_bytes().splitlines():
            with contextlib.suppress(ValueError, KeyError, TypeError):
                names.add(str(json.loads(line)["run"]))
    return names
