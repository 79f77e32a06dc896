"""Our Fig. 10: learning curves of the disturbed serve, a panel a condition, over all its runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import NDArray

from drake_viapoint.reproduction.disturbed_serve import check_columns
from drake_viapoint.reproduction.run_curves import LEARNED, REFUSED, curves, runs_of, stages

_D = "k", "ball to racket centre, $d$"
_LANDING = "tab:blue", "ball to goal, $|T_{Gd} - T_G|$"
_STAGES = {
    "exploring J_H": ("0.75", "exploring $J_H$"),
    "learning subtask 1": ("0.45", "learning subtask 1"),
    "exploring J_G": ("#b8d4ec", "exploring $J_G$"),
    "learning subtask 2": ("tab:blue", "learning subtask 2"),
    LEARNED: ("tab:green", "learned, repeated"),
    REFUSED: ("tab:red", "out of the arm's reach"),
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
        d = curves(runs, "d", trials)
        landing = curves(runs, "landing_error", trials)
        landing[np.isnan(landing) & ~np.isnan(d)] = np.inf  # farther off than any that landed
        _draw_curves(curve, d, *_D)
        _draw_curves(curve, landing, *_LANDING)
        curve.axhline(meeting_tolerance, color="k", linestyle=":", linewidth=0.9)
        curve.axhline(landing_tolerance, color="tab:blue", linestyle=":", linewidth=0.9)
        curve.set_ylim(0, _FARTHEST)
        curve.set_ylabel("distance [m]")
        learned = runs["learned_at"].notna().mean()
        title = (titles or {}).get(condition, condition)
        curve.set_title(f"{title}: {learned:.0%} of {len(runs)} runs learned", fontsize=10)
        _draw_stages(strip, runs, trials)
    panels[0].legend(fontsize=8, loc="upper right", ncols=2)
    handles, labels = panels[1].get_legend_handles_labels()
    figure.legend(handles, labels, fontsize=7, loc="outside lower center", ncols=len(labels))
    panels[-1].set_xlabel(
        "trial (thin: single runs, thick: median, band: quartiles; dotted: what a success must "
        "stay below)"
    )
    panels[-1].set_xlim(1, trials)
    return figure


def _draw_curves(ax: Any, values: NDArray[np.float64], colour: str, label: str) -> None:
    """Single runs, median and quartiles of the runs that made each trial."""
    number = np.arange(1, values.shape[1] + 1)
    ax.plot(number, values.T, color=colour, lw=0.3, alpha=min(0.6, 0.12 + 2.0 / len(values)))
    made = ~np.all(np.isnan(values), axis=0)
    low, median, high = np.full((3, number.size), np.nan)
    low[made], median[made], high[made] = np.nanpercentile(
        values[:, made], [25, 50, 75], axis=0, method="nearest"
    )
    median[np.isinf(median)] = np.nan  # a gap
    high = np.minimum(high, 10 * _FARTHEST)
    ax.fill_between(number, low, high, where=np.isfinite(low), color=colour, alpha=0.25, lw=0)
    ax.plot(number, median, color=colour, linewidth=1.8, label=label)


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
