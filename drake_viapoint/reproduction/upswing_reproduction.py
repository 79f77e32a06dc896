"""Section 3.3 from runs made here and now: our Figs. 11 to 14, three recordings; many persons."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from drake_viapoint.reproduction import figure11, figure12, figure13, upswing_persons
from drake_viapoint.reproduction.captions import captioned
from drake_viapoint.reproduction.findings import Findings, Recording
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.recording import record_trial
from drake_viapoint.reproduction.style import save
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.reproduction.upswing_comparison import (
    upswing_comparison,
    upswing_persons_comparison,
)
from drake_viapoint.reproduction.upswing_study import (
    MAX_TRIALS,
    study_result,
    study_upswings,
    summary,
)
from drake_viapoint.runs.learning_run import learn, recorded_via_points
from drake_viapoint.runs.run_folder import read_trials
from drake_viapoint.runs.task_run import begin_or_resume
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.jacobian_scenario import WAYS
from drake_viapoint.tasks.upswing import UpswingTask
from drake_viapoint.tasks.upswing_scene import UpswingScene
from drake_viapoint.tasks.upswing_trial import UpswingTrial

PERSONS = "upswing_persons.jsonl"
"""File of the study's results, a line a person."""

_RECORDED = (1, 15, 30)  # trials shown in a browser
_FIRST, _LAST = 1, 30  # trials of Figs. 12 and 14


def reproduce_upswing(out: Path, _: int, progress: Progress) -> Findings:
    """Learn the upswing in each way, draw our Figs. 11 to 14, and record three trials.

    Runs that the folder holds already are gone on with, not done again.

    Args:
        out: Folder of figures, recordings and runs.
        progress: Shows what goes on.

    Raises:
        ViapointError: The folder cannot be written or holds other runs.
    """
    runs = {way: out / f"upswing_{way}" for way in WAYS}
    with progress("learning the upswing", MAX_TRIALS * len(runs)) as bar:
        for way, path in runs.items():
            task = _learn(way, path)
            bar.update(MAX_TRIALS)
    records = {way: read_trials(path) for way, path in runs.items()}
    pages = [
        Recording(f"upswing_trial{number:02d}.html", f"the upswing, trial {number}")
        for number in _RECORDED
    ]
    figures = _figures(task, records)
    with progress("figures and recordings", len(figures) + len(pages)) as bar:
        for name, figure in figures.items():
            save(figure, out / f"{name}.png")
            bar.update(1)
        for number, page in zip(_RECORDED, pages, strict=True):
            record_trial(runs["recorded"], number, out / page.file)
            bar.update(1)
    lines = [_first_success(way, lines) for way, lines in records.items()]
    return Findings(
        lines=(*lines, _in_the_plant(task, records["recorded"][-1])),
        where=(
            f"figures in {out}/figure11.png to figure14.png",
            "recordings in " + ", ".join(str(out / page.file) for page in pages),
        ),
        pictures=captioned(*sorted(f"{name}.png" for name in figures)),
        recordings=tuple(pages),
        comparisons=upswing_comparison(task.scenario, records),
        seeds=str(task.scenario.seed),
    )


def reproduce_upswing_persons(out: Path, persons: int, progress: Progress) -> Findings:
    """Learn the upswing from many virtual persons, in each way and each execution.

    Args:
        out: Folder of the pictures, the table and the results.
        persons: How many.
        progress: Shows what goes on.

    Raises:
        ViapointError: The folder cannot be written or holds another study.
    """
    with progress("upswings of virtual persons", persons) as bar:
        runs = study_upswings(out / PERSONS, persons, on_person=bar.update)
    results = study_result(runs)
    table = write_table(results, out / "upswing_persons.csv")
    learning = task_scenario("upswing").learning
    success = save(upswing_persons.draw_success(runs, results), out / "upswing_persons.png")
    drawn = upswing_persons.draw_curves(runs, learning.angle_tolerance, learning.speed_tolerance)
    curves = save(drawn, out / "upswing_curves.png")
    return Findings(
        lines=tuple(map(summary, results)),
        where=(f"table in {table}, pictures in {success} and {curves}",),
        pictures=captioned(success.name, curves.name),
        comparisons=upswing_persons_comparison(runs),
        tables=(table.name,),
        seeds="0, of every run",
    )


def _learn(way: str, path: Path) -> UpswingTask:
    """Sixty trials whatever succeeds, as in Fig. 13."""
    changes = {"learning.jacobian.way": way, "learning.successes": 0}
    folder, scenario = begin_or_resume(path, task_scenario("upswing", None, changes))
    task = UpswingTask(scenario)
    with folder:
        learn(task, folder, seed=scenario.seed, max_trials=MAX_TRIALS)
    return task


def _figures(task: UpswingTask, records: dict[str, list[dict[str, Any]]]) -> dict[str, Figure]:
    scenario = task.scenario
    length, learning = scenario.pendulum.length, scenario.learning
    shown: dict[str, Figure] = {}
    for name, number in (("figure12", _FIRST), ("figure14", _LAST)):
        record = records["recorded"][number - 1]
        via_points = recorded_via_points(record, task.via_points.names)
        trial = task.execute(via_points, record["seed"])
        if isinstance(trial, UpswingTrial):
            title = f"Trial {number}: {trial.summary()}"
            shown[name] = figure12.draw(trial, via_points, task.watched, length, title)
    return {
        "figure11": figure11.draw(UpswingScene(scenario), length),
        **shown,
        "figure13": figure13.draw(records, learning.angle_tolerance, learning.speed_tolerance),
    }


def _first_success(way: str, records: list[dict[str, Any]]) -> str:
    good = [record["trial"] for record in records if record["success"]]
    first = f"first succeeds at trial {good[0]}" if good else "does not succeed"
    return f"upswing, {figure13.TITLES[way]}: {first}, {len(good)} of {len(records)} trials succeed"


def _in_the_plant(task: UpswingTask, record: dict[str, Any]) -> str:
    """How far apart the two executions end, at what was learned."""
    changes = {"execution": "plant"}
    plant = UpswingTask(task_scenario("upswing", None, changes), task.watched)
    via_points = recorded_via_points(record, task.via_points.names)
    trial = plant.execute(via_points, record["seed"])
    if not isinstance(trial, UpswingTrial):
        return f"the last of these in the plant: {trial.reason}"
    angle, speed = trial.end_state - record["T"]
    return (
        f"the last of these in the plant: {trial.summary()}; {angle:+.3f} rad and {speed:+.2f} "
        "rad/s from the paper's equation, whose steps are of first order"
    )
