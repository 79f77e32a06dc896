"""The ball stays in the cup while the cup pushes it: release times in closed form."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from moving_racket import Gliding, Oscillating
from scipy.spatial.transform import Rotation

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.tasks.carried_ball import Cup
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.racket import PoseSpline

CUP = Cup(np.array([-0.1, 0.0, -0.43]), np.array([-1.0, 0.0, 0.0]))


@given(st.floats(0.05, 0.4), st.floats(1.05, 5.0), st.floats(-2, 2))
def test_it_leaves_when_the_cup_falls_away_faster_than_the_ball(
    amplitude: float, excess: float, sideways: float
) -> None:
    """Of a cup that goes z = A sin(w t): first when A w^2 sin(w t) = g."""
    frequency = np.sqrt(excess * GRAVITY / amplitude)
    racket = Oscillating(amplitude, frequency, end=2 * np.pi / frequency, sideways=sideways)
    expected = np.arcsin(1 / excess) / frequency
    release = CUP.release_time(racket)
    assert release == pytest.approx(expected, abs=1e-8)
    ball = CUP.ball(racket, [release])
    # it leaves with the cup's velocity, upwards
    speed = amplitude * frequency * np.cos(frequency * expected)
    np.testing.assert_allclose(ball.velocity[0], [sideways, 0.0, speed], atol=1e-6)


@given(st.floats(0.01, 0.4), st.floats(0.05, 0.999))
def test_a_cup_that_slows_less_than_gravity_keeps_it(amplitude: float, share: float) -> None:
    frequency = np.sqrt(share * GRAVITY / amplitude)
    racket = Oscillating(amplitude, frequency, end=2 * np.pi / frequency)
    assert CUP.release_time(racket) is None


def test_the_push_is_gravity_and_acceleration_along_the_opening() -> None:
    racket = Oscillating(0.2, 9.0, end=1.5, sideways=1.0)
    times = np.linspace(0, 1.5, 200)
    np.testing.assert_allclose(
        CUP.support(racket, times)[1:-1],
        (GRAVITY - 0.2 * 81 * np.sin(9 * times))[1:-1],
        atol=1e-7,
    )
    # at the ends the difference is one-sided
    np.testing.assert_allclose(
        CUP.support(racket, times[[0, -1]]),
        GRAVITY - 0.2 * 81 * np.sin(9 * times[[0, -1]]),
        atol=1e-2,
    )


@pytest.mark.parametrize("tilt", [0.0, 0.5, 1.0, 1.5])
def test_a_tilted_cup_at_rest_is_pushed_by_the_part_of_gravity_along_it(tilt: float) -> None:
    upright = Rotation.from_matrix([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    turned = Rotation.from_euler("X", tilt) * upright
    still = Gliding(turned, np.zeros(3), np.zeros(3), np.zeros(3))
    np.testing.assert_allclose(CUP.support(still, [0.5]), GRAVITY * np.cos(tilt), atol=1e-9)
    assert CUP.release_time(still) is None


def test_a_cup_upside_down_lets_go_at_once() -> None:
    upright = Rotation.from_matrix([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    over = Gliding(Rotation.from_euler("X", 2.0) * upright, *np.zeros((3, 3)))
    assert CUP.release_time(over) == 0.0


def test_a_turning_cup_lets_go_where_the_centripetal_acceleration_outweighs_gravity() -> None:
    """About a horizontal axis, the cup's bottom away from it: held below, thrown off above.

    The ball circles at radius r, the cup opens along the circle's tangent, so the centripetal part
    is across the opening and the ball leaves where the tangent turns downwards.
    """
    cup = Cup(np.array([0.0, 0.0, -0.4]), np.array([-1.0, 0.0, 0.0]))
    upright = Rotation.from_matrix([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    w = 2.0
    racket = Gliding(upright, np.zeros(3), np.array([0.0, w, 0.0]), np.zeros(3))
    # the opening, up at first, has turned by w t about y: its height is cos(w t)
    assert cup.release_time(racket) == pytest.approx(np.pi / 2 / w, abs=1e-8)


def test_opening_inwards_it_is_held_by_the_turn() -> None:
    """A cup that opens towards the axis: w^2 r - g cos(angle) pushes; too slow, and it falls."""
    cup = Cup(np.array([0.4, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]))
    upright = Rotation.from_matrix([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])

    def circling(w: float) -> Gliding:
        return Gliding(
            upright, np.zeros(3), np.array([0.0, w, 0.0]), np.zeros(3), end=2 * np.pi / w
        )

    fast = np.sqrt(GRAVITY / 0.4)
    assert cup.release_time(circling(1.01 * fast)) is None
    w = 0.8 * fast
    # hanging below the axis at first; above it by angle a past the side, w^2 r = -g cos(w t)
    expected = np.arccos(-(w**2) * 0.4 / GRAVITY) / w
    assert cup.release_time(circling(w)) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("seed", range(4))
def test_the_ball_moves_with_the_cup(seed: int) -> None:
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-0.4, 0.4, (6, 6)) + [0.5, 0.4, 1.1, 0.0, np.pi / 2, 0.3]
    racket = PoseSpline(minimum_jerk(np.linspace(0, 1.2, 6), poses))
    h = 1e-6
    t = np.linspace(h, 1.2 - h, 50)
    now = CUP.ball(racket, t)
    slope = (CUP.ball(racket, t + h).position - CUP.ball(racket, t - h).position) / (2 * h)
    np.testing.assert_allclose(now.velocity, slope, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(now.opening, axis=1), 1, atol=1e-12)
    fine = np.arange(0, 1.2, 1e-4)
    pulled = np.nonzero(CUP.support(racket, fine) < 0)[0]
    release = CUP.release_time(racket)
    if pulled.size:
        assert release == pytest.approx(fine[pulled[0]], abs=1.1e-4)
    else:
        assert release is None
