"""Our Fig. 5: from Cartesian via-points to joint via-points, and the supplemental ones between."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.reproduction.style import DEMONSTRATED, OURS, SYNTHETIC, VIA_POINT
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.serve import ServeTask

_JOINT = "EB"  # the elbow, which moves most


def draw(task: ServeTask) -> Figure:
    """Draw the first movement without and with its supplemental via-points."""
    retargeting = task.retargeting
    points = task.via_points
    complete = retargeting.first
    at_via_points = np.isin(complete.times, points.times)
    alone = JointMovement(
        points.times,
        complete.angles[at_via_points],
        minimum_jerk(points.times, complete.angles[at_via_points]),
    )
    arm = task.scene.arm
    joint = arm.joint_names.index(_JOINT) if _JOINT in arm.joint_names else 0
    times = np.linspace(points.times[0], points.times[-1], 300)
    desired = minimum_jerk(points.times, points.values)(times)

    figure = Figure(figsize=(9, 6.5), layout="constrained")
    axes = figure.subplots(3, 2, sharex=True, sharey="row")
    titles = ("via-points alone", f"with {len(retargeting.supplemental_times)} supplemental")
    for column, (movement, title) in enumerate(zip((alone, complete), titles, strict=True)):
        joints, height, error = axes[:, column]
        joints.set_title(title, fontsize=10)
        angle = movement.trajectory(times)
        joints.plot(times, angle[:, joint], color=OURS, label="minimum jerk in joint space")
        own = np.isin(movement.times, points.times)
        joints.plot(movement.times[own], movement.angles[own, joint], "o", color=VIA_POINT)
        joints.plot(
            movement.times[~own],
            movement.angles[~own, joint],
            "D",
            color="tab:green",
            markersize=4,
            label="supplemental",
        )
        tool = np.array([arm.tool_pose(q).position for q in angle])
        height.plot(times, desired[:, 2], "--", color=DEMONSTRATED, label="desired")
        height.plot(times, tool[:, 2], color=OURS, label="expected from the joints")
        straying = retargeting.straying(points, movement)
        error.semilogy(straying.times, 1e3 * np.maximum(straying.distance, 1e-7), color=OURS)
    axes[0][0].set_ylabel(f"joint {arm.joint_names[joint]} [rad]")
    axes[1][0].set_ylabel("z of the racket [m]")
    axes[2][0].set_ylabel("distance from\nthe desired path [mm]")
    axes[0][1].legend(fontsize=7)
    axes[1][0].legend(fontsize=7)
    for ax in axes[-1]:
        ax.set_xlabel("time [s]")
    note = f" ({SYNTHETIC})" if task.watched.synthetic else ""
    figure.suptitle(f"From racket path to joints{note}", fontsize=10)
    return figure
