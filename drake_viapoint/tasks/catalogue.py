"""The tasks there are, by name: their scenarios, and how a task is made of one.

A task that is not listed can be learned all the same: whatever offers what ``trial.Task`` asks for
goes to the learning run. The list is for the command line and for folders that name their task.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.errors import ScenarioError
from drake_viapoint.packages import resolve
from drake_viapoint.tasks.scenario import Scenario, load_scenario, read_mapping
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_recording import record_person as record_server
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.trial import Task
from drake_viapoint.tasks.upswing import UpswingTask
from drake_viapoint.tasks.upswing_recording import record_person as record_swinger
from drake_viapoint.tasks.upswing_scenario import UpswingScenario


class TaskKind(NamedTuple):
    """What is needed to learn a task by its name."""

    scenario: type[Any]  # of its scenarios
    task: type[Any]  # made of one of them
    shipped: str  # address of the scenario that is used when none is named
    recorded_person: Callable[[int], MarkerRecording]  # a virtual person's demonstration


TASKS: Mapping[str, TaskKind] = {
    "serve": TaskKind(
        ServeScenario,
        ServeTask,
        "package://drake_viapoint/scenarios/serve.yaml",
        lambda number: record_server(number, ServeScene(ServeScenario()).ring),
    ),
    "upswing": TaskKind(
        UpswingScenario,
        UpswingTask,
        "package://drake_viapoint/scenarios/upswing.yaml",
        record_swinger,
    ),
}
"""By the name in a scenario's first key."""


def task_scenario(
    task: str, path: Path | None = None, changes: Mapping[str, object] | None = None
) -> Any:
    """A task's scenario, of a file or the shipped one, with changes.

    Args:
        task: Name of the task.
        path: File; the shipped one if None.
        changes: Values that replace the file's, by their full keys.

    Returns:
        A ``ServeScenario`` or ``UpswingScenario``.

    Raises:
        ScenarioError: The file or a change is not valid, or there is no such task.
    """
    kind = _kind(task)
    scenario: Scenario = load_scenario(path or resolve(kind.shipped), kind.scenario, changes)
    return scenario


def scenario_in(path: Path, changes: Mapping[str, object] | None = None) -> Any:
    """The scenario of a file that says of which task it is.

    Raises:
        ScenarioError: The file or a change is not valid, or names no task there is.
    """
    name = read_mapping(path).get("task")
    if not isinstance(name, str) or name not in TASKS:
        raise ScenarioError(f"{path}: task must be {' or '.join(TASKS)}, got {name}")
    return task_scenario(name, path, changes)


def build_task(scenario: Scenario) -> Task:
    """A task ready to execute trials, of a scenario."""
    task: Task = _kind(scenario.task).task(scenario)
    return task


def _kind(task: str) -> TaskKind:
    if task not in TASKS:
        raise ScenarioError(f"there is no task {task!r}; there are {', '.join(TASKS)}")
    return TASKS[task]
