"""Which components move the ball: section 2.2 for a run of the serve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drake_viapoint.errors import RunFolderError
from drake_viapoint.learning.component_effects import ComponentEffects, component_effects
from drake_viapoint.learning.selection import Selection, select_components
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction import figure9
from drake_viapoint.reproduction.style import save
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.runs.learning_run import recorded_via_points
from drake_viapoint.runs.run_folder import read_trials
from drake_viapoint.runs.task_run import read_scenario
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import STRIKE, THROW

TABLES = tuple(f"components_{name}.csv" for name in ("throw", "strike_norm", "strike_ratio"))
"""Files of the tables of why: S_H by norm, S_G by norm, S_G by ratio."""

_THROW, _STRIKE = 6, 3  # components of the paper's S_H and S_G


class ComponentsStudied(NamedTuple):
    """What was found, said of it, and where it is."""

    found: ServeComponents
    lines: list[str]
    where: str


@dataclass(frozen=True)
class ServeComponents:
    """What each component does to throw and strike, and which are chosen.

    Attributes:
        h: Effects on T_H around the unlearned movement (Eq. 5).
        g: Effects on T_G once the throw is learned (Eq. 8).
        disturbance: Effects on T_H there.
        throw: Chosen for subtask 1, by norm.
        by_norm: Chosen for subtask 2 by norm, which the paper says does not converge.
        by_ratio: Chosen for subtask 2 by ratio.
    """

    h: ComponentEffects
    g: ComponentEffects
    disturbance: ComponentEffects
    throw: Selection
    by_norm: Selection
    by_ratio: Selection


def first_meeting(records: Sequence[dict[str, Any]], reached: float) -> dict[str, Any] | None:
    """The first trial whose ball meets the face's centre, within so much [m], and lands."""
    for record in records:
        if record["d"] is not None and record["d"] < reached and record[STRIKE] is not None:
            return record
    return None


def trials_of(task: ServeTask) -> int:
    """How many trials ``serve_components`` makes."""
    return 2 * (1 + 2 * len(task.via_points.components))


def serve_components(
    task: ServeTask,
    first: ViaPoints,
    thrown: ViaPoints,
    *,
    position: float,
    angle: float,
    on_trial: Callable[[], None] | None = None,
) -> ServeComponents:
    """Move every component of a serve, before learning and once the throw is learned.

    Args:
        task: The serve.
        first: Its via-points before learning.
        thrown: Its via-points when the face's centre first meets the ball.
        position: Perturbation of x, y and z [m].
        angle: Perturbation of phi, theta and psi [rad].
        on_trial: Called after each trial.

    Raises:
        LearningError: Too few components leave a ball to be seen.
    """
    sizes = dict.fromkeys(("x", "y", "z"), position) | dict.fromkeys(("phi", "theta", "psi"), angle)

    def execute(via_points: ViaPoints) -> Any:
        return task.outcome(task.execute(via_points, 0).record())

    h = component_effects(execute, first, sizes, (THROW,), on_trial)[THROW]
    later = component_effects(execute, thrown, sizes, (THROW, STRIKE), on_trial)
    g, disturbance = later[STRIKE], later[THROW]
    return ServeComponents(
        h,
        g,
        disturbance,
        select_components(h, _THROW),
        select_components(g, _STRIKE),
        select_components(g, _STRIKE, preceding=disturbance),
    )


def study_components(
    run: Path,
    out: Path,
    *,
    position: float = 0.05,
    angle: float = float(np.radians(5.0)),
    on_trial: Callable[[], None] | None = None,
) -> ComponentsStudied:
    """Draw our Fig. 9 from a run of the serve, and write the tables of why.

    Args:
        run: Its folder; the throw must have been learned.
        out: Folder of the picture and the tables.
        position: Perturbation of x, y and z [m].
        angle: Perturbation of phi, theta and psi [rad].
        on_trial: Called after each trial.

    Returns:
        What was found, with lines that say what was chosen and where it is.

    Raises:
        RunFolderError: It is no run of the serve, or its throw was not learned.
        ViapointError: Something cannot be written.
    """
    scenario = read_scenario(run)
    if scenario.task != "serve":
        raise RunFolderError(run, f"holds a run of the {scenario.task}, not of the serve")
    task = ServeTask(scenario)
    reached = scenario.learning.throw.reached
    met = first_meeting(read_trials(run), reached)
    if met is None:
        raise RunFolderError(run, f"has no trial that lands with d below {reached:g} m")
    thrown = recorded_via_points(met, task.via_points.names)
    found = serve_components(
        task, task.via_points, thrown, position=position, angle=angle, on_trial=on_trial
    )
    perturbation = f"{position:g} m, {np.degrees(angle):g}°"
    picture = save(
        figure9.draw(
            found.h, found.g, found.disturbance, found.throw, found.by_norm, found.by_ratio,
            perturbation,
        ),
        out / "figure9.png",
    )  # fmt: skip
    for name, selection in zip(TABLES, (found.throw, found.by_norm, found.by_ratio), strict=True):
        write_table(selection.table, out / name)
    lines = [
        f"S_H by norm: {' '.join(found.throw.control)} (the paper: x3 y3 z3 x4 y4 z4)",
        f"S_G by norm: {' '.join(found.by_norm.control)}",
        f"S_G by ratio: {' '.join(found.by_ratio.control)} (the paper: phi6 phi7 psi7)",
        f"gaps: {len(found.h.gaps)} in h, {len(found.g.gaps)} in g"
        + (f", the first: {next(iter(found.g.gaps.values()))}" if found.g.gaps else ""),
    ]
    where = f"picture in {picture}, tables in {out}/components_*.csv"
    return ComponentsStudied(found, lines, where)
