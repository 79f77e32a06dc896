"""The racket as the ball meets it: an oval face that moves, and the cup by its handle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline

from drake_viapoint.motion.orientation import angular_velocity_from_zyz_rates, rotation_from_zyz


class RacketStates(NamedTuple):
    """Pose and velocity of the racket at n times; its origin is the centre of the face."""

    rotation: NDArray[np.float64]  # (n, 3, 3) world from racket
    position: NDArray[np.float64]  # (n, 3) [m]
    angular_velocity: NDArray[np.float64]  # (n, 3) [rad/s] in the world
    velocity: NDArray[np.float64]  # (n, 3) [m/s] of the origin

    @property
    def normal(self) -> NDArray[np.float64]:
        """The face's normal, y_racket, in the world. Shape (n, 3)."""
        return self.rotation[:, :, 1]

    def point_velocity(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Velocity (n, 3) [m/s] of the racket's material at world points (n, 3) [m]."""
        return self.velocity + np.cross(self.angular_velocity, point - self.position)


class RacketMotion(Protocol):
    """How a racket moves, whoever holds it."""

    @property
    def start(self) -> float:
        """Beginning of the motion [s]."""
        ...

    @property
    def end(self) -> float:
        """End of the motion [s]."""
        ...

    def __call__(self, times: ArrayLike) -> RacketStates:
        """States at times (n,) [s] within start and end."""
        ...


@dataclass(frozen=True)
class PoseSpline:
    """A racket moved along a spline of its position and ZYZ angles.

    Attributes:
        spline: Six dimensions: x, y, z [m], phi, theta, psi [rad].
    """

    spline: BSpline[np.float64]

    @property
    def start(self) -> float:
        """Beginning of the motion [s]."""
        return float(self.spline.t[0])

    @property
    def end(self) -> float:
        """End of the motion [s]."""
        return float(self.spline.t[-1])

    def __call__(self, times: ArrayLike) -> RacketStates:
        """See ``RacketMotion``."""
        t = np.atleast_1d(np.asarray(times, dtype=np.float64))
        pose, rate = self.spline(t), self.spline(t, 1)
        turn = angular_velocity_from_zyz_rates(pose[:, 3:])
        return RacketStates(
            rotation_from_zyz(pose[:, 3:]),
            pose[:, :3],
            np.einsum("nij,nj->ni", turn, rate[:, 3:]),
            rate[:, :3],
        )


@dataclass(frozen=True)
class Face:
    """The oval that can strike a ball."""

    half_width: float  # along x_racket [m]
    half_length: float  # along z_racket [m]

    def contains(self, point: NDArray[np.float64]) -> bool:
        """Whether a point (3,) [m] in the racket's frame lies within the oval's outline."""
        x, _, z = point
        return bool((x / self.half_width) ** 2 + (z / self.half_length) ** 2 <= 1.0)
