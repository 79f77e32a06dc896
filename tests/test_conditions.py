"""Section 3.2 from the shipped study: what the sweep made is what the figure and the tables say."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from progress_bars import Bars

from drake_viapoint.errors import StudyError, ViapointError
from drake_viapoint.packages import resolve
from drake_viapoint.reproduction.conditions import (
    STUDY,
    TITLES,
    reproduce_conditions,
    study_conditions,
)
from drake_viapoint.reproduction.findings import Findings
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.runs.run_folder import TRIALS, read_trials
from drake_viapoint.runs.study_file import read_study
from drake_viapoint.runs.study_table import read_table
from drake_viapoint.runs.sweep import sweep
from drake_viapoint.runs.task_run import read_scenario
from drake_viapoint.runs.workers import LocalWorkers
from drake_viapoint.tasks.catalogue import build_task


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Findings, Bars]:
    out, bars = tmp_path_factory.mktemp("conditions") / "results", Bars()
    return out, reproduce_conditions(out, 1, bars), bars


def test_the_shipped_study_is_section_3_2s() -> None:
    study = read_study(resolve(STUDY))
    assert list(study.conditions) == list(TITLES)
    assert len(study) == 300
    learning = study.scenario["learning"]
    assert learning["jacobian"]["window"] == 15
    assert learning["position_perturbation"] == 0.05
    assert learning["angle_perturbation"] == pytest.approx(np.radians(5))
    # the same bars in metres as the serve's own, per perturbation five times as large
    assert learning["throw"]["regularization"] == pytest.approx(25 * 0.04)
    assert learning["strike"]["regularization"] == pytest.approx(25 * 0.0064)
    assert learning["jacobian"]["regularization"] == pytest.approx(10 / 25)
    ranges = [run.changes.get("disturbance.release", 0.0) for run in study.runs()][:3]
    assert ranges == [0.0, 0.03, 0.03]


def test_both_shipped_studies_differ_in_their_explorations_alone() -> None:
    large = read_study(resolve(STUDY))
    small = read_study(resolve(STUDY.replace("conditions.", "conditions_small.")))
    assert [run.changes for run in small.runs()] == [run.changes for run in large.runs()]
    assert small.tabulate == large.tabulate
    assert small.repeats == large.repeats
    assert small.scenario["learning"]["position_perturbation"] == 0.01


def test_everything_into_one_folder(results: tuple[Path, Findings, Bars]) -> None:
    out, findings, bars = results
    said = findings.lines
    assert {path.name for path in out.iterdir()} == {
        "figure10.png", "conditions.csv", "conditions_paired.csv", "three_conditions"
    }  # fmt: skip
    assert (out / "figure10.png").stat().st_size > 50_000
    assert bars.seen == {"disturbing the ball, 5 cm, 5°": [3, 0, 1, 1, 1]}
    assert [line.split(":")[0] for line in said[:3]] == list(TITLES)
    with (out / "conditions.csv").open() as file:
        assert [row["condition"] for row in csv.DictReader(file)] == list(TITLES)


def test_a_run_of_the_sweep_is_the_run_that_learn_makes(
    results: tuple[Path, Findings, Bars],
) -> None:
    table = read_table(results[0] / "three_conditions")
    for row in table.to_dict("records"):
        folder = results[0] / "three_conditions" / row["folder"]
        records = read_trials(folder)
        scenario = read_scenario(folder)
        log = MemoryLog("alone")
        alone = learn(build_task(scenario), log, seed=scenario.seed, max_trials=60)
        assert [record["d"] for record in log.trials] == list(row["d"])
        assert [record["d"] for record in records] == list(row["d"])
        assert row["learned_at"] is alone.learned_at or row["learned_at"] == alone.learned_at
        assert row["wasted"] == alone.wasted


def test_repeats_of_an_undisturbed_serve_are_one_and_the_same(
    results: tuple[Path, Findings, Bars],
) -> None:
    table = read_table(results[0] / "three_conditions").set_index("condition")
    landings = {name: np.stack(table.loc[name, "repeated_T_G"]) for name in TITLES}
    assert landings["kept"].shape == (200, 2)
    assert np.ptp(landings["undisturbed"], axis=0).tolist() == [0.0, 0.0]
    assert np.all(np.ptp(landings["kept"], axis=0) > 0.02)


def test_a_second_call_does_no_trial_again(results: tuple[Path, Findings, Bars]) -> None:
    out, findings, bars = results
    files = sorted((out / "three_conditions" / "runs").glob(f"*/{TRIALS}"))
    assert len(files) == 3
    stamps = [path.stat().st_mtime_ns for path in files]
    assert reproduce_conditions(out, 1, bars) == findings
    assert [path.stat().st_mtime_ns for path in files] == stamps


def test_a_sweep_of_something_else(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"none: holds no sweep"):
        study_conditions(tmp_path / "none", tmp_path)
    (tmp_path / "swing.yaml").write_text(
        "task: upswing\nchanges: {execution: recurrence}\nvary: {seed: [0]}\nmax_trials: 1\n"
    )
    sweep(read_study(tmp_path / "swing.yaml"), tmp_path / "swing", LocalWorkers(1))
    with pytest.raises(ViapointError, match="holds runs of the upswing, not of the serve"):
        study_conditions(tmp_path / "swing", tmp_path)
