"""Choosing the components of a control variable by what they do (sections 2.2.1 and 2.2.2).

For the first subtask, those that do most to its task variable. For one that follows, those that do
most to its own for what they do to the one before, so that learning it does not undo the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.component_effects import ComponentEffects


@dataclass(frozen=True)
class ComponentChoice:
    """A line of the table that says why.

    Attributes:
        component: Its name.
        column: Its number in the full Jacobian, from 1 as in the paper.
        effect: On the task variable [its units a perturbation]; NaN at a gap.
        disturbance: On that of the preceding subtask; NaN at a gap, 0 if there is none.
        score: By which it is ranked: the effect, or its ratio to the disturbance.
        rank: From 1; 0 at a gap.
        chosen: Whether it belongs to the control variable.
        why: In words.
    """

    component: str
    column: int
    effect: float
    disturbance: float
    score: float
    rank: int
    chosen: bool
    why: str


@dataclass(frozen=True)
class Selection:
    """A control variable and the table it came from.

    Attributes:
        control: Names of the chosen components, in the order of their columns.
        table: All components, in the order of their columns.
    """

    control: tuple[str, ...]
    table: tuple[ComponentChoice, ...]


def select_components(
    effects: ComponentEffects,
    number: int,
    *,
    preceding: ComponentEffects | None = None,
    least_effect: float = 0.0,
) -> Selection:
    """Choose the components that do most, by norm or by ratio.

    Args:
        effects: On the subtask's own task variable.
        number: How many to choose.
        preceding: Effects on the preceding subtask's task variable: choose by the ratio of the
            norms, Eq. 8 over Eq. 5, instead of by the norm alone.
        least_effect: Components whose effect is below this share of the largest are not chosen: a
            ratio of two nothings may be large.

    Raises:
        LearningError: Fewer components than asked for have what it takes, or the two effects are of
            other components.
    """
    if preceding is not None and preceding.components != effects.components:
        raise LearningError("both effects must be of the same components")
    norms = effects.norms
    disturbance = np.zeros_like(norms) if preceding is None else preceding.norms
    with np.errstate(divide="ignore", invalid="ignore"):
        scores = norms if preceding is None else norms / disturbance
    strong = norms >= least_effect * np.nanmax(norms)
    ranks = _ranks(scores)
    fit = np.flatnonzero(strong & (ranks > 0))
    if number < 1 or fit.size < number:
        raise LearningError(
            f"{fit.size} of {norms.size} components do enough to {effects.task_variable} to be "
            f"chosen, {number} are asked for"
        )
    chosen = set(fit[np.argsort(ranks[fit])][:number].tolist())
    by = "norm" if preceding is None else "ratio"
    table = []
    for index, component in enumerate(effects.components):
        gap = effects.gaps.get(component) or (preceding and preceding.gaps.get(component))
        if gap:
            why = f"no {by}: {gap}"
        elif not strong[index]:
            why = f"effect below {least_effect:g} of the largest"
        else:
            why = f"{by} ranks {ranks[index]} of {int(np.sum(ranks > 0))}"
        table.append(
            ComponentChoice(
                component,
                index + 1,
                float(norms[index]),
                float(disturbance[index]),
                float(scores[index]),
                int(ranks[index]),
                index in chosen,
                why,
            )
        )
    return Selection(tuple(line.component for line in table if line.chosen), tuple(table))


def _ranks(scores: NDArray[np.float64]) -> NDArray[np.int_]:
    """1 for the largest score and so on; 0 for none."""
    ranks = np.zeros(scores.size, dtype=np.int_)
    there = np.flatnonzero(~np.isnan(scores))
    order = there[np.argsort(-scores[there], kind="stable")]
    ranks[order] = np.arange(1, order.size + 1)
    return ranks
