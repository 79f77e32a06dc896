"""The arm through a serve, with and without the ball: mechanics, release, accuracy of the steps."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.analysis import SimulatorConfig

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.robot.arm_motion import MotionSegment
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.held_racket import HeldRacket
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.serve_swing import Swing, SwingIntegration


@pytest.fixture(scope="module")
def movement(serve_task: ServeTask) -> JointMovement:
    return serve_task.retargeting(serve_task.via_points)


@pytest.fixture(scope="module")
def swing(serve_task: ServeTask, movement: JointMovement) -> Swing:
    return SwingIntegration(serve_task.scene, ServeScenario().simulator)(movement)


@pytest.fixture(scope="module")
def exact(serve_task: ServeTask, movement: JointMovement) -> Swing:
    """Steps of 2 ms: a hundred thousandth of the error of 20 ms."""
    config = SimulatorConfig(
        integration_scheme="runge_kutta5", use_error_control=False, max_step_size=2e-3
    )
    return SwingIntegration(serve_task.scene, config)(movement)


def steps(swing: Swing) -> NDArray:
    return np.concatenate([np.diff(segment.times) for segment in swing.motion.segments])


def error(swing: Swing, exact: Swing) -> float:
    """Largest difference of a joint's angle [rad]."""
    times = np.linspace(exact.motion.start, exact.motion.end, 500)
    return float(np.max(np.abs(swing.motion.q(times) - exact.motion.q(times))))


# the steps


def test_the_defaults_are_accurate(swing: Swing, exact: Swing) -> None:
    assert error(swing, exact) < 1e-5  # [rad]
    assert swing.release is not None
    assert exact.release is not None
    assert abs(swing.release - exact.release) < 1e-5  # [s]


@pytest.mark.parametrize("accuracy", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("longest", [0.1, 0.018])
def test_rejected_steps_do_not_spoil_what_follows(
    serve_task: ServeTask, movement: JointMovement, exact: Swing, accuracy: float, longest: float
) -> None:
    """Of long steps some are rejected; then all are shortened, and the result is good."""
    config = SimulatorConfig(
        integration_scheme="runge_kutta5", accuracy=accuracy, max_step_size=longest
    )
    integrated = SwingIntegration(serve_task.scene, config)(movement)
    assert error(integrated, exact) < 2e-5
    assert steps(integrated).max() < 0.05


def test_the_integrator_is_the_one_asked_for(
    serve_task: ServeTask, movement: JointMovement, exact: Swing
) -> None:
    """A method of first order errs in proportion to its steps, and they are as long as said."""
    errors = []
    for longest in (4e-3, 2e-3):
        config = SimulatorConfig(
            integration_scheme="explicit_euler", use_error_control=False, max_step_size=longest
        )
        integrated = SwingIntegration(serve_task.scene, config)(movement)
        assert steps(integrated).max() == pytest.approx(longest, rel=1e-2)
        errors.append(error(integrated, exact))
    assert errors[1] > 1e-3
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.3)


def test_a_swing_is_the_same_whatever_came_before(
    serve_task: ServeTask, movement: JointMovement, swing: Swing
) -> None:
    config = ServeScenario().simulator
    integration = SwingIntegration(serve_task.scene, config)
    other = serve_task.retargeting(serve_task.via_points.moved(["z3", "z4"], [0.1, 0.1]))
    for _ in range(2):
        again = integration(movement)
        assert again.release == swing.release
        for one, two in zip(again.motion.segments, swing.motion.segments, strict=True):
            assert one.q.tobytes() == two.q.tobytes()
            assert one.acceleration.tobytes() == two.acceleration.tobytes()
        integration(other)


# the release


def test_the_release_joins_both_parts(swing: Swing) -> None:
    carrying, swinging = swing.motion.segments
    assert carrying.times[-1] == swinging.times[0] == swing.release
    np.testing.assert_array_equal(carrying.q[-1], swinging.q[0])
    np.testing.assert_array_equal(carrying.v[-1], swinging.v[0])
    # the ball's weight is gone at once
    assert np.max(np.abs(carrying.acceleration[-1] - swinging.acceleration[0])) > 0.05


def test_at_the_release_the_cup_no_longer_pushes(serve_task: ServeTask, swing: Swing) -> None:
    """By the joints' accelerations there, apart from how the root was found."""
    carrying = swing.motion.segments[0]
    arm, cup = serve_task.scene.arm, serve_task.scene.cup
    pushes = []
    for q, v, acceleration in zip(
        carrying.q[-3:], carrying.v[-3:], carrying.acceleration[-3:], strict=True
    ):
        context = arm.plant.CreateDefaultContext()
        arm.plant.SetPositions(context, q)
        arm.plant.SetVelocities(context, v)
        racket = arm.plant.GetFrameByName("racket")
        world = arm.plant.world_frame()
        at_cup = context, JacobianWrtVariable.kV, racket, cup.centre, world, world
        jacobian = arm.plant.CalcJacobianTranslationalVelocity(*at_cup)
        bias = arm.plant.CalcBiasTranslationalAcceleration(*at_cup)[:, 0]
        moved = jacobian @ acceleration + bias + [0.0, 0.0, GRAVITY]
        opening = racket.CalcPoseInWorld(context).rotation().matrix() @ cup.opening
        pushes.append(float(opening @ moved))
    assert pushes[-1] == pytest.approx(0.0, abs=1e-7)
    assert pushes[0] > pushes[1] > 0.01


