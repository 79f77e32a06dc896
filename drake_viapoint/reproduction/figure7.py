"""Our Fig. 7: the learning curve, with the trials made for the Jacobians marked below it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

_MARKS = {
    ("exploration", "throw"): ("*", "exploration of $J_H$"),
    ("exploration", "strike"): ("P", "exploration of $J_G$"),
    ("learning", "throw"): ("x", "learning subtask 1"),
    ("learning", "strike"): ("o", "learning subtask 2"),
    ("repeat", "strike"): ("s", "repeat"),
}


def draw(
    records: Sequence[Mapping[str, Any]], meeting_tolerance: float, landing_tolerance: float
) -> Figure:
    """Draw both distances over the trials, and what each trial was for.

    Args:
        records: Lines of a run.
        meeting_tolerance: Of a success [m].
        landing_tolerance: Of a success [m].
    """
    trials = np.array([record["trial"] for record in records])
    d = np.array([_number(record["d"]) for record in records])
    landing = np.array([_number(record.get("landing_error")) for record in records])
    figure = Figure(figsize=(8, 4.6), layout="constrained")
    curve, purposes = figure.subplots(2, 1, sharex=True, height_ratios=[4, 1])
    curve.plot(trials, d, "x-", color="k", linewidth=0.7, label="ball to racket centre, $d$")
    curve.plot(
        trials,
        landing,
        "o-",
        color="tab:blue",
        markerfacecolor="none",
        linewidth=0.7,
        label="ball to goal, $|T_{Gd} - T_G|$",
    )
    curve.axhline(meeting_tolerance, color="k", linestyle=":", linewidth=0.8)
    curve.axhline(landing_tolerance, color="tab:blue", linestyle=":", linewidth=0.8)
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
    purposes.set_xlabel("trial (dotted: what a success must stay below)")
    return figure


def _number(value: float | None) -> float:
    return np.nan if value is None else value
