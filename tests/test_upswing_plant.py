"""The pendulum on a hand that obeys: laws of the swing, and integrations by others."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.math import BsplineBasis
from pydrake.multibody.plant import MultibodyPlantConfig
from pydrake.systems.analysis import Simulator, SimulatorConfig
from pydrake.trajectories import BsplineTrajectory
from scipy.integrate import solve_ivp
from swinging_hand import INVERTING, TIMES, movements

from drake_viapoint.errors import LineReachError, ScenarioError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.robot.stepping import Stepping
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.pendulum import HANGING, Pendulum, PendulumMotion, Recurrence
from drake_viapoint.tasks.upswing_line import HandLine
from drake_viapoint.tasks.upswing_plant import (
    KinematicExecution,
    PushedPendulum,
    sampling_times,
)
from drake_viapoint.tasks.upswing_scenario import UpswingPendulum, UpswingRobot, UpswingScenario

LENGTH = UpswingPendulum().length


@pytest.fixture(scope="module")
def line() -> HandLine:
    return HandLine(UpswingRobot())


@pytest.fixture(scope="module")
def execution(line: HandLine) -> KinematicExecution:
    return KinematicExecution(UpswingScenario(), line, TIMES)


def swung(
    pendulum: UpswingPendulum, angle: float, duration: float, hand: BsplineTrajectory | None = None
) -> NDArray:
    """Times, angles, speeds (n, 3) of a pendulum let go from an angle, and the hand's work."""
    pushed = PushedPendulum(pendulum, MultibodyPlantConfig(time_step=0.0))
    stepping = Stepping(pushed.diagram, UpswingScenario().simulator)
    if hand is not None:
        pushed.push(hand)

    def attempt() -> list:
        stepping.reset(0.0)
        own = pushed.plant.GetMyMutableContextFromRoot(stepping.context)
        pushed.joint.set_angle(own, angle)
        rows = []

        def watch() -> bool:
            state = stepping.context.get_continuous_state_vector().CopyToVector()
            rows.append([stepping.context.get_time(), *state])
            return False

        stepping.advance(duration, watch)
        return rows

    return np.array(stepping.until_accepted(attempt))


def acceleration(x: NDArray) -> BsplineTrajectory:
    spline = minimum_jerk(TIMES, x[:, None]).derivative(2)
    basis = BsplineBasis(spline.k + 1, list(spline.t))
    points = spline.c[: basis.num_basis_functions()]
    return BsplineTrajectory(basis, [row.reshape(1, 1) for row in points])


def integrated(
    x: NDArray, length: float, damping: float, times: NDArray
) -> tuple[NDArray, NDArray]:
    """The same upswing by scipy: angles and speeds at times."""
    pushed = minimum_jerk(TIMES, x[:, None]).derivative(2)

    def slope(t: float, y: NDArray) -> list[float]:
        pull = GRAVITY * np.sin(y[0]) + float(pushed(t)[0]) * np.cos(y[0])
        return [y[1], pull / length - damping * y[1]]

    solution = solve_ivp(
        slope, (0, 2), [HANGING, 0], "DOP853", times, rtol=1e-11, atol=1e-11, max_step=0.05
    )
    return solution.y[0], solution.y[1]


# laws of the swing


def test_the_energy_of_a_swing_is_kept_for_a_minute() -> None:
    """Undamped, the hand at rest: from nearly upright, through the bottom and back."""
    _, angle, speed, work = swung(UpswingPendulum(), 0.1, 60.0).T
    assert np.ptp(angle) > 6
    energy = 0.5 * LENGTH**2 * speed**2 + GRAVITY * LENGTH * np.cos(angle)
    np.testing.assert_allclose(energy, energy[0], rtol=0, atol=1e-5 * GRAVITY * LENGTH)
    assert not work.any()


@pytest.mark.parametrize("length", [0.2, 0.35, 1.0])
def test_a_small_swing_has_its_period(length: float) -> None:
    times, angle, speed, _ = swung(UpswingPendulum(length=length), HANGING + 1e-3, 10.0).T
    rate = np.sqrt(GRAVITY / length) * (1 - 1e-3**2 / 16)
    np.testing.assert_allclose(angle, HANGING + 1e-3 * np.cos(rate * times), atol=1e-8)
    np.testing.assert_allclose(speed, -rate * 1e-3 * np.sin(rate * times), atol=1e-7)


