"""Virtual swingers: everyone's own pendulum ends up, by its own laws, and the same every time."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.signal import find_peaks
from virtual_swingers import person_and_upswing

from drake_viapoint.errors import DemonstrationError
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.upswing_person import (
    FINE,
    LARGEST_REACH,
    PersonUpswing,
    UpswingPerson,
    draw_person,
    practise,
    reversals,
    worked,
)
from drake_viapoint.tasks.upswing_plan import first_plan
from drake_viapoint.tasks.upswing_recording import upswing_of

LOOK = 16 / 60  # [s] a quarter second and a little


@pytest.fixture(scope="module")
def swung() -> list[tuple[UpswingPerson, PersonUpswing]]:
    return [person_and_upswing(number) for number in range(20)]


def test_the_pendulum_hangs_at_first_and_is_up_at_the_end(
    swung: list[tuple[UpswingPerson, PersonUpswing]],
) -> None:
    for _, upswing in swung:
        assert (upswing.angle[0], upswing.speed[0]) == (-np.pi, 0)
        assert abs(upswing.angle[-1]) < 0.3
        assert abs(upswing.speed[-1]) < 1.5


def test_the_hand_moves_as_hands_do(swung: list[tuple[UpswingPerson, PersonUpswing]]) -> None:
    for person, upswing in swung:
        step = 1 / 60 / FINE
        np.testing.assert_allclose(np.diff(upswing.times), step, rtol=1e-9)
        assert upswing.times[-1] * 60 == pytest.approx(person.frames, rel=1e-12)
        assert 1.2 <= upswing.times[-1] <= 2.4
        assert upswing.hand[0] == 0
        assert 0.15 < np.max(np.abs(upswing.hand)) <= LARGEST_REACH
        assert 6 < np.max(np.abs(upswing.acceleration)) < 18
        sides = (upswing.hand, -upswing.hand)
        turns = [find_peaks(side, prominence=0.01)[0].size for side in sides]
        assert 2 <= sum(turns) <= 5


def test_place_and_acceleration_of_the_hand_belong_together(
    swung: list[tuple[UpswingPerson, PersonUpswing]],
) -> None:
    """To second order; at a look, where the jerk jumps, to first. At rest at both ends."""
    step = 1 / 60 / FINE
    for _, upswing in swung:
        differences = np.diff(upswing.hand, 2) / step**2
        assert np.max(np.abs(differences - upswing.acceleration[1:-1])) < 0.5
        assert np.median(np.abs(differences - upswing.acceleration[1:-1])) < 0.01
        assert upswing.acceleration[[0, -1]] == pytest.approx(0, abs=1e-9)
        assert np.max(np.abs(np.diff(upswing.hand)[[0, -1]])) / step < 1e-3


@pytest.mark.parametrize("number", [130, 151])
def test_who_has_much_to_mend_still_moves_the_hand_gently(number: int) -> None:
    """Nobody of the first 220 moves harder; with no dislike of it these would reach 18 m/s2."""
    assert np.max(np.abs(person_and_upswing(number)[1].acceleration)) < 16


def test_a_reversal_is_a_turn_and_a_centimetre_back() -> None:
    t = np.linspace(0, 1, 500)
    assert reversals(t) == 0
    assert reversals(-t) == 0
    assert reversals(np.zeros(9)) == 0
    assert reversals(0.1 * np.sin(2 * np.pi * t)) == 2
    assert reversals(0.1 * np.cos(5 * np.pi * t)) == 4
    assert reversals(t + 0.004 * np.sin(80 * t)) == 0  # trembling is none
    assert reversals(np.array([0, 0.1, 0.085, 0.2])) == 2
    assert reversals(np.array([0, 0.1, 0.095, 0.2])) == 0


def rates(
    person: UpswingPerson, push: Callable[[float], NDArray]
) -> Callable[[float, NDArray], list[float]]:
    """The pendulum's equation of motion, written here once more."""

    def change(t: float, state: NDArray) -> list[float]:
        theta, omega = state
        drag = person.damping * omega + person.friction * np.tanh(omega / 0.05)
        drive = float(push(t)) * np.cos(theta) / person.length
        return [omega, GRAVITY / person.length * np.sin(theta) + drive - drag]

    return change


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_pendulum_swings_as_an_independent_integration_has_it(friction: float) -> None:
    person = replace(draw_person(4), friction=friction)
    step = 1 / 240
    times = step * np.arange(481)

    def push(t: float) -> float:
        return float(9.0 * np.sin(6.0 * t))

    halves = np.array([push(t) for t in step / 2 * np.arange(961)])
    angle, speed = person.swing(-3.0, 0.2, halves, step)
    reference = solve_ivp(
        rates(person, push), (0, 2), [-3.0, 0.2], "DOP853", times, rtol=1e-10, atol=1e-10
    )
    assert reference.t.size == angle.size == 481
    np.testing.assert_allclose(angle, reference.y[0], atol=2e-5)
    np.testing.assert_allclose(speed, reference.y[1], atol=2e-4)


