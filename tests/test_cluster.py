"""A Dask cluster on the loopback: the bits of one process, or one line that says why not."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from small_studies import files_in, rows_in, small_study

from drake_viapoint.errors import ClusterError, VersionsError
from drake_viapoint.runs import cluster
from drake_viapoint.runs import workers as workers_module
from drake_viapoint.runs.cluster import cluster_workers
from drake_viapoint.runs.study import StudyRun
from drake_viapoint.runs.study_run import StudyResult, StudyWork, execute
from drake_viapoint.runs.sweep import sweep
from drake_viapoint.runs.workers import LocalWorkers

COMMAND = Path(sys.executable).parent / "drake-viapoint"


def part(module: str, *arguments: str, **options: Any) -> subprocess.Popen[bytes]:
    """A scheduler or a worker, as one would start it on any machine; it can import this module."""
    return subprocess.Popen(
        [sys.executable, "-m", f"distributed.cli.{module}", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parent)},
        **options,
    )


def worker(address: str, folder: Path, *arguments: str) -> subprocess.Popen[bytes]:
    own = ("--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1", "--no-nanny")
    own += ("--local-directory", str(folder))
    return part("dask_worker", address, *own, *arguments, cwd=folder)


@contextlib.contextmanager
def scheduler(*arguments: str) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    own = ("--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
    running = part("dask_scheduler", *own, *arguments)
    try:
        deadline = time.monotonic() + 30
        while True:
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1):
                break
            assert time.monotonic() < deadline
            time.sleep(0.02)
        yield f"tcp://127.0.0.1:{port}", running
    finally:
        running.kill()
        running.wait()


@pytest.fixture(scope="module")
def alone() -> Iterator[str]:
    """Address of a scheduler that tests give workers."""
    with scheduler() as (address, _):
        yield address


@pytest.fixture
def joined(alone: str, tmp_path: Path) -> Iterator[Callable[..., subprocess.Popen[bytes]]]:
    """Starts workers that end with the test."""
    processes = []

    def join(*arguments: str) -> subprocess.Popen[bytes]:
        processes.append(worker(alone, tmp_path, *arguments))
        return processes[-1]

    yield join
    for process in processes:
        process.kill()
        process.wait()
    with cluster._quiet():
        gone(alone)


def gone(address: str) -> None:
    import distributed

    with distributed.Client(address, set_as_default=False) as client:
        while client.scheduler_info()["workers"]:
            time.sleep(0.05)


@contextlib.contextmanager
def two_workers(address: str) -> Iterator[cluster.ClusterWorkers]:
    with cluster_workers(address) as workers:
        workers._client.wait_for_workers(2, timeout=30)
        yield workers


def test_two_workers_give_the_bits_of_one_process(
    alone: str, joined: Callable[..., Any], tmp_path: Path
) -> None:
    study = small_study(tmp_path)
    joined(), joined()
    with two_workers(alone) as workers:
        assert workers.number == 2
        there = sweep(study, tmp_path / "there", workers)
    here = sweep(study, tmp_path / "here", LocalWorkers(1))
    assert there.drop(columns="seconds").equals(here.drop(columns="seconds"))
    assert rows_in(tmp_path / "there") == rows_in(tmp_path / "here")
    assert files_in(tmp_path / "there") == files_in(tmp_path / "here")
    assert len(files_in(tmp_path / "there")) == 2 * 12


def deadly(work: StudyWork, run: StudyRun) -> StudyResult:
    if run.values["seed"] == 7:
        os.kill(os.getpid(), signal.SIGKILL)
    return execute(work, run)


def test_a_killed_worker_s_runs_are_done_by_others(
    alone: str, joined: Callable[..., Any], tmp_path: Path
) -> None:
    study = small_study(tmp_path)
    victim, _ = joined(), joined()

    def kill(rows: Any) -> None:
        if rows:
            victim.kill()

    with two_workers(alone) as workers:
        sweep(study, tmp_path / "there", workers, on_rows=kill)
    sweep(study, tmp_path / "here", LocalWorkers(1))
    assert rows_in(tmp_path / "there") == rows_in(tmp_path / "here")


def test_a_run_that_kills_its_workers_is_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Dask gives it up at its first death here; joblib by itself would wait for ever."""
    study = small_study(tmp_path, vary={"seed": [0, 7]}, conditions={"all": {}})
    monkeypatch.setattr(workers_module, "execute", deadly)
    monkeypatch.setattr(workers_module, "_DEATHS", 1)
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES", "0")
    with scheduler() as (address, _):
        hand = worker(address, tmp_path, "--nanny")  # which starts its worker again
        try:
            with cluster_workers(address) as workers:
                table = sweep(study, tmp_path / "out", workers)
        finally:
            hand.terminate()
            hand.wait()
    assert table["error"].isna().tolist() == [True, False]
    assert table["error"][1] == "its worker died, time and again"


