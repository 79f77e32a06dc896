"""Watching a serve: from a marker file to via-points of the racket and the time of the hit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.demonstration.impact import find_impact
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.demonstration.markers import read_markers
from drake_viapoint.demonstration.racket_pose import BodyMarkers, RacketPose, racket_pose
from drake_viapoint.motion.extraction import Extraction, extract_via_points
from drake_viapoint.robot.retargeting import POSE_NAMES
from drake_viapoint.tasks.serve_recording import record_person
from drake_viapoint.tasks.serve_scenario import ServeDemonstration
from drake_viapoint.tasks.serve_scene import scene_path


@dataclass(frozen=True)
class WatchedServe:
    """A serve as it was seen.

    Attributes:
        recording: The markers.
        markers: Which of them are the racket's.
        pose: Pose of the racket, smoothed; its times begin at the recording's.
        extraction: Via-points of the pose, with times from 0 at its first sample.
        hit_time: t_HIT [s], from the first sample.
        synthetic: Whether a virtual person made it.
    """

    recording: MarkerRecording
    markers: BodyMarkers
    pose: RacketPose
    extraction: Extraction
    hit_time: float
    synthetic: bool


def recorded_serve(config: ServeDemonstration, goal: NDArray[np.float64]) -> MarkerRecording:
    """The recording a scenario names: its file, or another virtual person's serve.

    Args:
        config: Which.
        goal: (3,) centre of the goal's ring, where a virtual person aims [m].
    """
    if config.person > 0:
        return record_person(config.person, goal)
    return read_markers(scene_path(config.file))


def watch_serve(config: ServeDemonstration, recording: MarkerRecording) -> WatchedServe:
    """Find the racket's pose, the hit and the via-points in a recording (section 2.1.1).

    Raises:
        MarkerMissingError, GapError, RacketPoseError: The markers give no pose.
        ImpactNotFoundError: No hit was found and none is given.
        ExtractionError: Too few samples.
    """
    upper, lower, wrist = config.markers
    markers = BodyMarkers(upper, lower, wrist)
    pose = racket_pose(recording, config.cutoff, markers)
    start = float(pose.times[0])
    hit = config.hit_time if config.hit_time is not None else find_impact(recording, markers)
    lever = config.angle_weight
    extraction = extract_via_points(
        pose.times - start,
        pose.values,
        POSE_NAMES,
        number=config.via_points,
        weights=[1.0, 1.0, 1.0, lever, lever, lever],
    )
    synthetic = config.person > 0 or config.file == ServeDemonstration().file
    return WatchedServe(recording, markers, pose, extraction, hit - start, synthetic)
