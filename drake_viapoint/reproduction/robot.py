"""The robot experiment of section 2.1: many runs, our Figs. 6 and 7, recordings of its trials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from drake_viapoint.errors import ViapointError
from drake_viapoint.reproduction import figure6, figure7
from drake_viapoint.reproduction.captions import captioned
from drake_viapoint.reproduction.findings import Findings, Recording
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.recording import record_trial
from drake_viapoint.reproduction.robot_comparison import robot_comparison
from drake_viapoint.reproduction.robot_runs import robot_run, summary
from drake_viapoint.reproduction.shipped_study import sweep_first
from drake_viapoint.reproduction.shown_trials import executed_trials, shown_trials
from drake_viapoint.reproduction.style import save
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.runs.run_folder import read_trials
from drake_viapoint.runs.task_run import read_scenario
from drake_viapoint.tasks.serve import ServeTask

STUDY = "package://drake_viapoint/studies/robot.yaml"
"""The study that is shipped."""


def reproduce_robot(out: Path, runs: int, progress: Progress) -> Findings:
    """Learn the serve as on a robot, again and again, and draw our Figs. 6 and 7.

    What the folder holds already is not done again.

    Args:
        out: Folder of figures, recordings, the table and the sweep.
        runs: How many; at most as many as the shipped study has.
        progress: Shows what goes on.

    Raises:
        ViapointError: The folder cannot be written or holds another study.
    """
    folder = out / "robot"
    table = sweep_first(STUDY, runs, folder, "learning on a robot", progress)
    if table["error"].notna().all():
        raise ViapointError(f"{folder}: no run came to its end: {table['error'].iloc[0]}")
    return study_robot(table, folder, out, progress)


def study_robot(table: pd.DataFrame, folder: Path, out: Path, progress: Progress) -> Findings:
    """Draw our Figs. 6 and 7 of a sweep of the robot's serve, and count its successes.

    Args:
        table: Of the sweep.
        folder: Of the sweep.
        out: Folder of pictures, recordings and the table.
        progress: Shows what goes on.

    Raises:
        ViapointError: Something cannot be read or written.
    """
    done = table[table["error"].isna()]
    most = int(table.attrs["study"]["max_trials"])
    records = [read_trials(folder / name) for name in done["folder"]]
    first = folder / done["folder"].iloc[0]
    scenario = read_scenario(first)
    learning = scenario.learning
    runs = [
        robot_run(
            lines,
            seed=int(row["seed"]),
            told_at=None if pd.isna(row["learned_at"]) else int(row["learned_at"]),
            wasted=int(row["wasted"]),
            most=most,
            meeting_tolerance=learning.meeting_tolerance,
            ring=scenario.contact.ring_radius,
        )
        for (_, row), lines in zip(done.iterrows(), records, strict=True)
    ]
    written = write_table(runs, out / "robot.csv")
    shown = shown_trials(records[0])
    with progress("figures and recordings", 2 + len(shown)) as bar:
        task = ServeTask(scenario)
        trials = executed_trials(task, records[0], shown)
        save(figure6.draw(task, trials), out / "figure6.png")
        bar.update(1)
        tolerances = learning.meeting_tolerance, learning.landing_tolerance
        save(figure7.draw(records[0], *tolerances, runs=records), out / "figure7.png")
        bar.update(1)
        pages = _recordings(first, shown, out, bar)
    return Findings(
        lines=tuple(summary(runs, most)),
        where=(
            f"pictures in {out}/figure6.png and {out}/figure7.png, table in {written}",
            "recordings in " + ", ".join(str(out / page.file) for page in pages),
        ),
        pictures=captioned("figure6.png", "figure7.png"),
        recordings=tuple(pages),
        comparisons=robot_comparison(runs, records),
        tables=(written.name,),
        seeds=f"{min(run.seed for run in runs)} to {max(run.seed for run in runs)}, each another "
        "robot",
    )


def _recordings(
    run: Path, shown: Mapping[str, Sequence[int]], out: Path, bar: Any
) -> list[Recording]:
    pages: list[Recording] = []
    for title, numbers in shown.items():
        page = Recording(f"robot_trial{numbers[-1]:02d}.html", f"the robot's serve, {title}")
        if page.file not in {other.file for other in pages}:
            record_trial(run, numbers[-1], out / page.file)
            pages.append(page)
            bar.update(1)
    return pages
