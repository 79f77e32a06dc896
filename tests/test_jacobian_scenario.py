"""The choice of what becomes of a Jacobian, as a scenario says it."""

import pytest

from drake_viapoint.errors import ScenarioError
from drake_viapoint.learning.jacobian import ExploredJacobian, KeptJacobian, RecordedJacobian
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.jacobian_scenario import WAYS, JacobianScenario
from drake_viapoint.tasks.serve import serve_subtasks
from drake_viapoint.tasks.upswing import upswing_subtask

KEPT = {
    "fixed": KeptJacobian(),
    "manual": ExploredJacobian((15, 29, 43, 57)),
    "recorded": RecordedJacobian(12, 10.0),
}


@pytest.mark.parametrize("way", WAYS)
def test_each_way_by_name(way: str) -> None:
    scenario = JacobianScenario(way=way)
    scenario.validate("learning.jacobian")
    assert scenario.kept() == KEPT[way]


def test_both_tasks_have_the_choice() -> None:
    changes = {"learning.jacobian.way": "recorded"}
    for subtask in serve_subtasks(task_scenario("serve", None, changes).learning):
        assert subtask.jacobian == RecordedJacobian(15, 10.0)  # K of section 3.2
    learning = task_scenario("upswing").learning
    assert upswing_subtask(learning).jacobian == RecordedJacobian(12, 10.0)  # K of section 3.3


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("way", "guessed", "must be fixed or manual or recorded, got guessed"),
        ("explored_again_at", [9, 0], "must be trials, from 1 on, got 0"),
        ("window", 0, "must be at least 1, got 0"),
        ("regularization", -1.0, "must be finite and not negative, got -1.0"),
        ("regularization", float("nan"), "must be finite and not negative, got nan"),
    ],
)
@pytest.mark.parametrize("task", ["serve", "upswing"])
def test_bounds(task: str, key: str, value: object, words: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        task_scenario(task, None, {f"learning.jacobian.{key}": value})
    assert f"learning.jacobian.{key}" in str(refused.value)
    assert words in str(refused.value)
