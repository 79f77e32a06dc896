"""How an arm differs from what its controller believes of it; nobody tells the learner."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from scipy.spatial.transform import Rotation

from drake_viapoint.tasks.scenario import require


@dataclass(frozen=True)
class UnknownArm:
    """How much is unknown of an arm and its tool; nothing by default.

    Attributes:
        inertia: Each body's mass is scaled by a factor within 1 - this and 1 + this, its moments a
            mass by another.
        viscous_friction: Of each joint, in efforts a rad/s [s/rad].
        shift: The tool sits beside its place, along each of its axes by a distance with this
            standard deviation [m].
        turn: And turned about its origin, about each axis by an angle with this one [rad].

    Raises:
        ScenarioError: A value is not in [0, 1).
    """

    inertia: float = 0.0
    viscous_friction: float = 0.0
    shift: float = 0.0
    turn: float = 0.0

    def __post_init__(self) -> None:
        """Check every value against its bounds."""
        for item in fields(self):
            value = getattr(self, item.name)
            require(0 <= value < 1, f"unknown {item.name}", value, "must be in [0, 1)")

    def draw_mount(self, rng: np.random.Generator) -> RigidTransform:
        """Pose of the real tool in the tool as modelled; draws six numbers."""
        shift, turn = self.shift * rng.standard_normal(3), self.turn * rng.standard_normal(3)
        return RigidTransform(RotationMatrix(Rotation.from_rotvec(turn).as_matrix()), shift)
