"""What is seen of an upswing: the hand's true path, the pendulum's true end, eight via-points."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from virtual_swingers import person_and_upswing, recorded

from drake_viapoint.demonstration.c3d import write_c3d
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.errors import (
    EndStateError,
    ExtractionError,
    GapError,
    HangingError,
    MarkerFileError,
    MarkerMissingError,
    RacketPoseError,
)
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.tasks.pendulum import Pendulum, Recurrence, whole_steps
from drake_viapoint.tasks.upswing_demonstration import (
    WatchedUpswing,
    angle_of_rod,
    recorded_upswing,
    see_pendulum,
    watch_upswing,
)
from drake_viapoint.tasks.upswing_person import FINE, PersonUpswing
from drake_viapoint.tasks.upswing_recording import TIP_NOISE
from drake_viapoint.tasks.upswing_scenario import UpswingDemonstration

SWINGERS = range(20)


@pytest.fixture(scope="module")
def seen() -> list[tuple[PersonUpswing, WatchedUpswing]]:
    return [
        (person_and_upswing(n)[1], watch_upswing(UpswingDemonstration(person=n), recorded(n)))
        for n in SWINGERS
    ]


@pytest.fixture(scope="module")
def watched() -> WatchedUpswing:
    config = UpswingDemonstration()
    return watch_upswing(config, recorded_upswing(config))


def without_tip(recording: MarkerRecording) -> MarkerRecording:
    return MarkerRecording(("hand",), recording.times, recording.positions[:, :1])


def with_gap(recording: MarkerRecording, marker: int, gap: slice) -> MarkerRecording:
    positions = recording.positions.copy()
    positions[gap, marker] = np.nan
    return MarkerRecording(recording.names, recording.times, positions)


def test_the_shipped_upswing_gives_eight_places_of_the_hand_and_an_end_near_upright(
    watched: WatchedUpswing,
) -> None:
    via_points = watched.extraction.via_points
    assert via_points.names == ("x",)
    assert via_points.times.size == 8
    assert via_points.times[0] == 0
    assert via_points.times[-1] == watched.times[-1]
    assert watched.hand[0] == 0
    assert watched.end_state.shape == (2,)
    assert abs(watched.end_state[0]) < 0.35
    assert abs(watched.end_state[1]) < 2.0
    assert watched.synthetic


def test_times_are_whole_steps_of_the_recurrence(watched: WatchedUpswing) -> None:
    """Though the file keeps its rate in 32 bits."""
    np.testing.assert_allclose(watched.times * 60, np.arange(watched.times.size), rtol=1e-12)
    assert whole_steps(watched.times[-1], 1 / 60) == watched.times.size - 1


def test_times_that_a_file_rounds_are_whole_steps_too(watched: WatchedUpswing) -> None:
    """To microseconds, as text does: 16.667 ms do not add up to whole sixtieths of a second."""
    recording = watched.recording
    rounded = MarkerRecording(recording.names, np.round(recording.times, 6), recording.positions)
    again = watch_upswing(UpswingDemonstration(), rounded)
    assert whole_steps(again.times[-1], 1 / 60) == watched.times.size - 1
    np.testing.assert_allclose(again.end_state, watched.end_state, atol=1e-6)


def test_hand_and_pendulum_are_seen_as_they_moved(
    seen: list[tuple[PersonUpswing, WatchedUpswing]],
) -> None:
    off_hand, off_angle, off_speed = [], [], []
    for upswing, watched in seen:
        assert watched.angle is not None
        assert watched.speed is not None
        noise = 4 * TIP_NOISE / np.sqrt(watched.times.size)  # four standard errors of a mean
        assert watched.length == pytest.approx(upswing.length, abs=noise)
        hand = watched.hand - upswing.hand[::FINE]
        off_hand.append(np.sqrt(np.mean((hand - hand.mean()) ** 2)))
        off_angle.append(np.sqrt(np.mean((watched.angle - upswing.angle[::FINE]) ** 2)))
        off_speed.append(np.sqrt(np.mean((watched.speed - upswing.speed[::FINE]) ** 2)))
    assert np.max(off_hand) < 2e-3
    assert np.max(off_angle) < 0.012
    assert np.max(off_speed) < 0.15


def test_the_end_state_is_the_true_one_up_to_noise(
    seen: list[tuple[PersonUpswing, WatchedUpswing]],
) -> None:
    off = np.array([w.end_state - [u.angle[-1], u.speed[-1]] for u, w in seen])
    assert np.all(np.sqrt(np.mean(off**2, axis=0)) < [0.02, 0.2])
    assert np.all(np.max(np.abs(off), axis=0) < [0.05, 0.5])


def test_six_interior_via_points_do_for_the_hand(
    seen: list[tuple[PersonUpswing, WatchedUpswing]],
) -> None:
    worst, rms = [], []
    for upswing, watched in seen:
        via_points = watched.extraction.via_points
        path = minimum_jerk(via_points.times, via_points.values)(watched.times)[:, 0]
        off = path - upswing.hand[::FINE]
        worst.append(np.max(np.abs(off)))
        rms.append(np.sqrt(np.mean(off**2)))
    assert np.median(worst) < 0.012
    assert np.max(worst) < 0.04
    assert np.median(rms) < 0.005


def test_the_same_movement_of_the_hand_fails_with_another_pendulum(
    seen: list[tuple[PersonUpswing, WatchedUpswing]],
) -> None:
    """The robot's is frictionless and 0.35 m long: most go over the top."""
    failed, over = [], []
    for _, watched in seen:
        via_points = watched.extraction.via_points
        motion = Recurrence(via_points.times, Pendulum(0.35), 1 / 60)(via_points.values[:, 0])
        off = np.array([motion.angle[-1], motion.speed[-1]]) - watched.end_state
        failed.append(abs(off[0]) >= 0.1 or abs(off[1]) >= 0.5)
        over.append(off[0] > 0.1)
    assert np.mean(failed) >= 0.9
    assert np.mean(over) > 0.5


