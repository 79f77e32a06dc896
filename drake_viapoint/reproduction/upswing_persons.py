"""Pictures of the upswing learned from many virtual persons: every curve, and how many succeed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from drake_viapoint.reproduction.figure13 import TITLES
from drake_viapoint.reproduction.upswing_study import MAX_TRIALS, PersonRun, WayResult

EXECUTION_TITLES = {
    "recurrence": "the paper's equation, steps of 1/60 s",
    "plant": "Drake's plant, continuous time, hand as commanded",
}
_COLOURS = {"fixed": "tab:red", "manual": "tab:orange", "recorded": "tab:blue"}
_SMALLEST, _LARGEST = 1e-2, 1e2  # of the error shown, in tolerances


def draw_curves(
    runs: Sequence[PersonRun], angle_tolerance: float, speed_tolerance: float
) -> Figure:
    """Draw every run's learning curve behind the median, a panel for each way and execution.

    Args:
        runs: Of the study.
        angle_tolerance: Of a success [rad].
        speed_tolerance: Of a success [rad/s].
    """
    ways, executions = _kinds(runs)
    figure = Figure(figsize=(4.6 * len(executions) + 0.6, 8), layout="constrained")
    axes = figure.subplots(len(ways), len(executions), sharex=True, sharey=True, squeeze=False)
    for row, way in enumerate(ways):
        for column, execution in enumerate(executions):
            chosen = [run for run in runs if (run.way, run.execution) == (way, execution)]
            tolerance = np.array([angle_tolerance, speed_tolerance])
            errors = np.array([np.max(np.abs(run.error) / tolerance, axis=1) for run in chosen])
            ax = axes[row][column]
            _draw_errors(ax, np.where(np.isnan(errors), _LARGEST, errors))
            ax.set_title(f"{TITLES[way]}\n{EXECUTION_TITLES[execution]}", fontsize=9)
    for ax in axes[:, 0]:
        ax.set_ylabel("error, in tolerances")
    for ax in axes[-1]:
        ax.set_xlabel("trial")
    axes[0][0].legend(fontsize=7, loc="upper right")
    number = len({run.person for run in runs})
    figure.suptitle(
        f"{number} virtual persons (synthetic): the larger of "
        rf"$|\theta-\theta_d|$ / {angle_tolerance:g} rad and "
        rf"$|\omega-\omega_d|$ / {speed_tolerance:g} rad/s",
        fontsize=10,
    )
    return figure


def draw_success(runs: Sequence[PersonRun], results: Sequence[WayResult]) -> Figure:
    """Draw how many persons' upswings have succeeded after so many trials, and the table."""
    _, executions = _kinds(runs)
    figure = Figure(figsize=(9, 5.6), layout="constrained")
    panels = figure.subplot_mosaic(
        [list(executions), ["table"] * len(executions)], height_ratios=[1.6, 1]
    )
    trials = np.arange(1, MAX_TRIALS + 1)
    for execution in executions:
        ax = panels[execution]
        for way, colour in _COLOURS.items():
            chosen = [run for run in runs if (run.way, run.execution) == (way, execution)]
            if not chosen:
                continue
            firsts = np.array([r.first_success or np.inf for r in chosen])
            share = np.mean(firsts[:, None] <= trials, axis=0)
            ax.step(trials, 100 * share, where="post", color=colour, label=TITLES[way])
        for mark in (30, 60):
            ax.axvline(mark, color="0.8", linewidth=0.8, zorder=0)
        ax.axvspan(1, 7, color="0.94", zorder=0)
        ax.set_title(EXECUTION_TITLES[execution], fontsize=10)
        ax.set_xlabel("trial (grey: the first exploration)")
        ax.set_ylabel("persons whose upswing has succeeded [%]")
        ax.set_ylim(0, 101)
        ax.legend(fontsize=7, loc="lower right")
    _draw_table(panels["table"], results)
    return figure


def _draw_errors(ax: Axes, errors: NDArray[np.float64]) -> None:
    trials = np.arange(1, errors.shape[1] + 1)
    shown = np.clip(errors, _SMALLEST, _LARGEST)
    ax.plot(trials, shown.T, color="0.6", linewidth=0.3, alpha=0.35, zorder=0)
    low, median, high = np.percentile(shown, [25, 50, 75], axis=0)
    ax.fill_between(trials, low, high, color="tab:blue", alpha=0.3, linewidth=0, label="quartiles")
    ax.plot(trials, median, color="tab:blue", linewidth=1.8, label="median")
    ax.axhline(1.0, color="k", linestyle=":", linewidth=0.9, label="a success is below")
    ax.set_yscale("log")
    ax.set_ylim(_SMALLEST, _LARGEST)


def _draw_table(ax: Axes, results: Sequence[WayResult]) -> None:
    ax.set_axis_off()
    heads = [
        "execution",
        "Jacobian",
        "within 30",
        "held at 30",
        "within 60",
        "held at 60",
        "median trial",
        "90th percentile",
    ]
    rows = [
        [
            result.execution,
            result.way,
            *(
                f"{100 * share:.1f} %"
                for share in (
                    result.within_30,
                    result.held_at_30,
                    result.within_60,
                    result.held_at_60,
                )
            ),
            _count(result.median),
            _count(result.percentile_90),
        ]
        for result in results
    ]
    table = ax.table(rows, colLabels=heads, loc="center", cellLoc="center")
    table.auto_set_font_size(False)
    table.set_fontsize(8)


def _count(value: float | None) -> str:
    return "never" if value is None else f"{value:g}"


def _kinds(runs: Sequence[PersonRun]) -> tuple[Any, Any]:
    """Ways and executions that occur, in their order."""
    ways = list(dict.fromkeys(run.way for run in runs))
    return ways, list(dict.fromkeys(run.execution for run in runs))
