"""A trial as a Meshcat recording: one HTML file that plays in any browser, offline."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, MeshcatParams, Rgba, Sphere
from pydrake.math import RigidTransform, RotationMatrix

from drake_viapoint.errors import RunFolderError, ViapointError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.orientation import rotation_from_zyz
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.runs.learning_run import recorded_via_points
from drake_viapoint.runs.run_folder import read_trials
from drake_viapoint.runs.task_run import read_scenario
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.serve_trial import ServeTrial

_FRAME = 1 / 64  # [s] Meshcat's own frame rate
_BALL = Rgba(0.75, 0.9, 0.1, 1.0)
_PATH = Rgba(0.2, 0.4, 0.9, 1.0)
_AXES = (Rgba(0.85, 0.15, 0.1, 1.0), Rgba(0.1, 0.65, 0.2, 1.0), Rgba(0.1, 0.3, 0.85, 1.0))
_AXIS = 0.06  # [m] length of a via-point's axes


def record_trial(run: Path, number: int | None, html: Path) -> int:
    """Execute a recorded trial once more and write its recording.

    Args:
        run: Folder of the run.
        number: Trial, from 1; the last one if None.
        html: File to write.

    Returns:
        The number of the trial.

    Raises:
        RunFolderError: There is no such run or trial, or the trial was refused.
        ViapointError: The file cannot be written.
    """
    scenario = read_scenario(run)
    records = read_trials(run)
    if not records:
        raise RunFolderError(run, "holds no trial yet")
    chosen = len(records) if number is None else number
    if not 1 <= chosen <= len(records):
        raise RunFolderError(run, f"has trials 1 to {len(records)}, not {chosen}")
    task = ServeTask(scenario)
    via_points = recorded_via_points(records[chosen - 1], task.via_points.names)
    trial = task.execute(via_points, records[chosen - 1]["seed"])
    if not isinstance(trial, ServeTrial):
        raise RunFolderError(run, f"trial {chosen} was not executed: {trial.reason}")
    text = serve_recording(scenario, trial, via_points)
    try:
        html.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ViapointError(f"{html}: cannot be written: {error.strerror}") from error
    return chosen


def serve_recording(scenario: ServeScenario, trial: ServeTrial, via_points: ViaPoints) -> str:
    """A serve as an HTML page: arm and ball at true speed, ball path and via-points drawn.

    Args:
        scenario: Of the trial.
        trial: What to show.
        via_points: What the trial was asked to do.
    """
    meshcat = Meshcat(MeshcatParams(host="localhost"))  # its server is not for others to see
    scene = ServeScene(scenario, meshcat)
    meshcat.SetCameraPose([2.3, -0.5, 1.6], [0.3, 1.1, 0.8])
    _draw_paths(meshcat, trial, via_points)
    context = scene.diagram.CreateDefaultContext()
    own = scene.plant.GetMyMutableContextFromRoot(context)
    cup = scene.carry.frame_on_parent()

    times = np.arange(0.0, trial.end + 0.3, _FRAME)
    balls = trial.ball_path(np.minimum(times, trial.end))
    meshcat.StartRecording(set_visualizations_while_recording=False)
    for time, ball in zip(times, balls, strict=True):
        scene.plant.SetPositions(own, scene.instance, trial.motion.q(min(time, trial.motion.end)))
        place = cup.CalcPoseInWorld(own).inverse() @ RigidTransform(ball)
        scene.carry.SetPose(own, place)
        context.SetTime(time)
        scene.diagram.ForcedPublish(context)
    meshcat.StopRecording()
    meshcat.PublishRecording()
    page: str = meshcat.StaticHtml()
    return page


def _draw_paths(meshcat: Meshcat, trial: ServeTrial, via_points: ViaPoints) -> None:
    times = np.linspace(0.0, trial.end, 300)
    meshcat.SetLine("paths/ball", trial.ball_path(times).T, 3.0, _BALL)
    path = minimum_jerk(via_points.times, via_points.values)(
        np.linspace(via_points.times[0], via_points.times[-1], 300)
    )
    meshcat.SetLine("paths/racket", path[:, :3].T, 2.0, _PATH)
    for number, pose in enumerate(via_points.values, start=1):
        _draw_via_point(meshcat, f"via_points/{number}", pose)


def _draw_via_point(meshcat: Meshcat, name: str, pose: NDArray[np.float64]) -> None:
    rotation = rotation_from_zyz(pose[3:])
    meshcat.SetObject(name, Sphere(0.012), _PATH)
    meshcat.SetTransform(name, RigidTransform(RotationMatrix(rotation), pose[:3]))
    for axis, colour in enumerate(_AXES):
        ends = np.array([np.zeros(3), _AXIS * np.eye(3)[axis]]).T
        meshcat.SetLine(f"{name}/axis{axis}", ends, 2.0, colour)
