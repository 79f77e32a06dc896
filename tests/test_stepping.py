"""Steps of one length, halved until none is rejected: how long, how good, where they stop."""

import numpy as np
import pytest
from pydrake.symbolic import Variable, sin
from pydrake.systems.analysis import SimulatorConfig
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import SymbolicVectorSystem
from scipy.integrate import solve_ivp

from drake_viapoint.robot.stepping import Stepping

START = np.array([3.0, 0.0])
END = 2.0


def swing() -> Diagram:
    """A pendulum of 1 m in a gravity of 30 m/s2."""
    angle, speed = Variable("angle"), Variable("speed")
    builder = DiagramBuilder()
    builder.AddSystem(
        SymbolicVectorSystem(state=[angle, speed], dynamics=[speed, -30 * sin(angle)])
    )
    return builder.Build()


def config(longest: float, accuracy: float) -> SimulatorConfig:
    return SimulatorConfig(
        integration_scheme="runge_kutta5", accuracy=accuracy, max_step_size=longest
    )


def integrate(stepping: Stepping, attempts: list[float] | None = None) -> tuple[list, list]:
    """Times and states of the steps."""

    def attempt() -> tuple[list, list]:
        times: list[float] = []
        states: list = []
        stepping.reset(0.0)
        stepping.context.SetContinuousState(START)

        def watch() -> bool:
            times.append(stepping.context.get_time())
            states.append(stepping.context.get_continuous_state_vector().CopyToVector())
            return False

        stepping.advance(END, watch)
        if attempts is not None:
            attempts.append(times[1])
        return times, states

    return stepping.until_accepted(attempt)


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    solution = solve_ivp(
        lambda _, y: [y[1], -30 * np.sin(y[0])], (0, END), START, rtol=1e-12, atol=1e-12
    )
    return solution.y[:, -1]


def test_steps_that_are_good_enough_are_the_longest_allowed(exact: np.ndarray) -> None:
    times, states = integrate(Stepping(swing(), config(0.01, 1e-4)))
    lengths = np.diff(times)
    # the integrator feels its way with two shorter ones
    assert np.mean(np.isclose(lengths, 0.01)) > 0.98
    assert times[0] == 0
    assert times[-1] == END
    np.testing.assert_allclose(states[-1], exact, atol=1e-5)


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6])
def test_steps_are_halved_until_none_is_rejected(exact: np.ndarray, accuracy: float) -> None:
    accepted: list[float] = []
    times, states = integrate(Stepping(swing(), config(0.1, accuracy)), accepted)
    longest = np.diff(times).max()
    halvings = np.log2(0.1 / longest)
    assert round(halvings) >= 1
    assert halvings == pytest.approx(round(halvings), abs=1e-6)
    assert len(accepted) == 1  # those broken off come to no end
    np.testing.assert_allclose(states[-1], exact, atol=100 * accuracy)


def test_when_no_halving_helps_the_last_attempt_counts() -> None:
    times, _ = integrate(Stepping(swing(), config(1.0, 1e-10)))
    assert times[-1] == END
    assert np.diff(times).max() <= 1.0 / 16


def test_a_watch_stops_at_the_step_it_says() -> None:
    stepping = Stepping(swing(), config(0.01, 1e-4))
    stepping.reset(0.5)
    stepping.context.SetContinuousState(START)
    stepping.advance(END, lambda: stepping.context.get_time() > 0.8)
    assert 0.8 < stepping.context.get_time() < 0.8101


def test_a_watch_that_stops_at_once_lets_nothing_move() -> None:
    stepping = Stepping(swing(), config(0.01, 1e-4))
    stepping.reset(0.5)
    stepping.context.SetContinuousState(START)
    stepping.advance(END, lambda: True)
    assert stepping.context.get_time() == 0.5
    state = stepping.context.get_continuous_state_vector().CopyToVector()
    np.testing.assert_array_equal(state, START)


def test_it_goes_from_any_state_to_any_time() -> None:
    stepping = Stepping(swing(), config(0.01, 1e-4))
    times, states = integrate(stepping)
    stepping.go(times[100], states[100], times[104])
    state = stepping.context.get_continuous_state_vector().CopyToVector()
    np.testing.assert_allclose(state, states[104], atol=1e-8)
    assert stepping.context.get_time() == times[104]


def test_an_integration_is_the_same_whatever_came_before() -> None:
    """Whether steps were halved or not, nothing of it is left."""
    for settings in (config(0.01, 1e-4), config(0.1, 1e-6)):
        used = Stepping(swing(), settings)
        first = integrate(used)
        for _ in range(20):
            again = integrate(used)
        fresh = integrate(Stepping(swing(), settings))
        for other in (again, fresh):
            assert other[0] == first[0]
            assert np.array(other[1]).tobytes() == np.array(first[1]).tobytes()


def marched(stepping: Stepping, steps: list[float]) -> np.ndarray:
    """The state at the end, after marches that end at these times."""
    stepping.reset(0.0)
    stepping.context.SetContinuousState(START)
    stepping.set_clock(0.0)
    for end in steps:
        stepping.march(end, 0.01)
        assert stepping.context.get_time() == end
    state: np.ndarray = stepping.context.get_continuous_state_vector().CopyToVector()
    return state


def test_marching_goes_to_the_very_times_asked_for(exact: np.ndarray) -> None:
    ends = [0.0123, 0.5, 1.2345, END]
    np.testing.assert_allclose(
        marched(Stepping(swing(), config(0.5, 1e-8)), ends), exact, atol=1e-5
    )


def test_another_clock_leaves_the_state_alone() -> None:
    stepping = Stepping(swing(), config(0.01, 1e-6))
    state = marched(stepping, [0.5])
    stepping.set_clock(7.0)
    assert stepping.context.get_time() == 7.0
    np.testing.assert_array_equal(
        stepping.context.get_continuous_state_vector().CopyToVector(), state
    )
    stepping.march(7.5, 0.01)
    went_on = stepping.context.get_continuous_state_vector().CopyToVector()
    np.testing.assert_array_equal(
        went_on.round(9), marched(stepping, [0.5, 1.0]).round(9), "it does not depend on the clock"
    )


def test_an_integrator_that_does_not_get_on_says_so() -> None:
    x = Variable("x")
    builder = DiagramBuilder()
    builder.AddSystem(SymbolicVectorSystem(state=[x], dynamics=[x * x]))  # infinite at t = 1
    stepping = Stepping(builder.Build(), config(0.1, 1e-6))
    stepping.reset(0.0)
    stepping.context.SetContinuousState([1.0])
    stepping.set_clock(0.0)
    with pytest.raises(RuntimeError, match="step"):
        stepping.march(1.5, 0.1)
    assert stepping.context.get_time() == pytest.approx(1.0, abs=1e-3)
