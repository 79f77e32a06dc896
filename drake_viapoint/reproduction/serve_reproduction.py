"""The serve from a run made here and now: our Figs. 2 to 5, 8 and 9, its curve.

Executed by events, as in the paper's simulation; our Figs. 6 and 7 are the robot's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from drake_viapoint.reproduction import (
    components,
    figure2,
    figure3,
    figure4,
    figure5,
    figure6,
    figure7,
    figure8,
    persons,
)
from drake_viapoint.reproduction.captions import captioned
from drake_viapoint.reproduction.findings import Findings, Recording
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.recording import record_trial
from drake_viapoint.reproduction.serve_comparison import serve_comparison
from drake_viapoint.reproduction.shown_trials import executed_trials, shown_trials
from drake_viapoint.reproduction.style import POSE_LABELS, SYNTHETIC, save
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.run_folder import read_trials
from drake_viapoint.runs.task_run import begin_or_resume
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import ServeTrial


def reproduce_serve(out: Path, _: int, progress: Progress) -> Findings:
    """Run the serve, draw our Figs. 2 to 5, 8 and 9 and its curve, and record three trials.

    A run that the folder holds already is gone on with, not done again.

    Args:
        out: Folder of figures, recordings and the run.
        progress: Shows what goes on.

    Raises:
        ViapointError: The folder cannot be written or holds another run.
    """
    run = out / "serve"
    folder, scenario = begin_or_resume(run, task_scenario("serve"))
    with folder, progress("learning the serve", persons.MAX_TRIALS) as bar:
        task = ServeTask(scenario)
        result = learn(
            task,
            folder,
            seed=scenario.seed,
            max_trials=persons.MAX_TRIALS,
            on_trial=lambda *_: bar.update(1),
        )
        bar.update(persons.MAX_TRIALS)
    records = read_trials(run)
    shown = shown_trials(records)
    figures = _figures(task, records, shown)
    with progress("figures and recordings", len(figures) + len(shown)) as bar:
        for name, figure in figures.items():
            save(figure, out / f"{name}.png")
            bar.update(1)
        pages = {}
        for title, numbers in shown.items():
            page = Recording(f"serve_trial{numbers[-1]:02d}.html", f"the serve, {title}")
            if page.file not in pages:
                record_trial(run, numbers[-1], out / page.file)
                pages[page.file] = page
                bar.update(1)
    lines = [
        f"serve: learned at trial {result.learned_at}"
        if result.learned_at
        else f"serve: not learned within {result.trials} trials"
    ]
    where = [
        f"figures in {out}/figure2.png to figure5.png, figure8.png and serve_*.png",
        "recordings in " + ", ".join(str(out / name) for name in pages),
    ]
    pictures = [f"{name}.png" for name in figures]
    found: components.ServeComponents | None = None
    if components.first_meeting(records, scenario.learning.throw.reached):
        with progress("moving each component", components.trials_of(task)) as bar:
            found, said, there = components.study_components(
                run, out, on_trial=lambda: bar.update(1)
            )
        lines += said
        where.append(there)
        pictures.append("figure9.png")
    return Findings(
        lines=tuple(lines),
        where=tuple(where),
        pictures=captioned(*pictures),
        recordings=tuple(pages.values()),
        comparisons=serve_comparison(task.watched, result.learned_at, found),
        tables=components.TABLES if found else (),
        seeds=str(scenario.seed),
    )


def _figures(
    task: ServeTask, records: Sequence[dict[str, Any]], shown: Mapping[str, Sequence[int]]
) -> dict[str, Any]:
    watched = task.watched
    times = watched.pose.times - watched.pose.times[0]
    note = f" ({SYNTHETIC})" if watched.synthetic else ""
    executed = executed_trials(task, records, shown)
    learning = task.scenario.learning
    first = task.execute(task.via_points, records[0]["seed"])
    return {
        "figure2": figure2.draw(watched),
        "figure3": figure3.draw(times, watched.pose.values, watched.extraction, note=note),
        "figure4": figure4.draw(
            times,
            watched.pose.values,
            watched.extraction,
            POSE_LABELS,
            title=f"Racket pose and via-points{note}",
            hit_time=watched.hit_time,
        ),
        "figure5": figure5.draw(task),
        **({"figure8": figure8.draw(task, first)} if isinstance(first, ServeTrial) else {}),
        "serve_views": figure6.draw(task, executed),
        "serve_curve": figure7.draw(
            records, learning.meeting_tolerance, learning.landing_tolerance
        ),
    }
