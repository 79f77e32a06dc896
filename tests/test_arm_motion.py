"""Between the integrator's steps the motion is as good as at them."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.systems.analysis import SimulatorConfig

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.arm_motion import ArmMotion, MotionSegment
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_event import EventExecution
from drake_viapoint.tasks.serve_scenario import ServeScenario

PHASE = np.linspace(0.0, 2.0, 7)


def swing(times: NDArray) -> MotionSegment:
    """Seven joints that swing at 3 rad/s, each at its own phase."""
    angle = 3.0 * times[:, None] + PHASE
    return MotionSegment(times, np.sin(angle), 3 * np.cos(angle), -9 * np.sin(angle))


def steps(seed: int, n: int = 12) -> NDArray:
    return np.cumsum(np.random.default_rng(seed).uniform(0.001, 0.1, n))


def test_what_was_logged_is_given_back() -> None:
    segment = swing(steps(0))
    motion = ArmMotion([segment])
    assert (motion.start, motion.end) == (segment.times[0], segment.times[-1])
    np.testing.assert_allclose(motion.q(segment.times), segment.q, atol=1e-15)
    np.testing.assert_allclose(motion.v(segment.times), segment.v, atol=1e-13)
    h = 1e-4
    inside = segment.times[1:-1]
    acceleration = (motion.v(inside + h) - motion.v(inside - h)) / (2 * h)
    np.testing.assert_allclose(acceleration, segment.acceleration[1:-1], atol=1e-3)


@pytest.mark.parametrize("seed", range(5))
def test_a_quintic_is_followed_exactly(seed: int) -> None:
    times = steps(seed)
    curves = [
        np.polynomial.Polynomial(row) for row in np.random.default_rng(seed).normal(size=(7, 6))
    ]

    def values(t: NDArray, order: int) -> NDArray:
        return np.stack([curve.deriv(order)(t) if order else curve(t) for curve in curves], axis=1)

    motion = ArmMotion([MotionSegment(times, values(times, 0), values(times, 1), values(times, 2))])
    between = np.linspace(times[0], times[-1], 500)
    np.testing.assert_allclose(motion.q(between), values(between, 0), atol=1e-13)
    np.testing.assert_allclose(motion.v(between), values(between, 1), atol=1e-11)


def test_its_error_is_of_sixth_order_in_the_step() -> None:
    between = np.linspace(0.0, 1.0, 2001)
    exact = swing(between)
    errors = []
    for n in (8, 16, 32):
        motion = ArmMotion([swing(np.linspace(0.0, 1.0, n + 1))])
        errors.append(np.max(np.abs(motion.q(between) - exact.q)))
    assert errors[0] / errors[1] == pytest.approx(64, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(64, rel=0.1)
    # h^6 / 46080 times the sixth derivative, 3^6
    assert errors[0] == pytest.approx((1 / 8) ** 6 * 3**6 / 46080, rel=0.05)


def test_velocity_is_the_slope_of_the_angles() -> None:
    motion = ArmMotion([swing(steps(1))])
    h = 1e-6
    t = np.linspace(motion.start + h, motion.end - h, 300)
    slope = (motion.q(t + h) - motion.q(t - h)) / (2 * h)
    np.testing.assert_allclose(motion.v(t), slope, atol=1e-8)


def test_where_segments_meet_only_the_acceleration_jumps() -> None:
    before, after = swing(np.linspace(0.0, 0.5, 9)), swing(np.linspace(0.5, 1.0, 9))
    heavy = MotionSegment(before.times, before.q, before.v, before.acceleration - 2.0)
    motion = ArmMotion([heavy, after])
    assert (motion.start, motion.end) == (0.0, 1.0)
    e = 1e-7
    np.testing.assert_allclose(motion.q(0.5 - e), motion.q(0.5 + e), atol=1e-5)
    np.testing.assert_allclose(motion.v(0.5 - e), motion.v(0.5 + e), atol=1e-5)
    h = 1e-5
    left = (motion.v(0.5) - motion.v(0.5 - h)) / h
    right = (motion.v(0.5 + h) - motion.v(0.5)) / h
    np.testing.assert_allclose(right - left, 2.0, atol=0.02)
    alone = ArmMotion([after])
    t = np.linspace(0.5, 1.0, 50)
    np.testing.assert_allclose(motion.q(t), alone.q(t), atol=1e-15)


def test_shapes_follow_the_times() -> None:
    motion = ArmMotion([swing(steps(2))])
    middle = (motion.start + motion.end) / 2
    assert motion.q(middle).shape == (7,)
    assert motion.q([middle, middle]).shape == (2, 7)
    np.testing.assert_array_equal(motion.q(middle), motion.q([middle])[0])


def test_the_tool_moves_with_the_joints(arm: Arm) -> None:
    motion = ArmMotion([swing(steps(3))])
    times = np.linspace(motion.start, motion.end, 5)
    for t, state in zip(times, motion.tool(arm, times), strict=True):
        expected = arm.tool_motion(motion.q(t), motion.v(t))
        np.testing.assert_allclose(state.position, expected.position, atol=1e-14)
        np.testing.assert_allclose(state.velocity, expected.velocity, atol=1e-13)
        h = 1e-6
        if motion.start < t < motion.end:
            ahead, behind = motion.tool(arm, [t + h, t - h])
            slope = (ahead.position - behind.position) / (2 * h)
            np.testing.assert_allclose(state.velocity, slope, atol=1e-7)


def test_a_serve_between_its_steps_is_that_of_a_much_tighter_integration(
    serve_task: ServeTask,
) -> None:
    """Steps of 20 ms against steps of 2 ms at a hundred thousandth of the error."""
    movement = serve_task.retargeting.first
    motion = serve_task.execution.execute(movement).motion
    scenario = ServeScenario()
    scenario.simulator = SimulatorConfig(
        integration_scheme="runge_kutta5", use_error_control=False, max_step_size=2e-3
    )
    fine = EventExecution(scenario, serve_task.scene, serve_task.watched.hit_time)
    reference = fine.execute(movement).motion
    longest = max(np.max(np.diff(segment.times)) for segment in motion.segments)
    assert longest > 0.01
    times = np.linspace(motion.start, motion.end, 3000)
    # measured: 4e-6 rad and 2e-4 rad/s, of which the steps themselves account for most
    assert np.max(np.abs(motion.q(times) - reference.q(times))) < 1e-5
    assert np.max(np.abs(motion.v(times) - reference.v(times))) < 5e-4
    at_steps = max(np.max(np.abs(s.q - reference.q(s.times))) for s in motion.segments)
    assert np.max(np.abs(motion.q(times) - reference.q(times))) < 2 * at_steps


def test_after_its_trajectory_an_arm_should_stay_at_its_end() -> None:
    trajectory = minimum_jerk(np.array([0.0, 0.5, 1.0]), np.array([[0.0], [0.4], [1.0]]))

    def motion(times: np.ndarray) -> ArmMotion:
        inside = np.minimum(times, 1.0)
        q, v, a = (trajectory(inside, order) for order in range(3))
        return ArmMotion([MotionSegment(times, q, v, a)])

    assert motion(np.linspace(0.0, 1.0, 11)).strayed(trajectory) < 1e-12
    on = motion(np.linspace(0.0, 2.0, 21))
    assert on.strayed(trajectory) < 1e-12
    q = np.minimum(np.linspace(0.0, 2.0, 21), 1.5)[:, None]
    drifting = ArmMotion([MotionSegment(np.linspace(0.0, 2.0, 21), q, 0 * q, 0 * q)])
    assert drifting.strayed(trajectory) >= 0.5
