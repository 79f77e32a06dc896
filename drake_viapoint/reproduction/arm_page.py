"""A trial of an arm that follows a path, drawn: its tool's path, the one asked for, and marks."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Meshcat, Rgba, Sphere
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction.page import frame_times, look, play
from drake_viapoint.reproduction.via_point_marks import draw_via_points
from drake_viapoint.tasks.arm_task import ArmTask
from drake_viapoint.tasks.arm_trial import ArmTrial

_AFTERWARDS = 0.3  # [s] that the end is looked at
_CAMERA = np.array([0.8, 0.25, 0.3])  # [m] from the middle of the path
_ASKED = Rgba(0.2, 0.4, 0.9, 1.0)
_DONE = Rgba(0.8, 0.16, 0.14, 1.0)
_MARK = Rgba(0.1, 0.65, 0.2, 0.6)


def draw_arm_task(meshcat: Meshcat, task: ArmTask, trial: ArmTrial, via_points: ViaPoints) -> float:
    """Show a trial: the arm at true speed, its tool's path red, the path asked for blue.

    The tool is drawn where the model has it; the red path is that of the real one.

    Args:
        meshcat: Where to draw.
        task: Of the trial; its marks are green.
        trial: What to show.
        via_points: What the trial was asked to do.

    Returns:
        How long it takes [s].
    """
    scene = task.scene.shown(meshcat)
    asked = minimum_jerk(via_points.times, via_points.values)(
        np.linspace(via_points.times[0], via_points.times[-1], 300)
    )[:, :3]
    middle = (asked.min(axis=0) + asked.max(axis=0)) / 2
    look(meshcat, middle + _CAMERA, middle)
    done = trial.tool.path(np.linspace(trial.motion.start, trial.motion.end, 300))
    meshcat.SetLine("paths/asked", asked.T, 2.0, _ASKED)
    meshcat.SetLine("paths/done", done.T, 3.0, _DONE)
    draw_via_points(meshcat, via_points)
    for name, place in task.marks.items():
        meshcat.SetObject(f"marks/{name}", Sphere(0.012), _MARK)
        meshcat.SetTransform(f"marks/{name}", RigidTransform(np.asarray(place, dtype=float)))
    times = frame_times(trial.motion.end + _AFTERWARDS)
    angles = trial.motion.q(np.minimum(times, trial.motion.end))

    def pose(context: Context, picture: int) -> None:
        own = scene.plant.GetMyMutableContextFromRoot(context)
        scene.plant.SetPositions(own, scene.instance, angles[picture])

    return play(meshcat, scene.diagram, times, pose)
