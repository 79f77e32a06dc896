"""Rackets that move in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from drake_viapoint.tasks.racket import RacketStates


@dataclass(frozen=True)
class Gliding:
    """A racket that moves at constant velocity and turns at constant angular velocity."""

    rotation: Rotation  # world from racket at time 0
    position: NDArray[np.float64]  # (3,) at time 0 [m]
    angular_velocity: NDArray[np.float64]  # (3,) [rad/s] in the world
    velocity: NDArray[np.float64]  # (3,) [m/s]
    start: float = 0.0
    end: float = 2.0

    def __call__(self, times: ArrayLike) -> RacketStates:
        t = np.atleast_1d(np.asarray(times, dtype=np.float64))[:, None]
        turned = Rotation.from_rotvec(t * self.angular_velocity) * self.rotation
        still = np.zeros((t.size, 3))
        return RacketStates(
            turned.as_matrix(),
            self.position + t * self.velocity,
            still + self.angular_velocity,
            still + self.velocity,
        )


@dataclass(frozen=True)
class Oscillating:
    """A racket that does not turn, whose cup opens upwards, and goes z = A sin(w t)."""

    amplitude: float  # [m]
    frequency: float  # [rad/s]
    end: float
    sideways: float = 0.0  # [m/s]
    start: float = 0.0

    def __call__(self, times: ArrayLike) -> RacketStates:
        t = np.atleast_1d(np.asarray(times, dtype=np.float64))
        zero, one = np.zeros_like(t), np.ones_like(t)
        a, w = self.amplitude, self.frequency
        # x_racket = -z, y_racket = y, z_racket = x: the cup's opening, -x_racket, looks up
        pose = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
        return RacketStates(
            np.broadcast_to(pose, (t.size, 3, 3)),
            np.stack([self.sideways * t, zero, a * np.sin(w * t)], axis=1),
            np.zeros((t.size, 3)),
            np.stack([self.sideways * one, zero, a * w * np.cos(w * t)], axis=1),
        )
