"""What each component of the via-points does to a task variable (section 2.2).

All columns of a full Jacobian, one component moved at a time, and their norms (Eqs. 5, 6 and 8). A
movement from which the task variable cannot be read leaves a gap that has a name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.motion.via_points import ViaPoints


@dataclass(frozen=True)
class ComponentEffects:
    """Columns of a full Jacobian, counted in perturbations.

    Attributes:
        task_variable: What changes.
        components: Names of the n components.
        columns: Change of the task variable a perturbation of each component (m, n) [units of T];
            NaN where there is a gap.
        gaps: Why a component has no column, by its name.
    """

    task_variable: str
    components: tuple[str, ...]
    columns: NDArray[np.float64]
    gaps: Mapping[str, str]

    @property
    def norms(self) -> NDArray[np.float64]:
        """Norm of each column (n,) [units of T]; NaN where there is a gap."""
        norms: NDArray[np.float64] = np.linalg.norm(self.columns, axis=0)
        return norms


def component_effects(
    execute: Callable[[ViaPoints], Outcome],
    via_points: ViaPoints,
    perturbation: Mapping[str, float],
    task_variables: tuple[str, ...],
    on_trial: Callable[[], None] | None = None,
) -> dict[str, ComponentEffects]:
    """Move each component up and down, and see what becomes of the task variables.

    Args:
        execute: Executes via-points; what comes of it is an outcome, whatever it is.
        via_points: Around which to look.
        perturbation: By how much to move a component, by the name of its dimension.
        task_variables: Names of those to look at; each must be reached unmoved.
        on_trial: Called after each trial, two a component and one more.

    Returns:
        The effects on each task variable, by its name.

    Raises:
        LearningError: A dimension has no perturbation, or the unmoved movement does not reach a
            task variable.
    """
    lacking = [name for name in via_points.names if not perturbation.get(name, 0.0) > 0]
    if lacking:
        raise LearningError(f"no positive perturbation for {', '.join(lacking)}")
    done = on_trial or (lambda: None)
    unmoved = execute(via_points)
    done()
    sizes = {}
    for name in task_variables:
        value = unmoved.realized.get(name)
        if value is None:
            raise LearningError(f"the movement to look around does not reach {name}")
        sizes[name] = value.size
    columns: dict[str, list[NDArray[np.float64]]] = {name: [] for name in task_variables}
    gaps: dict[str, dict[str, str]] = {name: {} for name in task_variables}
    for component in via_points.components:
        size = perturbation[component.rstrip("0123456789")]
        ways = {}
        for change in (size, -size):
            ways[change] = execute(via_points.moved([component], [change]))
            done()
        for name in task_variables:
            ends = {change: end.realized.get(name) for change, end in ways.items()}
            lost = [change for change, end in ends.items() if not _is_there(end)]
            up, down = ends.values()
            if lost or up is None or down is None:
                moved = " and ".join(f"{change:+.4g}" for change in lost)
                gaps[name][component] = f"{component} moved by {moved} does not reach {name}"
                columns[name].append(np.full(sizes[name], np.nan))
            else:
                columns[name].append((up - down) / 2)
    return {
        name: ComponentEffects(
            name, via_points.components, np.stack(columns[name], axis=1), gaps[name]
        )
        for name in task_variables
    }


def _is_there(value: NDArray[np.float64] | None) -> bool:
    return value is not None and bool(np.all(np.isfinite(value)))
