"""The base of tasks of an arm that follows a path: what is shared by all, so that one is short.

A subclass says what is measured of a trial, and which components are changed to bring it about.
From a demonstrated path the base extracts via-points, retargets them, executes trials in Drake's
dynamics, judges and records them, and refuses what is out of reach; it is a ``trial.Task``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.errors import BrokenOffError, ViaPointsError
from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.learning.gain import ConstantGain
from drake_viapoint.learning.subtask import Subtask
from drake_viapoint.motion.extraction import Extraction, extract_via_points
from drake_viapoint.motion.orientation import zyz_from_rotation
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.robot.inverse_kinematics import InverseKinematics
from drake_viapoint.robot.retargeting import POSE_NAMES, Retargeting
from drake_viapoint.tasks.arm_movement import ArmMovements
from drake_viapoint.tasks.arm_scene import ArmScene
from drake_viapoint.tasks.arm_trial import (
    ArmTrial,
    HeldTool,
    Result,
    checked_results,
    desired_name,
)
from drake_viapoint.tasks.trial import FAILED, RefusedTrial, recorded_vector

_LEVER = 0.3
"""Makes angles comparable with positions in the extraction [m/rad], as the serve does."""

_ROUNDED = 1e-9
"""By so much a time may be beyond an end [s]."""


class ArmTask(ABC):
    """A task of an arm that follows a path.

    Args:
        scene: The arm, its tool and the control.
        times: (n,) of the demonstration, increasing [s]; trials begin at 0.
        path: (n, 6) demonstrated x, y, z [m], phi, theta, psi [rad] of the tool in the world, at
            rest at both ends; or (n, 3) places alone, and the tool keeps its orientation at rest.
        via_points: Number of via-points, ends included.
        position_threshold: Supplemental via-points keep the tool this near to its path [m].
        rotation_threshold: And this near in orientation [rad].

    Attributes:
        scene: The diagram in which trials are executed.
        extraction: Via-points of the demonstration, and how they were found.
        via_points: Of the first trial.
        subtasks: In the order in which the movement meets them.
        retargeting: From via-points to joint movements.

    Raises:
        ExtractionError: Too few samples, or shapes that disagree.
        UnreachableError: The demonstrated path is out of the arm's reach.
        RetargetingError: The arm cannot stay as near to the path as asked.
        ViaPointsError: A subtask changes a component that there is not.
    """

    name: ClassVar[str]
    """What records call it."""
    successes: int = 3
    """So many successful trials in a row and the task is learned."""
    repeats: int = 0
    """So many further trials of what was learned."""
    marks: Mapping[str, ArrayLike] = {}
    """Places (3,) [m] to show with a trial, by name."""

    def __init__(
        self,
        scene: ArmScene,
        times: ArrayLike,
        path: ArrayLike,
        *,
        via_points: int = 8,
        position_threshold: float = 1e-3,
        rotation_threshold: float = 1e-2,
    ) -> None:
        self.scene = scene
        t, poses = np.asarray(times, dtype=np.float64), np.asarray(path, dtype=np.float64)
        if poses.ndim == 2 and poses.shape[1] == 3:
            kept = zyz_from_rotation(scene.arm.tool_pose(scene.arm.rest).rotation)
            poses = np.hstack([poses, np.tile(kept, (len(poses), 1))])
        self.extraction: Extraction = extract_via_points(
            t - t.min(initial=np.inf) if t.size else t,
            poses,
            POSE_NAMES,
            number=via_points,
            weights=[1.0, 1.0, 1.0, _LEVER, _LEVER, _LEVER],
        )
        self.via_points: ViaPoints = self.extraction.via_points
        self.subtasks: Sequence[Subtask] = tuple(self.learns())
        for subtask in self.subtasks:
            self.via_points.select(subtask.control)
        self.retargeting = Retargeting(
            InverseKinematics(scene.arm, scene.arm.rest),
            self.via_points,
            position_threshold=position_threshold,
            rotation_threshold=rotation_threshold,
        )
        self._variables = tuple(subtask.task_variable for subtask in self.subtasks)
        self._lengths = {subtask.task_variable: _length(subtask) for subtask in self.subtasks}
        self._movement = ArmMovements(self.retargeting, self._variables)

    @abstractmethod
    def learns(self) -> Sequence[Subtask]:
        """The subtasks, in the order in which the movement meets them.

        Each says which components of ``self.via_points`` may be changed, and which task variable
        that shall bring about; see ``nearest`` and ``correction``.
        """

    @abstractmethod
    def measure(self, tool: HeldTool, rng: np.random.Generator) -> Mapping[str, Result]:
        """Each subtask's T and Td in one trial.

        Args:
            tool: How the tool moved.
            rng: For whatever differs from trial to trial, such as noise of a sensor; of the trial's
                own seed.
        """

    def succeeded(self, results: Mapping[str, Result]) -> bool:
        """Whether a trial met the bar: by default each T is within its subtask's tolerance.

        One tolerance for all of T bounds the length of Td - T, one for each bounds each.
        """
        return all(_within(results[s.task_variable].error, s.tolerance) for s in self.subtasks)

    def nearest(self, time: float, names: Sequence[str] = "xyz") -> tuple[str, ...]:
        """Components of the via-point nearest to a time [s], the ends left out.

        Args:
            time: When something should happen.
            names: Of x, y, z, phi, theta and psi.

        Raises:
            ViaPointsError: The time is not within the movement, or there are only the ends.
        """
        start, end = self.via_points.times[[0, -1]].tolist()
        if not start - _ROUNDED <= time <= end + _ROUNDED:
            raise ViaPointsError(
                f"{self.name}: no via-point is near {time:g} s, the movement is from {start:g} s "
                f"to {end:g} s"
            )
        between = self.via_points.times[1:-1]
        if not between.size:
            raise ViaPointsError("a movement of two via-points has none between its ends")
        number = 2 + int(np.argmin(np.abs(between - time)))
        return tuple(f"{name}{number}" for name in names)

    def correction(
        self,
        task_variable: str,
        control: Sequence[str],
        *,
        tolerance: tuple[float, ...] | float,
        gain: tuple[float, ...] | float = 0.5,
        position_perturbation: float = 0.01,
        angle_perturbation: float = np.pi / 180,
        regularization: float = 0.04,
    ) -> Subtask:
        """A subtask in its plainest form: the Jacobian explored once and kept, a constant gain.

        Args:
            task_variable: Name of T among what is measured.
            control: Components that may be changed: S.
            tolerance: What may be missing of T, in its own units.
            gain: Diagonal of B.
            position_perturbation: By which x, y and z are explored [m].
            angle_perturbation: By which phi, theta and psi are explored [rad].
            regularization: Of the inverse, for a Jacobian in tolerances a perturbation [-].
        """
        return Subtask(
            name=task_variable,
            control=tuple(control),
            task_variable=task_variable,
            perturbation=tuple(
                position_perturbation if name[0] in "xyz" else angle_perturbation
                for name in control
            ),
            gain=ConstantGain(gain),
            regularization=regularization,
            reached=float(np.linalg.norm(tolerance)),
            tolerance=tolerance,
        )

    def execute(self, via_points: ViaPoints, seed: int) -> ArmTrial | RefusedTrial:
        """Execute one trial; refused if out of reach, failed if the simulation breaks off.

        Args:
            via_points: Of the tool's movement.
            seed: Of all that differs from trial to trial.

        Raises:
            OutcomeError: A task variable was not measured, or is no vector of the right length.
        """
        movement = self._movement(via_points)
        if isinstance(movement, RefusedTrial):
            return movement
        try:
            motion, clamped = self.scene.follow(movement)
        except BrokenOffError as error:
            return RefusedTrial(str(error), self._variables, FAILED)
        tool = HeldTool(self.scene.arm, motion, self.scene.mount)
        measured = self.measure(tool, np.random.default_rng(seed))
        results = checked_results(self.name, measured, self._lengths)
        arm = self.scene.arm
        return ArmTrial(
            results=results,
            success=bool(self.succeeded(results)),
            tool=tool,
            saturated=arm.named(clamped),
            beyond_limits=arm.named(motion.beyond(arm.limits)),
            tracking_error=motion.strayed(movement.trajectory),
        )

    def outcome(self, record: dict[str, Any]) -> Outcome:
        """What the learner is told of a recorded trial."""
        desired = {name: record.get(desired_name(name)) for name in self._variables}
        return Outcome(
            {name: recorded_vector(record, name) for name in self._variables},
            {name: np.array(value, float) for name, value in desired.items() if value is not None},
            record["success"],
            broken_off=record["outcome"] == FAILED and record[self._variables[0]] is None,
        )


def _length(subtask: Subtask) -> int | None:
    """Of T, where a tolerance or gain for each of its values says it."""
    values = (subtask.tolerance, getattr(subtask.gain, "value", None))
    return next((len(v) for v in values if isinstance(v, tuple | list)), None)


def _within(error: NDArray[np.float64] | None, tolerance: tuple[float, ...] | float) -> bool:
    if error is None:
        return False
    if np.ndim(tolerance) == 0:
        return bool(np.linalg.norm(error) <= tolerance)
    return bool(np.all(np.abs(error) <= np.asarray(tolerance)))
