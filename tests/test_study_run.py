"""One run of a study: a small message in, a row out, whatever the run does."""

from __future__ import annotations

import dataclasses
import json
import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_studies import small_study

from drake_viapoint.errors import RunFolderError, VersionsError
from drake_viapoint.runs import study_run
from drake_viapoint.runs.learning_run import learn, trial_seed
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.runs.run_folder import TRIALS, RunFolder, read_trials, write_run
from drake_viapoint.runs.study import StudyRun
from drake_viapoint.runs.study_run import FIRST_REPEAT, StudyResult, StudyWork, execute
from drake_viapoint.runs.task_run import versions
from drake_viapoint.tasks import catalogue
from drake_viapoint.tasks.catalogue import TaskBuilder, build_task, task_scenario
from drake_viapoint.tasks.pendulum import PendulumMotion, Recurrence
from drake_viapoint.tasks.upswing import UpswingTask


@pytest.fixture
def work(tmp_path: Path) -> StudyWork:
    return StudyWork(small_study(tmp_path), versions())


def a_run(work: StudyWork, number: int = 5) -> StudyRun:
    return list(work.study.runs())[number]


def without_seconds(result: StudyResult) -> dict[str, Any]:
    return {key: value for key, value in result.row.items() if key not in ("seconds", "folder")}


def test_a_row_is_what_learning_alone_gives(work: StudyWork) -> None:
    run = a_run(work)
    row = execute(work, run).row
    task = build_task(task_scenario("upswing", None, run.changes))
    log = MemoryLog("alone")
    result = learn(task, log, seed=run.values["seed"], max_trials=12)
    assert tuple(row) == work.study.columns()
    assert (row["run"], row["condition"]) == (run.name, "recorded")
    assert {key: row[key] for key in run.values} == run.values
    assert (row["learned_at"], row["trials"]) == (result.learned_at, result.trials)
    assert row["wasted"] == result.wasted
    firsts = [record["trial"] for record in log.trials if record["success"]]
    assert row["first_success"] == (firsts[0] if firsts else None)
    assert row["T"] == [record["T"] for record in log.trials]
    assert row["purpose"] == [record["purpose"] for record in log.trials]
    seeds = [trial_seed(run.values["seed"], FIRST_REPEAT + i) for i in range(2)]
    last = [task.execute(result.via_points, seed).record() for seed in seeds]
    assert row["repeated_T"] == [record["T"] for record in last]
    assert row["repeated_purpose"] == ["repeat", "repeat"]
    assert (row["error"], row["folder"]) == (None, None)
    assert 0 < row["seconds"] < 60
    json.dumps(row, allow_nan=False)


def test_repeats_draw_anew_and_the_same_for_every_condition() -> None:
    learning = {trial_seed(3, number) for number in range(1, 1000)}
    repeats = [trial_seed(3, FIRST_REPEAT + number) for number in range(200)]
    assert len(set(repeats)) == 200
    assert not learning & set(repeats)


def test_a_message_is_small(work: StudyWork) -> None:
    assert len(pickle.dumps((work, a_run(work)))) < 4000
    assert pickle.loads(pickle.dumps((work, a_run(work)))) == (work, a_run(work))


@pytest.mark.parametrize("send", [False, True])
def test_folders_here_and_trials_sent_are_the_same(
    work: StudyWork, tmp_path: Path, send: bool
) -> None:
    run = a_run(work)
    here = dataclasses.replace(work, folder=str(tmp_path / "here" / "runs"))
    row = execute(here, run)
    assert row.row["folder"] == f"runs/{run.name}"
    assert row.trials is None
    if send:
        sent = execute(dataclasses.replace(work, send_trials=True), run)
        assert sent.row["folder"] == row.row["folder"]
        assert sent.trials is not None
        write_run(tmp_path / "there" / "runs" / run.name, sent.scenario, sent.trials)
        for path in (tmp_path / "here" / "runs" / run.name).iterdir():
            assert (tmp_path / "there" / "runs" / run.name / path.name).read_bytes() == (
                path.read_bytes()
            )
    else:
        assert without_seconds(execute(work, run)) == without_seconds(row)


