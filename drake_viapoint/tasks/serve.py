"""The tennis serve: throw the ball up, strike it into the goal (section 2)."""

from __future__ import annotations

from typing import Any, Protocol

from pydrake.geometry import Meshcat

from drake_viapoint.errors import (
    BallFallsOutError,
    BrokenOffError,
    ScenarioError,
)
from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.learning.gain import ConstantGain, TaperedGain
from drake_viapoint.learning.subtask import Subtask
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.robot.inverse_kinematics import InverseKinematics
from drake_viapoint.robot.retargeting import JointMovement, Retargeting
from drake_viapoint.tasks.arm_movement import ArmMovements
from drake_viapoint.tasks.serve_contact import ContactExecution
from drake_viapoint.tasks.serve_contact_scene import ContactScene
from drake_viapoint.tasks.serve_demonstration import WatchedServe, recorded_serve, watch_serve
from drake_viapoint.tasks.serve_event import EventExecution
from drake_viapoint.tasks.serve_scenario import ServeLearning, ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.serve_sight import ServeSight
from drake_viapoint.tasks.serve_trial import (
    STRIKE,
    THROW,
    ServeOutcome,
    ServeTrial,
    serve_outcome,
)
from drake_viapoint.tasks.trial import FAILED, RefusedTrial

_RESULTS = ("d", THROW, STRIKE)  # what a trial of which nothing came does not reach


class ServeExecution(Protocol):
    """A way to execute serves."""

    def execute(self, movement: JointMovement, seed: int = 0) -> ServeTrial:
        """One serve; the seed is that of all that differs from trial to trial."""
        ...


class ServeTask:
    """A serve to be learned: demonstration watched, scene built, ready to execute trials.

    Args:
        scenario: Everything it depends on.
        watched: The demonstration, if it has been watched already.
        scene: The diagram, if it has been built already.

    Attributes:
        watched: The demonstration.
        scene: The diagram in which trials are executed.
        retargeting: From via-points to joint movements.
        execution: What executes them.
    """

    name = "serve"

    def __init__(
        self,
        scenario: ServeScenario,
        watched: WatchedServe | None = None,
        scene: ServeScene | None = None,
    ) -> None:
        scenario.validate()
        self.scenario = scenario
        self.scene = scene or serve_scene(scenario)
        self.watched = watched or watch_serve(
            scenario.demonstration, recorded_serve(scenario.demonstration, self.scene.ring)
        )
        self.via_points: ViaPoints = self.watched.extraction.via_points
        end = float(self.via_points.times[-1])
        if not 0 < self.watched.hit_time < end:
            raise ScenarioError(
                f"demonstration.hit_time must lie within the movement of {end:g} s, "
                f"got {self.watched.hit_time:g}"
            )
        self.subtasks = serve_subtasks(scenario.learning)
        for subtask in self.subtasks:
            self.via_points.select(subtask.control)
        self.successes = scenario.learning.successes
        self.repeats = scenario.learning.repeats
        self.retargeting = Retargeting(
            InverseKinematics(self.scene.arm, self.scene.arm.rest),
            self.via_points,
            position_threshold=scenario.robot.position_threshold,
            rotation_threshold=scenario.robot.rotation_threshold,
        )
        self.execution: ServeExecution
        if isinstance(self.scene, ContactScene):
            contact = ContactExecution(scenario, self.scene, self.watched.hit_time)
            contact.check_start(self.retargeting.first)
            self.execution = contact
        else:
            self.execution = EventExecution(scenario, self.scene, self.watched.hit_time)
        self._sight = (
            ServeSight(scenario, self.scene.arm, self.scene.ring)
            if scenario.cameras.see == "samples"
            else None
        )
        self._movement = ArmMovements(self.retargeting, _RESULTS)

    def execute(self, via_points: ViaPoints, seed: int) -> ServeTrial | RefusedTrial:
        """Execute one serve, and see it.

        Refused if the arm cannot follow these via-points, or the ball does not rest in the cup
        where they begin; failed if the simulation does not come to its end.

        Args:
            via_points: Of the racket's movement.
            seed: Of all that differs from trial to trial.
        """
        movement = self._movement(via_points)
        if isinstance(movement, RefusedTrial):
            return movement
        try:
            trial = self.execution.execute(movement, seed)
        except BallFallsOutError as error:
            return RefusedTrial(str(error), _RESULTS, ServeOutcome.SPILT)
        except BrokenOffError as error:
            return RefusedTrial(str(error), _RESULTS, FAILED)
        return trial if self._sight is None else self._sight(trial, movement, seed)

    def outcome(self, record: dict[str, Any]) -> Outcome:
        """What the learner is told of a recorded serve."""
        return serve_outcome(record)


def serve_scene(scenario: ServeScenario, meshcat: Meshcat | None = None) -> ServeScene:
    """The diagram in which a scenario's trials are executed."""
    kind = ContactScene if scenario.execution == "contact" else ServeScene
    return kind(scenario, meshcat)


def serve_subtasks(learning: ServeLearning) -> tuple[Subtask, Subtask]:
    """The two subtasks of section 2.1: throw (Eqs. 1, 2), then strike (Eqs. 3, 4)."""
    throw, strike = learning.throw, learning.strike
    return (
        Subtask(
            name="throw",
            control=tuple(throw.control),
            task_variable=THROW,
            perturbation=_perturbations(throw.control, learning),
            gain=ConstantGain(throw.gain),
            tolerance=learning.meeting_tolerance,
            regularization=throw.regularization,
            reached=throw.reached,
            jacobian=learning.jacobian.kept(),
        ),
        Subtask(
            name="strike",
            control=tuple(strike.control),
            task_variable=STRIKE,
            perturbation=_perturbations(strike.control, learning),
            gain=TaperedGain(strike.gain, strike.taper_start, strike.gate),
            tolerance=learning.landing_tolerance,
            regularization=strike.regularization,
            reached=0.0,
            gate=strike.gate,
            jacobian=learning.jacobian.kept(),
        ),
    )


def _perturbations(control: list[str], learning: ServeLearning) -> tuple[float, ...]:
    """Of each component: places are moved by metres, angles by radians."""
    return tuple(
        learning.position_perturbation
        if name.startswith(("x", "y", "z"))
        else learning.angle_perturbation
        for name in control
    )
