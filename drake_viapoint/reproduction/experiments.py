"""The experiments of the paper, in its order: what makes each, how large, and what it hangs on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from drake_viapoint.reproduction import (
    choices,
    conditions,
    persons,
    robot,
    serve_reproduction,
    upswing_reproduction,
    upswing_study,
)
from drake_viapoint.reproduction.findings import Findings
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.shipped_study import study_identity
from drake_viapoint.runs.task_run import versions
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.jacobian_scenario import WAYS
from drake_viapoint.tasks.scenario import dump_scenario


@dataclass(frozen=True)
class Experiment:
    """One experiment.

    Attributes:
        name: What the command line calls it.
        title: What the page calls it.
        section: Of the paper.
        what: In a sentence or two.
        make: Makes it in a folder, of so many runs.
        depends: What its runs hang on, as plain data.
        runs: Names of the files and folders that hold its runs.
        unit: What its size counts; empty if there is one run of it.
        reduced: Its size by default.
        full: Its full size.
        seconds: That its pictures take, and each of its runs, on two cores [s]; only what share of
            the whole it is matters.
    """

    name: str
    title: str
    section: str
    what: str
    make: Callable[[Path, int, Progress], Findings]
    depends: Callable[[], Mapping[str, Any]]
    runs: tuple[str, ...]
    unit: str = ""
    reduced: int = 1
    full: int = 1
    seconds: tuple[float, float] = (10.0, 0.0)

    def duration(self, runs: int) -> float:
        """That it takes [s] if so many runs are to be made, where it was measured."""
        return self.seconds[0] + self.seconds[1] * runs


def _scenario(task: str) -> Callable[[], dict[str, Any]]:
    """A task's shipped scenario and the versions."""

    def depends() -> dict[str, Any]:
        scenario = dump_scenario(task_scenario(task))
        return {"scenario": yaml.safe_load(scenario), "versions": versions()}

    return depends


EXPERIMENTS = (
    Experiment(
        "serve",
        "The serve",
        "2.1.1, 2.2",
        "One demonstration, watched, cut into via-points and replayed in the paper's kind of "
        "simulation; then what each component of its via-points moves.",
        serve_reproduction.reproduce_serve,
        _scenario("serve"),
        ("serve",),
        seconds=(9.0, 0.0),
    ),
    Experiment(
        "persons",
        "The serve from many persons",
        "2.2",
        "The same from other virtual persons, each with a body, a racket and a ball of their own.",
        persons.reproduce_persons,
        _scenario("serve"),
        ("persons",),
        "virtual persons",
        20,
        20,
        (1.0, 1.5),
    ),
    Experiment(
        "choices",
        "Which components",
        "2.2.2",
        "Each person's serve learned with the components that move the landing most, and with "
        "those that move it most for what they do to the throw.",
        choices.reproduce_choices,
        choices.choices_identity,
        (choices.RESULTS,),
        "virtual persons",
        8,
        20,
        (2.0, 4.5),
    ),
    Experiment(
        "robot",
        "On a robot",
        "2.1",
        "The ball is carried, thrown and struck by contact alone; the robot is not quite what its "
        "controller thinks, and two cameras tell the learner what happened.",
        robot.reproduce_robot,
        lambda: study_identity(robot.STUDY),
        ("robot",),
        "robots",
        6,
        20,
        (5.0, 9.0),
    ),
    Experiment(
        "conditions",
        "A disturbed ball",
        "3.2",
        "The ball's velocity is disturbed by up to 3 % when it leaves the cup and when it leaves "
        "the face. Does it help to estimate the Jacobians anew?",
        conditions.reproduce_conditions,
        lambda: study_identity(conditions.STUDY),
        ("three_conditions",),
        "runs under each condition",
        15,
        100,
        (3.0, 3.7),
    ),
    Experiment(
        "conditions-small",
        "A disturbed ball, explored by less",
        "3.2",
        "The same with explorations that the disturbance drowns.",
        conditions.reproduce_small_conditions,
        lambda: study_identity(conditions.SMALL_STUDY),
        ("three_conditions_small",),
        "runs under each condition",
        15,
        100,
        (3.0, 3.7),
    ),
    Experiment(
        "upswing",
        "The upswing",
        "3.3",
        "A pendulum swung up by the paper's difference equation, with the Jacobian kept, explored "
        "again, and estimated from the last trials.",
        upswing_reproduction.reproduce_upswing,
        _scenario("upswing"),
        tuple(f"upswing_{way}" for way in WAYS),
        seconds=(6.0, 0.0),
    ),
    Experiment(
        "upswing-persons",
        "The upswing from many persons",
        "3.3",
        "The same from other virtual persons, by the equation and in Drake's plant.",
        upswing_reproduction.reproduce_upswing_persons,
        upswing_study.study_identity,
        (upswing_reproduction.PERSONS,),
        "virtual persons",
        30,
        200,
        (3.0, 1.2),
    ),
)
"""In the order of the page."""

BY_NAME = {experiment.name: experiment for experiment in EXPERIMENTS}
