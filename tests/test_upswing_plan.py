"""Plans of an upswing: upright in the mind, to rest at the end, and going on from where one is."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import BSpline

from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.upswing_plan import FRAME, HandState, Mind, SwingState, first_plan
from drake_viapoint.tasks.upswing_plan import plan_anew as anew

MIND = Mind(length=0.35, damping=0.15, reach=0.28)
FRAMES = 120


def plan(seed: int) -> BSpline:
    found = first_plan(MIND, FRAMES, np.random.default_rng(seed))
    assert found is not None
    return found


def end_of(path: BSpline, start: SwingState, frames: int) -> tuple[float, float]:
    """Of the pendulum in the mind, integrated by an independent method."""
    push = path.derivative(2)

    def change(t: float, state: np.ndarray) -> list[float]:
        theta, omega = state
        pull = GRAVITY * np.sin(theta) + float(push(t)) * np.cos(theta)
        return [omega, pull / MIND.length - MIND.damping * omega]

    motion = solve_ivp(change, (0, FRAME * frames), list(start), rtol=1e-8, atol=1e-8)
    return float(motion.y[0, -1]), float(motion.y[1, -1])


@pytest.mark.parametrize("seed", range(5))
def test_a_first_plan_ends_upright_in_the_mind(seed: int) -> None:
    """Up to the mind's own steps of a sixtieth of a second."""
    path = plan(seed)
    angle, speed = end_of(path, SwingState(-np.pi, 0.0), FRAMES)
    assert abs(angle) < 0.15
    assert abs(speed) < 0.8
    t = np.linspace(0, FRAME * FRAMES, 500)
    assert np.max(np.abs(path(t))) < MIND.reach + 0.05
    assert np.max(np.abs(path(t, 2))) < 17


def test_a_plan_goes_from_rest_to_rest() -> None:
    path = plan(0)
    for order in (0, 1, 2):
        assert path(0.0, order) == pytest.approx(0, abs=1e-9)
    for order in (1, 2):
        assert path(FRAME * FRAMES, order) == pytest.approx(0, abs=1e-9)


def test_other_ideas_are_other_plans_and_the_same_the_same() -> None:
    assert plan(1).c.tobytes() == plan(1).c.tobytes()
    assert np.max(np.abs(plan(1).c - plan(2).c)) > 0.01


def test_a_new_plan_goes_on_from_the_state_of_the_hand_and_mends_the_end() -> None:
    path, elapsed = plan(0), 40
    rest = FRAMES - elapsed
    now = FRAME * elapsed
    push = path.derivative(2)

    def change(t: float, state: np.ndarray) -> list[float]:
        pull = GRAVITY * np.sin(state[0]) + float(push(t)) * np.cos(state[0])
        return [state[1], pull / MIND.length - MIND.damping * state[1]]

    swung = solve_ivp(change, (0, now), [-np.pi, 0.0], rtol=1e-8, atol=1e-8).y[:, -1]
    disturbed = SwingState(float(swung[0]) + 0.1, float(swung[1]) - 0.5)
    hand = HandState(float(path(now)) + 0.005, float(path(now, 1)), float(path(now, 2)) + 0.3)
    mended = anew(MIND, rest, hand, disturbed, path, now)
    for order, value in enumerate(hand):
        assert mended(0.0, order) == pytest.approx(value, abs=1e-9)
    for order in (1, 2):
        assert mended(FRAME * rest, order) == pytest.approx(0, abs=1e-9)

    shifted = BSpline(path.t - now, path.c, 5)
    before, after = (abs(end_of(p, disturbed, rest)[0]) for p in (shifted, mended))
    assert before > 0.3
    assert after < 0.1


def test_too_short_a_time_gives_no_plan() -> None:
    assert first_plan(MIND, 30, np.random.default_rng(0)) is None
