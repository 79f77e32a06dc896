"""Our Fig. 8: the simulated robot of the serve, and what is asked of it."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.reproduction.figure6 import draw_goal, face_outline
from drake_viapoint.reproduction.style import BALL, OURS, VIA_POINT
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import ServeTrial

_VIEWS = (("from the front", "x", 0), ("from the right", "y", 1))
_SHOWN = ((-0.25, 0.95), (-0.25, 3.35))  # [m] of x and y
_HEIGHT = (0.3, 1.7)  # [m]
_WIDTHS = [high - low for low, high in _SHOWN]


def draw(task: ServeTask, first: ServeTrial) -> Figure:
    """Draw arm, racket and ball as a serve starts, the via-points, the ball's path and the goal.

    Args:
        task: Whose arm and goal.
        first: Its first trial.
    """
    figure = Figure(figsize=(12, 4.4), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True, width_ratios=_WIDTHS)  # one scale for both
    joints = task.scene.arm.joint_positions(first.motion.q(0.0))
    face = face_outline(task, first, 0.0)
    ball = first.ball_path(np.linspace(0.0, first.end, 400))
    points = task.via_points
    path = minimum_jerk(points.times, points.values)(
        np.linspace(points.times[0], points.times[-1], 300)
    )
    for ax, (title, name, i) in zip(axes, _VIEWS, strict=True):
        ax.plot(joints[:, i], joints[:, 2], "o-", color="0.35", lw=3, ms=4, label="arm and joints")
        ax.plot(face[:, i], face[:, 2], color=OURS, lw=1.6, label="racket")
        ax.plot(path[:, i], path[:, 2], color=OURS, lw=0.9, ls="--", label="its centre's path")
        for number, value in enumerate(points.values, start=1):
            label = "via-points" if number == 1 else None
            ax.plot(value[i], value[2], "o", color=VIA_POINT, ms=4, label=label)
            ax.annotate(str(number), value[[i, 2]], (3, 3), textcoords="offset points", fontsize=7)
        ax.plot(ball[0, i], ball[0, 2], "o", color=BALL, ms=7, label="ball, in the cup")
        ax.plot(ball[:, i], ball[:, 2], color=BALL, lw=1.6, ls=":", label="its path, first trial")
        draw_goal(ax, task, i, 2)
        ax.set_aspect("equal", adjustable="box")
        ax.set_xlim(*_SHOWN[i])
        ax.set_ylim(*_HEIGHT)
        ax.set_title(title, fontsize=10)
        ax.set_xlabel(f"{name} [m]")
    axes[0].set_ylabel("z [m]")
    axes[1].legend(fontsize=7, loc="upper right")
    return figure
