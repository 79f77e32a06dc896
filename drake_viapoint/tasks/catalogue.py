"""The tasks there are, by name: their scenarios, and how a task is made of one.

A task that is not listed can be learned all the same: whatever offers what ``trial.Task`` asks for
goes to the learning run. The list is for the command line and for folders that name their task.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.errors import ScenarioError
from drake_viapoint.packages import resolve
from drake_viapoint.tasks.scenario import Scenario, dump_scenario, load_scenario, read_mapping
from drake_viapoint.tasks.serve import ServeTask, serve_scene
from drake_viapoint.tasks.serve_demonstration import recorded_serve, watch_serve
from drake_viapoint.tasks.serve_recording import record_person as record_server
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.trial import Task
from drake_viapoint.tasks.upswing import UpswingTask
from drake_viapoint.tasks.upswing_demonstration import recorded_upswing, watch_upswing
from drake_viapoint.tasks.upswing_recording import record_person as record_swinger
from drake_viapoint.tasks.upswing_scenario import UpswingScenario
from drake_viapoint.tasks.upswing_scene import UpswingScene


class TaskKind(NamedTuple):
    """What is needed to learn a task by its name."""

    scenario: type[Any]  # of its scenarios
    task: Callable[[Any, Any, Any], Task]  # of a scenario, its demonstration and its scene
    scene: Callable[[Any], Any]  # the diagram of a scenario; None if it needs none
    watch: Callable[[Any, Any], Any]  # the demonstration of a scenario, in its scene
    shipped: str  # address of the scenario that is used when none is named
    recorded_person: Callable[[int], MarkerRecording]  # a virtual person's demonstration


TASKS: Mapping[str, TaskKind] = {
    "serve": TaskKind(
        ServeScenario,
        ServeTask,
        serve_scene,
        lambda scenario, scene: watch_serve(
            scenario.demonstration, recorded_serve(scenario.demonstration, scene.ring)
        ),
        "package://drake_viapoint/scenarios/serve.yaml",
        lambda number: record_server(number, ServeScene(ServeScenario()).ring),
    ),
    "upswing": TaskKind(
        UpswingScenario,
        UpswingTask,
        lambda scenario: UpswingScene(scenario) if scenario.execution == "plant" else None,
        lambda scenario, _: watch_upswing(
            scenario.demonstration, recorded_upswing(scenario.demonstration)
        ),
        "package://drake_viapoint/scenarios/upswing.yaml",
        record_swinger,
    ),
}
"""By the name in a scenario's first key."""

ROBOT_SERVE = "package://drake_viapoint/scenarios/serve_robot.yaml"
"""Address of the scenario that stands for the robot experiment of section 2.1."""


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
    return TaskBuilder().build(scenario)


class TaskBuilder:
    """Builds one task after the other, for studies of many runs.

    A scene (a Drake diagram) and a watched demonstration are used again where the next scenario
    has the same. Tasks of one builder share them, so only one of them can execute at a time.
    """

    def __init__(self) -> None:
        self._scene = _Kept()
        self._watched = _Kept()

    def build(self, scenario: Scenario) -> Task:
        """A task ready to execute trials, of a scenario.

        Raises:
            ScenarioError: A value is out of its bounds.
            ViapointError: The demonstration or a model cannot be read or does not do.
        """
        kind = _kind(scenario.task)
        scenario.validate()
        bare = dump_scenario(_without(scenario, kind, _NOT_OF_A_SCENE))
        scene = self._scene.get(bare, lambda: kind.scene(scenario))
        seen = dump_scenario(_without(scenario, kind, _NOT_OF_A_DEMONSTRATION))
        watched = self._watched.get(seen, lambda: kind.watch(scenario, scene))
        return kind.task(scenario, watched, scene)


class _Kept:
    """The last of something that is made of a text."""

    def __init__(self) -> None:
        self._text: str | None = None
        self._made: Any = None

    def get(self, text: str, make: Callable[[], Any]) -> Any:
        if text != self._text:
            self._text = None  # nothing is kept if making fails
            self._made = make()
            self._text = text
        return self._made


_NOT_OF_A_DEMONSTRATION = frozenset({"learning", "disturbance", "cameras", "seed", "made_with"})
_NOT_OF_A_SCENE = _NOT_OF_A_DEMONSTRATION | {"demonstration"}


def _without(scenario: Any, kind: TaskKind, parts: frozenset[str]) -> Any:
    """A scenario with some of its parts as by default."""
    default = kind.scenario()
    kept = {name: getattr(default, name) for name in parts if hasattr(default, name)}
    return dataclasses.replace(scenario, **kept)


def _kind(task: str) -> TaskKind:
    if task not in TASKS:
        raise ScenarioError(f"there is no task {task!r}; there are {', '.join(TASKS)}")
    return TASKS[task]
