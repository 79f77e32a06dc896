"""A run killed with SIGKILL at random instants and resumed ends with the bytes of a whole one."""

from __future__ import annotations

import os
import selectors
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from drake_viapoint.runs.run_folder import TRIALS

COMMAND = Path(sys.executable).parent / "drake-viapoint"
KILLS = 20
LATEST = 2.5  # [s] after the start: importing and building take 1.3 s, a whole run takes 2.7 s


def begin(out: Path) -> subprocess.Popen[bytes]:
    """The one command of a run, whatever has happened to it before."""
    return subprocess.Popen(
        [COMMAND, "learn", "serve", "--out", out, "--resume"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )


def kill_after(running: subprocess.Popen[bytes], delay: float) -> bool:
    """Kill a run after so many seconds; False if it was over before."""
    try:
        running.communicate(timeout=delay)
    except subprocess.TimeoutExpired:
        running.kill()
        running.communicate()
        return True
    return False


def kill_in_a_trial(running: subprocess.Popen[bytes], trials: int, delay: float) -> bool:
    """Kill a run so many seconds after it has told of so many trials; False if it was over."""
    assert running.stdout is not None
    with selectors.DefaultSelector() as selector:
        selector.register(running.stdout, selectors.EVENT_READ)
        told = b""
        while told.count(b"\ntrial ") + told.startswith(b"trial ") < trials:
            assert selector.select(timeout=60.0), "the run is stuck"
            chunk = os.read(running.stdout.fileno(), 65536)
            if not chunk:
                running.communicate()
                return False
            told += chunk
    time.sleep(delay)
    over = running.poll() is not None
    running.kill()
    running.communicate()
    return not over


def test_a_run_killed_at_random_instants_ends_with_the_same_bytes(tmp_path: Path) -> None:
    """Half of the kills come at any time after the start, half within a trial and its recording."""
    uninterrupted = begin(tmp_path / "whole")
    _, err = uninterrupted.communicate()
    assert (uninterrupted.returncode, err) == (0, b"")
    expected = (tmp_path / "whole" / TRIALS).read_bytes()

    rng = np.random.default_rng(1998)
    kills, runs, progress = 0, 0, []
    while kills < KILLS:
        runs += 1
        out = tmp_path / f"run{runs}"
        alive = True
        while alive and kills < KILLS:
            running = begin(out)
            if kills % 2:
                alive = kill_in_a_trial(running, int(rng.integers(1, 6)), rng.uniform(0.0, 0.06))
            else:
                alive = kill_after(running, rng.uniform(0.0, LATEST))
            kills += alive
            trials = (out / TRIALS).read_bytes() if (out / TRIALS).exists() else b""
            whole = trials[: trials.rfind(b"\n") + 1]
            assert expected.startswith(whole), "a trial on record is never changed"
            progress.append(whole.count(b"\n"))
        last = begin(out)
        _, err = last.communicate()
        assert (last.returncode, err) == (0, b"")
        assert (out / TRIALS).read_bytes() == expected
    in_the_middle = [n for n in progress if 0 < n < expected.count(b"\n")]
    assert len(set(in_the_middle)) >= 5, "kills fell all over the run"