@given(
    start=st.floats(-0.49, 0.49),
    steps=st.lists(st.floats(-2.5, 2.5), min_size=1, max_size=60),
    length=st.floats(0.05, 2.0),
    depth=st.floats(-0.1, 0.1),
)
def test_the_angle_is_followed_however_often_it_goes_round(
    start: float, steps: list[float], length: float, depth: float
) -> None:
    """Half a turn a sample is what unwrapping can follow; where the camera looks from is not."""
    theta = -np.pi + start + np.concatenate([[0.0], np.cumsum(steps)])
    rod = np.stack(
        [-length * np.sin(theta), np.full_like(theta, depth), length * np.cos(theta)], axis=1
    )
    np.testing.assert_allclose(angle_of_rod(rod), theta, atol=1e-9)


@given(turns=st.integers(-3, 3), damping=st.floats(0.0, 0.5), swing=st.floats(-0.45, 0.45))
def test_an_undriven_pendulum_is_seen_without_noise(
    turns: int, damping: float, swing: float
) -> None:
    """Small swings of a still hand, in closed form; turns of the markers' angle are none.

    What the lines smooth is bent by the damping alone, by 0.5/s times 0.14 rad/s at most, so over
    half their 0.24 s a speed is off by 0.0085 rad/s at most.
    """
    length, t = 1.0, np.arange(90) / 60
    rate = np.sqrt(9.81 / length - damping**2 / 4)
    swing *= 0.1  # so that the sine is the angle
    decay = np.exp(-damping * t / 2)
    off = swing * decay * (np.cos(rate * t) + damping / (2 * rate) * np.sin(rate * t))
    speed = -swing * decay * (9.81 / length / rate) * np.sin(rate * t)
    theta = -np.pi + off + 2 * np.pi * turns
    rod = length * np.stack([-np.sin(theta), 0 * t, np.cos(theta)], axis=1)
    pendulum = see_pendulum(t, np.zeros_like(t), rod)
    np.testing.assert_allclose(pendulum.angle, -np.pi + off, atol=1e-3)
    np.testing.assert_allclose(pendulum.speed, speed, atol=0.01)
    assert pendulum.length == pytest.approx(length)


