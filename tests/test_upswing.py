"""The upswing as a task: one demonstration, three executions, the learner of every task."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drake_viapoint.errors import LineReachError, ScenarioError
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.pendulum import Pendulum, Recurrence
from drake_viapoint.tasks.trial import RefusedTrial, Task, Trial
from drake_viapoint.tasks.upswing import UpswingTask
from drake_viapoint.tasks.upswing_scene import UpswingScene
from drake_viapoint.tasks.upswing_trial import UpswingTrial

EXECUTIONS = {
    "recurrence": {"execution": "recurrence"},
    "kinematic": {"execution": "plant", "hand": "kinematic"},
    "tracked": {"execution": "plant", "hand": "tracked"},
}


@pytest.fixture(scope="module")
def scene() -> UpswingScene:
    return UpswingScene(task_scenario("upswing"))


@pytest.fixture(scope="module")
def tasks(scene: UpswingScene) -> dict[str, UpswingTask]:
    return {
        name: UpswingTask(task_scenario("upswing", None, changes), scene=scene)
        for name, changes in EXECUTIONS.items()
    }


def run(task: UpswingTask, trials: int = 60) -> tuple[int | None, list[dict[str, Any]]]:
    log = MemoryLog("test")
    result = learn(task, log, seed=0, max_trials=trials)
    return result.learned_at, log.trials


@pytest.mark.parametrize("name", EXECUTIONS)
def test_the_first_trial_fails_and_it_is_learned(tasks: dict[str, UpswingTask], name: str) -> None:
    task: Task = tasks[name]
    learned_at, records = run(tasks[name])
    assert not records[0]["success"]
    assert [r["purpose"] for r in records[:8]] == ["learning", *["exploration"] * 6, "learning"]
    assert learned_at is not None
    assert learned_at <= 30
    assert [r["success"] for r in records[-3:]] == [True] * 3
    trial: Trial = task.execute(task.via_points, 0)
    assert isinstance(trial, UpswingTrial)


def test_explores_by_a_centimetre_each_interior_via_point(tasks: dict[str, UpswingTask]) -> None:
    _, records = run(tasks["recurrence"], 7)
    values = np.array([record["via_points"]["values"] for record in records])[:, :, 0]
    np.testing.assert_allclose(values[1:] - values[0], 0.01 * np.eye(6, 8, 1), atol=1e-15)


@pytest.mark.parametrize("name", EXECUTIONS)
def test_same_via_points_same_bits(tasks: dict[str, UpswingTask], name: str) -> None:
    other = tasks[name].via_points.moved(["x4"], [0.02])
    first = tasks[name].execute(tasks[name].via_points, 0).record()
    tasks[name].execute(other, 1)
    assert tasks[name].execute(tasks[name].via_points, 0).record() == first
    fresh = UpswingTask(task_scenario("upswing", None, EXECUTIONS[name]))
    assert fresh.execute(fresh.via_points, 0).record() == first


def test_the_executions_agree_as_far_as_they_should(tasks: dict[str, UpswingTask]) -> None:
    """At a learned movement: the recurrence's step costs a few hundredths of a radian."""
    _, records = run(tasks["recurrence"])
    learned = records[-1]["via_points"]["values"]
    via_points = replace(tasks["recurrence"].via_points, values=np.array(learned))
    ends = {}
    for name, task in tasks.items():
        trial = task.execute(via_points, 0)
        assert isinstance(trial, UpswingTrial)
        ends[name] = trial.end_state
    assert np.all(np.abs(ends["recurrence"] - ends["kinematic"]) < [0.06, 0.6])
    assert np.all(np.abs(ends["tracked"] - ends["kinematic"]) < [0.2, 1.0])
    assert np.abs(ends["recurrence"] - ends["kinematic"])[0] > 1e-5  # they are not the same thing


def test_only_an_arm_that_carries_is_recorded(tasks: dict[str, UpswingTask]) -> None:
    own = {"saturated", "beyond_limits", "tracking_error", "hand_error"}
    for name, task in tasks.items():
        record = task.execute(task.via_points, 0).record()
        assert (own <= record.keys()) == (name == "tracked")
        assert record["Td"] == task.watched.end_state.tolist()


def test_damping_is_that_of_the_scenario() -> None:
    task = UpswingTask(task_scenario("upswing", None, {"pendulum.damping": 0.3}))
    x = task.via_points.values[:, 0]
    expected = Recurrence(task.via_points.times, Pendulum(0.35, 0.3), 1 / 60)(x)
    trial = task.execute(task.via_points, 0)
    assert isinstance(trial, UpswingTrial)
    np.testing.assert_array_equal(trial.motion.angle, expected.angle)


@pytest.mark.parametrize("name", ["kinematic", "tracked"])
def test_a_movement_out_of_reach_is_a_refused_trial(
    tasks: dict[str, UpswingTask], name: str
) -> None:
    far = tasks[name].via_points.moved(["x5"], [0.6])
    trial = tasks[name].execute(far, 0)
    assert isinstance(trial, RefusedTrial)
    record = trial.record()
    assert record["outcome"] == "unreachable"
    assert record["T"] is None
    assert "via-point 5 is out of reach" in record["reason"]
    assert "mm beyond the arm's reach" in record["reason"]
    assert tasks[name].outcome(record).error("T") is None
    assert isinstance(tasks["recurrence"].execute(far, 0), UpswingTrial)  # it knows no arm


@pytest.mark.parametrize("name", ["kinematic", "tracked"])
def test_a_demonstration_out_of_reach_is_refused_before_the_first_trial(name: str) -> None:
    changes = {**EXECUTIONS[name], "robot.line": [0.35, 0.44, 1.215]}
    with pytest.raises(LineReachError, match=r"via-point \d is out of reach: x = .* mm beyond"):
        UpswingTask(task_scenario("upswing", None, changes))


def test_a_time_step_that_does_not_divide_the_movement() -> None:
    with pytest.raises(ScenarioError, match=r"time_step 0\.03 s does not divide .* would, in"):
        UpswingTask(task_scenario("upswing", None, {"time_step": 0.03}))


def test_other_numbers_of_via_points() -> None:
    control = [f"x{i}" for i in range(2, 10)]
    changes = {"demonstration.via_points": 10, "learning.control": control}
    learned_at, records = run(UpswingTask(task_scenario("upswing", None, changes)), 30)
    assert [r["purpose"] for r in records[1:9]] == ["exploration"] * 8
    assert learned_at is not None


@pytest.mark.parametrize("way", ["fixed", "manual", "recorded"])
def test_every_way_gets_nearer(way: str) -> None:
    task = UpswingTask(
        task_scenario("upswing", None, {"learning.jacobian.way": way, "learning.successes": 0})
    )
    _, records = run(task, 30)
    errors = [np.linalg.norm(np.array(r["T"]) - r["Td"]) for r in records]
    assert len(records) == 30  # successes: 0 goes on whatever succeeds
    assert min(errors[7:]) < 0.1 * errors[0]
    explored = [r["trial"] for r in records if r["purpose"] == "exploration"]
    again = list(range(16, 22)) + [30] if way == "manual" else []
    assert explored == [*range(2, 8), *again]