def test_a_still_arm_keeps_the_ball(serve_task: ServeTask) -> None:
    times = np.array([0.0, 0.5, 1.0])
    angles = np.tile(serve_task.scene.arm.rest, (3, 1))
    still = JointMovement(times, angles, minimum_jerk(times, angles))
    swing = SwingIntegration(serve_task.scene, ServeScenario().simulator)(still)
    assert swing.release is None
    assert len(swing.motion.segments) == 1
    # but it gives way under the ball's weight, which the controller does not know of
    sag = np.abs(swing.motion.q(1.0) - serve_task.scene.arm.rest)
    assert 1e-3 < sag.max() < 0.05


# the mechanics


def test_the_controller_that_knows_the_arm_is_obeyed_once_the_ball_is_gone(
    serve_task: ServeTask, movement: JointMovement, swing: Swing
) -> None:
    """Then q'' = q_d'' + w^2 (q_d - q) + 2 w (q_d' - q'), to rounding error, at every step."""
    desired = movement.trajectory
    w = serve_task.scenario.robot.natural_frequency

    def wanted(segment: MotionSegment) -> NDArray:
        e, rate = desired(segment.times) - segment.q, desired(segment.times, 1) - segment.v
        return desired(segment.times, 2) + w**2 * e + 2 * w * rate

    carrying, swinging = swing.motion.segments
    np.testing.assert_allclose(swinging.acceleration, wanted(swinging), atol=1e-8)
    off = np.abs(carrying.acceleration - wanted(carrying)).max(axis=1)
    assert off.min() > 0.1  # [rad/s2] while it carries the ball


def test_the_carried_ball_pulls_the_arm_down(serve_task: ServeTask, swing: Swing) -> None:
    """At the first instant, by its weight on the inertia of arm, racket and ball together."""
    arm, cup, ball = serve_task.scene.arm, serve_task.scene.cup, serve_task.scenario.ball
    start = swing.motion.segments[0]
    plant: MultibodyPlant = arm.plant
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, start.q[0])
    world, racket = plant.world_frame(), plant.GetFrameByName("racket")
    jacobian = plant.CalcJacobianSpatialVelocity(
        context, JacobianWrtVariable.kV, racket, cup.centre, world, world
    )
    shell = 2 / 3 * ball.mass * ball.radius**2
    inertia = np.diag([shell] * 3 + [ball.mass] * 3)
    mass = plant.CalcMassMatrix(context) + jacobian.T @ inertia @ jacobian
    weight = jacobian[3:].T @ [0.0, 0.0, -ball.mass * GRAVITY]
    np.testing.assert_allclose(start.acceleration[0], np.linalg.solve(mass, weight), atol=1e-8)


def test_a_ball_without_weight_leaves_the_arm_alone(movement: JointMovement, swing: Swing) -> None:
    scenario = ServeScenario()
    scenario.ball.mass = 1e-9
    light = SwingIntegration(ServeScene(scenario), scenario.simulator)(movement)

    def strayed(swing: Swing) -> float:
        times = np.linspace(0, swing.motion.end, 500)
        return float(np.max(np.abs(swing.motion.q(times) - movement.trajectory(times))))

    assert strayed(light) < 1e-4 < 5e-3 < strayed(swing)
    assert light.release is not None
    assert swing.release is not None
    assert abs(light.release - swing.release) > 1e-4


def test_power_in_is_energy_gained(
    serve_task: ServeTask, movement: JointMovement, swing: Swing
) -> None:
    """After the release: work of the torques, reckoned from inverse dynamics, against the energy.

    Over each step by the quintic between the steps, so to the error of both.
    """
    plant = serve_task.scene.arm.plant
    context = plant.CreateDefaultContext()
    start, end = float(swing.motion.segments[1].times[0]), swing.motion.end
    times = np.linspace(start, end, 2001)
    desired, w = movement.trajectory, serve_task.scenario.robot.natural_frequency
    power, energy = [], []
    for t, q, v in zip(times, swing.motion.q(times), swing.motion.v(times), strict=True):
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        energy.append(plant.CalcKineticEnergy(context) + plant.CalcPotentialEnergy(context))
        wanted = desired(t, 2) + w**2 * (desired(t) - q) + 2 * w * (desired(t, 1) - v)
        bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
        power.append(float((plant.CalcMassMatrix(context) @ wanted + bias) @ v))
    work = np.concatenate([[0.0], np.cumsum((np.add(power[1:], power[:-1])) / 2 * np.diff(times))])
    gained = np.subtract(energy, energy[0])
    assert np.ptp(gained) > 5  # [J]
    np.testing.assert_allclose(gained, work, atol=0.01)


def test_the_arm_starts_where_the_movement_starts_and_ends_with_it(
    movement: JointMovement, swing: Swing
) -> None:
    assert (swing.motion.start, swing.motion.end) == (movement.times[0], movement.times[-1])
    np.testing.assert_array_equal(swing.motion.q(0.0), movement.angles[0])
    np.testing.assert_array_equal(swing.motion.v(0.0), 0)
    assert not swing.clamped.any()


def test_the_racket_held_moves_with_the_arm(serve_task: ServeTask, swing: Swing) -> None:
    racket = HeldRacket(serve_task.scene.arm, swing.motion)
    assert (racket.start, racket.end) == (swing.motion.start, swing.motion.end)
    h = 1e-6
    times = np.array([0.2, 0.6, 0.9, 1.2])
    state = racket(times)
    slope = (racket(times + h).position - racket(times - h).position) / (2 * h)
    np.testing.assert_allclose(state.velocity, slope, atol=1e-6)
