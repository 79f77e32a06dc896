"""One learning run: ask the learner, execute the trial, record it, tell the learner."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from drake_viapoint.errors import OutcomeNotFiniteError, RunFolderError, ViaPointsError
from drake_viapoint.learning.learner import Learner
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.runs.run_folder import TRIALS
from drake_viapoint.tasks.trial import FAILED, Task, Trial


class TrialLog(Protocol):
    """Where trials are recorded: a run folder, or memory."""

    @property
    def path(self) -> Path:
        """What to call it in an error."""
        ...

    @property
    def trials(self) -> Sequence[dict[str, Any]]:
        """Records of the trials so far."""
        ...

    def append(self, record: dict[str, Any]) -> dict[str, Any]:
        """Keep a record, and give it back as it will be read."""
        ...


@dataclass(frozen=True)
class RunResult:
    """How a run ended.

    Attributes:
        trials: Trials executed, repeats included.
        learned_at: The trial that completed the successes in a row; None if not learned.
        wasted: Exploration trials of which no Jacobian was made.
        via_points: What was learned; what would be executed next if it was not.
    """

    trials: int
    learned_at: int | None
    wasted: int
    via_points: ViaPoints


def learn(
    task: Task,
    folder: TrialLog,
    *,
    seed: int,
    max_trials: int,
    on_trial: Callable[[dict[str, Any], Trial], None] | None = None,
) -> RunResult:
    """Learn a task, going on from whatever trials the folder holds.

    Args:
        task: What to learn.
        folder: Where trials are recorded.
        seed: Of the run; each trial's own seed follows from it.
        max_trials: Give up after so many trials; repeats of a learned movement not counted.
        on_trial: Told each new trial's record and the trial, after it is on the disk.

    Raises:
        RunFolderError: The folder holds another run's trials, or cannot be written.
        LearningError: Nothing can be learned from an outcome. The trial is on record.
        OutcomeNotFiniteError: A trial gave no numbers. It is on record as failed; learning again
            executes the same via-points once more.
    """
    learner = Learner(
        task.via_points,
        task.subtasks,
        successes_to_learn=task.successes,
        repeats=task.repeats,
    )
    for record in folder.trials:
        _tell_again(learner, task, folder.path, record)
    while not learner.finished and (learner.learned_at or learner.trials < max_trials):
        proposal = learner.ask()
        number = learner.trials + 1
        own_seed = trial_seed(seed, number)
        trial = task.execute(proposal.via_points, own_seed)
        record = {
            "trial": number,
            "purpose": str(proposal.purpose),
            "subtask": proposal.subtask,
            **_checked(trial.record(), [subtask.task_variable for subtask in task.subtasks]),
            "via_points": {
                "times": proposal.via_points.times.tolist(),
                "values": proposal.via_points.values.tolist(),
            },
            "seed": own_seed,
        }
        record = folder.append(record)  # as read back, so that a resumed learner is told the same
        if on_trial is not None:
            on_trial(record, trial)
        learner.tell(task.outcome(record))
    return RunResult(learner.trials, learner.learned_at, learner.wasted, learner.via_points)


def trial_seed(seed: int, trial: int) -> int:
    """The seed of one trial of a run: trials draw independently, whatever came before them."""
    return int(np.random.SeedSequence([seed, trial]).generate_state(1)[0])


def recorded_via_points(record: dict[str, Any], names: tuple[str, ...]) -> ViaPoints:
    """The via-points a recorded trial executed.

    Args:
        record: A line of the run.
        names: Dimensions of the task's via-points.
    """
    points = record["via_points"]
    return ViaPoints(np.array(points["times"]), np.array(points["values"]), names)


def _tell_again(learner: Learner, task: Task, path: Path, record: dict[str, Any]) -> None:
    """Tell a recorded trial, if it is the one this learner asks for."""
    damaged = RunFolderError(path, f"{TRIALS}, line {record['trial']} is damaged")
    if learner.finished:
        raise RunFolderError(path, f"goes on after trial {learner.trials}, where learning ended")
    proposal = learner.ask()
    try:
        recorded = recorded_via_points(record, proposal.via_points.names)
    except (LookupError, TypeError, ValueError, ViaPointsError) as error:
        raise damaged from error
    same = recorded == proposal.via_points
    if not same or (record["purpose"], record["subtask"]) != (proposal.purpose, proposal.subtask):
        raise RunFolderError(
            path,
            f"trial {record['trial']} is not the one this scenario leads to; made by another "
            "version or another scenario",
        )
    try:
        learner.tell(task.outcome(record))
    except OutcomeNotFiniteError:
        return  # as it was refused before: it counts, and its via-points are asked for again
    except (LookupError, TypeError, ValueError) as error:
        raise damaged from error


def _checked(record: dict[str, Any], task_variables: Sequence[str]) -> dict[str, Any]:
    """A trial's record, said to have failed if a task variable is not a number."""
    for name in task_variables:
        value = record.get(name)
        if value is not None and not np.all(np.isfinite(value)):
            reason = f"{name} is not finite: {value}"
            return {**record, "outcome": FAILED, "success": False, "reason": reason}
    return record
