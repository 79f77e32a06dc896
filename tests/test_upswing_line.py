"""The hand's line: where it is, what of it the arm reaches, and what is said of the rest."""

import numpy as np
import pytest

from drake_viapoint.errors import LineReachError, ScenarioError, UnreachableError
from drake_viapoint.tasks.upswing_line import HandLine, LineCheck
from drake_viapoint.tasks.upswing_scenario import UpswingRobot

TIMES = np.linspace(0, 2, 8)


@pytest.fixture(scope="module")
def line() -> HandLine:
    return HandLine(UpswingRobot())


def test_the_axle_looks_forward_at_rest_where_the_line_starts(line: HandLine) -> None:
    pose = line.arm.tool_pose(line.arm.rest)
    np.testing.assert_allclose(pose.rotation, line.rotation, atol=1e-12)
    np.testing.assert_allclose(pose.rotation[:, 1], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(pose.position, UpswingRobot().line, atol=5e-3)


def test_the_hand_keeps_its_pose_along_the_line(line: HandLine) -> None:
    start = np.array(UpswingRobot().line)
    for x in np.linspace(-0.49, 0.49, 15):
        pose = line.arm.tool_pose(line.posture(x))
        np.testing.assert_allclose(pose.position, start + [x, 0, 0], atol=1e-9)
        np.testing.assert_allclose(pose.rotation, line.rotation, atol=1e-9)


def test_postures_found_together_are_those_found_one_by_one(line: HandLine) -> None:
    places = np.linspace(*line.reach, 9)
    alone = [line.posture(x) for x in places]
    np.testing.assert_allclose(line.postures(places), alone, atol=1e-10)
    with pytest.raises(UnreachableError, match=r"the hand at x = 0\.800 m"):
        line.postures(np.array([0.1, 0.8, 0.2]))


def test_the_shipped_line_is_at_ease_where_people_swing(line: HandLine) -> None:
    """Within 0.42 m of the middle: limits are far, joints turn slowly, nothing meets anything."""
    limits = line.arm.limits
    places = np.linspace(-0.42, 0.42, 43)
    postures = np.array([line.posture(x) for x in places])
    assert np.minimum(postures - limits.lower, limits.upper - postures).min() > 0.28
    assert np.abs(np.diff(postures, axis=0) / np.diff(places)[:, None]).max() < 6  # [rad/m]
    joints = np.array([line.arm.joint_positions(q) for q in postures])
    assert joints[:, :-1, 1].max() < UpswingRobot().line[1] - 0.09  # behind the pendulum's plane
    assert joints[:, 4, 2].max() < 1.1  # the elbow, below the shoulder
    for q in postures:
        jacobian = line.arm.tool_jacobian(q)
        jacobian[:3] *= 0.2  # [m] makes turns comparable
        assert np.linalg.svd(jacobian)[1][-1] > 0.06


def test_reach_ends_where_the_arm_does(line: HandLine) -> None:
    low, high = line.reach
    assert low == pytest.approx(-0.5, abs=0.01)
    assert high == pytest.approx(0.5, abs=0.01)
    for x in (low, high):
        line.posture(x)
        with pytest.raises(UnreachableError):
            line.posture(x + np.sign(x) * 0.01)


def test_via_points_are_poses_along_the_line(line: HandLine) -> None:
    points = line.via_points([0, 1, 2], [0, 0.1, -0.2])
    assert points.names == ("x", "y", "z", "phi", "theta", "psi")
    np.testing.assert_array_equal(points.values[:, 0], [0, 0.1, -0.2])
    np.testing.assert_array_equal(points.values[:, 1:], np.tile(points.values[0, 1:], (3, 1)))
    np.testing.assert_array_equal(points.values[:, :3], line.places(np.array([0, 0.1, -0.2])))


def test_a_via_point_out_of_reach_is_named_with_its_excess(line: HandLine) -> None:
    check = LineCheck(line, TIMES)
    x = np.array([0, 0.1, -0.2, 0.3, -0.7, 0.6, 0.0, 0.0])
    with pytest.raises(LineReachError) as caught:
        check(x)
    error = caught.value
    assert error.label == "via-point 5"
    assert error.place == -0.7
    assert error.reach == line.reach
    assert error.distance == pytest.approx(0.2, abs=0.005)
    message = str(error)
    assert "via-point 5" in message
    assert "-0.700 m" in message
    assert f"{1e3 * error.distance:.1f} mm" in message
    assert "\n" not in message
    assert isinstance(error, UnreachableError)


def test_a_path_out_of_reach_between_via_points_is_named_by_its_time(line: HandLine) -> None:
    """Two neighbours at the edge: the hand swings beyond it between them."""
    x = np.array([0, -0.2, -0.3, 0.485, 0.485, -0.2, 0.0, 0.0])
    with pytest.raises(LineReachError, match=r"the hand at \d\.\d{3} s") as caught:
        LineCheck(line, TIMES)(x)
    assert 0 < caught.value.distance < 0.3
    time = float(caught.value.label.split()[-2])
    assert TIMES[3] < time < TIMES[4]


def test_movements_within_reach_pass(line: HandLine) -> None:
    LineCheck(line, TIMES)(np.array([0, 0.1, -0.2, 0.4, -0.4, 0.3, 0.1, 0.0]))


@pytest.mark.parametrize("orientation", [[0.3, 1.5708, 0.0], [3.14159, 1.5708, 0.0], [0, 0, 0.1]])
def test_an_axle_that_does_not_look_forward_is_refused(orientation: list[float]) -> None:
    robot = UpswingRobot()
    robot.orientation = orientation
    with pytest.raises(ScenarioError, match=r"robot\.orientation must have its y axis forward"):
        HandLine(robot)


def test_a_line_that_starts_out_of_reach_is_refused() -> None:
    robot = UpswingRobot()
    robot.line = [0.0, 2.0, 1.0]
    with pytest.raises(ScenarioError, match=r"robot\.line") as caught:
        HandLine(robot)
    assert "\n" not in str(caught.value)
