"""The upswing carried by the arm: how near to its line the hand stays, and what follows for it."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation
from swinging_hand import INVERTING, TIMES, movements

from drake_viapoint.errors import (
    LineReachError,
    RetargetingError,
    ScenarioError,
)
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.pendulum import HANGING
from drake_viapoint.tasks.upswing_plant import KinematicExecution
from drake_viapoint.tasks.upswing_scenario import UpswingScenario
from drake_viapoint.tasks.upswing_scene import UpswingScene
from drake_viapoint.tasks.upswing_tracked import (
    CarriedUpswing,
    TrackedExecution,
    seen_from_the_front,
)


@pytest.fixture(scope="module")
def scene() -> UpswingScene:
    return UpswingScene(UpswingScenario())


@pytest.fixture
def roughly() -> UpswingScenario:
    """One whose retargeting is done sooner."""
    scenario = UpswingScenario()
    scenario.robot.position_threshold = 1e-3
    return scenario


@pytest.fixture(scope="module")
def execution(scene: UpswingScene) -> TrackedExecution:
    return TrackedExecution(UpswingScenario(), scene, TIMES, INVERTING)


@pytest.fixture(scope="module")
def carried(execution: TrackedExecution) -> CarriedUpswing:
    return execution(INVERTING)


@pytest.fixture(scope="module")
def kinematic(scene: UpswingScene) -> KinematicExecution:
    return KinematicExecution(UpswingScenario(), scene.line, TIMES)


def test_the_hand_stays_near_its_path(execution: TrackedExecution) -> None:
    for x in [INVERTING, *movements(2, seed=4)]:
        upswing = execution(x)
        path = minimum_jerk(TIMES, x[:, None])(upswing.motion.times)[:, 0]
        assert np.max(np.abs(upswing.motion.hand - path)) < 1.2e-3
        assert upswing.hand_error < 2e-3
        assert upswing.tracking_error < 0.02
        assert (upswing.saturated, upswing.beyond_limits) == ((), ())


def test_the_pendulum_pulls_the_hand_off_its_path(carried: CarriedUpswing) -> None:
    assert carried.hand_error > 1e-4
    assert carried.tracking_error > 1e-3


def test_hand_and_pendulum_are_seen_where_the_arm_has_them(
    scene: UpswingScene, carried: CarriedUpswing
) -> None:
    """By the plant's own kinematics, bob and all."""
    own = scene.plant.CreateDefaultContext()
    body = scene.plant.GetBodyByName("pendulum").body_frame()
    length = UpswingScenario().pendulum.length
    motion = carried.motion
    world = scene.plant.world_frame()
    places = []
    for t in motion.times:
        scene.plant.SetPositions(own, scene.instance, carried.arm_motion.q(t))
        scene.joint.set_angle(own, 0.0)
        places.append(scene.plant.CalcPointsPositions(own, body, [0, 0, 0], world)[:, 0])
    start = np.array(UpswingScenario().robot.line)
    np.testing.assert_allclose(motion.hand, np.array(places)[:, 0] - start[0], atol=1e-12)
    assert (motion.times[0], motion.times[-1]) == (0, 2)
    assert motion.angle[0] == pytest.approx(HANGING, abs=1e-9)
    assert motion.speed[0] == 0
    rate = CubicSpline(motion.times, motion.angle).derivative()(motion.times)
    np.testing.assert_allclose(motion.speed[3:-3], rate[3:-3], atol=0.03)
    assert motion.tip(length).shape == (motion.times.size, 2)


def test_the_pendulum_swings_by_where_its_hinge_really_is(
    scene: UpswingScene, carried: CarriedUpswing
) -> None:
    """Its equation, driven by the accelerations of the arm's hand, gives the same end."""
    times = np.linspace(0, 2, 2001)
    places = np.array([tool.position for tool in carried.arm_motion.tool(scene.arm, times)])
    pushed = CubicSpline(times, places).derivative(2)
    length = UpswingScenario().pendulum.length

    def slope(t: float, y: NDArray) -> list[float]:
        x, _, z = pushed(t)
        return [y[1], ((GRAVITY + z) * np.sin(y[0]) + x * np.cos(y[0])) / length]

    end = solve_ivp(slope, (0, 2), [HANGING, 0], "DOP853", rtol=1e-9, atol=1e-9).y[:, -1]
    motion = carried.motion
    np.testing.assert_allclose([motion.angle[-1], motion.speed[-1]], end, atol=0.01)


def test_a_pendulum_without_weight_swings_as_if_the_hand_obeyed(
    kinematic: KinematicExecution,
) -> None:
    """What is left is that the arm meets its line only to 0.1 mm."""
    scenario = UpswingScenario()
    scenario.pendulum.mass = 1e-6
    light = TrackedExecution(scenario, UpswingScene(scenario), TIMES, INVERTING)(INVERTING)
    obeyed = kinematic(INVERTING)
    assert light.hand_error < 1.1e-4
    assert light.tracking_error < 1e-5
    assert abs(light.motion.angle[-1] - obeyed.angle[-1]) < 0.02
    assert abs(light.motion.speed[-1] - obeyed.speed[-1]) < 0.1