@given(place=st.tuples(*[st.floats(-10, 10)] * 3))
def test_where_the_laboratory_has_its_origin_does_not_matter(
    place: tuple[float, float, float],
) -> None:
    recording = recorded(2)
    moved = MarkerRecording(recording.names, recording.times, recording.positions + place)
    config = UpswingDemonstration(person=2)
    one, other = watch_upswing(config, recording), watch_upswing(config, moved)
    np.testing.assert_allclose(other.hand, one.hand, atol=1e-9)
    np.testing.assert_allclose(other.end_state, one.end_state, atol=1e-8)


def test_person_0_is_the_one_in_the_shipped_file() -> None:
    filed = recorded_upswing(UpswingDemonstration())
    np.testing.assert_allclose(filed.positions, recorded(0).positions, atol=1e-6)
    other = recorded_upswing(UpswingDemonstration(person=3))
    np.testing.assert_array_equal(other.positions, recorded(3).positions)


def test_ones_own_file_is_read_and_is_not_called_synthetic(tmp_path: Path) -> None:
    own = tmp_path / "own.c3d"
    write_c3d(own, recorded(1))
    config = UpswingDemonstration(file=str(own))
    assert not watch_upswing(config, recorded_upswing(config)).synthetic
    assert watch_upswing(UpswingDemonstration(person=1), recorded(1)).synthetic


def test_a_given_end_replaces_what_was_seen(watched: WatchedUpswing) -> None:
    angle = watch_upswing(UpswingDemonstration(end_angle=0.2), watched.recording)
    np.testing.assert_array_equal(angle.end_state, [0.2, watched.end_state[1]])
    speed = watch_upswing(UpswingDemonstration(end_speed=0.0), watched.recording)
    np.testing.assert_array_equal(speed.end_state, [watched.end_state[0], 0.0])


def test_with_the_end_given_no_tip_is_needed(watched: WatchedUpswing) -> None:
    config = UpswingDemonstration(end_angle=0.0, end_speed=-0.1)
    for recording in (
        without_tip(watched.recording),
        with_gap(watched.recording, 1, slice(-3, None)),
    ):
        alone = watch_upswing(config, recording)
        np.testing.assert_array_equal(alone.end_state, [0.0, -0.1])
        np.testing.assert_array_equal(alone.hand, watched.hand)
        assert alone.pendulum is alone.angle is alone.speed is alone.length is None


@pytest.mark.parametrize(
    "config",
    [
        UpswingDemonstration(),
        UpswingDemonstration(end_angle=0.0),
        UpswingDemonstration(end_speed=0.0),
    ],
    ids=["neither", "angle alone", "speed alone"],
)
def test_an_end_neither_seen_nor_given_is_an_error(
    watched: WatchedUpswing, config: UpswingDemonstration
) -> None:
    needed = r"end state.*not given.*'tip' is absent.*end_angle.*end_speed"
    with pytest.raises(EndStateError, match=needed) as caught:
        watch_upswing(config, without_tip(watched.recording))
    assert caught.value.marker == "tip"
    assert "\n" not in str(caught.value)
    with pytest.raises(EndStateError, match="ends without it"):
        watch_upswing(config, with_gap(watched.recording, 1, slice(-2, None)))


def test_short_gaps_are_filled_and_long_ones_are_not(watched: WatchedUpswing) -> None:
    again = watch_upswing(UpswingDemonstration(), with_gap(watched.recording, 1, slice(50, 53)))
    np.testing.assert_allclose(again.end_state, watched.end_state, atol=0.05)
    again = watch_upswing(UpswingDemonstration(), with_gap(watched.recording, 0, slice(50, 53)))
    np.testing.assert_allclose(again.hand, watched.hand, atol=0.01)
    with pytest.raises(EndStateError, match=r"longer than the 0\.1 s"):
        watch_upswing(UpswingDemonstration(), with_gap(watched.recording, 1, slice(50, 60)))
    with pytest.raises(GapError, match="'hand'"):
        watch_upswing(UpswingDemonstration(), with_gap(watched.recording, 0, slice(50, 60)))


