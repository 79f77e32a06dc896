import numpy as np
import pytest
from numpy.typing import NDArray

from drake_viapoint.errors import ExtractionError
from drake_viapoint.motion.extraction import extract_via_points
from drake_viapoint.motion.minimum_jerk import EndMotion, minimum_jerk

T = np.linspace(0, 1.4, 351)


def movement(d: int = 6, seed: int = 0) -> NDArray:
    """A smooth path that is not a minimum-jerk curve of few points."""
    rng = np.random.default_rng(seed)
    s = 10 * (T / T[-1]) ** 3 - 15 * (T / T[-1]) ** 4 + 6 * (T / T[-1]) ** 5
    waves = [np.sin(np.pi * k * s)[:, None] * rng.normal(size=d) / k**2 for k in range(1, 7)]
    return s[:, None] * rng.normal(size=d) + np.sum(waves, axis=0)


def test_each_point_is_where_the_error_of_the_previous_path_was_largest() -> None:
    y = movement()
    found = extract_via_points(T, y, list("abcdef"), number=6).found
    for k in range(2, 6):
        chosen = sorted(found[:k])
        error = np.sum((minimum_jerk(T[chosen], y[chosen])(T) - y) ** 2, axis=1)
        assert found[k] == np.argmax(error)


def test_threshold_is_kept_and_one_point_fewer_breaks_it() -> None:
    y = movement()
    result = extract_via_points(T, y, list("abcdef"), threshold=0.02)
    path = minimum_jerk(result.via_points.times, result.via_points.values)(T)
    assert np.max(np.linalg.norm(path - y, axis=1)) <= 0.02
    assert result.worst_errors[-2] > 0.02
    assert result.worst_errors[-1] == pytest.approx(np.max(np.linalg.norm(path - y, axis=1)))


def test_more_points_never_run_out_and_the_error_falls() -> None:
    result = extract_via_points(T, movement(), list("abcdef"), number=30)
    assert result.worst_errors.shape == result.rms_errors.shape == (29,)
    assert result.worst_errors[-1] < 1e-3 * result.worst_errors[0]


def test_one_dimensional_data_and_weights() -> None:
    y = movement(d=2, seed=1)
    alone = extract_via_points(T, y[:, 0], ["x"], number=7)
    weighted = extract_via_points(T, y, ["x", "y"], number=7, weights=[1.0, 0.0])
    assert alone.found == weighted.found
    doubled = extract_via_points(T, y, ["x", "y"], number=7, weights=[2.0, 2.0])
    plain = extract_via_points(T, y, ["x", "y"], number=7)
    np.testing.assert_allclose(doubled.worst_errors, 2 * plain.worst_errors)


def test_every_sample_a_via_point_leaves_no_error() -> None:
    t = T[::50]
    result = extract_via_points(t, movement()[::50], list("abcdef"), number=t.size)
    assert result.worst_errors[-1] == 0.0


def test_a_segment_with_its_end_motion_needs_no_more_points_than_it_has() -> None:
    whole = minimum_jerk([0.0, 0.5, 0.9, 1.4], np.array([[0.0], [1.0], [-1.0], [0.5]]))
    t = np.linspace(0.55, 0.85, 76)  # between two via-points: a single quintic
    v, a = whole.derivative(1)(t), whole.derivative(2)(t)
    ends = EndMotion(v[0], a[0], v[-1], a[-1])
    result = extract_via_points(t, whole(t), ["x"], threshold=1e-9, end_motion=ends)
    assert result.via_points.times.size == 2
    at_rest = extract_via_points(t, whole(t), ["x"], number=2)
    assert at_rest.worst_errors[0] > 1e-2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"number": 352}, "352 via-points from 351 samples"),
        ({"number": 1}, "at least 2"),
        ({"threshold": 0.0}, "must be positive"),
        ({}, "either a threshold or a number"),
        ({"number": 5, "threshold": 0.1}, "either a threshold or a number"),
        ({"number": 5, "weights": [1.0]}, "weights"),
    ],
)
def test_bad_requests(arguments: dict, message: str) -> None:
    with pytest.raises(ExtractionError, match=message):
        extract_via_points(T, movement(), list("abcdef"), **arguments)


def test_gaps_are_refused() -> None:
    y = movement()
    y[5, 2] = np.nan
    with pytest.raises(ExtractionError, match="fill gaps"):
        extract_via_points(T, y, list("abcdef"), number=5)
