"""The racket as a moving arm holds it, tightly or loosely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from pydrake.math import RigidTransform

from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.arm_motion import ArmMotion
from drake_viapoint.tasks.racket import RacketStates


@dataclass(frozen=True)
class HeldRacket:
    """The racket as the arm's model has it.

    Attributes:
        arm: The arm, with the racket for a tool.
        motion: How its joints move.
    """

    arm: Arm
    motion: ArmMotion

    @property
    def start(self) -> float:
        """Beginning of the motion [s]."""
        return self.motion.start

    @property
    def end(self) -> float:
        """End of the motion [s]."""
        return self.motion.end

    def __call__(self, times: ArrayLike) -> RacketStates:
        """See ``RacketMotion``."""
        states = self.motion.tool(self.arm, times)
        return RacketStates(*(np.array(field) for field in zip(*states, strict=True)))


@dataclass(frozen=True)
class LooseRacket(HeldRacket):
    """The same in a mount that has given way.

    Attributes:
        moved: Pose of the real racket in the racket as the arm's model has it.
    """

    moved: RigidTransform

    def __call__(self, times: ArrayLike) -> RacketStates:
        """See ``RacketMotion``."""
        modelled = super().__call__(times)
        position = modelled.position + modelled.rotation @ self.moved.translation()
        return RacketStates(
            modelled.rotation @ self.moved.rotation().matrix(),
            position,
            modelled.angular_velocity,
            modelled.point_velocity(position),
        )
