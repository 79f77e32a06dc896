"""The synthetic recording: a rigid rod, noise as said, and the same bits every time."""

from pathlib import Path

import numpy as np
import pytest
from virtual_swingers import person_and_upswing, recorded

from drake_viapoint.demonstration.c3d import read_c3d, write_c3d
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.packages import models_path
from drake_viapoint.tasks.upswing_person import FINE, PersonUpswing
from drake_viapoint.tasks.upswing_recording import (
    HAND_NOISE,
    RATE,
    TIP_NOISE,
    record_person,
    record_upswing,
)


@pytest.fixture(scope="module")
def upswing() -> PersonUpswing:
    return person_and_upswing(3)[1]


@pytest.fixture(scope="module")
def recording(upswing: PersonUpswing) -> MarkerRecording:
    return record_upswing(upswing, np.random.default_rng(0))


def test_two_markers_at_the_rate_of_the_camera_for_the_whole_upswing(
    recording: MarkerRecording, upswing: PersonUpswing
) -> None:
    assert recording.names == ("hand", "tip")
    assert RATE == 60.0
    np.testing.assert_array_equal(recording.times, np.arange(recording.times.size) / 60)
    assert recording.times[-1] == pytest.approx(upswing.times[-1], rel=1e-12)
    assert np.all(np.isfinite(recording.positions))


def test_the_markers_are_where_hand_and_tip_were(
    recording: MarkerRecording, upswing: PersonUpswing
) -> None:
    """World: x right, y forward, z up; theta anticlockwise from inverted, seen from the front."""
    hand, tip = recording.marker("hand"), recording.marker("tip")
    x, theta = upswing.hand[::FINE], upswing.angle[::FINE]
    level = np.full_like(x, 1.2)
    expected = np.stack([hand[:, 0].mean() - x.mean() + x, 0.45 + 0 * x, level], axis=1)
    np.testing.assert_allclose(hand, expected, atol=6 * HAND_NOISE)
    rod = upswing.length * np.stack([-np.sin(theta), 0 * x, np.cos(theta)], axis=1)
    np.testing.assert_allclose(tip - expected, rod, atol=6 * TIP_NOISE)
    assert tip[0, 2] < 0.9  # hangs
    assert tip[-1, 2] > 1.5


def test_the_noise_is_of_the_size_said_and_white(upswing: PersonUpswing) -> None:
    """Against the same upswing with other noise: only the noise differs."""
    many = [record_upswing(upswing, np.random.default_rng(seed)).positions for seed in range(20)]
    noise = np.array(many) - np.mean(many, axis=0)  # (20, n, 2, 3)
    size = np.std(noise, axis=(0, 1, 3)) * np.sqrt(20 / 19)
    np.testing.assert_allclose(size, [HAND_NOISE, TIP_NOISE], rtol=0.05)
    assert 1e-3 < np.sqrt(3) * size[0] < 2e-3  # in space
    assert size[1] / upswing.length == pytest.approx(0.02, rel=0.1)
    neighbours = np.sum(noise[:, 1:] * noise[:, :-1]) / np.sum(noise**2)
    assert abs(neighbours) < 0.05


def test_a_person_is_recorded_the_same_every_time() -> None:
    one, again, other = recorded(3), record_person(3), recorded(1)
    assert one.positions.tobytes() == again.positions.tobytes()
    shared = min(len(one.times), len(other.times))
    assert np.max(np.abs(one.positions[:shared] - other.positions[:shared])) > 0.05
    assert record_person(3, seed=1).positions.tobytes() != one.positions.tobytes()


def test_the_shipped_file_is_regenerated_byte_for_byte(tmp_path: Path) -> None:
    write_c3d(tmp_path / "upswing.c3d", recorded(0))
    shipped = models_path() / "demonstrations/upswing.c3d"
    assert (tmp_path / "upswing.c3d").read_bytes() == shipped.read_bytes()
    np.testing.assert_allclose(read_c3d(shipped).times, recorded(0).times, rtol=1e-12, atol=0)
