"""How the arm really moved: the integrator's steps, and a curve as good between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BPoly, BSpline

from drake_viapoint.robot.arm import Arm, JointLimits, ToolMotion


@dataclass(frozen=True)
class MotionSegment:
    """Joint states at the integrator's steps, between two events.

    Attributes:
        times: Times of the steps [s].
        q: Joint angles [rad].
        v: Joint velocities [rad/s].
        acceleration: Joint accelerations [rad/s2].
    """

    times: NDArray[np.float64]  # (n,)
    q: NDArray[np.float64]  # (n, k)
    v: NDArray[np.float64]  # (n, k)
    acceleration: NDArray[np.float64]  # (n, k)


class ArmMotion:
    """A motion of the arm, at any time of it.

    Between two steps the joints follow the quintic that has their angles, velocities and
    accelerations at both: its error is of sixth order in the step, below that of the integration.
    Where segments meet, the acceleration may jump.

    Args:
        segments: In time order, each beginning where the one before ends.
    """

    def __init__(self, segments: Sequence[MotionSegment]) -> None:
        self.segments = tuple(segments)
        self._q = _hermite(self.segments[0])
        for segment in self.segments[1:]:
            self._q.extend(_hermite(segment).c, segment.times[1:])
        self._v = self._q.derivative()
        self.start = float(self._q.x[0])
        self.end = float(self._q.x[-1])

    def q(self, times: ArrayLike) -> NDArray[np.float64]:
        """Joint angles (..., k) [rad] at times (...) [s]."""
        angles: NDArray[np.float64] = self._q(np.asarray(times, dtype=np.float64))
        return angles

    def v(self, times: ArrayLike) -> NDArray[np.float64]:
        """Joint velocities (..., k) [rad/s] at times (...) [s]."""
        velocities: NDArray[np.float64] = self._v(np.asarray(times, dtype=np.float64))
        return velocities

    def strayed(self, desired: BSpline[np.float64]) -> float:
        """Largest angle of a joint from a desired trajectory, at the steps [rad].

        Where the motion goes on after the trajectory's end, the joints should stay there.
        """
        times = np.concatenate([segment.times for segment in self.segments])
        wanted = desired(np.minimum(times, desired.t[-1]))
        return float(np.max(np.abs(self.q(times) - wanted)))

    def beyond(self, limits: JointLimits) -> NDArray[np.bool_]:
        """Which joints (k,) left their range of angles or speeds at a step."""
        q = np.concatenate([segment.q for segment in self.segments])
        v = np.concatenate([segment.v for segment in self.segments])
        outside = (q < limits.lower) | (q > limits.upper) | (np.abs(v) > limits.speed)
        beyond: NDArray[np.bool_] = outside.any(axis=0)
        return beyond

    def tool(self, arm: Arm, times: ArrayLike) -> list[ToolMotion]:
        """Motion of the arm's tool at times (n,) [s]."""
        t = np.atleast_1d(np.asarray(times, dtype=np.float64))
        return [arm.tool_motion(q, v) for q, v in zip(self.q(t), self.v(t), strict=True)]


def _hermite(segment: MotionSegment) -> BPoly:
    """The quintics between the steps, by their Bernstein coefficients.

    ``BPoly.from_derivatives`` does the same piece by piece, in a third of a trial's time.
    """
    h = np.diff(segment.times)[:, None]
    q0, q1 = segment.q[:-1], segment.q[1:]
    v0, v1 = segment.v[:-1] * h / 5, segment.v[1:] * h / 5
    a0, a1 = segment.acceleration[:-1] * h**2 / 20, segment.acceleration[1:] * h**2 / 20
    coefficients = [q0, q0 + v0, q0 + 2 * v0 + a0, q1 - 2 * v1 + a1, q1 - v1, q1]
    return BPoly(np.array(coefficients), segment.times)
