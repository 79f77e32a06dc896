"""One run of a study, in whatever process it lands: from a small message to a row."""

from __future__ import annotations

import os
import platform
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drake_viapoint.errors import (
    FolderHeldError,
    LearningError,
    OutcomeNotFiniteError,
    RunFolderError,
    VersionsError,
)
from drake_viapoint.learning.ask_tell import Purpose
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.runs.learning_run import TrialLog, learn, trial_seed
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.runs.run_folder import RunFolder
from drake_viapoint.runs.study import REPEATED, Study, StudyRun
from drake_viapoint.runs.task_run import begin_or_resume, versions
from drake_viapoint.runs.trial_lines import as_read_back
from drake_viapoint.tasks.catalogue import TASKS, TaskBuilder
from drake_viapoint.tasks.scenario import Scenario, dump_scenario, make_scenario
from drake_viapoint.tasks.trial import FAILED, Task

RUNS = "runs"
"""Folder of the runs' folders, beside the table."""

FIRST_REPEAT = 1_000_001
"""Number of the first repeat's trial: beyond all trials of learning, so that it draws anew, and the
same in every condition, so that conditions are compared by equal disturbances."""

_LET_GO = 60.0  # [s] a killed worker's folder is waited for


@dataclass(frozen=True)
class StudyWork:
    """What all runs of a study have in common; with a run it is the message to a worker.

    Attributes:
        study: What is run. What varies is said by each run, see ``Study.without_runs``.
        versions: Of the process that asks; a worker of others refuses.
        folder: Where the worker keeps the runs' folders; None to keep trials in memory.
        send_trials: Whether trials come back with the row, for who asks to keep.
        asker: Its process id, if it runs on this machine: a worker ends with it.
    """

    study: Study
    versions: Mapping[str, str]
    folder: str | None = None
    send_trials: bool = False
    asker: int | None = None


@dataclass(frozen=True)
class StudyResult:
    """What comes back from a worker.

    Attributes:
        row: Of the table, as plain data.
        scenario: Text of the run's scenario, if trials were asked for.
        trials: Records of its trials, if asked for.
    """

    row: dict[str, Any]
    scenario: str = ""
    trials: tuple[dict[str, Any], ...] | None = None


# The one thing a worker keeps from run to run: a diagram costs as much as ten trials. One a thread,
# as a cluster's worker may have several and a diagram serves one at a time.
_kept = threading.local()


def execute(work: StudyWork, run: StudyRun) -> StudyResult:
    """Execute one run, and its movement's repeats.

    Whatever the run raises is its row's error; what was recorded before is in the row.

    Raises:
        VersionsError: This process is of other versions.
        RunFolderError: The run's folder cannot be written or holds something else.
        OSError: The disk fails otherwise.
    """
    _check_versions(work.versions)
    start = time.perf_counter()
    row = row_without_result(work.study, run)
    repeats: list[dict[str, Any]] = []
    text = ""
    with ExitStack() as closing:
        log: TrialLog = MemoryLog(run.name)
        try:
            scenario = _scenario(work, run)
            text = dump_scenario(scenario)
            task = _builder().build(scenario)
            if work.folder is not None:
                log = closing.enter_context(_run_folder(Path(work.folder) / run.name, scenario))
            if work.folder is not None or work.send_trials:
                row["folder"] = f"{RUNS}/{run.name}"
            final = _learn(work, task, log, scenario.seed, row)
            _repeat(work, task, final, scenario.seed, repeats)
        except (RunFolderError, OSError):
            raise
        except (Exception, SystemExit) as error:
            _kept.builder = None  # what an exception leaves behind is not trusted
            row["error"] = _one_line(error)
        trials = tuple(log.trials)
    row |= _counts(trials) | _columns(work.study, trials, repeats)
    row["seconds"] = time.perf_counter() - start
    return StudyResult(as_read_back(row), text, trials if work.send_trials else None)


def row_without_result(study: Study, run: StudyRun, error: str | None = None) -> dict[str, Any]:
    """A row with every column, of a run of which nothing came yet, or nothing but an error."""
    row: dict[str, Any] = dict.fromkeys(study.columns())
    row |= {"run": run.name, "condition": run.condition, **run.values, "error": error}
    return row | _counts(()) | _columns(study, (), ())


def _check_versions(asked: Mapping[str, str]) -> None:
    if getattr(_kept, "versions", None) == asked:
        return
    own = versions()
    for package in sorted(asked):
        if own.get(package) != asked[package]:
            name = f"{platform.node()} (process {os.getpid()})"
            raise VersionsError(name, package, own.get(package), asked[package])
    _kept.versions = asked


def _builder() -> TaskBuilder:
    if getattr(_kept, "builder", None) is None:
        _kept.builder = TaskBuilder()
    builder: TaskBuilder = _kept.builder
    return builder


def _scenario(work: StudyWork, run: StudyRun) -> Scenario:
    schema = TASKS[work.study.task].scenario
    scenario: Scenario = make_scenario(work.study.scenario, schema, run.changes)
    scenario.made_with = dict(work.versions)
    return scenario


def _run_folder(path: Path, scenario: Scenario) -> RunFolder:
    """The run's folder, once a worker that was killed or left alone has let go of it."""
    deadline = time.monotonic() + _LET_GO
    while True:
        try:
            return begin_or_resume(path, scenario)[0]
        except FolderHeldError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.1)


def _learn(work: StudyWork, task: Task, log: TrialLog, seed: int, row: dict[str, Any]) -> ViaPoints:
    """Learn, and return the final movement."""
    if log.trials and log.trials[-1]["outcome"] == FAILED:  # it ended there before it was killed
        raise LearningError(_failure(log))
    try:
        result = learn(
            task,
            log,
            seed=seed,
            max_trials=work.study.max_trials,
            on_trial=lambda _record, _trial: _end_with(work.asker),
        )
    except OutcomeNotFiniteError as error:
        raise LearningError(_failure(log)) from error
    row["learned_at"], row["wasted"] = result.learned_at, result.wasted
    return result.via_points


def _repeat(
    work: StudyWork, task: Task, final: ViaPoints, seed: int, repeats: list[dict[str, Any]]
) -> None:
    for number in range(FIRST_REPEAT, FIRST_REPEAT + work.study.repeats):
        own_seed = trial_seed(seed, number)
        record = task.execute(final, own_seed).record()
        repeats.append({"trial": number, "purpose": Purpose.REPEAT, **record, "seed": own_seed})
        _end_with(work.asker)


def _failure(log: TrialLog) -> str:
    last = log.trials[-1]
    return f"trial {last['trial']}: {last['reason']}"


def _counts(trials: Sequence[dict[str, Any]]) -> dict[str, Any]:
    successes = (record["trial"] for record in trials if record["success"])
    return {"trials": len(trials), "first_success": next(successes, None)}


def _columns(
    study: Study, trials: Sequence[dict[str, Any]], repeats: Sequence[dict[str, Any]]
) -> dict[str, list[Any]]:
    """A list a tabulated field, with a value a trial; None where a trial has no such field."""
    columns = {name: [record.get(name) for record in trials] for name in study.tabulate}
    if study.repeats:
        columns |= {
            REPEATED + name: [record.get(name) for record in repeats] for name in study.tabulate
        }
    return columns


def _end_with(asker: int | None) -> None:
    """End this process if who asked was killed: nobody waits, and the folder is wanted again."""
    if asker is not None and asker not in (os.getpid(), os.getppid()):
        os._exit(1)


def _one_line(error: BaseException) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())
