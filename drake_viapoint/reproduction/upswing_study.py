"""The upswing learned from many virtual persons, in each way and each execution."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.ask_tell import Purpose
from drake_viapoint.reproduction.trials_needed import trials_in_words, trials_percentile
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.runs.study_log import StudyLog
from drake_viapoint.runs.task_run import versions
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.jacobian_scenario import WAYS
from drake_viapoint.tasks.scenario import dump_scenario
from drake_viapoint.tasks.upswing import UpswingTask
from drake_viapoint.tasks.upswing_demonstration import recorded_upswing, watch_upswing
from drake_viapoint.tasks.upswing_scene import UpswingScene

EXECUTIONS = ("recurrence", "plant")
"""The paper's equation, and Drake's with a hand that moves exactly as commanded."""

MAX_TRIALS = 60
"""All of them are made, whatever succeeds: what is learned has to be held."""

_HELD = 3  # successes at the end
_CHUNK = 4  # persons whose runs share a scene


@dataclass(frozen=True)
class PersonRun:
    """One run: from one virtual person, in one execution and one way.

    Attributes:
        person: Number of the virtual person.
        execution: One of ``EXECUTIONS``.
        way: One of ``jacobian_scenario.WAYS``.
        error: T - Td of each trial (n, 2) [rad, rad/s]; NaN where the arm could not do it.
        success: Of each trial (n,).
        exploration: Whether a trial was made to explore (n,).
    """

    person: int
    execution: str
    way: str
    error: NDArray[np.float64]
    success: NDArray[np.bool_]
    exploration: NDArray[np.bool_]

    @property
    def first_success(self) -> int | None:
        """Number of the first trial that succeeded, exploration counted; None if none did."""
        return int(np.argmax(self.success)) + 1 if self.success.any() else None

    def held(self, trials: int) -> bool:
        """Whether the last three of so many trials succeeded.

        Explorations are left out: they are moved away on purpose.
        """
        return bool(np.all(self.success[:trials][~self.exploration[:trials]][-_HELD:]))


@dataclass(frozen=True)
class WayResult:
    """What all persons' runs in one execution and one way came to.

    Attributes:
        execution: One of ``EXECUTIONS``.
        way: One of ``jacobian_scenario.WAYS``.
        persons: Runs.
        first_trial_failed: Share of them.
        within_30: Share that succeeded within 30 trials.
        held_at_30: Share whose last three trials up to the 30th succeeded.
        within_60: As above.
        held_at_60: As above.
        median: Trial of the first success, of all persons; None if most never succeed.
        percentile_90: The same for nine of ten.
    """

    execution: str
    way: str
    persons: int
    first_trial_failed: float
    within_30: float
    held_at_30: float
    within_60: float
    held_at_60: float
    median: float | None
    percentile_90: float | None


def study_upswings(
    file: Path,
    persons: int,
    *,
    executions: Sequence[str] = EXECUTIONS,
    workers: int = -1,
    on_person: Callable[[int], None] | None = None,
) -> list[PersonRun]:
    """Learn the upswing from persons 0 to ``persons`` - 1, in each way.

    Persons whose runs are in the file already are not done again.

    Args:
        file: Where results are kept, a line a person.
        persons: How many.
        executions: Which of ``EXECUTIONS``.
        workers: Processes; as many as there are cores if -1.
        on_person: Told how many persons have been done since it was last told.

    Raises:
        RunFolderError: The file cannot be written or holds another study.
    """
    with StudyLog(file, study_identity(executions)) as log:
        wanted = set(range(persons))
        missing = sorted(wanted - {row["person"] for row in log.rows})
        if on_person is not None:
            on_person(persons - len(missing))
        chunks = [missing[i : i + _CHUNK] for i in range(0, len(missing), _CHUNK)]
        work = Parallel(n_jobs=workers, return_as="generator_unordered")(
            delayed(_study_chunk)(chunk, tuple(executions)) for chunk in chunks
        )
        for rows in work:
            for row in rows:
                log.append(row)
            if on_person is not None:
                on_person(len(rows))
        done = [row for row in log.rows if row["person"] in wanted]
    done.sort(key=lambda row: row["person"])
    return [run for row in done for run in _runs(row)]


def study_identity(executions: Sequence[str] = EXECUTIONS) -> dict[str, Any]:
    """What the study's results depend on beside the number of persons."""
    return {
        "max_trials": MAX_TRIALS,
        "executions": list(executions),
        "scenario": dump_scenario(task_scenario("upswing")),
        "versions": versions(),
    }