@pytest.mark.parametrize("damping", [0.2, 1.0])
def test_a_damped_swing_decays_at_its_rate(damping: float) -> None:
    times, angle, _, _ = swung(UpswingPendulum(damping=damping, mass=0.3), HANGING + 1e-3, 8.0).T
    rate = np.sqrt(GRAVITY / LENGTH - damping**2 / 4)
    decay = np.exp(-damping * times / 2)
    expected = decay * (np.cos(rate * times) + damping / (2 * rate) * np.sin(rate * times))
    np.testing.assert_allclose(angle, HANGING + 1e-3 * expected, atol=1e-8)


def test_a_hand_that_accelerates_evenly_tilts_the_vertical() -> None:
    """Let go where gravity and acceleration balance, the pendulum stays there: tan = x''/g."""
    basis = BsplineBasis(1, [0.0, 5.0])
    even = BsplineTrajectory(basis, [np.array([[4.0]])])
    lag = np.arctan2(4.0, GRAVITY)
    _, angle, speed, work = swung(UpswingPendulum(), HANGING - lag, 5.0, even).T
    np.testing.assert_allclose(angle, HANGING - lag, atol=1e-9)
    np.testing.assert_allclose([speed, work], 0, atol=1e-9)
    # the hand runs to the right, so the bob hangs to its left
    assert -np.sin(HANGING - lag) < 0


def test_what_the_hand_does_is_what_the_pendulum_gains() -> None:
    """Work put in, less what damping takes, is the energy, in the hand's frame."""
    pendulum = UpswingPendulum(damping=0.3)
    times, angle, speed, work = swung(pendulum, HANGING, 2.0, acceleration(INVERTING)).T
    mass, length = pendulum.mass, pendulum.length
    energy = mass * (0.5 * length**2 * speed**2 + GRAVITY * length * (np.cos(angle) + 1))
    loss = pendulum.damping * mass * length**2 * speed**2
    lost = np.r_[0, np.cumsum((loss[1:] + loss[:-1]) / 2 * np.diff(times))]
    assert np.ptp(energy) > 0.1  # [J]
    assert lost[-1] > 0.01
    np.testing.assert_allclose(energy, work - lost, atol=1e-4)


# the same by others


@pytest.mark.parametrize("damping", [0.0, 0.2])
def test_it_agrees_with_another_integrator(line: HandLine, damping: float) -> None:
    scenario = UpswingScenario()
    scenario.pendulum.damping = damping
    execution = KinematicExecution(scenario, line, TIMES)
    for x in movements(8, seed=1):
        motion = execution(x)
        angle, speed = integrated(x, LENGTH, damping, execution.times)
        assert abs(motion.angle[-1] - angle[-1]) < 1e-6
        assert abs(motion.speed[-1] - speed[-1]) < 1e-6
        np.testing.assert_allclose(motion.angle, angle, atol=1e-6)
        np.testing.assert_allclose(motion.speed, speed, atol=2e-6)
        np.testing.assert_allclose(motion.hand, minimum_jerk(TIMES, x[:, None])(motion.times)[:, 0])


@pytest.mark.parametrize("x", movements(4, seed=2))
def test_in_steps_of_a_sixtieth_it_is_the_papers_recurrence(x: NDArray) -> None:
    pushed = PushedPendulum(UpswingPendulum(), MultibodyPlantConfig(time_step=1 / 60))
    pushed.push(acceleration(x))
    simulator = Simulator(pushed.diagram)
    own = pushed.plant.GetMyContextFromRoot(simulator.get_context())
    motion = Recurrence(TIMES, Pendulum(LENGTH), 1 / 60)(x)
    for time, angle, speed in list(zip(motion.times, motion.angle, motion.speed, strict=True))[
        ::12
    ]:
        simulator.AdvanceTo(time)
        assert pushed.joint.get_angle(own) == pytest.approx(angle, abs=1e-6)
        assert pushed.joint.get_angular_rate(own) == pytest.approx(speed, abs=1e-6)


def test_the_recurrence_tends_to_it_as_its_step_shrinks(execution: KinematicExecution) -> None:
    """Its angle with the step's square; its speed with the step, as it is that half a step ago."""
    x = movements(2, seed=3)[0]
    motion = execution(x)
    angle, speed, half_ago = [], [], []
    for finer in (1, 10, 100):
        step = 1 / 60 / finer
        recurrence = Recurrence(TIMES, Pendulum(LENGTH), step)(x)
        angle.append(abs(recurrence.angle[-1] - motion.angle[-1]))
        speed.append(abs(recurrence.speed[-1] - motion.speed[-1]))
        slope = GRAVITY / LENGTH * np.sin(motion.angle[-1])  # the hand is at rest
        half_ago.append(abs(recurrence.speed[-1] - (motion.speed[-1] - slope * step / 2)))
    assert 0.001 < angle[0] < 0.5  # [rad]
    assert angle[0] / angle[1] == pytest.approx(100, rel=0.2)
    assert angle[1] / angle[2] == pytest.approx(100, rel=0.2)
    assert speed[1] / speed[2] == pytest.approx(10, rel=0.2)
    assert half_ago[2] < 0.1 * speed[2]


