"""What nobody controls: the struck ball never flies quite as the movement says (section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class VelocityFactors(NamedTuple):
    """What one trial's disturbance makes of the ball's velocity, component by component."""

    release: NDArray[np.float64]  # (3,) as it leaves the cup
    bounce: NDArray[np.float64]  # (3,) as it leaves the face


@dataclass(frozen=True)
class Disturbance:
    """Scales each component of the ball's velocity by a factor of its own, drawn for every trial.

    Attributes:
        release: Factors at the release lie within 1 - this and 1 + this, evenly.
        bounce: The same after the bounce off the racket.
    """

    release: float
    bounce: float

    def draw(self, seed: int) -> VelocityFactors:
        """The factors of the trial with this seed; exactly 1 where nothing is disturbed.

        All are drawn in every trial, so that the bounce's do not depend on the release's range.
        """
        draws = np.random.default_rng(seed).uniform(-1.0, 1.0, size=(2, 3))
        return VelocityFactors(1.0 + self.release * draws[0], 1.0 + self.bounce * draws[1])
