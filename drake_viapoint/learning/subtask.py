"""One goal on the way: which components to change, which result to bring about, and how boldly."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.gain import Gain
from drake_viapoint.learning.jacobian import KeptJacobian


@dataclass(frozen=True)
class Subtask:
    """A subtask of a sequential movement (section 2).

    Attributes:
        name: What a person calls it.
        control: Components of the via-points that may be changed: the control variable S.
        task_variable: Name of the result T in the outcomes told to the learner.
        perturbation: Change of each component in its exploration trials, in its own units.
        gain: Diagonal of B.
        regularization: lambda of the generalised inverse, for a Jacobian measured in tolerances a
            perturbation; so it has no unit. A direction of S in which one perturbation moves T by
            less than the root of it, in tolerances, is hardly used.
        reached: The next subtask starts once the norm of Td - T is below this [units of T].
        gate: A trial counts for this subtask only if the preceding subtask's norm of Td - T is
            below this; otherwise it serves the preceding one.
        jacobian: What becomes of the Jacobian once explored.
        one_sided: Explore by one trial a component, compared with the trial explored around,
            instead of by one up and one down.
        tolerance: What may be missing of each task variable, in its own units; one value for all
            or one for each. The inverse weighs task variables by it.
    """

    name: str
    control: tuple[str, ...]  # (k,)
    task_variable: str
    perturbation: tuple[float, ...]  # (k,)
    gain: Gain
    regularization: float
    reached: float
    gate: float = np.inf
    jacobian: KeptJacobian = field(default_factory=KeptJacobian)
    one_sided: bool = False
    tolerance: tuple[float, ...] | float = 1.0

    def __post_init__(self) -> None:
        if not self.control or len(self.control) != len(self.perturbation):
            raise LearningError(
                f"subtask {self.name!r} has {len(self.control)} components and "
                f"{len(self.perturbation)} perturbations; it needs one of each, at least one"
            )
        if not np.all(np.isfinite(self.tolerance) & (np.asarray(self.tolerance) > 0)):
            raise LearningError(
                f"subtask {self.name!r}: tolerances must be positive, got {self.tolerance}"
            )
        for component, size in zip(self.control, self.perturbation, strict=True):
            if not (np.isfinite(size) and size != 0):
                raise LearningError(
                    f"subtask {self.name!r}: the perturbation of {component} must be finite and "
                    f"not zero, got {size:g}"
                )
