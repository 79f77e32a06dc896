"""From a path of the tool to a movement of the joints (section 2.1.1 and Fig. 5).

Via-points of the tool become via-points of the joints by inverse kinematics, joined by minimum
jerk in joint space. Between them the tool strays from its minimum-jerk path in Cartesian space, so
supplemental via-points are added where it strays most. Their times are chosen once, on the first
movement, and kept: the joint movement is then a smooth function of the via-points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.spatial.transform import Rotation

from drake_viapoint.errors import RetargetingError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.orientation import rotation_from_zyz
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.robot.inverse_kinematics import InverseKinematics

POSE_NAMES = ("x", "y", "z", "phi", "theta", "psi")
"""Dimensions of a tool path: position [m] and ZYZ angles [rad]."""

_SAMPLES = 201  # places at which the tool's straying is looked at
_MOST_SUPPLEMENTAL = 40


@dataclass(frozen=True)
class JointMovement:
    """A movement of the joints and the via-points it goes through.

    Attributes:
        times: Times of via-points and supplemental via-points [s].
        angles: Joint angles there [rad].
        trajectory: The minimum-jerk trajectory through them.
    """

    times: NDArray[np.float64]  # (n,)
    angles: NDArray[np.float64]  # (n, k)
    trajectory: BSpline[np.float64]


@dataclass(frozen=True)
class Straying:
    """How far the tool is from its Cartesian path, at sampled times."""

    times: NDArray[np.float64]  # (s,) [s]
    distance: NDArray[np.float64]  # (s,) [m]
    angle: NDArray[np.float64]  # (s,) [rad]


class Retargeting:
    """The map from Cartesian via-points to joint movements, fixed by the first movement.

    Args:
        inverse_kinematics: Of the arm that shall move.
        first: Via-points of the first movement, with dimensions ``POSE_NAMES``.
        position_threshold: The first movement's tool path stays this near [m].
        rotation_threshold: And this near in orientation [rad].

    Attributes:
        supplemental_times: Times added to the via-points' own, in the order they were found [s].
        first: The first movement.

    Raises:
        UnreachableError: A via-point or a point between is out of reach.
        RetargetingError: The thresholds cannot be met, or the via-points are not poses.
    """

    def __init__(
        self,
        inverse_kinematics: InverseKinematics,
        first: ViaPoints,
        *,
        position_threshold: float = 1e-3,
        rotation_threshold: float = 1e-2,
    ) -> None:
        if first.names != POSE_NAMES:
            raise RetargetingError(
                f"a tool path has dimensions {', '.join(POSE_NAMES)}, got {', '.join(first.names)}"
            )
        if not (position_threshold > 0 and rotation_threshold > 0):
            raise RetargetingError(
                f"thresholds must be positive, got {position_threshold:g} m and "
                f"{rotation_threshold:g} rad"
            )
        self._ik = inverse_kinematics
        self._via_times = first.times
        self.supplemental_times: tuple[float, ...] = ()
        self._times = first.times
        self._postures = self._solve(first, self._times, None)
        while True:
            movement = self._movement(self._postures)
            straying = self.straying(first, movement)
            error = np.maximum(
                straying.distance / position_threshold, straying.angle / rotation_threshold
            )
            worst = int(np.argmax(error))
            if error[worst] <= 1.0:
                break
            if len(self.supplemental_times) == _MOST_SUPPLEMENTAL:
                raise RetargetingError(
                    f"{_MOST_SUPPLEMENTAL} supplemental via-points leave the tool "
                    f"{1e3 * straying.distance[worst]:.2f} mm and {straying.angle[worst]:.4f} rad "
                    f"off its path at {straying.times[worst]:.3f} s"
                )
            added = straying.times[worst : worst + 1]
            row = int(np.searchsorted(self._times, added[0]))
            self.supplemental_times += (float(added[0]),)
            self._times = np.insert(self._times, row, added[0])
            self._postures = np.insert(
                self._postures, row, self._solve(first, added, None)[0], axis=0
            )
        self.first = movement

    def __call__(self, via_points: ViaPoints) -> JointMovement:
        """The joint movement for other via-points at the same times.

        Raises:
            UnreachableError: A pose is out of reach.
            RetargetingError: The via-points are at other times or are not poses.
        """
        same = via_points.names == POSE_NAMES and np.array_equal(via_points.times, self._via_times)
        if not same:
            raise RetargetingError(
                "via-points must be poses at the times of the first movement: "
                f"{', '.join(f'{t:g}' for t in self._via_times)} s"
            )
        return self._movement(self._solve(via_points, self._times, self._postures))

    def straying(self, via_points: ViaPoints, movement: JointMovement) -> Straying:
        """Distance of the tool, moved by the joints, from its Cartesian minimum-jerk path."""
        times = np.linspace(via_points.times[0], via_points.times[-1], _SAMPLES)
        path = minimum_jerk(via_points.times, via_points.values)(times)
        poses = [self._ik.arm.tool_pose(q) for q in movement.trajectory(times)]
        position = np.array([pose.position for pose in poses])
        rotation = np.array([pose.rotation for pose in poses])
        turn = rotation_from_zyz(path[:, 3:]).transpose(0, 2, 1) @ rotation
        return Straying(
            times,
            np.linalg.norm(position - path[:, :3], axis=1),
            np.atleast_1d(Rotation.from_matrix(turn).magnitude()),
        )

    def _solve(
        self,
        via_points: ViaPoints,
        times: NDArray[np.float64],
        near: NDArray[np.float64] | None,
    ) -> NDArray[np.float64]:
        path = minimum_jerk(via_points.times, via_points.values)(times)
        numbers = {float(t): i + 1 for i, t in enumerate(via_points.times)}
        labels = [
            f"via-point {numbers[t]}" if t in numbers else f"supplemental via-point at {t:.3f} s"
            for t in map(float, times)
        ]
        rotations, positions = rotation_from_zyz(path[:, 3:]), path[:, :3]
        # via-points first: where one is out of reach, so are points near it, and it is to be named
        order = np.argsort(~np.isin(times, via_points.times), kind="stable")
        angles = np.empty((times.size, self._ik.arm.num_joints))
        angles[order] = self._ik.solve(
            rotations[order],
            positions[order],
            [labels[i] for i in order],
            None if near is None else near[order],
        )
        return angles

    def _movement(self, angles: NDArray[np.float64]) -> JointMovement:
        return JointMovement(self._times, angles, minimum_jerk(self._times, angles))