def test_a_run_cut_short_goes_on_from_its_folder(work: StudyWork, tmp_path: Path) -> None:
    run = a_run(work)
    here = dataclasses.replace(work, folder=str(tmp_path / "runs"))
    whole = execute(here, run)
    trials = tmp_path / "runs" / run.name / TRIALS
    content = trials.read_bytes()
    for length in (0, len(content) // 3, len(content) - 10, len(content)):
        trials.write_bytes(content[:length])
        assert without_seconds(execute(here, run)) == without_seconds(whole)
        assert trials.read_bytes() == content


def test_a_folder_is_waited_for(work: StudyWork, tmp_path: Path) -> None:
    """A worker whose sweep was killed may hold it for a moment."""
    run = a_run(work)
    here = dataclasses.replace(work, folder=str(tmp_path / "runs"))
    whole = execute(here, run)
    held = RunFolder.open(tmp_path / "runs" / run.name)
    threading.Timer(0.3, held.close).start()
    start = time.monotonic()
    assert without_seconds(execute(here, run)) == without_seconds(whole)
    assert time.monotonic() - start > 0.25


def test_a_worker_ends_when_who_asked_is_gone(work: StudyWork, tmp_path: Path) -> None:
    run = a_run(work)
    asked = dataclasses.replace(work, folder=str(tmp_path / "runs"), asker=2**22 + 1)
    (tmp_path / "message").write_bytes(pickle.dumps((asked, run)))
    program = (
        "import pickle, sys; from drake_viapoint.runs.study_run import execute\n"
        "execute(*pickle.load(open(sys.argv[1], 'rb'))); print('went on')"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, tmp_path / "message"], check=False, capture_output=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (1, b"", b"")
    assert len(read_trials(tmp_path / "runs" / run.name)) == 1
    alive = dataclasses.replace(asked, asker=os.getppid())
    assert execute(alive, run).row["error"] is None


# -------------------------------------------------------------------------------------- errors


def failing(error: BaseException, at: int) -> Callable[..., Any]:
    sound = UpswingTask.execute
    count = 0

    def execute(self: UpswingTask, *arguments: Any) -> Any:
        nonlocal count
        count += 1
        if count == at:
            raise error
        return sound(self, *arguments)

    return execute


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (RuntimeError("minimum step\nreached"), "RuntimeError: minimum step reached"),
        (SystemExit("wrong number of rows"), "SystemExit: wrong number of rows"),
        (MemoryError(), "MemoryError:"),
    ],
    ids=str,
)
def test_a_run_that_raises_is_a_row(
    work: StudyWork, monkeypatch: pytest.MonkeyPatch, error: BaseException, words: str
) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(UpswingTask, "execute", failing(error, at=4))
        row = execute(work, a_run(work)).row
    assert row["error"] == words
    assert (row["trials"], len(row["T"]), row["repeated_T"]) == (3, 3, [])
    assert (row["learned_at"], row["wasted"]) == (None, None)
    assert execute(work, a_run(work)).row["error"] is None


def test_repeats_that_raise_keep_those_before(
    work: StudyWork, monkeypatch: pytest.MonkeyPatch
) -> None:
    number = execute(work, a_run(work)).row["trials"]
    monkeypatch.setattr(UpswingTask, "execute", failing(ValueError("x"), at=number + 2))
    row = execute(work, a_run(work)).row
    assert row["error"] == "ValueError: x"
    assert (row["trials"], len(row["repeated_T"])) == (number, 1)


def test_a_scenario_that_cannot_be_built_is_a_row(tmp_path: Path) -> None:
    study = small_study(tmp_path, vary={"time_step": [0.03]})
    work = StudyWork(study, versions(), folder=str(tmp_path / "runs"))
    row = execute(work, a_run(work, 0)).row
    assert row["error"].startswith("ScenarioError: time_step 0.03 s does not divide")
    assert (row["trials"], row["T"], row["folder"]) == (0, [], None)
    assert not (tmp_path / "runs").exists()


