"""The rigid fit: poses given back, laws of rigid motion, the low-pass, and bad markers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from synthetic_swing import NAMES, random_swing

from drake_viapoint.demonstration.markers import MarkerRecording
from drake_viapoint.demonstration.racket_pose import (
    BodyMarkers,
    fit_rigid_body,
    hand_pose,
    low_passed,
    racket_pose,
)
from drake_viapoint.errors import GapError, MarkerMissingError, RacketPoseError
from drake_viapoint.motion.orientation import rotation_from_zyz


def test_exact_markers_give_the_pose_back() -> None:
    swing = random_swing(1, noise=0.0, jump=None)
    rotation, origin = fit_rigid_body(np.array(swing.recording.positions))
    np.testing.assert_allclose(origin, swing.position, atol=1e-12)
    np.testing.assert_allclose(rotation, rotation_from_zyz(swing.zyz), atol=1e-7)


@pytest.mark.parametrize("rate", [100.0, 250.0, 1000.0])
def test_noisy_markers_give_the_pose_nearly_back(rate: float) -> None:
    """Away from the ends, where a low-pass cannot know what follows."""
    swing = random_swing(2, rate=rate, noise=1.5e-3, jump=None)
    pose = racket_pose(swing.recording)
    inner = slice(round(0.1 * rate), -round(0.1 * rate))
    assert np.abs(pose.position - swing.position)[inner].max() < 2e-3
    assert np.abs(pose.zyz - swing.zyz)[inner].max() < 0.015
    np.testing.assert_array_equal(pose.values, np.hstack([pose.position, pose.zyz]))
    np.testing.assert_array_equal(pose.times, swing.recording.times)


@given(st.integers(0, 2**32 - 1))
def test_moving_the_laboratory_moves_the_pose(seed: int) -> None:
    """Also where the racket then passes the singularity of the ZYZ angles."""
    swing = random_swing(3, rate=60.0, jump=None).recording
    rng = np.random.default_rng(seed)
    turn, shift = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    moved = MarkerRecording(NAMES, swing.times, swing.positions @ turn.T + shift)
    before, after = racket_pose(swing), racket_pose(moved)
    np.testing.assert_allclose(after.position, before.position @ turn.T + shift, atol=1e-10)
    np.testing.assert_allclose(
        rotation_from_zyz(after.zyz), turn @ rotation_from_zyz(before.zyz), atol=1e-7
    )


def test_angles_are_continuous_over_many_turns() -> None:
    """Away from the singularity: phi runs through three turns."""
    times = np.arange(500) / 250
    zyz = np.stack([3 * np.pi * times, np.full(500, 1.2), -2 * np.pi * times], axis=1)
    places = np.array([[-0.1, 0, 0], [0.1, 0, 0], [0, 0, -0.4]])
    points = np.einsum("nij,mj->nmi", rotation_from_zyz(zyz), places)
    pose = racket_pose(MarkerRecording(NAMES, times, points))
    assert np.abs(np.diff(pose.zyz, axis=0)).max() < 0.1
    assert pose.zyz[-1, 0] - pose.zyz[0, 0] == pytest.approx(zyz[-1, 0], abs=0.1)


def test_uneven_times_are_resampled() -> None:
    swing = random_swing(4, noise=0.0, jump=None)
    kept = np.delete(np.arange(len(swing.position)), [50, 120, 121, 200])
    uneven = MarkerRecording(
        NAMES, swing.recording.times[kept], np.array(swing.recording.positions[kept])
    )
    pose = racket_pose(uneven)
    np.testing.assert_allclose(pose.times, swing.recording.times, atol=1e-9)
    np.testing.assert_allclose(pose.values, racket_pose(swing.recording).values, atol=1e-4)


def test_short_gap_is_filled_and_long_gap_refused() -> None:
    swing = random_swing(5, noise=0.0, jump=None).recording
    holed = np.array(swing.positions)
    holed[100:120, 2] = np.nan
    pose = racket_pose(MarkerRecording(NAMES, swing.times, holed))
    np.testing.assert_allclose(pose.values, racket_pose(swing).values, atol=1e-2)
    holed[100:150, 2] = np.nan
    with pytest.raises(GapError, match="'wrist'"):
        racket_pose(MarkerRecording(NAMES, swing.times, holed))


@pytest.mark.parametrize("rate", [100.0, 250.0, 1000.0])
def test_low_pass_halves_the_power_at_its_cutoff_without_delay(rate: float) -> None:
    times = np.arange(round(4 * rate)) / rate
    inner = slice(round(rate), round(3 * rate))
    for frequency, gain, near in ((1.0, 1.0, 1e-3), (12.0, np.sqrt(0.5), 1e-4), (40.0, 0.0, 0.02)):
        wave = np.sin(2 * np.pi * frequency * times)
        passed = low_passed(wave, rate, cutoff=12.0)
        np.testing.assert_allclose(passed[inner], gain * wave[inner], atol=near)


def test_hand_z_points_to_the_marker_ahead() -> None:
    times = np.arange(50) / 50
    points = np.tile([[[-0.03, 0, 1], [0.03, 0, 1], [0.0, 0, 1.08]]], (50, 1, 1))
    recording = MarkerRecording(("P:RWRA", "P:RWRB", "P:RFIN"), times, points)
    pose = hand_pose(recording)
    np.testing.assert_allclose(pose.position, [[0, 0, 1.0]] * 50, atol=1e-12)
    np.testing.assert_allclose(rotation_from_zyz(pose.zyz), [np.eye(3)] * 50, atol=1e-7)
    reverse = racket_pose(recording, markers=BodyMarkers("RWRA", "RWRB", "RFIN"))
    np.testing.assert_allclose(rotation_from_zyz(reverse.zyz)[:, 2, 2], -1.0, atol=1e-7)


def test_bad_input_is_named() -> None:
    swing = random_swing(6).recording
    with pytest.raises(MarkerMissingError, match="'tip'"):
        racket_pose(swing, markers=BodyMarkers("racket_upper", "racket_lower", "tip"))
    with pytest.raises(RacketPoseError, match="on a line"):
        racket_pose(swing, markers=BodyMarkers("racket_upper", "racket_lower", "racket_lower"))
    for cutoff in (0.0, -1.0, 125.0, np.nan):
        with pytest.raises(RacketPoseError, match="half the sampling rate, 125 Hz"):
            racket_pose(swing, cutoff)
    short = MarkerRecording(NAMES, swing.times[:21], swing.positions[:21])
    with pytest.raises(RacketPoseError, match="21 samples at 250 Hz are too few"):
        racket_pose(short)
