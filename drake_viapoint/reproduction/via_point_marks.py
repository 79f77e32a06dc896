"""Via-points of a tool drawn on a page: a ball at each place, with the tool's axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, Rgba, Sphere
from pydrake.math import RigidTransform, RotationMatrix

from drake_viapoint.motion.orientation import rotation_from_zyz
from drake_viapoint.motion.via_points import ViaPoints

_BALL = Rgba(0.2, 0.4, 0.9, 1.0)
_AXES = (Rgba(0.85, 0.15, 0.1, 1.0), Rgba(0.1, 0.65, 0.2, 1.0), Rgba(0.1, 0.3, 0.85, 1.0))
_AXIS = 0.06  # [m] length of a via-point's axes


def draw_via_points(meshcat: Meshcat, via_points: ViaPoints) -> None:
    """Draw via-points of poses as ``via_points/1``, ``via_points/2`` and so on.

    Args:
        meshcat: Where to draw.
        via_points: With places [m] and ZYZ angles [rad].
    """
    for number, pose in enumerate(via_points.values, start=1):
        _draw_via_point(meshcat, f"via_points/{number}", pose)


def _draw_via_point(meshcat: Meshcat, name: str, pose: NDArray[np.float64]) -> None:
    rotation = rotation_from_zyz(pose[3:])
    meshcat.SetObject(name, Sphere(0.012), _BALL)
    meshcat.SetTransform(name, RigidTransform(RotationMatrix(rotation), pose[:3]))
    for axis, colour in enumerate(_AXES):
        ends = np.array([np.zeros(3), _AXIS * np.eye(3)[axis]]).T
        meshcat.SetLine(f"{name}/axis{axis}", ends, 2.0, colour)