def test_a_trial_without_numbers_is_an_error_however_often_it_is_resumed(
    work: StudyWork, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sound = Recurrence.__call__
    count = 0

    def broken(self: Recurrence, x: Any) -> PendulumMotion:
        nonlocal count
        count += 1
        motion = sound(self, x)
        return motion._replace(angle=motion.angle * np.nan) if count == 5 else motion

    monkeypatch.setattr(Recurrence, "__call__", broken)
    here = dataclasses.replace(work, folder=str(tmp_path / "runs"))
    first = execute(here, a_run(work))
    assert first.row["error"].startswith("LearningError: trial 5: T is not finite: [nan, ")
    assert first.row["T"][4][0] is None
    assert without_seconds(execute(here, a_run(work))) == without_seconds(first)
    count = 0
    assert without_seconds(execute(work, a_run(work))) == without_seconds(first)


@pytest.mark.parametrize("error", [OSError(28, "full"), KeyboardInterrupt()], ids=str)
def test_what_is_no_fault_of_the_run_ends_the_sweep(
    work: StudyWork, monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    monkeypatch.setattr(UpswingTask, "execute", failing(error, at=2))
    with pytest.raises(type(error)):
        execute(work, a_run(work))


def test_a_folder_of_another_scenario_ends_the_sweep(work: StudyWork, tmp_path: Path) -> None:
    here = dataclasses.replace(work, folder=str(tmp_path))
    write_run(tmp_path / a_run(work).name, "task: upswing\nseed: 99\n", [])
    with pytest.raises(RunFolderError):
        execute(here, a_run(work))


def test_errors_come_back_from_other_processes() -> None:
    for error in (
        VersionsError("w", "drake", None, "1.51"),
        RunFolderError(Path("x"), "is full"),
    ):
        back = pickle.loads(pickle.dumps(error))
        assert type(back) is type(error)
        assert (str(back), back.__dict__) == (str(error), error.__dict__)


@pytest.mark.parametrize("theirs", ["9.9", None])
def test_other_versions_are_refused(
    work: StudyWork, monkeypatch: pytest.MonkeyPatch, theirs: str | None
) -> None:
    other = {**versions(), "drake": theirs}
    monkeypatch.setattr(study_run, "versions", lambda: other)
    monkeypatch.setattr(study_run, "_kept", threading.local())
    with pytest.raises(VersionsError, match="drake") as refused:
        execute(work, a_run(work))
    assert refused.value.theirs == theirs
    assert refused.value.ours == versions()["drake"]
    assert "bits would differ" in str(refused.value)


# ------------------------------------------------------------------------------- what is kept


def test_a_worker_builds_one_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = small_study(
        tmp_path, changes={"execution": "plant"}, vary={"demonstration.person": [0, 1]},
        max_trials=2,
    )  # fmt: skip
    work = StudyWork(study, versions())
    built: list[int] = []
    monkeypatch.setattr(study_run, "_kept", threading.local())
    scene = catalogue.TASKS["upswing"].scene

    def counted(scenario: Any) -> Any:
        built.append(1)
        return scene(scenario)

    kind = catalogue.TASKS["upswing"]._replace(scene=counted)
    monkeypatch.setattr(catalogue, "TASKS", {**catalogue.TASKS, "upswing": kind})
    rows = [without_seconds(execute(work, run)) for run in study.runs()]
    assert len(built) == 1
    assert len(rows) == 4
    again = []
    for run in study.runs():
        monkeypatch.setattr(study_run, "_kept", threading.local())
        again.append(without_seconds(execute(work, run)))
    assert again == rows, "a scene used again gives the same bits"


def test_threads_do_not_share_a_builder() -> None:
    builders: list[TaskBuilder] = []
    threads = [
        threading.Thread(target=lambda: builders.append(study_run._builder())) for _ in range(2)
    ]
    for thread in threads:
        thread.start()
        thread.join()
    assert len({id(builder) for builder in [*builders, study_run._builder()]}) == 3
    assert study_run._builder() is study_run._builder()
