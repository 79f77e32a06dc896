"""The serve learned from many virtual persons: how often, how fast, and why not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from drake_viapoint.errors import RunFolderError, ViapointError
from drake_viapoint.reproduction.captions import captioned
from drake_viapoint.reproduction.findings import Findings
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.style import save
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.run_folder import read_trials
from drake_viapoint.runs.task_run import begin_or_resume
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.serve import ServeTask

MAX_TRIALS = 60
"""Trials within which the paper's robot learned its serve."""


@dataclass(frozen=True)
class PersonResult:
    """What came of learning from one person.

    Attributes:
        person: Number of the virtual person.
        first_outcome: How the first trial ended.
        first_d: Its distance of the ball from the face's centre [m].
        first_landing_error: Its distance from the goal [m], None if it did not land.
        learned_at: Trial that completed three successes in a row, None if not learned.
        trials: Trials executed, repeats included.
        reason: Why it was not learned; empty if it was.
    """

    person: int
    first_outcome: str
    first_d: float | None
    first_landing_error: float | None
    learned_at: int | None
    trials: int
    reason: str


def reproduce_persons(out: Path, number: int, progress: Progress) -> Findings:
    """Learn the serve from many virtual persons.

    Args:
        out: Folder of the picture, the table and the runs.
        number: Of persons.
        progress: Shows what goes on.

    Raises:
        ViapointError: The folder cannot be written or holds other runs.
    """
    with progress("learning from virtual persons", number) as bar:
        results = study_persons(out / "persons", number, lambda: bar.update(1))
    table = write_table(results, out / "persons.csv")
    picture = save(draw(results), out / "persons.png")
    return Findings(
        lines=(summary(results),),
        where=(f"table in {table}, picture in {picture}",),
        pictures=captioned(picture.name),
        tables=(table.name,),
        seeds="0, of every run",
    )


def study_persons(
    out: Path, number: int, on_person: Callable[[], None] | None = None
) -> list[PersonResult]:
    """Learn the serve from persons 0 to number - 1, each in a run folder of its own.

    Runs that are there already, whole or interrupted, are not done again.

    Args:
        out: Folder of the run folders.
        number: How many persons.
        on_person: Called after each.

    Raises:
        RunFolderError: A run cannot be written, or the folder holds others.
    """
    results = []
    for person in range(number):
        results.append(_study(out / f"person{person:02d}", person))
        if on_person is not None:
            on_person()
    return results


def _study(path: Path, person: int) -> PersonResult:
    reason, learned_at = "", None
    try:
        folder, scenario = begin_or_resume(
            path, task_scenario("serve", None, {"demonstration.person": person})
        )
        with folder:
            result = learn(ServeTask(scenario), folder, seed=scenario.seed, max_trials=MAX_TRIALS)
        learned_at = result.learned_at
        if learned_at is None:
            last = read_trials(path)[-1]
            reason = f"after {MAX_TRIALS} trials: " + last.get("reason", last["outcome"])
    except RunFolderError:  # a disk, not a person
        raise
    except ViapointError as error:
        reason = str(error)
    records = read_trials(path) if (path / "trials.jsonl").is_file() else []
    first = records[0] if records else {}
    return PersonResult(
        person,
        str(first.get("outcome", "not executed")),
        first.get("d"),
        first.get("landing_error"),
        learned_at,
        len(records),
        reason,
    )


def summary(results: Sequence[PersonResult]) -> str:
    """Success, median and worst count in one line."""
    counts = [result.learned_at for result in results if result.learned_at is not None]
    if not counts:
        return f"none of {len(results)} virtual persons' serves was learned"
    return (
        f"{len(counts)} of {len(results)} virtual persons' serves learned within {MAX_TRIALS} "
        f"trials, those by trial {np.median(counts):g} (median), {max(counts)} (worst)"
    )


def draw(results: Sequence[PersonResult]) -> Figure:
    """Draw at which trial each person's serve was learned."""
    figure = Figure(figsize=(8, 3.4), layout="constrained")
    ax = figure.subplots()
    persons = [r.person for r in results if r.learned_at is not None]
    counts = [r.learned_at for r in results if r.learned_at is not None]
    failed = [r.person for r in results if r.learned_at is None]
    ax.bar(persons, counts, color="tab:blue", label="third success in a row")
    if failed:
        ax.plot(failed, [MAX_TRIALS] * len(failed), "x", color="tab:red", label="not learned")
    if counts:
        median = float(np.median(counts))
        ax.axhline(median, color="k", linestyle="--", linewidth=0.8, label=f"median {median:g}")
    ax.axhline(MAX_TRIALS, color="0.6", linestyle=":", linewidth=0.8)
    ax.set_xlabel("virtual person (synthetic demonstrations)")
    ax.set_ylabel("trials, exploration included")
    ax.set_xticks([r.person for r in results])
    ax.legend(fontsize=8)
    return figure
