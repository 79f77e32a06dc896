"""The pendulum upswing: move the hand so that the pendulum it holds swings up (section 3.3)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.errors import UnreachableError
from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.learning.gain import ConstantGain
from drake_viapoint.learning.subtask import Subtask
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.tasks.pendulum import Pendulum, PendulumMotion, Recurrence
from drake_viapoint.tasks.trial import RefusedTrial
from drake_viapoint.tasks.upswing_demonstration import (
    WatchedUpswing,
    recorded_upswing,
    watch_upswing,
)
from drake_viapoint.tasks.upswing_line import LineCheck
from drake_viapoint.tasks.upswing_plant import KinematicExecution
from drake_viapoint.tasks.upswing_scenario import UpswingLearning, UpswingScenario
from drake_viapoint.tasks.upswing_scene import UpswingScene
from drake_viapoint.tasks.upswing_tracked import CarriedUpswing, TrackedExecution
from drake_viapoint.tasks.upswing_trial import END_STATE, UpswingTrial, upswing_outcome

Execution = Callable[[NDArray[np.float64]], PendulumMotion | CarriedUpswing]
"""What executes an upswing: from places of the hand at the via-points (n,) [m]."""


class UpswingTask:
    """An upswing to be learned: demonstration watched, pendulum hung, ready to execute trials.

    Args:
        scenario: Everything it depends on.
        watched: The demonstration, if it has been watched already.
        scene: The arm with its pendulum, if it has been built already; the recurrence needs none.

    Attributes:
        watched: The demonstration.
        execution: What executes trials.

    Raises:
        ScenarioError: The time step does not divide the movement, or a value is out of its bounds.
        UnreachableError: The demonstrated movement is out of the arm's reach.
        ViapointError: The demonstration cannot be read or does not show an upswing.
    """

    name = "upswing"

    def __init__(
        self,
        scenario: UpswingScenario,
        watched: WatchedUpswing | None = None,
        scene: UpswingScene | None = None,
    ) -> None:
        scenario.validate()
        self.scenario = scenario
        self.watched = watched or watch_upswing(
            scenario.demonstration, recorded_upswing(scenario.demonstration)
        )
        self.via_points: ViaPoints = self.watched.extraction.via_points
        learning = scenario.learning
        self.subtasks = (upswing_subtask(learning),)
        self.successes = learning.successes
        self.repeats = learning.repeats
        self._tolerance = np.array([learning.angle_tolerance, learning.speed_tolerance])
        self.execution = self._execution(scene)

    def execute(self, via_points: ViaPoints, seed: int) -> UpswingTrial | RefusedTrial:
        """Execute one upswing; refused if the arm cannot make the movement.

        Nothing is drawn at random.
        """
        del seed
        try:
            done = self.execution(via_points.values[:, 0])
        except UnreachableError as error:
            return RefusedTrial(str(error), (END_STATE,))
        if isinstance(done, CarriedUpswing):
            return UpswingTrial(done.motion, self.watched.end_state, self._tolerance, done)
        return UpswingTrial(done, self.watched.end_state, self._tolerance)

    def outcome(self, record: dict[str, Any]) -> Outcome:
        """What the learner is told of a recorded upswing."""
        return upswing_outcome(record)

    def _execution(self, scene: UpswingScene | None) -> Execution:
        scenario, first = self.scenario, self.via_points
        if scenario.execution == "recurrence":
            pendulum = Pendulum(scenario.pendulum.length, scenario.pendulum.damping)
            return Recurrence(first.times, pendulum, scenario.time_step)
        scene = scene or UpswingScene(scenario)
        LineCheck(scene.line, first.times)(first.values[:, 0])  # said before the first trial
        if scenario.hand == "kinematic":
            return KinematicExecution(scenario, scene.line, first.times)
        return TrackedExecution(scenario, scene, first.times, first.values[:, 0])


def upswing_subtask(learning: UpswingLearning) -> Subtask:
    """The one subtask of section 3.3.2 (Eqs. 14 to 16)."""
    return Subtask(
        name="swing",
        control=tuple(learning.control),
        task_variable=END_STATE,
        perturbation=(learning.perturbation,) * len(learning.control),
        gain=ConstantGain(tuple(learning.gain)),
        tolerance=(learning.angle_tolerance, learning.speed_tolerance),
        regularization=learning.regularization,
        reached=0.0,
        jacobian=learning.jacobian.kept(),
        one_sided=True,
    )
