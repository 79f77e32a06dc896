"""The paper's difference equation: by hand, by batch, and against continuous time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from drake_viapoint.errors import ScenarioError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.tasks.pendulum import HANGING, Pendulum, PendulumMotion, Recurrence, whole_steps

PAPERS = Pendulum(0.35)
STEP = 1 / 60
TIMES = np.linspace(0.0, 2.0, 8)


def movements(count: int, seed: int = 0, size: float = 0.15) -> NDArray:
    """Places of the hand at eight times, from 0 on."""
    x = np.random.default_rng(seed).normal(scale=size, size=(count, 8))
    x[:, 0] = 0.0
    return x


def test_five_steps_by_hand() -> None:
    """The hand starts and stops; the table was worked out step by step with a desk calculator.

    Two via-points, 0 and 0.1 m, five steps of 0.1 s: the hand follows 0.1 (10 s^3 - 15 s^4 + 6 s^5)
    with s = t / 0.5 s, so its acceleration at steps 0 to 4 is 0.4 (60 s - 180 s^2 + 120 s^3):
    0, 2.304, 1.152, -1.152, -2.304 m/s2. The length is 0.981 m, so alpha_2 = 1,
    and alpha_1 = 0.1 * 0.5 = 0.05.
    """
    table = [  # theta and speed, from rest
        (-3.141592653590, 0.0),
        (-3.141592653590, 0.0),  # 0.95 * 0 + sin(-pi) + 0
        (-3.165078892122, -0.234862385321),  # 0 + sin(-pi) + 2.304 cos(-pi) / 9.81
        (-3.196782291429, -0.317033993072),  # 0.95 * -0.23486 + sin(-3.16508) + 1.152 cos / 9.81
        (-3.209659118614, -0.128768271853),
        (-3.191658859485, 0.180002591289),
    ]
    motion = Recurrence([0.0, 0.5], Pendulum(0.981, 0.5), 0.1)([0.0, 0.1])
    np.testing.assert_allclose(motion.times, np.arange(6) / 10, atol=1e-12)
    np.testing.assert_allclose(
        np.stack([motion.angle, motion.speed], axis=1), table, rtol=0, atol=1e-11
    )


def test_alpha_2_is_the_papers() -> None:
    """0.468, printed 0.47: what a pendulum held level by nothing gains in the first step."""
    motion = Recurrence([0.0, 1.0], PAPERS, STEP)([0.0, 0.0])
    np.testing.assert_allclose(motion.angle, HANGING, atol=1e-9)  # hanging still, it stays
    assert pytest.approx(0.4671, abs=1e-4) == 9.81 * STEP / PAPERS.length


@given(seed=st.integers(0, 2**31), damping=st.sampled_from([0.0, 0.3]))
def test_a_batch_is_its_movements_one_by_one(seed: int, damping: float) -> None:
    swing = Recurrence(TIMES, Pendulum(0.35, damping), STEP)
    x = movements(4, seed)
    batch = swing(x)
    assert batch.angle.shape == batch.speed.shape == batch.hand.shape == (4, 121)
    for row in range(4):
        alone = swing(x[row])
        for one, many in zip(alone[1:], batch[1:], strict=True):
            assert one.shape == (121,)
            np.testing.assert_allclose(many[row], one, rtol=1e-6, atol=1e-6)


def test_the_hand_goes_along_its_minimum_jerk_path() -> None:
    x = movements(1)[0]
    motion = Recurrence(TIMES, PAPERS, STEP)(x)
    path = minimum_jerk(TIMES, x[:, None])(motion.times)[:, 0]
    np.testing.assert_allclose(motion.hand, path, atol=1e-12)


def test_comes_near_the_continuous_pendulum_as_the_step_shrinks() -> None:
    """First order: a tenth of the step, a tenth of the error, against a converged integration."""
    x = movements(1, 3, 0.08)[0]
    acceleration = minimum_jerk(TIMES, x[:, None]).derivative(2)

    def rates(t: float, state: NDArray) -> list[float]:
        push = float(acceleration(t)[0])
        return [state[1], (9.81 * np.sin(state[0]) + push * np.cos(state[0])) / 0.35]

    exact = solve_ivp(rates, (0.0, 2.0), [HANGING, 0.0], rtol=1e-11, atol=1e-11).y[:, -1]
    errors = []
    for step in (1e-2, 1e-3, 1e-4):
        motion = Recurrence(TIMES, PAPERS, step)(x)
        errors.append(np.linalg.norm([motion.angle[-1], motion.speed[-1]] - exact))
    assert 5 < errors[0] / errors[1] < 20
    assert 5 < errors[1] / errors[2] < 20


def test_a_mirrored_hand_mirrors_the_swing() -> None:
    swing = Recurrence(TIMES, PAPERS, STEP)
    x = movements(1, 5)[0]
    one, other = swing(x), swing(-x)
    np.testing.assert_allclose(other.angle - HANGING, HANGING - one.angle, atol=1e-6)


def test_going_over_the_top_is_not_wrapped() -> None:
    x = np.array([0.0, 0.3, -0.3, 0.35, -0.35, 0.4, -0.4, 0.0])
    angle = Recurrence(TIMES, PAPERS, STEP)(x).angle
    assert np.max(np.abs(np.diff(angle))) < 1.0  # no jump by a turn
    assert np.ptp(angle) > 2 * np.pi


def test_the_tip_is_a_length_from_the_hand_and_below_it_at_first() -> None:
    motion = Recurrence(TIMES, PAPERS, STEP)(movements(3))
    tip = motion.tip(0.35)
    assert tip.shape == (3, 121, 2)
    np.testing.assert_allclose(np.hypot(tip[..., 0] - motion.hand, tip[..., 1]), 0.35, atol=1e-12)
    np.testing.assert_allclose(tip[:, 0], [[0.0, -0.35]] * 3, atol=1e-12)
    leaning = PendulumMotion(np.zeros(1), np.zeros(1), np.array([0.5]), np.zeros(1)).tip(1.0)[0]
    assert leaning[0] < 0 < leaning[1]  # anticlockwise from the top is to the left


def test_a_time_step_has_to_divide_the_movement() -> None:
    assert whole_steps(2.0, 1 / 60) == 120
    with pytest.raises(ScenarioError, match=r"time_step 0.03 s .* of 2 s; 0.0298507463 s would"):
        Recurrence(TIMES, PAPERS, 0.03)


@pytest.mark.parametrize("x", [np.zeros(6), np.zeros((3, 9)), np.zeros((2, 2, 8)), 0.0])
def test_as_many_places_as_via_points(x: NDArray) -> None:
    with pytest.raises(ScenarioError, match="has 8 via-points, got an array of shape"):
        Recurrence(TIMES, PAPERS, STEP)(x)
