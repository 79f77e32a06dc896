import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.errors import ViaPointsError
from drake_viapoint.motion.via_points import ViaPoints

NAMES = ("x", "y", "z", "phi", "theta", "psi")


def eight() -> ViaPoints:
    return ViaPoints(np.arange(8.0), np.arange(48.0).reshape(8, 6), NAMES)


def test_columns_are_those_of_the_paper() -> None:
    points = eight()
    columns = [points.column(c) + 1 for c in ("x3", "y3", "z3", "x4", "y4", "z4")]
    assert columns == [13, 14, 15, 19, 20, 21]
    assert [points.column(c) + 1 for c in ("phi6", "phi7", "psi7")] == [34, 40, 42]
    assert points.components[33] == "phi6"


@given(st.integers(0, 47), st.floats(-1, 1))
def test_moving_changes_one_component_and_nothing_else(column: int, change: float) -> None:
    points = eight()
    moved = points.moved([points.components[column]], [change])
    difference = (moved.values - points.values).ravel()
    assert difference[column] == pytest.approx(change, abs=1e-12)
    assert np.count_nonzero(np.delete(difference, column)) == 0
    assert moved.select([points.components[column]])[0] == points.values.ravel()[column] + change


def test_equal_to_the_last_bit() -> None:
    points = eight()
    assert points == eight()
    assert points == points.moved(["x3"], [0.0])
    assert points != points.moved(["x3"], [1e-14])
    assert points != ViaPoints(points.times + 1e-14, points.values, NAMES)
    assert points != ViaPoints(points.times, points.values, NAMES[::-1])
    assert points != "x3"
    assert len({points, eight(), points.moved(["x3"], [1.0])}) == 2


def test_values_cannot_be_changed_in_place() -> None:
    with pytest.raises(ValueError, match="read-only"):
        eight().values[0, 0] = 1.0


@pytest.mark.parametrize("component", ["x0", "x9", "w3", "3x", "x", ""])
def test_unknown_component_is_named(component: str) -> None:
    with pytest.raises(ViaPointsError, match="no component"):
        eight().column(component)


def test_bad_via_points_are_named() -> None:
    with pytest.raises(ViaPointsError, match="via-point 3 is at 1 s"):
        ViaPoints(np.array([0.0, 1.0, 1.0]), np.zeros((3, 1)), ("x",))
    with pytest.raises(ViaPointsError, match="via-point 2 is not finite"):
        ViaPoints(np.arange(2.0), np.array([[0.0], [np.nan]]), ("x",))
    with pytest.raises(ViaPointsError, match="at least 2"):
        ViaPoints(np.zeros(1), np.zeros((1, 1)), ("x",))
    with pytest.raises(ViaPointsError, match=r"values \(n, 1\)"):
        ViaPoints(np.arange(2.0), np.zeros((3, 1)), ("x",))