def test_a_carried_upswing_ends_near_one_of_a_hand_that_obeys(
    kinematic: KinematicExecution, carried: CarriedUpswing
) -> None:
    """Not the same: a millimetre of the hand is about as much as a success forgives."""
    obeyed = kinematic(INVERTING)
    assert 0.01 < abs(carried.motion.angle[-1] - obeyed.angle[-1]) < 0.2
    assert 0.05 < abs(carried.motion.speed[-1] - obeyed.speed[-1]) < 1.0


def test_the_integration_is_accurate(roughly: UpswingScenario, scene: UpswingScene) -> None:
    usual = TrackedExecution(roughly, scene, TIMES, INVERTING)
    movement = usual.movement(INVERTING)
    roughly.simulator.max_step_size = 0.001
    fine = TrackedExecution(roughly, scene, TIMES, INVERTING)
    motion, exact = (one.execute(movement, INVERTING).motion for one in (usual, fine))
    assert 0 < abs(motion.angle[-1] - exact.angle[-1]) < 1e-5
    assert 0 < abs(motion.speed[-1] - exact.speed[-1]) < 1e-4


def test_an_execution_is_the_same_whatever_came_before(
    execution: TrackedExecution, carried: CarriedUpswing
) -> None:
    for x in movements(4):
        execution(x)
    scene = UpswingScene(UpswingScenario())
    fresh = TrackedExecution(UpswingScenario(), scene, TIMES, INVERTING)
    for other in (execution(INVERTING), fresh(INVERTING)):
        assert other.motion.angle.tobytes() == carried.motion.angle.tobytes()
        assert other.motion.hand.tobytes() == carried.motion.hand.tobytes()
        ours, theirs = carried.arm_motion.segments[0], other.arm_motion.segments[0]
        assert ours.q.tobytes() == theirs.q.tobytes()
        assert ours.acceleration.tobytes() == theirs.acceleration.tobytes()


def test_a_hurried_arm_is_told_by_the_joints_that_gave_way(roughly: UpswingScenario) -> None:
    """A fifth of the time is 25 times the acceleration."""
    hurried = TrackedExecution(roughly, UpswingScene(roughly), TIMES / 5, INVERTING)(INVERTING)
    assert "SFE" in hurried.saturated
    assert "SFE" in hurried.beyond_limits
    assert hurried.hand_error > 0.02


def test_a_hand_out_of_reach_is_refused(scene: UpswingScene, execution: TrackedExecution) -> None:
    x = INVERTING.copy()
    x[5] = -0.61
    with pytest.raises(LineReachError, match="via-point 6"):
        execution(x)
    with pytest.raises(LineReachError, match="via-point 6"):
        TrackedExecution(UpswingScenario(), scene, TIMES, x)


def test_what_is_no_movement_is_refused(execution: TrackedExecution) -> None:
    with pytest.raises(ScenarioError, match="8 via-points"):
        execution(np.zeros(6))
    with pytest.raises(ScenarioError, match="finite"):
        execution(np.full(8, np.nan))


def test_a_line_that_cannot_be_followed_so_closely_is_refused(scene: UpswingScene) -> None:
    scenario = UpswingScenario()
    scenario.robot.position_threshold = 1e-9
    with pytest.raises(RetargetingError, match="supplemental via-points"):
        TrackedExecution(scenario, scene, TIMES, INVERTING)


# the view from the front


def test_a_hand_turned_about_the_pendulums_axis_turns_the_pendulum() -> None:
    angle, speed = np.array([-3.0, 0.5, 8.0]), np.array([1.0, -2.0, 0.0])
    tilt, rate = np.array([0.1, -0.2, 0.05]), np.array([0.3, 0.0, -1.0])
    turn = Rotation.from_rotvec(np.outer(tilt, [0, -1, 0])).as_matrix()
    spin = np.outer(rate, [0, -1, 0])
    seen = seen_from_the_front(angle, speed, turn, spin)
    np.testing.assert_allclose(seen, [angle + tilt, speed + rate], atol=1e-12)


def test_speed_seen_is_the_rate_of_the_angle_seen() -> None:
    """For any slow turning of the hand."""
    rng = np.random.default_rng(0)
    h = 1e-6
    for _ in range(20):
        axis, start = rng.normal(size=3), Rotation.from_rotvec(rng.normal(scale=0.1, size=3))
        angle, speed = rng.uniform(-7, 7), rng.uniform(-5, 5)
        turns = np.array(
            [(Rotation.from_rotvec(axis * t) * start).as_matrix() for t in (-h, 0.0, h)]
        )
        angles = angle + speed * np.array([-h, 0, h])
        seen, rate = seen_from_the_front(angles, np.full(3, speed), turns, np.tile(axis, (3, 1)))
        assert rate[1] == pytest.approx((seen[2] - seen[0]) / (2 * h), abs=1e-6)
        assert abs(seen[1] - angle) < 0.5