def study_result(runs: Iterable[PersonRun]) -> list[WayResult]:
    """Shares and counts, one line an execution and a way, in the order of Fig. 13."""
    groups: dict[tuple[str, str], list[PersonRun]] = {}
    for run in runs:
        groups.setdefault((run.execution, run.way), []).append(run)
    return [_result(execution, way, group) for (execution, way), group in groups.items()]


def summary(result: WayResult) -> str:
    """One line of the table in words."""
    return (
        f"{result.execution:<10} {result.way:<8} of {result.persons} persons "
        f"{result.within_30:6.1%} succeed within 30 trials ({result.held_at_30:.1%} held), "
        f"{result.within_60:6.1%} within 60 ({result.held_at_60:.1%} held), median trial "
        f"{trials_in_words(result.median)}, 90th percentile {trials_in_words(result.percentile_90)}"
    )


def _study_chunk(persons: Sequence[int], executions: Sequence[str]) -> list[dict[str, Any]]:
    """All runs of a few persons, in a process of its own."""
    scene = UpswingScene(task_scenario("upswing")) if "plant" in executions else None
    return [
        {"person": person, "runs": list(_learn(person, executions, scene))} for person in persons
    ]


def _learn(
    person: int, executions: Sequence[str], scene: UpswingScene | None
) -> Iterator[dict[str, Any]]:
    watched = None
    for execution in executions:
        for way in WAYS:
            changes = {
                "demonstration.person": person,
                "execution": execution,
                "learning.jacobian.way": way,
                "learning.successes": 0,
            }
            scenario = task_scenario("upswing", None, changes)
            if watched is None:
                config = scenario.demonstration
                watched = watch_upswing(config, recorded_upswing(config))
            log = MemoryLog(f"person {person}, {execution}, {way}")
            reason = ""
            try:
                task = UpswingTask(scenario, watched, scene)
                learn(task, log, seed=scenario.seed, max_trials=MAX_TRIALS)
            except LearningError as error:
                reason = str(error)
            yield {
                "execution": execution,
                "way": way,
                "error": [_error(record) for record in log.trials],
                "success": [record["success"] for record in log.trials],
                "exploration": [r["purpose"] == Purpose.EXPLORATION for r in log.trials],
                "reason": reason,
            }


def _error(record: dict[str, Any]) -> list[float] | None:
    if record["T"] is None:
        return None
    return [is_ - should for is_, should in zip(record["T"], record["Td"], strict=True)]


def _runs(row: dict[str, Any]) -> Iterator[PersonRun]:
    """Runs as they were recorded, filled up with failures where learning ended early."""
    for run in row["runs"]:
        left = MAX_TRIALS - len(run["success"])
        nothing = [np.nan, np.nan]
        yield PersonRun(
            row["person"],
            run["execution"],
            run["way"],
            np.array([error or nothing for error in run["error"]] + [nothing] * left),
            np.array(run["success"] + [False] * left, dtype=bool),
            np.array(run["exploration"] + [False] * left, dtype=bool),
        )


def _result(execution: str, way: str, runs: Sequence[PersonRun]) -> WayResult:
    firsts = np.array([np.inf if r.first_success is None else r.first_success for r in runs])
    return WayResult(
        execution=execution,
        way=way,
        persons=len(runs),
        first_trial_failed=float(np.mean(firsts > 1)),
        within_30=float(np.mean(firsts <= 30)),
        held_at_30=float(np.mean([run.held(30) for run in runs])),
        within_60=float(np.mean(firsts <= 60)),
        held_at_60=float(np.mean([run.held(60) for run in runs])),
        median=trials_percentile(firsts, 50),
        percentile_90=trials_percentile(firsts, 90),
    )