# executions


def test_it_hangs_at_first_and_the_end_is_the_integrators(execution: KinematicExecution) -> None:
    motion = execution(INVERTING)
    assert isinstance(motion, PendulumMotion)
    assert (motion.times[0], motion.times[-1]) == (0, 2)
    assert (motion.angle[0], motion.speed[0]) == (HANGING, 0)
    _, angle, speed, _ = swung(UpswingPendulum(), HANGING, 2.0, acceleration(INVERTING))[-1]
    assert motion.angle[-1] == pytest.approx(angle, abs=1e-12)
    assert motion.speed[-1] == pytest.approx(speed, abs=1e-11)
    assert abs(motion.angle[-1]) < 0.1  # it is about to stand


def test_a_movement_that_starts_later_is_the_same(
    line: HandLine, execution: KinematicExecution
) -> None:
    later = KinematicExecution(UpswingScenario(), line, TIMES + 3)(INVERTING)
    now = execution(INVERTING)
    assert (later.times[0], later.times[-1]) == (3, 5)
    np.testing.assert_allclose(later.angle, now.angle, atol=1e-7)


def test_the_bobs_mass_does_not_matter(line: HandLine, execution: KinematicExecution) -> None:
    scenario = UpswingScenario()
    scenario.pendulum.mass = 3.0
    heavy = KinematicExecution(scenario, line, TIMES)(INVERTING)
    np.testing.assert_allclose(heavy.angle, execution(INVERTING).angle, atol=1e-9)


def test_mirrored_movements_swing_mirrored(execution: KinematicExecution) -> None:
    one, other = execution(INVERTING), execution(-INVERTING)
    np.testing.assert_allclose(one.angle - HANGING, HANGING - other.angle, atol=1e-9)


def test_an_execution_is_the_same_whatever_came_before(line: HandLine) -> None:
    used = KinematicExecution(UpswingScenario(), line, TIMES)
    for x in [*movements(10), np.zeros(8)] * 9:
        used(x)
    again = used(INVERTING)
    fresh = KinematicExecution(UpswingScenario(), line, TIMES)(INVERTING)
    assert again.angle.tobytes() == fresh.angle.tobytes()
    assert again.speed.tobytes() == fresh.speed.tobytes()
    assert again.hand.tobytes() == fresh.hand.tobytes()


def test_steps_too_long_for_the_accuracy_are_shortened(
    line: HandLine, execution: KinematicExecution
) -> None:
    scenario = UpswingScenario()
    scenario.simulator = SimulatorConfig(
        integration_scheme="runge_kutta5", accuracy=1e-7, max_step_size=0.1
    )
    motion = KinematicExecution(scenario, line, TIMES)(INVERTING)
    np.testing.assert_allclose(motion.angle, execution(INVERTING).angle, atol=1e-4)


def test_times_are_regular_and_no_further_apart_than_asked() -> None:
    times = sampling_times(np.array([0.0, 0.7, 2.0]), 1 / 60)
    np.testing.assert_allclose(times, Recurrence([0, 2], Pendulum(1.0), 1 / 60).times)
    times = sampling_times(np.array([1.0, 1.9, 2.01]), 0.1)
    assert (times[0], times[-1]) == (1.0, 2.01)
    np.testing.assert_allclose(np.diff(times), 1.01 / 11)


def test_a_hand_out_of_reach_is_refused(execution: KinematicExecution) -> None:
    x = INVERTING.copy()
    x[3] = 0.63
    with pytest.raises(LineReachError, match="via-point 4") as caught:
        execution(x)
    assert caught.value.place == 0.63
    assert caught.value.distance == pytest.approx(0.13, abs=0.01)


@pytest.mark.parametrize(
    ("x", "said"),
    [
        (np.zeros(7), r"8 via-points, got an array of shape \(7,\)"),
        (np.zeros((2, 8)), r"\(2, 8\)"),
        (np.r_[np.zeros(7), np.nan], "must be finite"),
    ],
)
def test_what_is_no_movement_is_refused(
    execution: KinematicExecution, x: NDArray, said: str
) -> None:
    with pytest.raises(ScenarioError, match=said):
        execution(x)
