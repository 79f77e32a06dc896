"""Tasks by name: siblings that the command line and the run folders treat alike."""

from pathlib import Path

import pytest

from drake_viapoint.errors import ScenarioError, ViapointError
from drake_viapoint.packages import resolve
from drake_viapoint.tasks.catalogue import (
    TASKS,
    TaskBuilder,
    build_task,
    scenario_in,
    task_scenario,
)
from drake_viapoint.tasks.scenario import dump_scenario, load_scenario
from drake_viapoint.tasks.upswing import UpswingTask
from drake_viapoint.tasks.upswing_scene import UpswingScene
from drake_viapoint.tasks.upswing_tracked import TrackedExecution


@pytest.mark.parametrize("name", TASKS)
def test_a_shipped_scenario_says_what_its_class_defaults_to(name: str) -> None:
    """So the file can be read as documentation, and left out."""
    kind = TASKS[name]
    assert dump_scenario(task_scenario(name)) == dump_scenario(kind.scenario())
    assert task_scenario(name).task == name


@pytest.mark.parametrize("name", TASKS)
def test_a_dumped_scenario_is_read_back_as_it_was(name: str, tmp_path: Path) -> None:
    changed = task_scenario(name, None, {"seed": 5, "learning.jacobian.way": "recorded"})
    (tmp_path / "s.yaml").write_text(dump_scenario(changed))
    again = scenario_in(tmp_path / "s.yaml")
    assert type(again) is TASKS[name].scenario
    assert dump_scenario(again) == dump_scenario(changed)


@pytest.mark.parametrize("name", TASKS)
def test_a_task_offers_what_a_run_asks_for(name: str) -> None:
    task = build_task(task_scenario(name))
    assert task.name == name
    for subtask in task.subtasks:
        task.via_points.select(subtask.control)
    trial = task.execute(task.via_points, 0)
    record = trial.record()
    assert record.keys() >= {"outcome", "success"}
    outcome = task.outcome(record)
    for subtask in task.subtasks:
        assert outcome.error(subtask.task_variable) is not None
    assert trial.summary()


def test_a_builder_uses_scene_and_demonstration_again_where_they_are_the_same() -> None:
    builder = TaskBuilder()
    plant = {"execution": "plant", "hand": "tracked"}

    def build(**changes: object) -> UpswingTask:
        named = {key.replace("__", "."): value for key, value in changes.items()}
        task = builder.build(task_scenario("upswing", None, {**plant, **named}))
        assert isinstance(task, UpswingTask)
        return task

    def scene_of(task: UpswingTask) -> UpswingScene:
        assert isinstance(task.execution, TrackedExecution)
        return task.execution.scene

    first = build()
    assert build(seed=3, learning__jacobian__way="fixed").watched is first.watched
    other = build(demonstration__person=3)
    assert other.watched is not first.watched
    assert scene_of(other) is scene_of(first)
    assert scene_of(build(pendulum__length=0.36)) is not scene_of(first)


def test_a_built_task_is_the_one_made_alone() -> None:
    builder = TaskBuilder()
    for changes in ({}, {"demonstration.person": 3}, {"seed": 2, "demonstration.person": 3}):
        scenario = task_scenario("serve", None, changes)
        built, alone = builder.build(scenario), build_task(scenario)
        assert built.via_points == alone.via_points
        moved = built.via_points.moved(["z3"], [0.005])
        assert built.execute(moved, 5).record() == alone.execute(moved, 5).record()


def test_a_builder_goes_on_after_a_demonstration_that_could_not_be_read(tmp_path: Path) -> None:
    builder = TaskBuilder()
    missing = {"demonstration.file": str(tmp_path / "none.c3d")}
    for _ in range(2):
        with pytest.raises(ViapointError, match=r"none.c3d"):
            builder.build(task_scenario("upswing", None, missing))
    assert builder.build(task_scenario("upswing")).via_points.times.size == 8


def test_changes_go_by_their_full_keys() -> None:
    scenario = task_scenario(
        "upswing", None, {"demonstration.person": 3, "learning.gain": [0.1, 0.2], "hand": "tracked"}
    )
    assert scenario.demonstration.person == 3
    assert scenario.learning.gain == [0.1, 0.2]
    assert scenario.hand == "tracked"
    assert scenario.demonstration.via_points == 8  # what stands beside it stays


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"demonstration.persn": 3}, "persn"),
        ({"pendulum": 3}, "pendulum"),
        ({"pendulum.length": "long"}, "pendulum.length: 'long'"),
        ({"pendulum.length": -1.0}, "pendulum.length must be positive, got -1.0"),
        ({"task": "serve"}, "task must be upswing, got serve"),
    ],
)
def test_a_change_that_cannot_be(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        task_scenario("upswing", None, changes)
    assert words in str(refused.value)


def test_unknown_tasks(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="no task 'golf'; there are serve, upswing"):
        task_scenario("golf")
    (tmp_path / "golf.yaml").write_text("task: golf\n")
    with pytest.raises(ScenarioError, match=r"golf.yaml: task must be serve or upswing, got golf"):
        scenario_in(tmp_path / "golf.yaml")
    (tmp_path / "none.yaml").write_text("seed: 1\n")
    with pytest.raises(ScenarioError, match="got None"):
        scenario_in(tmp_path / "none.yaml")


def test_a_change_does_not_touch_the_next_scenario() -> None:
    kind = TASKS["upswing"]
    load_scenario(resolve(kind.shipped), kind.scenario, {"learning.jacobian.way": "fixed"})
    assert task_scenario("upswing").learning.jacobian.way == "recorded"
