"""Our Fig. 11: the arm, the pendulum in its hand, and what is measured of them."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc
from numpy.typing import NDArray

from drake_viapoint.reproduction.style import OURS, TIP
from drake_viapoint.tasks.upswing_scene import UpswingScene

_PLACE, _ANGLE = 0.2, 0.6  # of the hand [m] and the pendulum [rad] as drawn


def draw(scene: UpswingScene, length: float) -> Figure:
    """Draw the arm from the front and from its right side.

    Args:
        scene: The arm and its line.
        length: Of the pendulum [m].
    """
    figure = Figure(figsize=(9, 4.6), layout="constrained")
    front, side = figure.subplots(1, 2, sharey=True, width_ratios=[2.2, 1])  # one scale for both
    joints = scene.arm.joint_positions(scene.line.posture(_PLACE))
    hand = joints[-1]
    tip = hand + length * np.array([-np.sin(_ANGLE), 0.0, np.cos(_ANGLE)])
    ends = scene.line.places(np.array(scene.line.reach))
    for ax, across, name in ((front, 0, "x"), (side, 1, "y")):
        ax.plot(
            joints[:, across], joints[:, 2], "o-", color="0.35", lw=3, ms=4, label="arm and joints"
        )
        ax.plot(ends[:, across], ends[:, 2], color=OURS, lw=1.2, label="line of the hand in reach")
        ax.plot([hand[across], tip[across]], [hand[2], tip[2]], color=TIP, lw=2, label="pendulum")
        ax.plot(tip[across], tip[2], "o", color=TIP, ms=9)
        ax.plot(hand[across], hand[2], "s", color=OURS, ms=6, label="hand, at $x$")
        ax.set_aspect("equal", adjustable="box")
        ax.set_xlabel(f"{name} [m]")
        ax.set_ylabel("z [m]")
    front.set_title("from the front", fontsize=10)
    side.set_title("from the right", fontsize=10)
    _draw_angle(front, hand, length)
    front.legend(fontsize=7, loc="lower left")
    return figure


def _draw_angle(ax: Axes, hand: NDArray[np.float64], length: float) -> None:
    """Mark theta, from the upright on."""
    ax.plot([hand[0]] * 2, [hand[2], hand[2] + 1.1 * length], "k:", linewidth=0.8)
    degrees = np.degrees(_ANGLE)
    ax.add_patch(
        Arc((hand[0], hand[2]), length, length, theta1=90.0, theta2=90.0 + degrees, color="k")
    )
    middle = _ANGLE / 2
    ax.annotate(
        r"$\theta$",
        (hand[0] - 0.58 * length * np.sin(middle), hand[2] + 0.58 * length * np.cos(middle)),
        ha="center",
        fontsize=12,
    )
    middle_of_rod = (
        hand[0] - 0.5 * length * np.sin(_ANGLE),
        hand[2] + 0.5 * length * np.cos(_ANGLE),
    )
    ax.annotate("$l$", middle_of_rod, xytext=(-12, -12), textcoords="offset points", fontsize=12)
