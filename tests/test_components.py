"""Section 2.2 on the shipped serve: our Fig. 9, its tables, and what cannot be asked."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drake_viapoint.errors import RunFolderError
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction import components, figure9
from drake_viapoint.reproduction.components import (
    ServeComponents,
    serve_components,
    study_components,
    trials_of,
)
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.run_folder import read_trials
from drake_viapoint.runs.task_run import begin
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.upswing import UpswingTask


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, serve_task: ServeTask) -> Path:
    path = tmp_path_factory.mktemp("components") / "run"
    with begin(path, task_scenario("serve")) as folder:
        learn(serve_task, folder, seed=0, max_trials=14)  # the throw is learned by then
    return path


@pytest.fixture(scope="module")
def found(serve_task: ServeTask) -> ServeComponents:
    told: list[int] = []
    first = serve_task.via_points
    result = serve_components(
        serve_task, first, first, position=0.002, angle=0.0035, on_trial=lambda: told.append(1)
    )
    assert len(told) == trials_of(serve_task) == 194
    return result


def test_columns_are_the_slopes_of_single_trials(
    serve_task: ServeTask, found: ServeComponents
) -> None:
    for component in ("z3", "psi6"):
        size = 0.002 if component[0] == "z" else 0.0035
        ends = [
            serve_task.outcome(
                serve_task.execute(serve_task.via_points.moved([component], [way]), 0).record()
            ).realized
            for way in (size, -size)
        ]
        j = serve_task.via_points.column(component)
        for name, effects in (("T_H", found.h), ("T_G", found.g)):
            up, down = (end[name] for end in ends)
            assert up is not None
            assert down is not None
            np.testing.assert_array_equal(effects.columns[:, j], (up - down) / 2)


def test_what_comes_after_the_throw_hardly_moves_the_thrown_ball(found: ServeComponents) -> None:
    norms = dict(zip(found.h.components, found.h.norms, strict=True))
    assert max(norms[f"{name}8"] for name in ("x", "y", "z")) < 0.01 * norms["z3"]
    assert {"x3", "y3", "z3"} <= set(found.throw.control)
    late = {component[-1] for component in found.by_ratio.control}
    assert late <= {"6", "7", "8"}


def test_picture_and_tables_of_a_run(
    run: Path, tmp_path: Path, found: ServeComponents, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def measured(task: ServeTask, first: ViaPoints, thrown: ViaPoints, **_: object) -> Any:
        asked.append((task.via_points, first, thrown))
        return found

    monkeypatch.setattr(components, "serve_components", measured)
    said = study_components(run, tmp_path).lines
    ((unlearned, first, thrown),) = asked
    np.testing.assert_array_equal(first.values, unlearned.values)
    met = next(r for r in read_trials(run) if r["d"] < 0.03)  # not before it is explored
    np.testing.assert_array_equal(thrown.values, met["via_points"]["values"])
    assert (tmp_path / "figure9.png").stat().st_size > 20_000
    for name, number in (("throw", 6), ("strike_norm", 3), ("strike_ratio", 3)):
        with (tmp_path / f"components_{name}.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == 48
        chosen = [row["component"] for row in rows if row["chosen"] == "True"]
        assert len(chosen) == number
        assert any(" ".join(chosen) in line for line in said)
        assert all(row["why"] for row in rows)


def test_the_figure_shows_the_norms(found: ServeComponents) -> None:
    figure = figure9.draw(
        found.h, found.g, found.disturbance, found.throw, found.by_norm, found.by_ratio, "2 mm"
    )
    upper, middle, lower = figure.axes[:3]
    for ax, values in (
        (upper, found.h.norms),
        (middle, found.g.norms),
        (lower, found.g.norms / found.disturbance.norms),
    ):
        heights = [bar.get_height() for bar in ax.patches]
        np.testing.assert_array_equal(heights, np.nan_to_num(values))
        assert ax.get_ylabel()
    marked = {str(line.get_label()): line.get_xdata() for line in upper.get_lines()}
    columns = [line.column for line in found.throw.table if line.chosen]
    assert list(marked["chosen here"]) == columns
    assert list(marked["the paper's choice"]) == [13, 14, 15, 19, 20, 21]


def test_runs_that_have_nothing_to_show(tmp_path: Path, serve_task: ServeTask) -> None:
    upswing = task_scenario("upswing")
    with begin(tmp_path / "swing", upswing) as folder:
        learn(UpswingTask(upswing), folder, seed=0, max_trials=1)
    with pytest.raises(RunFolderError, match="holds a run of the upswing, not of the serve"):
        study_components(tmp_path / "swing", tmp_path)
    scenario = task_scenario("serve", None, {"learning.throw.reached": 0.001})
    with begin(tmp_path / "serve", scenario) as folder:
        learn(serve_task, folder, seed=0, max_trials=1)
    with pytest.raises(RunFolderError, match=r"no trial that lands with d below 0\.001 m"):
        study_components(tmp_path / "serve", tmp_path)
    with pytest.raises(RunFolderError, match="holds no run"):
        study_components(tmp_path / "nothing", tmp_path)
