"""An upswing as a page: arm and pendulum as they moved, the tip's path, and what was asked."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Cylinder, Meshcat, Rgba, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.framework import Context

from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction.page import frame_times, look, page_of, play
from drake_viapoint.tasks.pendulum import PendulumMotion
from drake_viapoint.tasks.upswing_line import HandLine
from drake_viapoint.tasks.upswing_pendulum import PENDULUM
from drake_viapoint.tasks.upswing_scenario import UpswingScenario
from drake_viapoint.tasks.upswing_scene import UpswingScene
from drake_viapoint.tasks.upswing_trial import UpswingTrial

_AFTERWARDS = 0.5  # [s] that the end is looked at
_FINE = 1 / 256  # [s] between two points of a drawn path
_TIP = Rgba(0.8, 0.16, 0.14, 1.0)
_PATH = Rgba(0.2, 0.4, 0.9, 1.0)
_GOAL = Rgba(0.1, 0.65, 0.2, 0.35)
_ASIDE, _BACK, _UP = 0.65, -0.8, 0.3  # [m] of the camera, from where the line starts


class UpswingFrames(NamedTuple):
    """Where everything is, at n times.

    The pendulum hangs where the hand was in the trial. An arm that carried it moves as it did; an
    arm that did not is shown where it would hold it, as far as it reaches.
    """

    times: NDArray[np.float64]  # (n,) from 0 on [s]
    arm: NDArray[np.float64]  # (n, k) joint angles [rad]
    angle: NDArray[np.float64]  # (n,) theta [rad]
    beyond: NDArray[np.float64]  # (n,) of the pendulum from the arm's hand, along the line [m]


def upswing_page(scenario: UpswingScenario, trial: UpswingTrial, via_points: ViaPoints) -> str:
    """An upswing as an HTML page; see ``draw_upswing``."""
    return page_of(lambda meshcat: draw_upswing(meshcat, scenario, trial, via_points))


def draw_upswing(
    meshcat: Meshcat, scenario: UpswingScenario, trial: UpswingTrial, via_points: ViaPoints
) -> float:
    """Show an upswing: arm and pendulum at true speed, the tip's path, via-points, goal.

    The recurrence knows no arm: where its hand leaves the arm's reach, the arm stays at the nearest
    place that it reaches and the pendulum goes on without it.

    Args:
        meshcat: Where to draw.
        scenario: Of the trial.
        trial: What to show.
        via_points: What the trial was asked to do.

    Returns:
        How long it takes [s].

    Raises:
        ScenarioError: The scenario's line is out of the arm's reach.
    """
    scene = UpswingScene(scenario, meshcat)
    start = scene.line.places(np.zeros(1))[0]
    look(meshcat, start + [_ASIDE, _BACK, _UP], start)
    _draw_paths(meshcat, scenario, scene.line, trial.motion, via_points)
    _draw_goal(meshcat, scenario, scene.line, trial, via_points)
    frames = upswing_frames(scene.line, trial)
    leaves = bool(np.any(frames.beyond))

    def pose(context: Context, picture: int) -> None:
        own = scene.plant.GetMyMutableContextFromRoot(context)
        scene.plant.SetPositions(own, scene.instance, frames.arm[picture])
        scene.joint.set_angle(own, frames.angle[picture])
        if leaves:
            shift = RigidTransform(np.array([frames.beyond[picture], 0.0, 0.0]))
            meshcat.SetTransform(f"visualizer/{PENDULUM}", shift, frames.times[picture])

    return play(meshcat, scene.diagram, frames.times, pose)


def upswing_frames(line: HandLine, trial: UpswingTrial) -> UpswingFrames:
    """What the pictures of an upswing show.

    Args:
        line: Where the hand moves.
        trial: What to show.
    """
    start, end = trial.motion.times[[0, -1]]
    times = frame_times(end - start + _AFTERWARDS)
    hand, angle = _between(trial.motion, start + times)
    if trial.carried is not None:
        arm = trial.carried.arm_motion.q(np.minimum(start + times, end))
        return UpswingFrames(times, arm, angle, np.zeros_like(times))
    held = np.clip(hand, *line.reach)
    return UpswingFrames(times, line.postures(held), angle, hand - held)


def _between(
    motion: PendulumMotion, times: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Hand (n,) [m] and angle (n,) [rad] at any times, as the recurrence has it: steady steps."""
    hand, angle = (np.interp(times, motion.times, y) for y in (motion.hand, motion.angle))
    return hand, angle


def _draw_paths(
    meshcat: Meshcat,
    scenario: UpswingScenario,
    line: HandLine,
    motion: PendulumMotion,
    via_points: ViaPoints,
) -> None:
    fine = np.arange(motion.times[0], motion.times[-1] + _FINE, _FINE)
    hand, angle = _between(motion, fine)
    tip = PendulumMotion(fine, hand, angle, angle).tip(scenario.pendulum.length)
    path = line.places(tip[:, 0])
    path[:, 2] += tip[:, 1]
    meshcat.SetLine("paths/tip", path.T, 3.0, _TIP)
    asked = via_points.values[:, 0]
    ends = np.array([min(hand.min(), asked.min()), max(hand.max(), asked.max())])
    meshcat.SetLine("paths/hand", line.places(ends).T, 2.0, _PATH)
    for number, place in enumerate(line.places(asked), start=1):
        meshcat.SetObject(f"via_points/{number}", Sphere(0.012), _PATH)
        meshcat.SetTransform(f"via_points/{number}", RigidTransform(place))


def _draw_goal(
    meshcat: Meshcat,
    scenario: UpswingScenario,
    line: HandLine,
    trial: UpswingTrial,
    via_points: ViaPoints,
) -> None:
    """The pendulum as it should end: at the angle of Td, over the last via-point."""
    length = scenario.pendulum.length
    place = line.places(via_points.values[-1:, 0])[0]
    turn = RotationMatrix.MakeYRotation(-trial.desired[0])
    meshcat.SetTransform("goal", RigidTransform(turn, place))
    for part, shape, height in (
        ("rod", Cylinder(0.006, length), length / 2),
        ("bob", Sphere(0.028), length),
    ):
        meshcat.SetObject(f"goal/{part}", shape, _GOAL)
        meshcat.SetTransform(f"goal/{part}", RigidTransform(np.array([0.0, 0.0, height])))
