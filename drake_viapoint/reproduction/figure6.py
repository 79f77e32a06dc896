"""Our Fig. 6: three views of trials: arm at the hit, racket, path of the ball, goal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from numpy.typing import NDArray

from drake_viapoint.reproduction.style import BALL, OURS
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import ServeTrial

_VIEWS = (("x", "y", 0, 1), ("x", "z", 0, 2), ("y", "z", 1, 2))


def draw(task: ServeTask, columns: Mapping[str, Sequence[ServeTrial]]) -> Figure:
    """Draw trials in columns, projected into the x-y, x-z and y-z planes.

    Args:
        task: Whose arm and goal.
        columns: Title of each column, and the trials superimposed in it.
    """
    figure = Figure(figsize=(3.6 * len(columns), 11), layout="constrained")
    axes = figure.subplots(
        3, len(columns), squeeze=False, sharex="row", sharey="row", height_ratios=[3, 2, 1.3]
    )
    for column, (title, trials) in enumerate(columns.items()):
        axes[0][column].set_title(title, fontsize=10)
        for row, (across, up, i, j) in enumerate(_VIEWS):
            ax = axes[row][column]
            for trial in trials:
                _draw_trial(ax, task, trial, i, j)
            draw_goal(ax, task, i, j)
            ax.set_aspect("equal", adjustable="box")
            ax.set_xlabel(f"{across} [m]")
            ax.set_ylabel(f"{up} [m]")
    handles, labels = axes[0][0].get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(unique.values(), unique.keys(), loc="outside lower center", ncols=5, fontsize=9)
    return figure


def _draw_trial(ax: Axes, task: ServeTask, trial: ServeTrial, i: int, j: int) -> None:
    q = trial.motion.q(trial.hit_time)
    joints = task.scene.arm.joint_positions(q)
    ax.plot(
        joints[:, i],
        joints[:, j],
        "o-",
        color="0.3",
        linewidth=2,
        markersize=3,
        label="arm at $t_{HIT}$",
    )
    face = face_outline(task, trial, trial.hit_time)
    ax.plot(face[:, i], face[:, j], color=OURS, linewidth=1.5, label="racket at $t_{HIT}$")
    times = np.linspace(0.0, trial.end, 400)
    ball = trial.ball_path(times)
    ax.plot(ball[:, i], ball[:, j], color=BALL, linewidth=1.2, label="ball")
    at_hit = trial.told.meeting
    if at_hit is None:
        return
    ax.plot(at_hit[i], at_hit[j], "x", color="k", markersize=5, label="$T_H$")


def face_outline(task: ServeTask, trial: ServeTrial, time: float) -> NDArray[np.float64]:
    """Points (n, 3) of the rim of the racket's face at a time of a trial [m]."""
    racket = trial.racket([time])
    turn = np.linspace(0, 2 * np.pi, 60)
    robot = task.scenario.robot
    rim = np.stack(
        [robot.half_width * np.cos(turn), np.zeros(60), robot.half_length * np.sin(turn)], axis=1
    )
    outline: NDArray[np.float64] = racket.position[0] + rim @ racket.rotation[0].T
    return outline


def draw_goal(ax: Axes, task: ServeTask, i: int, j: int) -> None:
    """Draw the goal's ring, projected onto two of the axes x, y and z."""
    ring = task.scene.ring
    width = 2 * task.scenario.learning.landing_tolerance
    height = width if (i, j) == (0, 1) else 0.02
    ax.add_patch(
        Ellipse((ring[i], ring[j]), width, height, fill=False, edgecolor="tab:orange", linewidth=2)
    )
    ax.plot([], [], color="tab:orange", linewidth=2, label="goal")
