"""The synthetic recording: rigid parts, noise and jolt as said, and the same bits every time."""

from pathlib import Path

import numpy as np
import pytest
from virtual_persons import GOAL, person_and_serve, recorded

from drake_viapoint.demonstration.c3d import write_c3d
from drake_viapoint.demonstration.impact import find_impact
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.packages import models_path
from drake_viapoint.tasks.serve_person import PersonServe, ServePerson
from drake_viapoint.tasks.serve_recording import RATE, record_person, record_serve


@pytest.fixture(scope="module")
def person() -> ServePerson:
    return person_and_serve(3)[0]


@pytest.fixture(scope="module")
def serve() -> PersonServe:
    return person_and_serve(3)[1]


@pytest.fixture(scope="module")
def recording(person: ServePerson, serve: PersonServe) -> MarkerRecording:
    return record_serve(person, serve, np.random.default_rng(0))


def marker(recording: MarkerRecording, name: str) -> np.ndarray:
    return recording.positions[:, recording.names.index(name)]


def test_five_markers_at_the_rate_of_the_cameras(
    recording: MarkerRecording, serve: PersonServe
) -> None:
    assert recording.names == ("shoulder", "elbow", "wrist", "racket_upper", "racket_lower")
    assert RATE == 250.0
    np.testing.assert_allclose(np.diff(recording.times), 1 / RATE, rtol=1e-9)
    assert recording.times[0] == 0
    assert 0 <= serve.racket.end - recording.times[-1] < 1 / RATE
    assert np.all(np.isfinite(recording.positions))


def test_the_noise_is_one_to_two_millimetres_and_white(
    person: ServePerson, serve: PersonServe
) -> None:
    """Against the same serve with other noise: only the noise differs."""
    one, other = (record_serve(person, serve, np.random.default_rng(seed)) for seed in (1, 2))
    noise = (one.positions - other.positions) / np.sqrt(2)
    size = np.sqrt(np.mean(np.sum(noise**2, axis=2), axis=0))  # (markers,) [m] in space
    assert np.all((size > 1e-3) & (size < 2e-3))
    flat = noise.reshape(len(noise), -1)
    neighbours = np.sum(flat[1:] * flat[:-1], axis=0) / np.sum(flat**2, axis=0)
    assert np.max(np.abs(neighbours)) < 4 / np.sqrt(len(noise))
    assert np.max(np.abs(np.mean(flat, axis=0))) < 5 * 9e-4 / np.sqrt(len(noise))


def test_markers_on_one_rigid_part_keep_their_distance(
    person: ServePerson, serve: PersonServe, recording: MarkerRecording
) -> None:
    """Up to noise; shoulder still, upper arm rigid, both edges of the head on one racket."""

    def spread(a: str, b: str) -> tuple[float, float]:
        distance = np.linalg.norm(marker(recording, a) - marker(recording, b), axis=1)
        return float(np.median(distance)), float(np.std(distance))

    length, noise = spread("shoulder", "elbow")
    assert length == pytest.approx(person.upper_arm, abs=3e-4)
    assert noise < 2e-3
    length, noise = spread("racket_upper", "racket_lower")
    assert length == pytest.approx(0.25, abs=3e-4)
    assert noise < 2e-3
    before = recording.times < serve.hit
    handle = marker(recording, "racket_upper") + marker(recording, "racket_lower")
    reach = np.linalg.norm(handle / 2 - marker(recording, "wrist"), axis=1)[before]
    assert np.median(reach) == pytest.approx(person.handle, abs=3e-4)
    assert np.std(reach) < 2e-3
    assert np.max(np.std(marker(recording, "shoulder"), axis=0)) < 1.2e-3


def test_the_ball_throws_the_racket_back_along_its_normal(
    serve: PersonServe, recording: MarkerRecording
) -> None:
    centre = (marker(recording, "racket_upper") + marker(recording, "racket_lower")) / 2
    state = serve.racket(recording.times)
    along = np.einsum("ni,ni->n", centre - state.position, state.normal)
    after = recording.times - serve.hit
    quiet, thrown = after <= 0, (after > 0.01) & (after < 0.03)
    assert np.std(along[quiet]) < 1e-3
    assert np.max(np.abs(along[quiet])) < 4e-3
    assert np.all(along[thrown] < -6e-3)
    assert np.std(along[after > 0.25]) < 1e-3  # and the hand has brought it back
    across = centre - state.position - along[:, None] * state.normal
    assert np.max(np.linalg.norm(across, axis=1)) < 4e-3


@pytest.mark.parametrize("number", range(4))
def test_the_hit_is_found_where_it_was(number: int) -> None:
    someone, serve = person_and_serve(number)
    found = find_impact(record_serve(someone, serve, np.random.default_rng(number)))
    assert abs(found - serve.hit) < 8e-3


def test_a_person_is_recorded_the_same_every_time() -> None:
    one, again, other = recorded(3), record_person(3, GOAL), recorded(1)
    assert one.positions.tobytes() == again.positions.tobytes()
    shared = min(len(one.times), len(other.times))
    assert np.max(np.abs(one.positions[:shared] - other.positions[:shared])) > 0.01


def test_the_shipped_file_is_regenerated_byte_for_byte(tmp_path: Path) -> None:
    write_c3d(tmp_path / "serve.c3d", recorded(0))
    shipped = (models_path() / "demonstrations/serve.c3d").read_bytes()
    assert (tmp_path / "serve.c3d").read_bytes() == shipped
