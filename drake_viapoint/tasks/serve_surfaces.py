"""What the ball can touch: the cup's hollow, the strings' oval and the goal's ring.

Shapes are those for which Drake's collision queries are exact: a ring is a polygon of capsules, the
oval a flat plate that the ball meets as a hydroelastic body. (Against plates and ellipsoids its
point contact is found by iteration and goes wrong in some of a hundred places.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.geometry import Capsule, Convex
from pydrake.math import RigidTransform, RotationMatrix

_SEAT_ANGLE = np.radians(50.0)  # between the cup's axis and where the ball lies on its seat
_SEAT_TUBE = 0.003  # [m] radius of the capsules that make the cup
_WALL_DEPTH = 0.6  # of the ball's radius below its centre: deeper cups hold on to a leaving ball
_SEAT_SIDES, _WALL_SIDES, _RING_SIDES, _OVAL_SIDES = 8, 16, 24, 48


@dataclass(frozen=True)
class CapsuleRing:
    """A regular polygon of capsules around the z-axis.

    Attributes:
        radius: Of the circle that touches the capsules' axes from within [m].
        height: z of the axes [m].
        tube: Radius of the capsules [m].
        sides: How many.
    """

    radius: float
    height: float
    tube: float
    sides: int

    def capsules(self) -> list[tuple[RigidTransform, Capsule]]:
        """Each capsule and its pose."""
        corners = self._corners()
        shapes = []
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            along = RotationMatrix.MakeFromOneVector(end - start, 2)
            length = float(np.linalg.norm(end - start))
            shapes.append((RigidTransform(along, (start + end) / 2), Capsule(self.tube, length)))
        return shapes

    def gap(self, centre: ArrayLike, ball: float) -> NDArray[np.float64]:
        """Distance (n,) [m] of a ball from the ring; below 0 where it presses into it.

        Args:
            centre: Of the ball (n, 3) [m].
            ball: Its radius [m].
        """
        corners = self._corners()
        return _to_polyline(np.asarray(centre), corners) - self.tube - ball

    def least_gap(self, centre: NDArray[np.float64], ball: float) -> float:
        """The gap to a ball at (3,) [m] or a little less, at a fraction of the cost."""
        x, y, z = centre
        beyond = self.radius * (1 / math.cos(math.pi / self.sides) - 1)  # of the corners
        aside = max(0.0, abs(math.hypot(x, y) - self.radius) - beyond)
        return math.hypot(aside, z - self.height) - self.tube - ball

    def _corners(self) -> NDArray[np.float64]:
        turn = 2 * np.pi * (np.arange(self.sides) + 0.5) / self.sides
        outer = self.radius / np.cos(np.pi / self.sides)
        heights = np.full(self.sides, self.height)
        return np.stack([outer * np.cos(turn), outer * np.sin(turn), heights], axis=1)


@dataclass(frozen=True)
class OvalPlate:
    """The strings: a thin plate across y, its outline an oval.

    Attributes:
        half_width: Along x [m].
        half_length: Along z [m].
        half_thickness: Along y [m].
    """

    half_width: float
    half_length: float
    half_thickness: float = 0.002

    def shape(self) -> Convex:
        """The plate as Drake knows it."""
        away = np.array([0.0, self.half_thickness, 0.0])
        outline = self._outline()
        return Convex(np.vstack([outline + away, outline - away]).T, "strings")

    def gap(self, centre: ArrayLike, ball: float) -> NDArray[np.float64]:
        """Distance (n,) [m] of a ball from the plate; below 0 where it presses into it.

        Args:
            centre: Of the ball (n, 3) [m].
            ball: Its radius [m].
        """
        points = np.asarray(centre, dtype=np.float64)
        flat = points * [1.0, 0.0, 1.0]
        outline = self._outline()
        edges = np.roll(outline, -1, axis=0) - outline
        across = np.stack([edges[:, 2], np.zeros(len(edges)), -edges[:, 0]], axis=1)
        inside = np.all(np.einsum("nki,ki->nk", flat[:, None] - outline, across) <= 0, axis=1)
        beside = np.where(inside, 0.0, _to_polyline(flat, outline))
        above = np.maximum(np.abs(points[:, 1]) - self.half_thickness, 0.0)
        return np.asarray(np.hypot(beside, above) - ball)

    def least_gap(self, centre: NDArray[np.float64], ball: float) -> float:
        """The gap to a ball at (3,) [m] or a little less, at a fraction of the cost."""
        sizes = self.half_width, self.half_thickness, self.half_length
        beyond = [max(0.0, abs(c) - size) for c, size in zip(centre, sizes, strict=True)]
        return math.hypot(*beyond) - ball

    def _outline(self) -> NDArray[np.float64]:
        turn = 2 * np.pi * np.arange(_OVAL_SIDES) / _OVAL_SIDES
        x, z = self.half_width * np.cos(turn), self.half_length * np.sin(turn)
        return np.stack([x, np.zeros(_OVAL_SIDES), z], axis=1)


def cup_rings(cup_radius: float, ball: float) -> tuple[CapsuleRing, CapsuleRing]:
    """The cup about the centre of the resting ball, opening along z: its seat and its wall.

    Args:
        cup_radius: Of the hollow, inside its wall [m].
        ball: Radius of the ball that rests on the seat [m].
    """
    away = ball + _SEAT_TUBE
    seat = CapsuleRing(
        away * np.sin(_SEAT_ANGLE), -away * np.cos(_SEAT_ANGLE), _SEAT_TUBE, _SEAT_SIDES
    )
    depth = _WALL_DEPTH * ball
    wall = math.sqrt((cup_radius + _SEAT_TUBE) ** 2 - depth**2)
    return seat, CapsuleRing(wall, -depth, _SEAT_TUBE, _WALL_SIDES)


def goal_ring(inner_radius: float, tube: float) -> CapsuleRing:
    """The goal's upper ring about its centre."""
    return CapsuleRing(inner_radius + tube, 0.0, tube, _RING_SIDES)


def _to_polyline(points: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance (n,) of points (n, 3) from the closed line through corners (k, 3)."""
    edges = np.roll(corners, -1, axis=0) - corners
    offsets = points[:, None] - corners
    along = np.einsum("nki,ki->nk", offsets, edges) / np.sum(edges**2, axis=1)
    foot = corners + np.clip(along, 0.0, 1.0)[..., None] * edges
    distances: NDArray[np.float64] = np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1)
    return distances