def test_a_hand_that_is_missing_is_named(watched: WatchedUpswing) -> None:
    with pytest.raises(MarkerMissingError, match="'axle'"):
        watch_upswing(UpswingDemonstration(hand="axle"), watched.recording)
    config = UpswingDemonstration(hand="axle", end_angle=0.0, end_speed=0.0)
    with pytest.raises(MarkerMissingError, match="'axle'"):
        watch_upswing(config, watched.recording)


def test_markers_by_other_names(watched: WatchedUpswing) -> None:
    recording = watched.recording
    renamed = MarkerRecording(("axle", "bob"), recording.times, recording.positions)
    again = watch_upswing(UpswingDemonstration(hand="axle", tip="bob"), renamed)
    np.testing.assert_array_equal(again.end_state, watched.end_state)


def test_a_pendulum_that_does_not_hang_at_first_is_an_error(watched: WatchedUpswing) -> None:
    recording = watched.recording
    late = MarkerRecording(recording.names, recording.times[60:], recording.positions[60:])
    with pytest.raises(HangingError, match="from hanging when the recording starts") as caught:
        watch_upswing(UpswingDemonstration(), late)
    assert abs(caught.value.deviation) > caught.value.bound == 0.5


def test_uneven_times_are_evened_out(watched: WatchedUpswing) -> None:
    """Samples a quarter period early or late, as if by a slack clock; the movement is the same."""
    upswing = person_and_upswing(1)[1]
    shift = np.random.default_rng(0).integers(-1, 2, recorded(1).times.size)
    shift[[0, -1]] = 0
    index = FINE * np.arange(shift.size) + shift
    uneven = markers_of(upswing, index)
    watched = watch_upswing(UpswingDemonstration(person=1), uneven)
    even = np.diff(watched.times)
    np.testing.assert_allclose(even, even[0], rtol=1e-9)
    truth = np.interp(watched.times, upswing.times, upswing.hand)
    np.testing.assert_allclose(watched.hand, truth, atol=2e-3)
    expected = [
        np.interp(watched.times[-1], upswing.times, upswing.angle),
        np.interp(watched.times[-1], upswing.times, upswing.speed),
    ]
    assert np.all(np.abs(watched.end_state - expected) < [0.02, 0.3])


def markers_of(upswing: PersonUpswing, index: NDArray) -> MarkerRecording:
    """Without noise, at some of the times."""
    x, theta = upswing.hand[index], upswing.angle[index]
    hand = np.stack([x, 0 * x, 0 * x], axis=1)
    rod = upswing.length * np.stack([-np.sin(theta), 0 * x, np.cos(theta)], axis=1)
    positions = np.stack([hand, hand + rod], axis=1)
    return MarkerRecording(("hand", "tip"), upswing.times[index], positions)


@pytest.mark.parametrize("number", [3, 6, 12])
def test_as_many_via_points_as_asked_for(watched: WatchedUpswing, number: int) -> None:
    config = UpswingDemonstration(via_points=number)
    assert watch_upswing(config, watched.recording).extraction.via_points.times.size == number


def test_what_cannot_be_smoothed_or_extracted_is_an_error(watched: WatchedUpswing) -> None:
    config, recording = UpswingDemonstration(), watched.recording
    with pytest.raises(RacketPoseError, match="half the sampling rate"):
        watch_upswing(replace(config, cutoff=30.0), recording)
    short = MarkerRecording(recording.names, recording.times[:5], recording.positions[:5])
    with pytest.raises(RacketPoseError, match="too few"):
        watch_upswing(config, short)
    with pytest.raises(ExtractionError, match="500 via-points"):
        watch_upswing(replace(config, via_points=500), recording)


def test_a_file_that_is_not_there_is_named() -> None:
    with pytest.raises(MarkerFileError, match=r"none\.c3d"):
        recorded_upswing(UpswingDemonstration(file="none.c3d"))
