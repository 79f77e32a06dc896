"""Sweeps: the same rows and bytes however many workers, whatever is killed, whenever it goes on."""

from __future__ import annotations

import contextlib
import errno
import itertools
import json
import os
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Generator, Iterable, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import psutil
import pytest
from small_studies import SMALL, files_in, rows_in, small_study, study_file

from drake_viapoint.errors import FolderHeldError, RunFolderError, StudyError
from drake_viapoint.runs import sweep as sweep_module
from drake_viapoint.runs import workers as workers_module
from drake_viapoint.runs.study import Study, StudyRun
from drake_viapoint.runs.study_run import StudyResult, StudyWork, execute
from drake_viapoint.runs.study_table import TABLE, read_table
from drake_viapoint.runs.sweep import RESULTS, sweep
from drake_viapoint.runs.workers import LocalWorkers, WorkerDiedError, results_despite_deaths

COMMAND = Path(sys.executable).parent / "drake-viapoint"
MANY = {"vary": {"demonstration.person": {"from": 0, "to": 5}, "seed": {"from": 0, "to": 3}}}


@pytest.fixture(scope="module")
def serial(tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, Path, pd.DataFrame]:
    """The small study, one run after the other; tests leave it as it is."""
    folder = tmp_path_factory.mktemp("sweep")
    study = small_study(folder)
    return study, folder / "out", sweep(study, folder / "out", LocalWorkers(1))


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A study of 48 runs in a file, and what comes of it in one process."""
    folder = tmp_path_factory.mktemp("many")
    file = study_file(folder / "study.yaml", **MANY)
    sweep(small_study(folder, **MANY), folder / "out", LocalWorkers(1))
    return file, folder / "out"


def same(one: Path, other: Path) -> None:
    """Rows, table and every byte of the runs, but not the seconds."""
    assert rows_in(one) == rows_in(other)
    assert files_in(one) == files_in(other)
    tables = [read_table(out).drop(columns="seconds").map(str) for out in (one, other)]
    pd.testing.assert_frame_equal(*tables)


def workers_of(process: psutil.Process) -> list[psutil.Process]:
    return [
        child for child in process.children(recursive=True)
        if any("LokyProcess" in word for word in child.cmdline())
    ]  # fmt: skip


# --------------------------------------------------------------------------------- bits and rows


def test_a_row_a_run_in_the_order_of_the_study(serial: tuple[Study, Path, pd.DataFrame]) -> None:
    study, out, table = serial
    assert table["run"].tolist() == [run.name for run in study.runs()]
    assert {path.name for path in out.iterdir()} == {RESULTS, TABLE, "runs"}
    assert {path.name for path in (out / "runs").iterdir()} == set(table["run"])
    assert table["error"].isna().all()
    assert set(table["condition"]) == {"fixed", "recorded"}
    for _, row in table.iterrows():
        lines = (out / row["folder"] / "trials.jsonl").read_text().splitlines()
        assert [json.loads(line)["T"] for line in lines] == row["T"]
    read = read_table(out)
    for name in ("run", "learned_at", "trials", "seconds", "folder"):
        assert read[name].tolist() == table[name].tolist()
    assert [list(map(list, T)) for T in read["T"]] == table["T"].tolist()


def test_two_processes_give_the_bits_of_one(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path
) -> None:
    study, out, table = serial
    both = sweep(study, tmp_path, LocalWorkers(2))
    same(tmp_path, out)
    pd.testing.assert_frame_equal(both.drop(columns="seconds"), table.drop(columns="seconds"))


def test_without_folders_the_rows_are_the_same(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path
) -> None:
    study, out, _ = serial
    sweep(study, tmp_path, LocalWorkers(1), folders=False, csv=True)
    assert {path.name for path in tmp_path.iterdir()} == {RESULTS, TABLE, "table.csv"}
    rows, kept = rows_in(tmp_path), rows_in(out)
    assert rows == {name: {**row, "folder": None} for name, row in kept.items()}


# ------------------------------------------------------------------------------- going on, growing


def test_what_is_done_is_not_done_again(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study, out, _ = serial
    lines = (out / RESULTS).read_bytes().splitlines(keepends=True)
    (tmp_path / RESULTS).write_bytes(b"".join(lines[:4]) + lines[4][:100])  # killed while writing
    told: list[int] = []
    done: list[str] = []

    def counted(work: StudyWork, run: StudyRun) -> StudyResult:
        done.append(run.name)
        return execute(work, run)

    monkeypatch.setattr(workers_module, "execute", counted)
    sweep(study, tmp_path, LocalWorkers(1), on_rows=lambda rows: told.append(len(rows)))
    assert told == [3] + [1] * 9
    assert rows_in(tmp_path) == rows_in(out)
    assert sorted(done) == sorted(set(rows_in(out)) - {json.loads(x)["run"] for x in lines[1:4]})
    done.clear()
    sweep(study, tmp_path, LocalWorkers(1))
    assert done == []


def test_a_study_may_grow_but_not_change(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path
) -> None:
    _, out, _ = serial
    vary = SMALL["vary"]
    part = small_study(tmp_path, vary={**vary, "seed": [7]})
    sweep(part, tmp_path / "out", LocalWorkers(1))
    sweep(small_study(tmp_path), tmp_path / "out", LocalWorkers(1))
    same(tmp_path / "out", out)
    with pytest.raises(StudyError, match=r"runs that are not in this study: .*-seed0-.*3 more"):
        sweep(part, tmp_path / "out", LocalWorkers(1))
    for other in ({"max_trials": 13}, {"repeats": 3}, {"tabulate": ["T"]},
                  {"changes": {"learning.perturbation": 0.02}}):  # fmt: skip
        with pytest.raises(StudyError, match="holds another study"):
            sweep(small_study(tmp_path, **other), tmp_path / "out", LocalWorkers(1))
    same(tmp_path / "out", out)


def test_results_of_another_study_or_version_are_left_alone(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study, out, _ = serial
    (tmp_path / RESULTS).write_bytes((out / RESULTS).read_bytes())
    monkeypatch.setattr(sweep_module, "versions", lambda: {"drake": "9.9"})
    with pytest.raises(RunFolderError, match="another study or version"):
        sweep(study, tmp_path, LocalWorkers(1))
    with pytest.raises(StudyError, match="holds another study"):
        sweep(study, out, LocalWorkers(1))
    assert (tmp_path / RESULTS).read_bytes() == (out / RESULTS).read_bytes()


def test_two_sweeps_do_not_share_a_folder(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path
) -> None:
    study, _, _ = serial

    def second(_: Any) -> None:
        with pytest.raises(FolderHeldError, match="another process is writing"):
            sweep(study, tmp_path, LocalWorkers(1))

    sweep(study, tmp_path, LocalWorkers(1), on_rows=second)


def test_a_disk_that_fills_ends_the_sweep(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study, out, _ = serial
    fsync, count = os.fsync, itertools.count()

    def full(descriptor: int) -> None:
        if next(count) > 40:
            raise OSError(errno.ENOSPC, "No space left on device")
        fsync(descriptor)

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        with pytest.raises(RunFolderError, match="No space left"):
            sweep(study, tmp_path, LocalWorkers(1))
    assert 0 < len(rows_in(tmp_path)) < 12
    sweep(study, tmp_path, LocalWorkers(1))
    same(tmp_path, out)


def test_an_interruption_leaves_results_and_table_whole(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path
) -> None:
    study, out, _ = serial
    for number, workers in ((2, 1), (5, 2)):

        def interrupt(_: Any, at: int = number) -> None:
            if (tmp_path / RESULTS).read_bytes().count(b"\n") > at:
                raise KeyboardInterrupt

        with warnings.catch_warnings(action="error"), pytest.raises(KeyboardInterrupt):
            sweep(study, tmp_path, LocalWorkers(workers), on_rows=interrupt)
        assert len(read_table(tmp_path)) == len(rows_in(tmp_path)) == number
    sweep(study, tmp_path, LocalWorkers(1))
    same(tmp_path, out)


def test_runs_that_raise_are_rows(tmp_path: Path) -> None:
    study = small_study(tmp_path, vary={"time_step": [0.03, 1 / 60]})
    table = sweep(study, tmp_path / "out", LocalWorkers(2))
    assert table["error"].notna().tolist() == [True, True, False, False]
    assert all("0.03 s does not divide" in error for error in table["error"][:2])
    assert table["trials"].tolist()[:2] == [0, 0]
    assert table["learned_at"].isna().tolist()[:2] == [True, True]


# ----------------------------------------------------------------------------------------- kills


def test_a_worker_killed_loses_nothing(many: tuple[Path, Path], tmp_path: Path) -> None:
    """Two of them, with SIGKILL, in the middle of their runs."""
    _, out = many
    study = small_study(tmp_path, **MANY)
    killed: list[int] = []
    seen = 0

    def kill(rows: Any) -> None:
        nonlocal seen
        seen += len(rows)
        if seen >= (1, 12, 49)[len(killed)]:
            victim = workers_of(psutil.Process())[0]
            victim.send_signal(signal.SIGKILL)
            killed.append(victim.pid)

    sweep(study, tmp_path / "out", LocalWorkers(2), on_rows=kill)
    assert len(set(killed)) == 2
    same(tmp_path / "out", out)


def test_a_sweep_killed_goes_on(many: tuple[Path, Path], tmp_path: Path) -> None:
    """With SIGKILL, and not its workers: they end by themselves."""
    file, out = many
    line = [COMMAND, "sweep", file, "--out", tmp_path, "--workers", "2"]
    running = psutil.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    before = b""
    while before.count(b"\n") <= 5:
        assert running.poll() is None
        time.sleep(0.005)
        with contextlib.suppress(FileNotFoundError):
            before = (tmp_path / RESULTS).read_bytes()
    workers = workers_of(running)
    assert len(workers) == 2
    running.kill()
    running.wait()
    before = before[: before.rfind(b"\n") + 1]
    again = subprocess.run(line, check=False, capture_output=True, text=True)
    assert (again.returncode, again.stderr) == (0, "")
    assert (tmp_path / RESULTS).read_bytes().startswith(before), "what is done is not done again"
    same(tmp_path, out)
    _, alive = psutil.wait_procs(workers, timeout=10)
    assert alive == []


def deadly(work: StudyWork, run: StudyRun) -> StudyResult:
    if run.values["seed"] == 7 and run.condition == "fixed":
        os.kill(os.getpid(), signal.SIGKILL)
    return execute(work, run)


def test_a_run_that_kills_its_workers_is_a_row(
    serial: tuple[Study, Path, pd.DataFrame], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, out, _ = serial
    vary = {**SMALL["vary"], "demonstration.person": [0]}
    study = small_study(tmp_path, vary=vary)
    monkeypatch.setattr(workers_module, "execute", deadly)
    monkeypatch.setattr(workers_module, "_DEATHS", 2)
    table = sweep(study, tmp_path / "out", LocalWorkers(2))
    died = table[table["error"].notna()]
    assert [(row["condition"], row["seed"]) for _, row in died.iterrows()] == [("fixed", 7)]
    assert died["error"].tolist() == ["its worker died, time and again"]
    sound = {name: row for name, row in rows_in(tmp_path / "out").items() if not row["error"]}
    assert len(sound) == 3
    assert all(rows_in(out)[name] == row for name, row in sound.items())


def test_conditions_of_a_person_go_to_one_worker_where_there_are_persons_enough(
    tmp_path: Path,
) -> None:
    """Their demonstration is watched once; every run still has a row and a folder of its own."""
    persons = {"demonstration.person": {"from": 0, "to": 7}}
    study = small_study(tmp_path, vary=persons, max_trials=1, repeats=0)
    handed: list[list[str]] = []

    class Watched(LocalWorkers):
        def results(self, work: StudyWork, groups: Iterable[Sequence[StudyRun]]) -> Any:
            kept = list(groups)
            handed.extend([run.name for run in group] for group in kept)
            return super().results(work, kept)

    sweep(study, tmp_path / "two", Watched(2))
    names = [run.name for run in study.runs()]
    assert handed == [names[i : i + 2] for i in range(0, 16, 2)]
    sweep(study, tmp_path / "one", LocalWorkers(1))
    same(tmp_path / "two", tmp_path / "one")
    for out, options in (("three", Watched(3)), ("bare", Watched(2))):
        handed.clear()
        sweep(study, tmp_path / out, options, folders=out != "bare")
        assert handed == [[name] for name in names]


class FragileWorkers:
    """Workers in this process, of which one dies by each run named, and takes along two others."""

    number = 2

    def __init__(self, deadly: set[str]) -> None:
        self.deadly = deadly
        self.tried: list[list[str]] = []

    def results(
        self, work: StudyWork, groups: Iterable[Sequence[StudyRun]]
    ) -> Generator[StudyResult, None, None]:
        del work
        feed = itertools.chain.from_iterable(groups)
        names: list[str] = []
        self.tried.append(names)
        while in_hand := list(itertools.islice(feed, 3)):
            names += [run.name for run in in_hand]
            if self.deadly & {run.name for run in in_hand}:
                raise WorkerDiedError
            for run in in_hand:
                yield StudyResult({"run": run.name})


def test_a_run_is_blamed_alone(serial: tuple[Study, Path, pd.DataFrame]) -> None:
    study, _, _ = serial
    runs = list(study.runs())
    fragile = FragileWorkers({runs[4].name})
    work = StudyWork(study, {})
    results = list(results_despite_deaths(fragile, work, runs))
    assert sorted(r.row["run"] for r in results) == sorted(run.name for run in runs)
    blamed = [r.row["run"] for r in results if r.row.get("error")]
    assert blamed == [runs[4].name]
    alone = [names for names in fragile.tried if len(names) == 1]
    assert alone == [[run.name] for run in runs[3:6]], "all that were in hand, and none else"