def test_a_scheduler_that_dies_is_one_line(tmp_path: Path) -> None:
    study = small_study(tmp_path, vary={"seed": {"from": 0, "to": 60}})
    with scheduler() as (address, process):
        hand = worker(address, tmp_path)

        def kill(rows: Any) -> None:
            if rows:
                process.kill()

        try:
            with (
                pytest.raises(ClusterError, match=address),
                cluster_workers(address) as workers,
            ):
                sweep(study, tmp_path / "out", workers, on_rows=kill)
        finally:
            hand.kill()
            hand.wait()
    done = len(rows_in(tmp_path / "out"))
    assert 0 < done < len(study)


# ------------------------------------------------------------------------------------- refused


def test_workers_of_another_version_are_refused(
    alone: str, joined: Callable[..., Any], tmp_path: Path
) -> None:
    (tmp_path / "older.py").write_text(
        "import drake_viapoint\ndrake_viapoint.__version__ = '0.0'\n"
    )
    joined("--preload", str(tmp_path / "older.py"))
    with pytest.raises(VersionsError) as refused, cluster_workers(alone):
        pass
    error = refused.value
    assert (error.package, error.theirs) == ("drake_viapoint", "0.0")
    assert error.worker.startswith("tcp://127.0.0.1:")
    assert "bits would differ" in str(error)


def test_a_worker_of_another_version_that_comes_later_refuses(
    alone: str, joined: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "older.py").write_text(
        "import drake_viapoint\ndrake_viapoint.__version__ = '0.0'\n"
    )
    joined("--preload", str(tmp_path / "older.py"))
    with monkeypatch.context() as patched:
        patched.setattr(
            cluster, "_check_workers", lambda _address, client: client.wait_for_workers(1)
        )
        with (
            pytest.raises(VersionsError, match=r"drake_viapoint 0\.0"),
            cluster_workers(alone) as workers,
        ):
            sweep(small_study(tmp_path), tmp_path / "out", workers)


def test_a_worker_without_the_package_is_refused(
    alone: str, joined: Callable[..., Any], tmp_path: Path
) -> None:
    (tmp_path / "without.py").write_text("import sys\nsys.modules['drake_viapoint'] = None\n")
    joined("--preload", str(tmp_path / "without.py"))
    with (
        pytest.raises(ClusterError, match=r"worker tcp://.* cannot be used: ModuleNotFoundError"),
        cluster_workers(alone),
    ):
        pass


def test_a_scheduler_without_the_package_is_refused(tmp_path: Path) -> None:
    (tmp_path / "without.py").write_text("import sys\nsys.modules['drake_viapoint'] = None\n")
    with (
        scheduler("--preload", str(tmp_path / "without.py")) as (address, _),
        pytest.raises(ClusterError, match="needs the package, too"),
        cluster_workers(address),
    ):
        pass


def test_a_scheduler_without_workers(alone: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_COME", 0.3)
    with pytest.raises(ClusterError, match=r"has no workers after 0.3 s"), cluster_workers(alone):
        pass


def test_a_scheduler_that_does_not_answer(tmp_path: Path) -> None:
    """Five seconds, one line, and nothing on the disk."""
    file = tmp_path / "study.yaml"
    small_study(tmp_path)
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        bound.listen()
        address = f"tcp://127.0.0.1:{bound.getsockname()[1]}"
        done = subprocess.run(
            [COMMAND, "sweep", file, "--out", tmp_path / "out", "--scheduler", address],
            check=False,
            capture_output=True,
            text=True,
            timeout=60,
        )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"drake-viapoint: scheduler {address} does not answer within 5 s\n"
    assert not (tmp_path / "out").exists()


def test_a_port_where_nobody_listens(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_ANSWER", 0.3)
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{bound.getsockname()[1]}"
        with (
            pytest.raises(ClusterError, match=rf"{address} does not answer within 0.3 s"),
            cluster_workers(address),
        ):
            pass


@pytest.mark.parametrize("address", ["", "nonsense", "foo://x:1", "tcp://x:y", "inproc://x"])
def test_what_is_no_address(address: str) -> None:
    with pytest.raises(ClusterError, match="is no address") as refused, cluster_workers(address):
        pass
    assert "\n" not in str(refused.value)


def test_a_worker_is_no_scheduler(alone: str, joined: Callable[..., Any]) -> None:
    joined()
    with cluster_workers(alone) as workers:
        (address,) = workers._client.scheduler_info()["workers"]
    with pytest.raises(ClusterError, match="no scheduler, but a Worker"), cluster_workers(address):
        pass


def test_without_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"drake-viapoint\[cluster\]"), cluster_workers("x:1"):
        pass
