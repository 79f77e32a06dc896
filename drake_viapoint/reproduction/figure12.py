"""Our Figs. 12 and 14: one upswing, the pendulum's movement and its course in time."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction.style import DEMONSTRATED, OURS, SYNTHETIC, TIP, VIA_POINT
from drake_viapoint.tasks.upswing_demonstration import WatchedUpswing
from drake_viapoint.tasks.upswing_trial import UpswingTrial

_STICKS = 45  # positions of the pendulum drawn
_DEMONSTRATED: dict[str, Any] = {"color": DEMONSTRATED, "linestyle": ":", "linewidth": 1.6}


def draw(
    trial: UpswingTrial, via_points: ViaPoints, watched: WatchedUpswing, length: float, title: str
) -> Figure:
    """Draw a trial beside the demonstration.

    Args:
        trial: What was executed.
        via_points: What it was asked to do.
        watched: The demonstration.
        length: Of the robot's pendulum [m].
        title: Which trial, and what came of it.
    """
    figure = Figure(figsize=(10, 6), layout="constrained")
    panels = figure.add_gridspec(3, 2, width_ratios=[1, 1.25])
    _draw_sticks(figure.add_subplot(panels[:, 0]), trial, length)
    hand = figure.add_subplot(panels[0, 1])
    angle = figure.add_subplot(panels[1, 1], sharex=hand)
    speed = figure.add_subplot(panels[2, 1], sharex=hand)
    motion = trial.motion
    hand.plot(watched.times, watched.hand, **_DEMONSTRATED, label="hand, demonstration")
    hand.plot(motion.times, motion.hand, color=OURS, label="hand $x$")
    hand.plot(motion.times, motion.tip(length)[:, 0], color=TIP, linestyle="--", label="tip")
    hand.plot(
        via_points.times,
        via_points.values[:, 0],
        "o",
        color=VIA_POINT,
        mfc="none",
        label="via-points",
    )
    hand.set_ylabel("place [m]")
    courses = (
        (angle, watched.angle, motion.angle, r"$\theta$ [rad]", trial.desired[0], r"\theta"),
        (speed, watched.speed, motion.speed, r"$\omega$ [rad/s]", trial.desired[1], r"\omega"),
    )
    for ax, seen, executed, label, desired, symbol in courses:
        if seen is not None:
            ax.plot(watched.times, seen, **_DEMONSTRATED, label="demonstration")
        ax.plot(motion.times, executed, color=OURS, label="execution")
        ax.plot(
            motion.times[-1], desired, "*", color=VIA_POINT, markersize=10, label=f"${symbol}_d$"
        )
        ax.set_ylabel(label)
    for level in (-np.pi, 0.0):
        angle.axhline(level, color="0.8", linewidth=0.8, zorder=0)
    speed.set_xlabel("time [s]")
    for ax in (hand, angle, speed):
        ax.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.suptitle(title + (f" ({SYNTHETIC})" if watched.synthetic else ""), fontsize=10)
    return figure


def _draw_sticks(ax: Axes, trial: UpswingTrial, length: float) -> None:
    motion = trial.motion
    chosen = np.unique(np.linspace(0, motion.times.size - 1, _STICKS).astype(int))
    hinge = np.stack([motion.hand, np.zeros(motion.times.size)], axis=1)
    tip = motion.tip(length)
    sticks = LineCollection(
        np.stack([hinge, tip], axis=1)[chosen],
        array=motion.times[chosen],
        cmap="viridis_r",
        norm=Normalize(0.0, float(motion.times[-1])),
        linewidths=1.0,
    )
    ax.add_collection(sticks)
    ax.plot(tip[:, 0], tip[:, 1], color=TIP, linewidth=0.8, label="path of the tip")
    ax.plot(motion.hand, np.zeros(motion.times.size), color=OURS, linewidth=2.0, label="hand")
    ax.plot(*tip[-1], "o", color="k", markersize=7, label="tip at the end")
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("$x$ [m]")
    ax.set_ylabel("height above the hand [m]")
    ax.legend(fontsize=7, loc="upper left")
    ax.figure.colorbar(sticks, ax=ax, label="time [s]", location="bottom", shrink=0.8)
