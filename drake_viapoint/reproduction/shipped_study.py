"""Sweeping a study that ships with the package, or the first runs of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd
from joblib import cpu_count

from drake_viapoint.packages import resolve
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.runs.study_file import read_study
from drake_viapoint.runs.sweep import sweep
from drake_viapoint.runs.workers import LocalWorkers


def sweep_first(
    address: str, values: int, folder: Path, label: str, progress: Progress
) -> pd.DataFrame:
    """Execute the runs of a shipped study that a folder lacks, on every core.

    Args:
        address: Of the study in the package.
        values: So many, the first ones, of whatever varies.
        folder: Of the sweep.
        label: Of the progress bar.
        progress: Shows what goes on.

    Returns:
        The sweep's table.

    Raises:
        ViapointError: The folder cannot be written or holds another study.
    """
    study = read_study(resolve(address))
    fewer = replace(
        study,
        vary={key: listed[:values] for key, listed in study.vary.items()},
        together={key: listed[:values] for key, listed in study.together.items()},
    )
    workers = LocalWorkers(cpu_count())
    with progress(label, len(fewer)) as bar:
        return sweep(fewer, folder, workers, on_rows=lambda rows: bar.update(len(rows)))
