"""A pendulum on a moving hinge, by the paper's difference equation (section 3.3.1, Eq. 13).

The angle theta is 0 where the pendulum is inverted and -pi where it hangs at first; it grows
anticlockwise as seen from the front (x right, z up), so the tip is at x - l sin theta. It is never
wrapped: going over the top is an overshoot, not a jump.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.errors import ScenarioError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.tasks.flight import GRAVITY

HANGING = -math.pi
"""Angle of the pendulum before the movement [rad]."""


class PendulumMotion(NamedTuple):
    """How hand and pendulum moved, at n times; a batch of b movements has arrays (b, n)."""

    times: NDArray[np.float64]  # (n,) [s]
    hand: NDArray[np.float64]  # (..., n) x of the hinge [m]
    angle: NDArray[np.float64]  # (..., n) theta [rad]
    speed: NDArray[np.float64]  # (..., n) omega [rad/s]

    def tip(self, length: float) -> NDArray[np.float64]:
        """Where the end of a pendulum is (..., n, 2): x and height above the hinge [m]."""
        x = self.hand - length * np.sin(self.angle)
        return np.stack([x, length * np.cos(self.angle)], axis=-1)


@dataclass(frozen=True)
class Pendulum:
    """All its mass at the tip.

    Attributes:
        length: From the hinge to the tip [m].
        damping: Viscous, as a share of the speed lost in a second [1/s].
    """

    length: float
    damping: float = 0.0


class Recurrence:
    """The paper's difference equation, for movements with the same times, a batch in one call.

    The hand's acceleration along a minimum-jerk path is linear in its via-points, so one matrix,
    found once, stands for the spline.

    Args:
        times: (m,) of the via-points, from 0 on [s].
        pendulum: What swings.
        time_step: Delta [s]; divides the duration.

    Raises:
        ScenarioError: The time step does not divide the duration.
    """

    def __init__(self, times: ArrayLike, pendulum: Pendulum, time_step: float) -> None:
        t = np.asarray(times, dtype=np.float64)
        steps = whole_steps(float(t[-1] - t[0]), time_step)
        self.times = t[0] + time_step * np.arange(steps + 1)  # (n,)
        basis = minimum_jerk(t, np.eye(t.size))
        self._hand = basis(self.times)  # (n, m)
        self._acceleration = basis.derivative(2)(self.times[:-1])  # (n - 1, m)
        self._kept = 1.0 - pendulum.damping * time_step  # 1 - alpha_1
        self._gain = time_step * GRAVITY / pendulum.length  # alpha_2
        self._step = time_step

    def __call__(self, x: ArrayLike) -> PendulumMotion:
        """Move the hand through via-points and see what the pendulum does.

        Args:
            x: (m,) or (b, m) places of the hand at the via-points [m].

        Raises:
            ScenarioError: Not as many via-points as times.
        """
        points = np.asarray(x, dtype=np.float64)
        if points.ndim not in (1, 2) or points.shape[-1] != self._hand.shape[1]:
            raise ScenarioError(
                f"the movement has {self._hand.shape[1]} via-points, got an array of shape "
                f"{np.shape(x)}"
            )
        if points.ndim == 1:
            return PendulumMotion(self.times, self._hand @ points, *self._swing_one(points))
        places = np.ascontiguousarray(points.T)
        angle, speed = self._swing(places)
        return PendulumMotion(self.times, _products(self._hand, places).T, angle.T, speed.T)

    def _swing(
        self, places: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Angle and speed (n, b) of via-points (m, b): rows are contiguous, so a step is quick."""
        # the speed is reckoned in radians a step: one product less
        pull = self._step * self._gain
        drive = _products(self._acceleration, places)  # (n - 1, b)
        drive *= pull / GRAVITY
        angles = np.empty((self.times.size, places.shape[1]))
        speeds = np.empty_like(angles)
        angles[0], speeds[0] = HANGING, 0.0
        push = np.empty(places.shape[1])
        angle, speed = angles[0], speeds[0]
        for along, next_angle, next_speed in zip(drive, angles[1:], speeds[1:], strict=True):
            np.sin(angle, out=next_speed)
            next_speed *= pull
            np.cos(angle, out=push)
            push *= along
            next_speed += push
            if self._kept == 1.0:
                next_speed += speed
            else:
                next_speed += np.multiply(speed, self._kept, out=push)
            np.add(angle, next_speed, out=next_angle)
            angle, speed = next_angle, next_speed
        speeds /= self._step
        return angles, speeds

    def _swing_one(
        self, point: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The same for a single movement: plain numbers are quicker than arrays of one."""
        pull = self._step * self._gain
        drive = (pull / GRAVITY) * (self._acceleration @ point)  # (n - 1,)
        angle, speed = HANGING, 0.0
        angles, speeds = [angle], [speed]
        for along in drive.tolist():
            speed = self._kept * speed + pull * math.sin(angle) + along * math.cos(angle)
            angle += speed
            angles.append(angle)
            speeds.append(speed)
        return np.array(angles), np.array(speeds) / self._step


def _products(matrix: NDArray[np.float64], columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """A matrix product without the threads of one: they wait long for a core that is busy."""
    product: NDArray[np.float64] = np.einsum("ij,jk->ik", matrix, columns)
    return product


def whole_steps(duration: float, time_step: float) -> int:
    """How often a time step fits into a duration.

    Raises:
        ScenarioError: It does not, to a millionth of a step; names the nearest that do.
    """
    steps = max(1, round(duration / time_step))
    if abs(duration / time_step - steps) > 1e-6:
        raise ScenarioError(
            f"time_step {time_step:.9g} s does not divide the movement of {duration:.9g} s; "
            f"{duration / steps:.9g} s would, in {steps} steps"
        )
    return steps
