"""Real tennis serves: hand markers of a motion capture system, no racket. Skips without them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_viapoint.demonstration.impact import find_impact
from drake_viapoint.demonstration.markers import MarkerRecording, read_markers
from drake_viapoint.demonstration.racket_pose import HAND_MARKERS, fit_rigid_body, hand_pose
from drake_viapoint.errors import ImpactNotFoundError, MarkerMissingError
from drake_viapoint.motion.extraction import extract_via_points
from drake_viapoint.motion.minimum_jerk import EndMotion, minimum_jerk
from drake_viapoint.motion.orientation import rotation_from_zyz

FILE = (
    Path(__file__).parents[1].parent
    / "shared" / "data" / "tennis-serve-ktk" / "kinematics_tennis_serve.c3d"
)  # fmt: skip


@pytest.fixture(scope="module")
def serve() -> MarkerRecording:
    if not FILE.exists():
        pytest.skip(f"{FILE.name} is not there")
    return read_markers(FILE)


def test_reading(serve: MarkerRecording) -> None:
    assert serve.positions.shape == (1092, 39, 3)
    assert serve.rate == pytest.approx(50.0)
    assert serve.times[[0, -1]] == pytest.approx([0.0, 21.82])
    assert not np.isnan(serve.positions).any()
    np.testing.assert_array_equal(serve.marker("RFIN"), serve.marker("Derrick:RFIN"))


def test_hand_pose(serve: MarkerRecording) -> None:
    pose = hand_pose(serve)
    assert pose.values.shape == (1092, 6)
    middle = (serve.marker("RWRA") + serve.marker("RWRB")) / 2
    # The low-pass at 12 Hz rounds the serve's fastest moment off; elsewhere it leaves millimetres.
    distance = np.linalg.norm(pose.position - middle, axis=1)
    assert np.median(distance) < 2e-3
    assert distance.max() < 0.08
    to_hand = serve.marker("RFIN") - middle
    z = rotation_from_zyz(pose.zyz)[:, :, 2]
    assert np.median(np.sum(z * to_hand, axis=1) / np.linalg.norm(to_hand, axis=1)) > 0.95
    assert np.abs(np.diff(pose.zyz[:, 1])).max() < np.pi


def test_the_hand_is_nearly_rigid(serve: MarkerRecording) -> None:
    points = np.stack([serve.marker(name) for name in HAND_MARKERS.names], axis=1)
    rotation, origin = fit_rigid_body(points, HAND_MARKERS)
    inside = np.einsum("nij,nmi->nmj", rotation, points - origin[:, None])
    residual = np.linalg.norm(inside - np.median(inside, axis=0), axis=2)
    assert np.median(residual) < 0.015


def test_without_racket_markers_the_error_lists_the_others(serve: MarkerRecording) -> None:
    with pytest.raises(MarkerMissingError, match="Derrick:RFIN"):
        find_impact(serve)


def test_at_50_hz_no_impact_is_claimed(serve: MarkerRecording) -> None:
    with pytest.raises(ImpactNotFoundError, match="too slow"):
        find_impact(serve, HAND_MARKERS)


def test_the_recording_holds_five_serves(serve: MarkerRecording) -> None:
    """Five times the wrist passes 9 m/s above shoulder height; each serve is about 1.8 s long."""
    wrist = (serve.marker("RWRA") + serve.marker("RWRB")) / 2
    speed = np.linalg.norm(np.gradient(wrist, serve.times, axis=0), axis=1)
    fast = serve.times[(speed > 9.0) & (wrist[:, 2] > 1.0)]
    starts = fast[np.r_[True, np.diff(fast) > 1.0]]
    np.testing.assert_allclose(starts, [4.0, 7.65, 11.2, 14.9, 18.6], atol=0.1)


def test_via_points_tell_a_real_serve_again(serve: MarkerRecording) -> None:
    """From rest to follow-through: extraction to 3 cm, and what it leaves by numbers of points."""
    pose = hand_pose(serve)
    part = (pose.times >= 2.44) & (pose.times <= 4.20)
    times, path = pose.times[part], pose.position[part]
    speed = np.gradient(path, times, axis=0)[[0, -1]]
    ends = EndMotion(speed[0], np.zeros(3), speed[1], np.zeros(3))
    found = extract_via_points(times, path, ["x", "y", "z"], threshold=0.03, end_motion=ends)
    points = found.via_points
    again = minimum_jerk(points.times, points.values, ends)(times)
    assert np.max(np.linalg.norm(again - path, axis=1)) <= 0.03
    assert points.times.size < times.size / 4
    assert found.rms_errors[-1] < 0.05 * found.rms_errors[0]
