"""The loop of a run, on a task of pure numbers: no Drake, no tennis."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drake_viapoint.errors import OutcomeNotFiniteError, RunFolderError
from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.learning.gain import ConstantGain
from drake_viapoint.learning.subtask import Subtask
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.runs.learning_run import RunResult, learn, trial_seed
from drake_viapoint.runs.run_folder import TRIALS, RunFolder, read_trials

GOAL = np.array([0.3, -0.2])


@dataclass(frozen=True)
class Reach:
    """One execution of the toy: where a point ended up."""

    reached: np.ndarray

    @property
    def error(self) -> float:
        return float(np.linalg.norm(GOAL - self.reached))

    def record(self) -> dict[str, Any]:
        return {
            "outcome": "reached",
            "success": self.error < 0.01,
            "d": self.error,
            "T": self.reached.tolist(),
        }

    def summary(self) -> str:
        return f"reached, {self.error:.3f} m off"


@dataclass
class ReachTask:
    """Two components bent by an unknown, slightly curved world, with noise from the seed."""

    name: str = "reach"
    successes: int = 3
    repeats: int = 2
    broken_at: int | None = None
    executed: list[tuple[ViaPoints, int]] = field(default_factory=list)

    via_points = ViaPoints(np.array([0.0, 0.5, 1.0]), np.zeros((3, 2)), ("x", "y"))
    subtasks = (
        Subtask("reach", ("x2", "y2"), "T", (0.01, 0.01), ConstantGain(0.5), 1e-9, reached=0.0),
    )

    def execute(self, via_points: ViaPoints, seed: int) -> Reach:
        self.executed.append((via_points, seed))
        if len(self.executed) == self.broken_at:
            return Reach(np.array([np.nan, 0.0]))
        x, y = via_points.select(("x2", "y2"))
        noise = 1e-4 * np.random.default_rng(seed).normal(size=2)
        return Reach(np.array([x + 0.3 * y + 0.2 * x * y, 0.8 * y - 0.1 * x**2]) + noise)

    def outcome(self, record: dict[str, Any]) -> Outcome:
        reached = np.array(record["T"], dtype=float)
        return Outcome({"T": reached}, {"T": GOAL}, record["success"])


def run(path: Path, task: ReachTask, max_trials: int = 40, seed: int = 5) -> RunResult:
    if (path / TRIALS).exists():
        opened = RunFolder.open(path)
    else:
        opened = RunFolder.create(path, "task: reach\n")
    with opened as folder:
        return learn(task, folder, seed=seed, max_trials=max_trials)


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("run") / "whole"
    result = run(path, ReachTask())
    assert result.learned_at is not None
    assert result.trials == result.learned_at + 2
    return (path / TRIALS).read_bytes()


def test_records_say_what_was_executed(tmp_path: Path) -> None:
    task = ReachTask()
    result = run(tmp_path / "run", task)
    records = read_trials(tmp_path / "run")
    assert len(records) == result.trials == len(task.executed)
    for number, (record, (points, seed)) in enumerate(
        zip(records, task.executed, strict=True), start=1
    ):
        assert record["trial"] == number
        assert record["seed"] == seed == trial_seed(5, number)
        np.testing.assert_array_equal(record["via_points"]["times"], points.times)
        np.testing.assert_array_equal(record["via_points"]["values"], points.values)
    purposes = [record["purpose"] for record in records]
    assert purposes[:3] == ["learning", "exploration", "exploration"]
    assert purposes[-2:] == ["repeat", "repeat"]
    assert {"exploration", "learning", "repeat"} == set(purposes)
    learned = result.learned_at or 0
    assert [record["success"] for record in records[learned - 3 : learned]] == [True] * 3
    assert not records[learned - 4]["success"]


def test_trials_of_a_run_draw_independently() -> None:
    seeds = {trial_seed(seed, number) for seed in range(20) for number in range(1, 61)}
    assert len(seeds) == 20 * 60


def test_it_gives_up_at_max_trials_and_goes_on_with_more(
    tmp_path: Path, uninterrupted: bytes
) -> None:
    for _ in range(2):
        result = run(tmp_path / "run", ReachTask(), max_trials=4)
        assert (result.trials, result.learned_at) == (4, None)
    run(tmp_path / "run", ReachTask())
    assert (tmp_path / "run" / TRIALS).read_bytes() == uninterrupted


def test_resumed_after_every_trial_it_ends_with_the_same_bytes(
    tmp_path: Path, uninterrupted: bytes
) -> None:
    lines = uninterrupted.splitlines(keepends=True)
    for kept in range(len(lines) + 1):
        path = tmp_path / f"run{kept}"
        RunFolder.create(path, "task: reach\n").close()
        (path / TRIALS).write_bytes(b"".join(lines[:kept]) + b'{"trial": ')
        task = ReachTask()
        run(path, task)
        assert len(task.executed) == len(lines) - kept, "what is on record is not done again"
        assert (path / TRIALS).read_bytes() == uninterrupted


def test_a_trial_is_on_record_before_it_is_reported(tmp_path: Path) -> None:
    seen = []

    def report(record: dict[str, Any], trial: Any) -> None:
        assert read_trials(tmp_path / "run")[-1] == record
        assert trial.record()["d"] == record["d"]
        seen.append(record["trial"])

    with RunFolder.create(tmp_path / "run", "") as folder:
        learn(ReachTask(), folder, seed=5, max_trials=4, on_trial=report)
    assert seen == [1, 2, 3, 4]


def test_what_is_not_finite_is_recorded_as_failed_refused_and_tried_again(tmp_path: Path) -> None:
    with pytest.raises(OutcomeNotFiniteError, match="trial 3: T is not finite"):
        run(tmp_path / "run", ReachTask(broken_at=3))
    failed = read_trials(tmp_path / "run")[-1]
    assert (failed["trial"], failed["outcome"], failed["success"]) == (3, "failed", False)
    assert failed["T"] == [None, 0.0]
    assert failed["reason"] == "T is not finite: [nan, 0.0]"

    result = run(tmp_path / "run", ReachTask())
    records = read_trials(tmp_path / "run")
    assert records[2] == failed  # nothing recorded is lost
    assert records[3]["via_points"] == failed["via_points"]
    undisturbed = run(tmp_path / "undisturbed", ReachTask())
    assert result.learned_at == (undisturbed.learned_at or 0) + 1  # the failed trial counts
    assert run(tmp_path / "run", ReachTask()) == result  # told a second time, it ends the same


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"T": [-0.', '"T": [-1.', "trial 6 is not the one this scenario leads to"),
        ('"values": [[0.0', '"values": [[0.5', "trial 3 is not the one"),
        ('"purpose": "exploration"', '"purpose": "learning"', "trial 3 is not the one"),
        ('"subtask": "reach"', '"subtask": "throw"', "trial 3 is not the one"),
        ('"T":', '"t":', "line 3 is damaged"),
        ('"T": [', '"T": ["a", ', "line 3 is damaged"),
        ('"times": [0.0', '"times": [2.0', "line 3 is damaged"),
        ('"times"', '"time"', "line 3 is damaged"),
        ('"via_points": {', '"via_points": 3, "x": {', "line 3 is damaged"),
    ],
)
def test_another_runs_trials_are_refused(
    tmp_path: Path, uninterrupted: bytes, old: str, new: str, message: str
) -> None:
    RunFolder.create(tmp_path / "run", "").close()
    lines = uninterrupted.decode().splitlines(keepends=True)
    assert old in lines[2]
    lines[2] = lines[2].replace(old, new, 1)
    (tmp_path / "run" / TRIALS).write_text("".join(lines))
    with pytest.raises(RunFolderError, match=message):
        run(tmp_path / "run", ReachTask())
    assert (tmp_path / "run" / TRIALS).read_text() == "".join(lines)


def test_trials_after_the_end_are_refused(tmp_path: Path, uninterrupted: bytes) -> None:
    RunFolder.create(tmp_path / "run", "").close()
    (tmp_path / "run" / TRIALS).write_bytes(uninterrupted)
    folder = RunFolder.open(tmp_path / "run")
    with folder, pytest.raises(RunFolderError, match="where learning ended"):
        learn(ReachTask(repeats=0), folder, seed=5, max_trials=40)


def test_the_loop_needs_no_drake() -> None:
    program = (
        "import sys, drake_viapoint.runs.run_folder, drake_viapoint.runs.learning_run\n"
        "sys.exit('pydrake' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
