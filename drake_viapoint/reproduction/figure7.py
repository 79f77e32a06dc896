"""Our Fig. 7: the learning curve, with the trials made for the Jacobians marked below it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from drake_viapoint.reproduction.robot_runs import what_happened

_MARKS = {
    ("exploration", "throw"): ("*", "exploration of $J_H$"),
    ("exploration", "strike"): ("P", "exploration of $J_G$"),
    ("learning", "throw"): ("x", "learning subtask 1"),
    ("learning", "strike"): ("o", "learning subtask 2"),
    ("repeat", "strike"): ("s", "repeat"),
}


def draw(
    records: Sequence[Mapping[str, Any]],
    meeting_tolerance: float,
    landing_tolerance: float,
    *,
    runs: Sequence[Sequence[Mapping[str, Any]]] = (),
) -> Figure:
    """Draw both distances over the trials, what each trial was for, and the curves of more runs.

    Where cameras told the learner, what they saw stands beside what happened.

    Args:
        records: Lines of a run.
        meeting_tolerance: Of a success [m].
        landing_tolerance: Of a success [m].
        runs: Lines of all runs whose curves stand below.
    """
    trials = np.array([record["trial"] for record in records])
    height = 4.6 + (3.4 if runs else 0.0)
    figure = Figure(figsize=(8, height), layout="constrained")
    ratios = [4.0, 1.0, *((1.7, 1.7) if runs else ())]
    panels = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios)
    curve, purposes = panels[:2]
    for (name, mark, color, label, symbol), bound in zip(
        _CURVES, (meeting_tolerance, landing_tolerance), strict=True
    ):
        curve.plot(
            trials,
            _numbers(records, name),
            mark,
            color=color,
            markerfacecolor="none",
            linewidth=0.7,
            label=label,
        )
        if any("happened" in record for record in records):
            seen = [np.nan if r.get(name) is None else r[name] for r in records]
            curve.plot(
                trials, seen, ".", color=color, alpha=0.4, label=f"{symbol}, as seen by the cameras"
            )
        curve.axhline(bound, color=color, linestyle=":", linewidth=0.8)
    curve.set_ylabel("distance [m]")
    curve.set_ylim(bottom=0)
    curve.legend(fontsize=8)
    names = list(_MARKS)
    for row, key in enumerate(names):
        mark, _ = _MARKS[key]
        chosen = [r["trial"] for r in records if (r["purpose"], r["subtask"]) == key]
        purposes.plot(chosen, [row] * len(chosen), mark, color="0.2", markersize=4)
    purposes.set_yticks(range(len(names)), [_MARKS[key][1] for key in names], fontsize=7)
    purposes.set_ylim(len(names) - 0.5, -0.5)
    for panel, (name, _, color, label, _), bound in zip(
        panels[2:], _CURVES, (meeting_tolerance, landing_tolerance), strict=False
    ):
        for lines in runs:
            numbers = [record["trial"] for record in lines]
            panel.plot(numbers, _numbers(lines, name), color=color, linewidth=0.5, alpha=0.5)
        panel.axhline(bound, color=color, linestyle=":", linewidth=0.8)
        panel.set_ylim(bottom=0)
        panel.set_ylabel("distance [m]")
        panel.set_title(f"{label}, {len(runs)} runs", fontsize=8)
    panels[-1].set_xlabel("trial (dotted: what a success must stay below)")
    return figure


_CURVES = (
    ("d", "x-", "k", "ball to racket centre, $d$", "$d$"),
    ("landing_error", "o-", "tab:blue", "ball to goal, $|T_{Gd} - T_G|$", "$|T_{Gd} - T_G|$"),
)


def _numbers(records: Sequence[Mapping[str, Any]], name: str) -> list[float]:
    """What happened, trial by trial; NaN where nothing came of it."""
    values = [what_happened(record).get(name) for record in records]
    return [np.nan if value is None else float(value) for value in values]
