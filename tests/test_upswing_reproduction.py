"""Our Figs. 11 to 14: drawn from runs, and showing what they say they show."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from progress_bars import Bars

from drake_viapoint.reproduction import figure11, figure12, figure13
from drake_viapoint.reproduction.findings import Findings, Verdict
from drake_viapoint.reproduction.style import save
from drake_viapoint.reproduction.upswing_reproduction import reproduce_upswing
from drake_viapoint.runs.run_folder import TRIALS, read_trials
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.upswing import UpswingTask
from drake_viapoint.tasks.upswing_scene import UpswingScene
from drake_viapoint.tasks.upswing_trial import UpswingTrial


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Findings, Bars]:
    out, bars = tmp_path_factory.mktemp("upswing") / "results", Bars()
    return out, reproduce_upswing(out, 1, bars), bars


def test_everything_into_one_folder(results: tuple[Path, Findings, Bars]) -> None:
    out, findings, bars = results
    said = findings.lines
    assert {path.name for path in out.iterdir()} == {
        *(f"figure{number}.png" for number in range(11, 15)),
        *(f"upswing_trial{number:02d}.html" for number in (1, 15, 30)),
        *(f"upswing_{way}" for way in ("fixed", "manual", "recorded")),
    }
    assert set(findings.files) == {path.name for path in out.iterdir() if path.is_file()}
    for path in out.glob("figure*.png"):
        assert path.stat().st_size > 20_000
    for label, counts in bars.seen.items():
        assert counts[0] == sum(counts[1:]), label
    records = read_trials(out / "upswing_recorded")
    assert len(records) == 60
    first = next(record["trial"] for record in records if record["success"])
    assert "in the plant: inverted" in said[3]
    assert f"estimated from the last trials: first succeeds at trial {first}, " in said[2]


def test_what_the_paper_says_stands_beside_it(results: tuple[Path, Findings, Bars]) -> None:
    out, findings, _ = results
    rows = {row.quantity: row for row in findings.comparisons}
    assert rows["a2 = Δ g / l of the pendulum"].verdict is Verdict.MATCHES
    assert rows["first trials, before anything is learned"].ours == "7"
    runs = [read_trials(out / f"upswing_{way}") for way in ("fixed", "manual", "recorded")]
    first, again, soonest = (
        next(record["trial"] for record in run if record["success"]) for run in runs
    )
    recorded = runs[-1]
    row = rows["Jacobian kept as first explored"]
    assert f"first succeeds at trial {first}, holds at trial 60" in row.ours
    latest = first > max(again, soonest)
    assert row.verdict is (Verdict.MATCHES if latest else Verdict.DIFFERS)
    assert recorded[29]["success"]
    assert rows["Jacobian estimated from the last 12 trials"].verdict is Verdict.MATCHES


def test_a_second_call_does_no_trial_again(results: tuple[Path, Findings, Bars]) -> None:
    out, findings, bars = results
    lines = [out / f"upswing_{way}" / TRIALS for way in ("fixed", "manual", "recorded")]
    stamps = [path.stat().st_mtime_ns for path in lines]
    assert reproduce_upswing(out, 1, bars) == findings
    assert [path.stat().st_mtime_ns for path in lines] == stamps


def test_figure_11_draws_the_hand_where_it_is(tmp_path: Path) -> None:
    scene = UpswingScene(task_scenario("upswing"))
    figure = figure11.draw(scene, 0.35)
    front, side = figure.axes
    for ax, across in ((front, 0), (side, 1)):
        lines = {str(line.get_label()): line.get_xydata() for line in ax.get_lines()}
        hand, pendulum = lines["hand, at $x$"], lines["pendulum"]
        np.testing.assert_allclose(hand[0], scene.line.places(np.array([0.2]))[0][[across, 2]])
        np.testing.assert_allclose(pendulum[0], hand[0])
    rod = np.diff(
        next(x.get_xydata() for x in front.get_lines() if x.get_label() == "pendulum"), axis=0
    )
    assert np.linalg.norm(rod) == pytest.approx(0.35)
    save(figure, tmp_path / "figure11.png")


def test_figure_12_draws_what_was_executed() -> None:
    task = UpswingTask(task_scenario("upswing"))
    trial = task.execute(task.via_points, 0)
    assert isinstance(trial, UpswingTrial)
    figure = figure12.draw(trial, task.via_points, task.watched, 0.35, "Trial 1")
    title = figure.get_suptitle()
    assert title.startswith("Trial 1")
    assert "synthetic" in title
    hand, angle, speed = (
        next(ax for ax in figure.axes if label in ax.get_ylabel())
        for label in ("place [m]", "theta", "omega")
    )
    drawn = {str(line.get_label()): line.get_xydata() for line in hand.get_lines()}
    np.testing.assert_array_equal(drawn["hand $x$"][:, 1], trial.motion.hand)
    np.testing.assert_array_equal(drawn["via-points"][:, 1], task.via_points.values[:, 0])
    for ax, course, symbol, wanted in (
        (angle, trial.motion.angle, r"\theta", trial.desired[0]),
        (speed, trial.motion.speed, r"\omega", trial.desired[1]),
    ):
        drawn = {str(line.get_label()): line.get_xydata() for line in ax.get_lines()}
        np.testing.assert_array_equal(drawn["execution"][:, 1], course)
        assert drawn[f"${symbol}_d$"][0, 1] == wanted
        assert "demonstration" in drawn
        assert symbol in ax.get_ylabel()


def test_figure_13_has_a_panel_a_way_with_its_trials(
    results: tuple[Path, list[str], Bars],
) -> None:
    out, _, _ = results
    ways = ("fixed", "manual", "recorded")
    records = {way: read_trials(out / f"upswing_{way}") for way in ways}
    figure = figure13.draw(records, 0.1, 0.5)
    panels, speeds = figure.axes[:3], figure.axes[3:]
    for way, panel, fast in zip(ways, panels, speeds, strict=True):
        error = np.array([np.array(r["T"]) - r["Td"] for r in records[way]])
        lines = {str(line.get_label()): line.get_xydata() for line in panel.get_lines()}
        np.testing.assert_array_equal(lines[r"$\theta - \theta_d$"][:, 1], error[:, 0])
        np.testing.assert_array_equal(fast.get_lines()[0].get_ydata(), error[:, 1])
        explored = [r["trial"] for r in records[way] if r["purpose"] == "exploration"]
        assert lines["exploration"][:, 0].tolist() == explored
        good = [r["trial"] for r in records[way] if r["success"]]
        assert lines["success"][:, 0].tolist() == good
        assert f"first success at trial {good[0]}" in panel.get_title()
    lines = {str(line.get_label()): line.get_xydata() for line in panels[2].get_lines()}
    assert lines["estimated anew"][:, 0].tolist() == list(range(8, 61))


def test_figure_13_of_trials_that_reached_nothing() -> None:
    record = {"trial": 1, "T": None, "success": False, "purpose": "learning"}
    figure = figure13.draw({"fixed": [record]}, 0.1, 0.5)
    assert "no success" in figure.axes[0].get_title()
