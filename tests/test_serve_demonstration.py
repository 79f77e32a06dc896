"""What is seen of a serve: the racket's true path, the true hit, eight via-points."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from virtual_persons import GOAL, person_and_serve, recorded

from drake_viapoint.demonstration.c3d import write_c3d
from drake_viapoint.errors import ImpactNotFoundError, MarkerFileError, MarkerMissingError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.orientation import rotation_from_zyz
from drake_viapoint.robot.retargeting import POSE_NAMES
from drake_viapoint.tasks.serve_demonstration import WatchedServe, recorded_serve, watch_serve
from drake_viapoint.tasks.serve_scenario import ServeDemonstration


def watch(config: ServeDemonstration) -> WatchedServe:
    return watch_serve(config, recorded_serve(config, GOAL))


@pytest.fixture(scope="module")
def watched() -> WatchedServe:
    return watch(ServeDemonstration())


def test_the_shipped_serve_gives_eight_poses_from_its_start_to_its_end(
    watched: WatchedServe,
) -> None:
    via_points = watched.extraction.via_points
    assert via_points.names == POSE_NAMES
    assert via_points.times.size == 8
    assert via_points.times[0] == 0
    assert via_points.times[-1] == pytest.approx(watched.pose.times[-1] - watched.pose.times[0])
    assert watched.synthetic


@pytest.mark.parametrize("number", [0, 2])
def test_the_path_seen_is_the_path_of_the_racket(number: int) -> None:
    """Millimetres of noise, smoothed; its jolt by the ball is no part of the movement."""
    serve = person_and_serve(number)[1]
    watched = watch(ServeDemonstration(person=number))
    times = watched.pose.times
    truth = serve.racket(times)
    quiet = (np.abs(times - serve.hit) > 0.1) & (times > 0.05) & (times < times[-1] - 0.05)
    values = watched.pose.values
    off = np.linalg.norm(values[:, :3] - truth.position, axis=1)
    assert np.sqrt(np.mean(off[quiet] ** 2)) < 2e-3
    assert off.max() < 0.03
    turn = Rotation.from_matrix(
        truth.rotation.transpose(0, 2, 1) @ rotation_from_zyz(values[:, 3:])
    ).magnitude()
    assert np.sqrt(np.mean(turn[quiet] ** 2)) < 0.01
    assert abs(watched.hit_time - (serve.hit - times[0])) < 8e-3


def test_person_0_is_the_one_in_the_shipped_file() -> None:
    filed = recorded_serve(ServeDemonstration(), GOAL)
    drawn = recorded(0)
    np.testing.assert_allclose(filed.positions, drawn.positions, atol=1e-6)
    other = recorded_serve(ServeDemonstration(person=3), GOAL)
    np.testing.assert_array_equal(other.positions, recorded(3).positions)


def test_ones_own_file_is_read_and_is_not_called_synthetic(tmp_path: Path) -> None:
    own = tmp_path / "own.c3d"
    write_c3d(own, recorded(1))
    config = ServeDemonstration(file=str(own))
    assert not watch(config).synthetic
    assert watch(ServeDemonstration(person=1)).synthetic


def test_the_hit_may_be_given(watched: WatchedServe) -> None:
    config = ServeDemonstration(hit_time=0.9)
    given = watch_serve(config, watched.recording)
    assert given.hit_time == pytest.approx(0.9 - watched.pose.times[0])
    np.testing.assert_array_equal(
        given.extraction.via_points.values, watched.extraction.via_points.values
    )


def test_a_serve_nobody_hit_needs_the_time_of_the_hit(watched: WatchedServe) -> None:
    """The first half second, long before the ball is met."""
    early = watched.recording.times < 0.6
    cut = type(watched.recording)(
        watched.recording.names, watched.recording.times[early], watched.recording.positions[early]
    )
    with pytest.raises(ImpactNotFoundError, match="--t-hit"):
        watch_serve(ServeDemonstration(), cut)
    assert watch_serve(ServeDemonstration(hit_time=0.5), cut).hit_time == pytest.approx(0.5)


@pytest.mark.parametrize("number", [3, 6, 12])
def test_as_many_via_points_as_asked_for(watched: WatchedServe, number: int) -> None:
    config = ServeDemonstration(via_points=number)
    found = watch_serve(config, watched.recording).extraction.via_points
    assert found.times.size == number


def test_the_lever_weighs_angles_against_positions(watched: WatchedServe) -> None:
    """A long lever puts the via-points where the angles need them."""

    def angular_error(lever: float) -> float:
        config = ServeDemonstration(angle_weight=lever)
        seen = watch_serve(config, watched.recording)
        via_points = seen.extraction.via_points
        path = minimum_jerk(via_points.times, via_points.values)(
            seen.pose.times - seen.pose.times[0]
        )
        return float(np.sum((path - seen.pose.values)[:, 3:] ** 2))

    assert angular_error(10.0) < angular_error(1e-3)


def test_markers_by_other_names(watched: WatchedServe) -> None:
    recording = watched.recording
    renamed = type(recording)(
        tuple(f"s:{name}" for name in recording.names), recording.times, recording.positions
    )
    names = ["s:racket_upper", "s:racket_lower", "s:wrist"]
    again = watch_serve(ServeDemonstration(markers=names), renamed)
    np.testing.assert_array_equal(again.pose.values, watched.pose.values)
    with pytest.raises(MarkerMissingError, match="'heel'"):
        watch_serve(ServeDemonstration(markers=["racket_upper", "racket_lower", "heel"]), recording)


def test_a_file_that_is_not_there_is_named() -> None:
    with pytest.raises(MarkerFileError, match=r"none\.c3d"):
        recorded_serve(ServeDemonstration(file="none.c3d"), GOAL)
