"""The robot experiment, whole: runs that go on whatever breaks, and what is drawn of them."""

from __future__ import annotations

import csv
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest
from contact_scenes import robot_scenario
from progress_bars import Bars

from drake_viapoint.errors import RunFolderError
from drake_viapoint.packages import resolve
from drake_viapoint.reproduction.robot import STUDY, reproduce_robot, study_robot
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.runs.run_folder import TRIALS
from drake_viapoint.runs.study_file import read_study
from drake_viapoint.runs.task_run import begin
from drake_viapoint.tasks.catalogue import build_task

COMMAND = Path(sys.executable).parent / "drake-viapoint"
MOST = 3


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The beginning of a run."""
    path = tmp_path_factory.mktemp("runs") / "whole"
    scenario = robot_scenario()
    with begin(path, scenario) as folder:
        learn(build_task(scenario), folder, seed=scenario.seed, max_trials=MOST)
    return path


def test_a_run_killed_in_a_trial_ends_with_the_same_bytes(run: Path, tmp_path: Path) -> None:
    out = tmp_path / "killed"
    words = [COMMAND, "learn", "serve", "--robot", "--out", out, "--max-trials", str(MOST)]
    running = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while not (out / TRIALS).exists() or not (out / TRIALS).read_bytes():
        assert running.poll() is None, running.communicate()
        time.sleep(0.01)
    time.sleep(0.2)  # well within the second trial
    running.kill()
    running.communicate()
    expected = (run / TRIALS).read_bytes()
    assert expected.startswith((out / TRIALS).read_bytes())
    assert (out / TRIALS).read_bytes() != expected
    done = subprocess.run([*words, "--resume"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (1, ""), "not learned within so few trials"
    assert "going on after trial" in done.stdout
    assert (out / TRIALS).read_bytes() == expected


def test_a_run_goes_on_after_trials_that_fail() -> None:
    scenario = robot_scenario({"contact.strings_stiffness": 1e14})
    log = MemoryLog("failing")
    result = learn(build_task(scenario), log, seed=0, max_trials=2)
    assert (result.trials, result.learned_at) == (2, None)
    for record in log.trials:
        assert record["outcome"] == "failed"
        assert record["reason"].startswith("the simulation failed after 0.9")
        assert "step" in record["reason"]
    first, second = log.trials
    assert first["via_points"] == second["via_points"], "it is tried again"
    assert first["seed"] != second["seed"]


def test_the_shipped_study_is_twenty_robots() -> None:
    study = read_study(resolve(STUDY))
    assert len(study) == 20
    assert study.max_trials == 80
    assert study.scenario["execution"] == "contact"


def test_figures_table_and_recordings_of_a_sweep(run: Path, tmp_path: Path) -> None:
    row = {"seed": 0, "learned_at": None, "wasted": 0, "error": None, "folder": "whole"}
    table = pd.DataFrame([row, {**row, "seed": 1, "error": "a run that raised", "folder": None}])
    table.attrs = {"study": {"max_trials": MOST}}
    bars = Bars()
    findings = study_robot(table, run.parent, tmp_path, bars)
    assert findings.lines[0].startswith("robot: 0 of 1 runs")
    for name in ("figure6.png", "figure7.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    with (tmp_path / "robot.csv").open(newline="") as file:
        (line,) = csv.DictReader(file)
    assert (line["seed"], line["trials"], line["learned_at"]) == ("0", str(MOST), "")
    pages = sorted(tmp_path.glob("*.html"))
    assert pages[0].name == "robot_trial01.html"
    assert all("<html" in page.read_text()[:200].lower() for page in pages)
    shown = bars.seen["figures and recordings"]
    assert shown[0] == len(shown) - 1 + (3 - len(pages))


def test_another_sweep_in_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot" / "results.jsonl").write_text('{"study": "another"}\n')
    with pytest.raises(RunFolderError, match="another study"):
        reproduce_robot(tmp_path, 1, Bars())
