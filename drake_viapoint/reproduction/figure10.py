"""Our Fig. 10: learning curves of the disturbed serve, a panel a condition, over all its runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from drake_viapoint.reproduction.disturbed_serve import check_columns
from drake_viapoint.reproduction.run_curves import curves, runs_of, stages

_CURVES = {
    "d": ("k", "ball to racket centre, $d$"),
    "landing_error": ("tab:blue", "ball to goal, $|T_{Gd} - T_G|$"),
}
_STAGES = {
    "exploring J_H": ("0.75", "exploring $J_H$"),
    "learning subtask 1": ("0.45", "learning subtask 1"),
    "exploring J_G": ("#b8d4ec", "exploring $J_G$"),
    "learning subtask 2": ("tab:blue", "learning subtask 2"),
    "learned": ("tab:green", "learned, repeated"),
}
_FARTHEST = 0.8  # [m] shown


def draw(
    table: pd.DataFrame,
    trials: int,
    meeting_tolerance: float,
    landing_tolerance: float,
    titles: Mapping[str, str] | None = None,
) -> Figure:
    """Draw single runs, their median and quartiles, and below what their trials were for.

    A run that was learned goes on with repeats of its movement.

    Args:
        table: Of a sweep of the serve.
        trials: How many to show.
        meeting_tolerance: Of a success [m].
        landing_tolerance: Of a success [m].
        titles: What to write over a condition's panel; its name if not given.

    Raises:
        ViapointError: The table lacks a column.
    """
    check_columns(table)
    conditions = list(table["condition"].unique())
    figure = Figure(figsize=(8.5, 3.6 * len(conditions)), layout="constrained")
    panels = figure.subplots(
        2 * len(conditions), 1, sharex=True, height_ratios=[5, 1] * len(conditions)
    )
    for number, condition in enumerate(conditions):
        curve, strip = panels[2 * number : 2 * number + 2]
        runs = runs_of(table, condition)
        for field, (colour, label) in _CURVES.items():
            _draw_curves(curve, curves(runs, field, trials), colour, label)
        curve.axhline(meeting_tolerance, color="k", linestyle=":", linewidth=0.9)
        curve.axhline(landing_tolerance, color="tab:blue", linestyle=":", linewidth=0.9)
        curve.set_ylim(0, _FARTHEST)
        curve.set_ylabel("distance [m]")
        learned = runs["learned_at"].notna().mean()
        title = (titles or {}).get(condition, condition)
        curve.set_title(f"{title}: {learned:.0%} of {len(runs)} runs learned", fontsize=10)
        _draw_stages(strip, runs, trials)
    panels[0].legend(fontsize=8, loc="upper right", ncols=2)
    panels[1].legend(fontsize=6, loc="center right", ncols=5)
    panels[-1].set_xlabel(
        "trial (thin: single runs, thick: median, band: quartiles; dotted: what a success must "
        "stay below)"
    )
    panels[-1].set_xlim(1, trials)
    return figure


def _draw_curves(ax: Any, values: Any, colour: str, label: str) -> None:
    number = np.arange(1, values.shape[1] + 1)
    ax.plot(number, values.T, color=colour, linewidth=0.3, alpha=0.15)
    # a ball that did not land is farther off than any that did
    low, median, high = np.percentile(
        np.where(np.isnan(values), np.inf, values), [25, 50, 75], axis=0, method="nearest"
    )
    shown = np.isfinite(median)
    ax.fill_between(
        number[shown],
        low[shown],
        np.minimum(high[shown], 10 * _FARTHEST),
        color=colour,
        alpha=0.25,
        linewidth=0,
    )
    ax.plot(number[shown], median[shown], color=colour, linewidth=1.8, label=label)


def _draw_stages(ax: Any, runs: pd.DataFrame, trials: int) -> None:
    shares = stages(runs, tuple(_STAGES), trials)
    number = np.arange(1, trials + 1)
    ax.stackplot(
        number,
        shares,
        colors=[colour for colour, _ in _STAGES.values()],
        labels=[label for _, label in _STAGES.values()],
        step="mid",
    )
    ax.set_ylim(0, 1)
    ax.set_ylabel("runs", fontsize=8)
    ax.set_yticks([0, 1], ["0", "all"], fontsize=7)
