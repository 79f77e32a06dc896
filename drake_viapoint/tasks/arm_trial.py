"""A trial of an arm that follows a path: how its tool moved, and what was measured of that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.math import RigidTransform

from drake_viapoint.errors import OutcomeError
from drake_viapoint.robot.arm import Arm, ToolMotion
from drake_viapoint.robot.arm_motion import ArmMotion

SUCCEEDED, MISSED = "succeeded", "missed"
"""How a trial that was executed can end."""


class Result(NamedTuple):
    """A task variable of one trial."""

    realized: NDArray[np.float64] | None  # (m,) T; None if the trial did not get so far
    desired: NDArray[np.float64]  # (m,) Td

    @property
    def error(self) -> NDArray[np.float64] | None:
        """Td - T (m,), if there is T."""
        return None if self.realized is None else self.desired - self.realized


@dataclass(frozen=True)
class HeldTool:
    """The tool as the arm really held and moved it.

    Before the movement and after it the arm stands still.

    Attributes:
        arm: The controller's model of the arm.
        motion: How its joints moved.
        mount: Pose of the real tool in the tool as modelled.
    """

    arm: Arm
    motion: ArmMotion
    mount: RigidTransform

    def __call__(self, time: float) -> ToolMotion:
        """Where the tool is and how it moves at a time [s]."""
        during = min(max(time, self.motion.start), self.motion.end)
        q = self.motion.q(during)
        v = self.motion.v(during) if during == time else np.zeros_like(q)
        modelled = self.arm.tool_motion(q, v)
        beside = modelled.rotation @ self.mount.translation()
        return ToolMotion(
            modelled.rotation @ self.mount.rotation().matrix(),
            modelled.position + beside,
            modelled.angular_velocity,
            modelled.velocity + np.cross(modelled.angular_velocity, beside),
        )

    def path(self, times: ArrayLike) -> NDArray[np.float64]:
        """Places (n, 3) [m] of the tool at times (n,) [s]."""
        return np.array([self(time).position for time in np.asarray(times, dtype=float).tolist()])


@dataclass(frozen=True)
class ArmTrial:
    """Record of one trial.

    Attributes:
        results: Task variables by their names.
        success: Whether it met the bar of the task.
        tool: How the tool moved.
        saturated: Joints whose torque was clamped at their effort.
        beyond_limits: Joints that left their range of angles or speeds at a step.
        tracking_error: Largest distance of a joint from its desired angle at a step [rad].
    """

    results: Mapping[str, Result]
    success: bool
    tool: HeldTool
    saturated: tuple[str, ...]
    beyond_limits: tuple[str, ...]
    tracking_error: float

    @property
    def motion(self) -> ArmMotion:
        """How the joints moved."""
        return self.tool.motion

    def record(self) -> dict[str, Any]:
        """What a line of the run's trials keeps: T and Td under ``T`` and ``Td``."""
        variables: dict[str, Any] = {}
        for name, (realized, desired) in self.results.items():
            variables[name] = None if realized is None else np.asarray(realized).tolist()
            variables[desired_name(name)] = np.asarray(desired).tolist()
        return {
            "outcome": SUCCEEDED if self.success else MISSED,
            "success": self.success,
            **variables,
            "saturated": list(self.saturated),
            "beyond_limits": list(self.beyond_limits),
            "tracking_error": self.tracking_error,
        }

    def summary(self) -> str:
        """The same in a few words."""
        off = [
            f"{name} " + ("not reached" if result.error is None else f"off by {_norm(result):.4g}")
            for name, result in self.results.items()
        ]
        clamped = [f"torque clamped: {' '.join(self.saturated)}"] if self.saturated else []
        beyond = [f"beyond limits: {' '.join(self.beyond_limits)}"] if self.beyond_limits else []
        return ", ".join([SUCCEEDED if self.success else MISSED, *off, *clamped, *beyond])


def checked_results(
    task: str, measured: object, lengths: Mapping[str, int | None]
) -> dict[str, Result]:
    """What a task measured of a trial, each variable a vector of floats.

    Args:
        task: Its name, for errors.
        measured: What its ``measure`` returned.
        lengths: Of the task variables that have to be there, None where any will do.

    Raises:
        OutcomeError: It is not results by name, a variable is missing, or its T and Td are not
            vectors of the same length. Names task, variable and type or shape.
    """
    if not isinstance(measured, Mapping):
        kind = type(measured).__name__
        raise OutcomeError(f"{task}: measure must return results by name, got {kind}")
    for name in lengths:
        if name not in measured:
            there = ", ".join(map(str, measured)) or "nothing"
            raise OutcomeError(f"{task}: {name} was not measured, only {there}")
    return {
        name: _checked(f"{task}: {name}", result, lengths.get(name))
        for name, result in measured.items()
    }


def _checked(what: str, result: object, length: int | None) -> Result:
    if not isinstance(result, Result):
        raise OutcomeError(
            f"{what} must be a Result(realized=..., desired=...), got {type(result).__name__}"
        )
    desired = _vector(f"{what}: desired", result.desired)
    if result.realized is None:
        return Result(None, desired)
    realized = _vector(f"{what}: realized", result.realized)
    if realized.shape != desired.shape:
        raise OutcomeError(
            f"{what}: realized and desired must be of the same length, got shapes "
            f"{realized.shape} and {desired.shape}"
        )
    if length not in (None, realized.size):
        raise OutcomeError(
            f"{what} must have {length} values, as its subtask's tolerance or gain has, got shape "
            f"{realized.shape}"
        )
    return Result(realized, desired)


def _vector(what: str, value: ArrayLike) -> NDArray[np.float64]:
    try:
        vector = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        kind = type(value).__name__
        raise OutcomeError(f"{what} must be a vector of numbers, got {kind}") from error
    if vector.ndim != 1 or not vector.size:
        raise OutcomeError(f"{what} must be a vector (m,), got shape {vector.shape}")
    return vector


def desired_name(task_variable: str) -> str:
    """What a record calls the desired value of a task variable."""
    return f"{task_variable}d"


def _norm(result: Result) -> float:
    return float(np.linalg.norm(result.error)) if result.error is not None else np.inf
