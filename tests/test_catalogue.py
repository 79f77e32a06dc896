"""Tasks by name: siblings that the command line and the run folders treat alike."""

from pathlib import Path

import pytest

from drake_viapoint.errors import ScenarioError
from drake_viapoint.packages import resolve
from drake_viapoint.tasks.catalogue import TASKS, build_task, scenario_in, task_scenario
from drake_viapoint.tasks.scenario import dump_scenario, load_scenario


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
