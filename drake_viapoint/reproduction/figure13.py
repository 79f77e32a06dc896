"""Our Fig. 13: learning curves of the upswing, a panel for each way to keep the Jacobian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

TITLES = {
    "fixed": "Jacobian kept as first explored",
    "manual": "Jacobian explored again at given trials",
    "recorded": "Jacobian estimated from the last trials",
}
_ANGLE, _SPEED = "k", "tab:blue"


def draw(
    panels: Mapping[str, Sequence[Mapping[str, Any]]],
    angle_tolerance: float,
    speed_tolerance: float,
) -> Figure:
    """Draw what theta and omega came to, trial by trial.

    Args:
        panels: Way to keep the Jacobian, and the lines of its run.
        angle_tolerance: Of a success [rad].
        speed_tolerance: Of a success [rad/s].
    """
    figure = Figure(figsize=(8, 3.1 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for ax, (way, records) in zip(axes, panels.items(), strict=True):
        trials = np.array([record["trial"] for record in records])
        error = np.array([_error(record) for record in records])
        ax.fill_between(
            [0, trials[-1] + 1], -angle_tolerance, angle_tolerance, color="0.9", linewidth=0
        )
        ax.axhline(0.0, color="0.7", linewidth=0.8)
        ax.plot(trials, error[:, 0], "x-", color=_ANGLE, lw=0.6, ms=5, label=r"$\theta - \theta_d$")
        ax.set_ylim(-3.6, 3.6)
        ax.set_ylabel(r"$\theta - \theta_d$ [rad]")
        fast = ax.twinx()
        fast.plot(
            trials,
            error[:, 1],
            "o-",
            color=_SPEED,
            mfc="none",
            lw=0.6,
            ms=4,
            label=r"$\omega - \omega_d$",
        )
        fast.set_ylim(-18, 18)  # the zeros of both scales coincide
        fast.set_ylabel(r"$\omega - \omega_d$ [rad/s]", color=_SPEED)
        _mark(ax, records, way)
        good = [record["trial"] for record in records if record["success"]]
        ax.plot(good, [3.25] * len(good), "|", color="tab:green", ms=7, label="success")
        first = f"first success at trial {good[0]}" if good else "no success"
        ax.set_title(f"{TITLES.get(way, way)}: {first}", fontsize=10)
        handles = [*ax.get_legend_handles_labels()[0], *fast.get_legend_handles_labels()[0]]
        labels = [*ax.get_legend_handles_labels()[1], *fast.get_legend_handles_labels()[1]]
        ax.legend(handles, labels, fontsize=7, ncols=5, loc="lower right")
        ax.set_xlim(0, trials[-1] + 1)
    axes[-1].set_xlabel(
        f"trial (success: within {angle_tolerance:g} rad, the grey band, and "
        f"{speed_tolerance:g} rad/s)"
    )
    return figure


def _mark(ax: Any, records: Sequence[Mapping[str, Any]], way: str) -> None:
    """What the Jacobian of each trial came from, below the curves."""
    explored = [r["trial"] for r in records if r["purpose"] == "exploration"]
    ax.plot(explored, [-2.6] * len(explored), "*", color="0.3", ms=5, label="exploration")
    if way == "recorded" and explored:
        estimated = [r["trial"] for r in records if r["trial"] > explored[-1]]
        ax.plot(estimated, [-2.6] * len(estimated), "+", color="0.3", ms=5, label="estimated anew")


def _error(record: Mapping[str, Any]) -> Any:
    if record["T"] is None:
        return np.full(2, np.nan)
    return np.array(record["T"], dtype=float) - np.array(record["Td"], dtype=float)
