"""How a scenario says what becomes of an explored Jacobian; every task has the same choice."""

from dataclasses import dataclass, field

from drake_viapoint.learning.jacobian import ExploredJacobian, KeptJacobian, RecordedJacobian
from drake_viapoint.tasks.scenario import require, require_not_negative, require_one_of

WAYS = ("fixed", "manual", "recorded")
"""Ways to keep a Jacobian, from the upper to the lower panel of Fig. 13."""


@dataclass
class JacobianScenario:
    """A way to keep a Jacobian, and what the ways need."""

    way: str = "fixed"
    """fixed: kept as first explored. manual: explored again at given trials. recorded: estimated
    anew from the last trials' differences before every step (Eq. 12)."""
    explored_again_at: list[int] = field(default_factory=lambda: [15, 29, 43, 57])
    """Trials around which the manual way explores again: after every eight trials of learning, if
    one exploration takes six."""
    window: int = 12
    """K of Eqs. 10 and 11: the recorded way looks at so many differences."""
    regularization: float = 10.0
    """lambda_X of Eq. 12, in perturbations squared: the smaller the last differences are against
    its root, about 3 perturbations, the smaller the estimate and so the larger the steps
    [assumed]."""

    def validate(self, key: str) -> None:
        """Check every value against its bounds.

        Args:
            key: Where it stands in the scenario.

        Raises:
            ScenarioError: Names the value and the bound.
        """
        require_one_of(f"{key}.way", self.way, WAYS)
        for trial in self.explored_again_at:
            require(trial >= 1, f"{key}.explored_again_at", trial, "must be trials, from 1 on")
        require(self.window >= 1, f"{key}.window", self.window, "must be at least 1")
        require_not_negative(f"{key}.regularization", self.regularization)

    def kept(self) -> KeptJacobian:
        """What the learner is given."""
        if self.way == "manual":
            return ExploredJacobian(tuple(self.explored_again_at))
        if self.way == "recorded":
            return RecordedJacobian(self.window, self.regularization)
        return KeptJacobian()
