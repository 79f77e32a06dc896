"""A serve as a page: arm and ball as they moved, the ball's path, and what was asked."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Meshcat, Rgba
from pydrake.systems.framework import Context

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction.page import frame_times, look, page_of, play
from drake_viapoint.reproduction.via_point_marks import draw_via_points
from drake_viapoint.tasks.serve import serve_scene
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_trial import ServeTrial

_AFTERWARDS = 0.3  # [s] that the end is looked at
_BALL = Rgba(0.75, 0.9, 0.1, 1.0)
_PATH = Rgba(0.2, 0.4, 0.9, 1.0)


def serve_page(scenario: ServeScenario, trial: ServeTrial, via_points: ViaPoints) -> str:
    """A serve as an HTML page; see ``draw_serve``."""
    return page_of(lambda meshcat: draw_serve(meshcat, scenario, trial, via_points))


def draw_serve(
    meshcat: Meshcat, scenario: ServeScenario, trial: ServeTrial, via_points: ViaPoints
) -> float:
    """Show a serve: arm and ball at true speed, ball path and via-points drawn.

    Args:
        meshcat: Where to draw.
        scenario: Of the trial.
        trial: What to show.
        via_points: What the trial was asked to do.

    Returns:
        How long it takes [s].
    """
    scene = serve_scene(scenario, meshcat)
    look(meshcat, [2.3, -0.5, 1.6], [0.3, 1.1, 0.8])
    _draw_paths(meshcat, trial, via_points)
    times = frame_times(trial.end + _AFTERWARDS)
    angles = trial.motion.q(np.minimum(times, trial.motion.end))
    balls = trial.ball_path(np.minimum(times, trial.end))

    def pose(context: Context, picture: int) -> None:
        own = scene.plant.GetMyMutableContextFromRoot(context)
        scene.plant.SetPositions(own, scene.instance, angles[picture])
        scene.place_ball(own, balls[picture])

    return play(meshcat, scene.diagram, times, pose)


def _draw_paths(meshcat: Meshcat, trial: ServeTrial, via_points: ViaPoints) -> None:
    times = np.linspace(0.0, trial.end, 300)
    meshcat.SetLine("paths/ball", trial.ball_path(times).T, 3.0, _BALL)
    path = minimum_jerk(via_points.times, via_points.values)(
        np.linspace(via_points.times[0], via_points.times[-1], 300)
    )
    meshcat.SetLine("paths/racket", path[:, :3].T, 2.0, _PATH)
    draw_via_points(meshcat, via_points)