def test_a_whole_upswing_obeys_the_equation_of_motion(
    swung: list[tuple[UpswingPerson, PersonUpswing]],
) -> None:
    """From look to look, with the acceleration interpolated between its samples."""
    for person, upswing in swung[:5]:
        looks = [*np.arange(0, upswing.times[-1] - 0.2, LOOK), upswing.times[-1]]
        for start, end in pairwise(np.round(np.array(looks) * 240).astype(int)):
            part = slice(start, end + 1)
            push = CubicSpline(upswing.times[part], upswing.acceleration[part])
            first = [upswing.angle[start], upswing.speed[start]]
            span = (upswing.times[start], upswing.times[end])
            reference = solve_ivp(rates(person, push), span, first, rtol=1e-8, atol=1e-8)
            assert upswing.angle[end] == pytest.approx(reference.y[0, -1], abs=2e-5)
            assert upswing.speed[end] == pytest.approx(reference.y[1, -1], abs=2e-4)


def test_without_friction_energy_is_kept_and_with_it_lost() -> None:
    still = np.zeros(2 * 2400 + 1)

    def energies(person: UpswingPerson) -> NDArray:
        angle, speed = person.swing(-1.0, 0.0, still, 1 / 240)
        return 0.5 * speed**2 + GRAVITY / person.length * np.cos(angle)

    free = energies(replace(draw_person(0), damping=0.0, friction=0.0))
    np.testing.assert_allclose(free, free[0], atol=1e-5)
    for drag in ({"damping": 0.2, "friction": 0.0}, {"damping": 0.0, "friction": 0.2}):
        lossy = energies(replace(draw_person(0), **drag))
        assert np.max(np.diff(lossy)) < 1e-7
        assert lossy[-1] < lossy[0] - 1


def test_everyone_has_a_pendulum_of_their_own_and_knows_it_roughly() -> None:
    people = [draw_person(number) for number in range(50)]
    for name in ("length", "damping", "friction", "mind", "unsteadiness"):
        assert len({getattr(person, name) for person in people}) == 50
    for person in people:
        assert abs(person.length / 0.35 - 1) <= 0.02
        assert 0.05 <= person.damping <= 0.3
        assert 0 <= person.friction <= 0.3
        assert 0 < abs(person.mind.length / person.length - 1) <= 0.02
        assert 0 < abs(person.mind.damping / person.damping - 1) <= 0.3


def test_it_takes_looking_to_succeed() -> None:
    """Most who only followed their first plan, even with a steady hand, would not end up."""
    up = 0
    for number in range(20):
        person = draw_person(number)
        plan = first_plan(person.mind, person.frames, np.random.default_rng([1998, number, 2]))
        assert plan is not None
        push = plan(np.linspace(0, person.frames / 60, 8 * person.frames + 1), 2)
        angle, speed = person.swing(-np.pi, 0.0, push, 1 / 240)
        up += abs(angle[-1]) < 0.3 and abs(speed[-1]) < 1.5
    assert up < 10


def test_the_same_person_swings_the_same_to_the_bit(
    swung: list[tuple[UpswingPerson, PersonUpswing]],
) -> None:
    first, again = swung[2][1], upswing_of(2)
    for one, other in zip(first, again, strict=True):
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()


def test_other_persons_and_other_luck_are_other_upswings(
    swung: list[tuple[UpswingPerson, PersonUpswing]],
) -> None:
    ends = {float(upswing.angle[-1]) for _, upswing in swung}
    assert len(ends) == 20
    assert len({upswing.times[-1] for _, upswing in swung}) > 10
    person, upswing = swung[0]
    assert practise(person, np.random.default_rng(9)).hand[50] != upswing.hand[50]
    assert draw_person(3, seed=1).length != draw_person(3).length


def test_what_counts_as_having_worked(
    swung: list[tuple[UpswingPerson, PersonUpswing]],
) -> None:
    upswing = swung[0][1]
    assert worked(upswing)

    def ending(angle: float, speed: float) -> PersonUpswing:
        return upswing._replace(
            angle=np.append(upswing.angle[:-1], angle), speed=np.append(upswing.speed[:-1], speed)
        )

    assert worked(ending(0.29, -1.4))
    assert not worked(ending(-0.31, 0.0))
    assert not worked(ending(0.0, 1.6))
    assert not worked(ending(2 * np.pi, 0.0))  # over the top
    assert not worked(upswing._replace(hand=upswing.hand * 2))
    assert not worked(upswing._replace(hand=upswing.times * 0.1))


@pytest.mark.parametrize("impossible", [{"frames": 30}, {"friction": 60.0}], ids=str)
def test_someone_who_cannot_do_it_is_an_error(impossible: dict[str, Any]) -> None:
    person = replace(draw_person(0), **impossible)
    with pytest.raises(DemonstrationError, match="30 tries"):
        practise(person, np.random.default_rng(0))
