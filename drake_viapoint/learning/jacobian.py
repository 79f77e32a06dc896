"""What becomes of an explored Jacobian while learning goes on (section 3.1).

A way to keep a Jacobian is a small class: override one or both methods of ``KeptJacobian``.
Changes of S are counted in perturbations, one unit a component, so that centimetres and degrees
weigh the same and a Jacobian has the units of T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.generalized_inverse import generalized_inverse


class Observation(NamedTuple):
    """What one trial says of a subtask."""

    control: NDArray[np.float64]  # (k,) S, in perturbations
    error: NDArray[np.float64]  # (m,) Td - T


@dataclass(frozen=True)
class KeptJacobian:
    """The Jacobian as first explored, for ever; and the base of all other ways."""

    def explores_again(self, trials: int, explored_at: int) -> bool:
        """Whether to explore anew, around the via-points of the trial just told.

        Args:
            trials: Trials told so far.
            explored_at: Of these, how many when the last exploration was complete.
        """
        del trials, explored_at
        return False

    def revised(
        self, jacobian: NDArray[np.float64], observations: Sequence[Observation]
    ) -> NDArray[np.float64]:
        """The Jacobian for the next step.

        Args:
            jacobian: (m, k) of the last step, or as just explored [units of T a perturbation].
            observations: Of all trials that reached T, exploration included, in their order.
        """
        del observations
        return jacobian


@dataclass(frozen=True)
class ExploredJacobian(KeptJacobian):
    """Explored anew where a person says so (middle panel of Fig. 13).

    Attributes:
        at: Trials around whose via-points to explore; where one of them is itself an exploration,
            the first trial after it.
    """

    at: tuple[int, ...]

    def explores_again(self, trials: int, explored_at: int) -> bool:
        """See ``KeptJacobian``."""
        return any(explored_at < trial <= trials for trial in self.at)


@dataclass(frozen=True)
class RecordedJacobian(KeptJacobian):
    """Estimated from the trials already made: J = (X# T)^T (Eqs. 10 to 12).

    Row j of X is the difference of S between two trials that follow each other, row j of T that of
    the task variable.

    Attributes:
        window: K, differences looked at: the last ones.
        regularization: lambda of X#, in perturbations squared. The larger it is against the
            differences, the smaller the estimate, and so the larger the steps.

    Raises:
        LearningError: The window is empty or the regularization negative.
    """

    window: int
    regularization: float

    def __post_init__(self) -> None:
        if self.window < 1:
            raise LearningError(f"a window needs at least 1 difference, got {self.window}")
        if not self.regularization >= 0:
            raise LearningError(
                f"the regularization must not be negative, got {self.regularization:g}"
            )

    def revised(
        self, jacobian: NDArray[np.float64], observations: Sequence[Observation]
    ) -> NDArray[np.float64]:
        """See ``KeptJacobian``."""
        recent = observations[-self.window - 1 :]
        if len(recent) < 2:
            return jacobian
        changes = np.diff([observation.control for observation in recent], axis=0)  # (K, k)
        # the error falls as T rises
        results = -np.diff([observation.error for observation in recent], axis=0)  # (K, m)
        transposed: NDArray[np.float64] = (
            generalized_inverse(changes, self.regularization) @ results
        )
        return transposed.T
