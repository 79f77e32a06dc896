"""The horizontal line along which the hand moves the pendulum, and how much of it is in reach."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.errors import LineReachError, ScenarioError, UnreachableError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.orientation import rotation_from_zyz
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.inverse_kinematics import InverseKinematics
from drake_viapoint.robot.retargeting import POSE_NAMES
from drake_viapoint.tasks.scene import scene_path
from drake_viapoint.tasks.upswing_scenario import UpswingRobot

_STRIDES = (0.1, 0.01, 0.001)  # [m] in which the end of the reach is looked for
_FARTHEST = 2.0  # [m]
_SAMPLES = 401  # places of a path at which it is looked at


class HandLine:
    """Places x of the hand along the world's x, from where the line starts.

    What the arm reaches of the line is found once, by inverse kinematics; then a path is checked
    against two numbers.

    Args:
        robot: Where the line starts, and how the hand is held.
        arm: Who moves the hand; loaded from the robot's models if None.

    Attributes:
        arm: Who moves the hand.
        reach: Least and largest x that the arm reaches without bending another way [m].

    Raises:
        ScenarioError: The pendulum's axis does not look forward, or the line starts out of reach.
        ModelFileError: A model cannot be read or lacks a frame.
    """

    def __init__(self, robot: UpswingRobot, arm: Arm | None = None) -> None:
        self.arm = arm or Arm(scene_path(robot.directives), robot.tool_frame)
        self._start = np.array(robot.line, dtype=np.float64)
        self._angles = np.array(robot.orientation, dtype=np.float64)
        self._rotation = rotation_from_zyz(self._angles)
        self._ik = InverseKinematics(self.arm, self.arm.rest)
        if self._rotation[1, 1] < 1 - 1e-6:
            raise ScenarioError(
                f"robot.orientation must have its y axis forward, got {robot.orientation} with y "
                f"along {np.round(self._rotation[:, 1], 3).tolist()}"
            )
        try:
            self.posture(0.0)
        except UnreachableError as error:
            raise ScenarioError(f"robot.line {robot.line}: {error}") from error
        self.reach = self._farthest(-1.0), self._farthest(1.0)

    @property
    def rotation(self) -> NDArray[np.float64]:
        """World from axle (3, 3), all along the line."""
        return self._rotation

    def posture(self, x: float) -> NDArray[np.float64]:
        """Joint angles (k,) [rad] that hold the axle at a place [m].

        Raises:
            UnreachableError: The arm does not reach it.
        """
        return self.postures(np.array([x]))[0]

    def postures(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Joint angles (n, k) [rad] that hold the axle at places (n,) [m], found together.

        Raises:
            UnreachableError: The arm does not reach one of them.
        """
        labels = [f"the hand at x = {place:.3f} m" for place in x]
        rotations = np.tile(self._rotation, (x.size, 1, 1))
        near = np.tile(self._ik.reference, (x.size, 1))
        return self._ik.solve(rotations, self.places(x), labels, near)

    def places(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places (n,) along the line as points in the world (n, 3) [m]."""
        points = np.tile(self._start, (x.size, 1))
        points[:, 0] += x
        return points

    def via_points(self, times: ArrayLike, x: ArrayLike) -> ViaPoints:
        """Places (n,) [m] at times (n,) [s] as via-points of the tool's pose."""
        points = self.places(np.asarray(x, dtype=np.float64))
        values = np.hstack([points, np.tile(self._angles, (len(points), 1))])
        return ViaPoints(np.asarray(times, dtype=np.float64), values, POSE_NAMES)

    def _farthest(self, way: float) -> float:
        """How far the arm reaches one way along the line [m], with its sign.

        In ever finer strides and not by bisection: a place out of reach costs far more to find out
        than one within.
        """
        inside = 0.0
        for stride in _STRIDES:
            while inside < _FARTHEST and self._reached(way * (inside + stride)):
                inside += stride
        return way * inside

    def _reached(self, x: float) -> bool:
        try:
            self.posture(x)
        except UnreachableError:
            return False
        return True


class LineCheck:
    """Checks movements with via-points at the same times against the reach of the line.

    Args:
        line: The line.
        times: (n,) of the via-points [s].
    """

    def __init__(self, line: HandLine, times: ArrayLike) -> None:
        self._line = line
        t = np.asarray(times, dtype=np.float64)
        self._sampled = np.linspace(t[0], t[-1], _SAMPLES)
        self._path = minimum_jerk(t, np.eye(t.size))(self._sampled)  # (s, n)

    def __call__(self, x: NDArray[np.float64]) -> None:
        """Check via-points x (n,) [m] and the minimum-jerk path through them.

        Raises:
            LineReachError: A via-point is out of reach, or the path is between two.
        """
        low, high = self._line.reach
        beyond = np.maximum(x - high, low - x)
        worst = int(np.argmax(beyond))
        if beyond[worst] > 0:
            raise LineReachError(f"via-point {worst + 1}", float(x[worst]), (low, high))
        path = self._path @ x
        beyond = np.maximum(path - high, low - path)
        worst = int(np.argmax(beyond))
        if beyond[worst] > 0:
            label = f"the hand at {self._sampled[worst]:.3f} s"
            raise LineReachError(label, float(path[worst]), (low, high))
