"""The study of many persons: complete, resumed, and counted right."""

import csv
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from drake_viapoint.errors import RunFolderError
from drake_viapoint.reproduction import upswing_persons, upswing_study
from drake_viapoint.reproduction.style import save
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.reproduction.upswing_study import (
    MAX_TRIALS,
    PersonRun,
    study_result,
    study_upswings,
    summary,
)
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.upswing import UpswingTask


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("study") / "study.jsonl"
    study_upswings(path, 3, executions=("recurrence",), workers=1)
    return path


def runs(file: Path) -> list[PersonRun]:
    return study_upswings(file, 3, executions=("recurrence",), workers=1)


def test_every_person_in_every_way(file: Path) -> None:
    done = runs(file)
    assert [(run.person, run.way) for run in done] == [
        (person, way) for person in range(3) for way in ("fixed", "manual", "recorded")
    ]
    for run in done:
        assert run.error.shape == (MAX_TRIALS, 2)
        assert run.success.shape == run.exploration.shape == (MAX_TRIALS,)
        assert run.exploration[1:7].all()
        assert not run.exploration[[0, 7]].any()


def test_a_run_of_the_study_is_a_run_like_any_other(file: Path) -> None:
    changes = {
        "demonstration.person": 2,
        "learning.jacobian.way": "recorded",
        "learning.successes": 0,
    }
    log = MemoryLog("alone")
    learn(UpswingTask(task_scenario("upswing", None, changes)), log, seed=0, max_trials=MAX_TRIALS)
    of_the_study = next(r for r in runs(file) if (r.person, r.way) == (2, "recorded"))
    alone = np.array([r["T"] for r in log.trials]) - np.array([r["Td"] for r in log.trials])
    np.testing.assert_array_equal(of_the_study.error, alone)


def test_what_is_done_is_not_done_again(file: Path, tmp_path: Path) -> None:
    lines = file.read_bytes().splitlines(keepends=True)
    assert len(lines) == 4
    part = tmp_path / "part.jsonl"
    part.write_bytes(b"".join(lines[:2]) + lines[2][:100])  # killed while writing
    told: list[int] = []
    again = study_upswings(part, 3, executions=("recurrence",), workers=1, on_person=told.append)
    assert told == [1, 2]
    for one, other in zip(again, runs(file), strict=True):
        np.testing.assert_array_equal(one.error, other.error)


def test_processes_give_the_same_bits(file: Path, tmp_path: Path) -> None:
    both = study_upswings(tmp_path / "two.jsonl", 3, executions=("recurrence",), workers=2)
    for one, other in zip(both, runs(file), strict=True):
        np.testing.assert_array_equal(one.error, other.error)


def test_results_of_other_versions_are_not_mixed(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(upswing_study, "versions", lambda: {"drake": "9.9"})
    with pytest.raises(RunFolderError, match="another study or version"):
        runs(file)


def made_up(person: int, successes: list[int], explorations: range = range(2, 8)) -> PersonRun:
    numbers: NDArray[np.int_] = np.arange(1, MAX_TRIALS + 1)
    return PersonRun(
        person,
        "recurrence",
        "recorded",
        np.zeros((MAX_TRIALS, 2)),
        np.isin(numbers, successes),
        np.isin(numbers, list(explorations)),
    )


def test_counts() -> None:
    steady = made_up(0, list(range(12, 61)))
    late = made_up(1, [40, 58, 59, 60])
    lost = made_up(2, [20, 21, 22])
    never = made_up(3, [])
    (result,) = study_result([steady, late, lost, never])
    assert result.persons == 4
    assert (result.within_30, result.held_at_30) == (0.5, 0.25)
    assert (result.within_60, result.held_at_60) == (0.75, 0.5)
    assert result.first_trial_failed == 1.0
    assert result.median == 40.0
    assert result.percentile_90 is None
    assert "50.0% succeed within 30 trials (25.0% held)" in summary(result)


def test_what_is_held_is_judged_without_explorations() -> None:
    assert made_up(0, [25, 26, 27], range(28, 34)).held(30)
    assert not made_up(0, [25, 26, 28], range(28, 34)).held(30)


def test_table_and_pictures(file: Path, tmp_path: Path) -> None:
    done = runs(file)
    results = study_result(done)
    with write_table(results, tmp_path / "new" / "table.csv").open() as table:
        rows = list(csv.DictReader(table))
    assert [row["way"] for row in rows] == ["fixed", "manual", "recorded"]
    assert float(rows[2]["within_60"]) == results[2].within_60
    curves = upswing_persons.draw_curves(done, 0.1, 0.5)
    assert len(curves.axes) == 3
    for ax in curves.axes:
        assert ax.get_ylabel() or ax.get_xlabel()
    table_figure = upswing_persons.draw_success(done, results)
    steps = table_figure.axes[0].get_lines()
    recorded = next(line for line in steps if "last trials" in str(line.get_label()))
    shares = np.asarray(recorded.get_ydata())
    assert np.all(np.diff(shares) >= 0)
    assert shares[59] == pytest.approx(100 * results[2].within_60)
    for name, figure in (("curves", curves), ("success", table_figure)):
        assert save(figure, tmp_path / f"{name}.png").stat().st_size > 10_000
