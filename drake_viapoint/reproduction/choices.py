"""Does it matter how components are chosen? Section 2.2.2 asked of many virtual persons.

Each person's serve is learned with the control variable of subtask 2 as the scenario says, then
with the three components of the largest norms, then with those of the largest ratios.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from drake_viapoint.errors import LearningError
from drake_viapoint.reproduction.components import first_meeting, serve_components
from drake_viapoint.reproduction.findings import Comparison, Findings, judged
from drake_viapoint.reproduction.persons import MAX_TRIALS
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.runs.learning_run import learn, recorded_via_points
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.runs.study_log import StudyLog
from drake_viapoint.runs.task_run import versions
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.scenario import dump_scenario
from drake_viapoint.tasks.serve import ServeTask

RESULTS = "choices.jsonl"
"""File of the results, a line a person."""

_POSITION, _ANGLE = 0.01, float(np.radians(1.0))  # small enough that hardly a ball is lost


@dataclass(frozen=True)
class PersonChoice:
    """What came of one person's serve with each control variable of subtask 2.

    Attributes:
        person: Number of the virtual person.
        as_given: Trial at which it was learned with the scenario's; None if not.
        norm: Components chosen by norm; empty if there was nothing to choose from.
        by_norm: Trial at which it was learned with them.
        ratio: Components chosen by ratio.
        by_ratio: Trial at which it was learned with them.
    """

    person: int
    as_given: int | None
    norm: str
    by_norm: int | None
    ratio: str
    by_ratio: int | None


def reproduce_choices(out: Path, persons: int, progress: Progress) -> Findings:
    """Learn many persons' serves with each choice, into a table.

    Args:
        out: Folder of the results and the table.
        persons: How many.
        progress: Shows what goes on.

    Raises:
        ViapointError: The folder cannot be written or holds another study.
    """
    with progress("learning with each choice", persons) as bar:
        results = study_choices(out / RESULTS, persons, on_person=bar.update)
    table = write_table(results, out / "choices.csv")
    return Findings(
        lines=tuple(choices_summary(results)),
        where=(f"table in {table}",),
        comparisons=choices_comparison(results),
        tables=(table.name,),
        seeds="0, of every run",
    )


def study_choices(
    file: Path,
    persons: int,
    *,
    workers: int = -1,
    on_person: Callable[[int], None] | None = None,
) -> list[PersonChoice]:
    """Learn the serve from persons 0 to ``persons`` - 1, with each choice.

    Persons in the file already are not done again. Where the ball is never met nothing can be
    chosen, and the serve counts as not learned.

    Args:
        file: Where results are kept, a line a person.
        persons: How many.
        workers: Processes; as many as there are cores if -1.
        on_person: Told how many persons have been done since it was last told.

    Raises:
        RunFolderError: The file cannot be written or holds another study.
    """
    told = on_person or (lambda _: None)
    with StudyLog(file, choices_identity()) as log:
        missing = sorted(set(range(persons)) - {row["person"] for row in log.rows})
        told(persons - len(missing))
        work = Parallel(n_jobs=workers, return_as="generator_unordered")(
            delayed(_study)(person) for person in missing
        )
        for row in work:
            log.append(row)
            told(1)
        rows = sorted(log.rows, key=lambda row: int(row["person"]))
    return [PersonChoice(**row) for row in rows if row["person"] < persons]


def choices_identity() -> dict[str, Any]:
    """What the results depend on beside the number of persons."""
    return {
        "max_trials": MAX_TRIALS,
        "perturbations": [_POSITION, _ANGLE],
        "scenario": dump_scenario(task_scenario("serve")),
        "versions": versions(),
    }


def choices_summary(results: list[PersonChoice]) -> list[str]:
    """How many serves were learned with each choice, and how soon."""
    lines = []
    for name, what in (
        ("as_given", "as the scenario says"),
        ("by_norm", "by norm"),
        ("by_ratio", "by ratio"),
    ):
        counts = [value for value in (getattr(r, name) for r in results) if value is not None]
        median = (
            f", those by trial {np.median(counts):g} (median), {max(counts)} (worst)"
            if counts
            else ""
        )
        lines.append(
            f"S_G chosen {what}: {len(counts)} of {len(results)} serves learned within "
            f"{MAX_TRIALS} trials{median}"
        )
    return lines


def choices_comparison(results: Sequence[PersonChoice]) -> tuple[Comparison, ...]:
    """What the paper says comes of choosing by norm and by ratio, and what does."""
    by_norm = sum(result.by_norm is not None for result in results)
    by_ratio = sum(result.by_ratio is not None for result in results)
    number = len(results)
    return (
        Comparison(
            "S_G chosen by norm",
            "2.2.2",
            "does not converge",
            f"{by_norm} of {number} persons' serves learned",
            judged(2 * by_norm < number),
            "the paper has one person; here it fails for most, not for all",
        ),
        Comparison(
            "S_G chosen by ratio",
            "2.2.2",
            "converges stably",
            f"{by_ratio} of {number} persons' serves learned",
            judged(2 * by_ratio > number),
            "" if by_ratio == number else f"the rest were not within {MAX_TRIALS} trials",
        ),
    )


def _study(person: int) -> dict[str, Any]:
    """All runs of one person, in a process of its own."""
    task, records, as_given = _learn(person, {})
    met = first_meeting(records, task.scenario.learning.throw.reached)
    if met is None:
        return asdict(PersonChoice(person, as_given, "", None, "", None))
    thrown = recorded_via_points(met, task.via_points.names)
    found = serve_components(task, task.via_points, thrown, position=_POSITION, angle=_ANGLE)
    learned = [
        _learn(person, {"learning.strike.control": list(selection.control)})[2]
        for selection in (found.by_norm, found.by_ratio)
    ]
    norm, ratio = (" ".join(choice.control) for choice in (found.by_norm, found.by_ratio))
    return asdict(PersonChoice(person, as_given, norm, learned[0], ratio, learned[1]))


def _learn(
    person: int, changes: dict[str, object]
) -> tuple[ServeTask, list[dict[str, Any]], int | None]:
    asked = {"demonstration.person": person, "learning.repeats": 0, **changes}
    task, log = ServeTask(task_scenario("serve", None, asked)), MemoryLog(f"person {person}")
    try:
        result = learn(task, log, seed=task.scenario.seed, max_trials=MAX_TRIALS)
    except LearningError:  # no slope to be found: a serve that is not learned
        return task, log.trials, None
    return task, log.trials, result.learned_at
