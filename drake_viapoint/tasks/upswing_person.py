"""A virtual person who swings up their own pendulum. Synthetic, and named so.

No recording of the paper's is public, so the demonstration is made. The person knows the pendulum
only roughly: they plan the hand's path with a length and a damping that are not quite right and
without the hinge's dry friction, their hand strays from the plan, and every quarter second they
look and plan the rest anew. So the hand's path fits this pendulum and what went wrong this time,
and another pendulum that is moved along it does not end upright.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from drake_viapoint.errors import DemonstrationError
from drake_viapoint.motion.minimum_jerk import EndMotion, minimum_jerk
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.pendulum import HANGING
from drake_viapoint.tasks.upswing_plan import (
    FRAME,
    HandState,
    Mind,
    SwingState,
    first_plan,
    plan_anew,
)

LARGEST_REACH = 0.35
"""The hand stays so near to where it starts [m]."""
REVERSALS = 2, 5
"""The hand turns round at least and at most so often."""
UPRIGHT = 0.3, 1.5
"""An upswing has worked if it ends so near to inverted [rad] and so slow [rad/s]."""
FINE = 4
"""The pendulum is reckoned at times so much finer than frames."""

_LOOK = 16  # frames from one look at the pendulum to the next: 0.27 s
_LAST_LOOK = 18  # frames before the end; later nothing could be mended
_TRIES = 30
_CREEP = 0.05  # [rad/s] below which the hinge's friction fades, so that it has no jump
_TURN = 0.01  # [m] the hand goes back at least, for a reversal


class PersonUpswing(NamedTuple):
    """A person's upswing as it happened, at n times."""

    times: NDArray[np.float64]  # (n,) [s]
    hand: NDArray[np.float64]  # (n,) x, from 0 [m]
    acceleration: NDArray[np.float64]  # (n,) of the hand [m/s2]
    angle: NDArray[np.float64]  # (n,) theta [rad]
    speed: NDArray[np.float64]  # (n,) omega [rad/s]
    length: float  # of the pendulum [m]
    tries: int  # the last of which this is


@dataclass(frozen=True)
class UpswingPerson:
    """Pendulum and skill of one virtual person.

    Attributes:
        length: Of the own pendulum [m].
        damping: Viscous, as a share of the speed lost in a second [1/s].
        friction: Of the hinge, as the deceleration it causes [rad/s2].
        mind: What the person believes of the pendulum, and likes.
        frames: Duration of the upswing, in frames.
        unsteadiness: Standard deviation of what the hand strays in a quarter second [m].
    """

    length: float
    damping: float
    friction: float
    mind: Mind
    frames: int
    unsteadiness: float

    def swing(
        self, angle: float, speed: float, acceleration: NDArray[np.float64], step: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Reckon the own pendulum by Runge and Kutta's fourth-order rule.

        Args:
            angle: theta at first [rad].
            speed: omega at first [rad/s].
            acceleration: (2 n + 1,) of the hand, at steps and halfway between [m/s2].
            step: Time step [s].

        Returns:
            theta and omega (n + 1,), the first included.
        """
        gravity, drive = GRAVITY / self.length, (acceleration / self.length).tolist()
        damping, friction = self.damping, self.friction

        def change(theta: float, omega: float, push: float) -> float:
            drag = damping * omega + friction * math.tanh(omega / _CREEP)
            return gravity * math.sin(theta) + push * math.cos(theta) - drag

        angles, speeds = [angle], [speed]
        half = step / 2
        for k in range(0, len(drive) - 1, 2):
            a1 = change(angle, speed, drive[k])
            v2 = speed + half * a1
            a2 = change(angle + half * speed, v2, drive[k + 1])
            v3 = speed + half * a2
            a3 = change(angle + half * v2, v3, drive[k + 1])
            v4 = speed + step * a3
            a4 = change(angle + step * v3, v4, drive[k + 2])
            angle += step / 6 * (speed + 2 * v2 + 2 * v3 + v4)
            speed += step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
            angles.append(angle)
            speeds.append(speed)
        return np.array(angles), np.array(speeds)


def draw_person(number: int, seed: int = 1998) -> UpswingPerson:
    """Person ``number`` of the population that ``seed`` draws; 0 swings in the shipped file."""
    rng = np.random.default_rng([seed, number])
    length = 0.35 * rng.uniform(0.98, 1.02)
    damping = rng.uniform(0.05, 0.3)
    mind = Mind(
        length * rng.uniform(0.98, 1.02),
        damping * rng.uniform(0.7, 1.3),
        reach=rng.uniform(0.25, 0.31),
    )
    return UpswingPerson(
        length=length,
        damping=damping,
        friction=rng.uniform(0.0, 0.3),
        mind=mind,
        frames=int(rng.integers(102, 144, endpoint=True)),
        unsteadiness=rng.uniform(0.003, 0.005),
    )


def practise(person: UpswingPerson, rng: np.random.Generator) -> PersonUpswing:
    """The person's upswing: tried with another plan and other luck each time, until it works.

    Raises:
        DemonstrationError: It never does.
    """
    for number in range(1, _TRIES + 1):
        plan = first_plan(person.mind, person.frames, rng)
        upswing = None if plan is None else _try(person, plan, rng, number)
        if upswing is not None and worked(upswing):
            return upswing
    raise DemonstrationError(f"{_TRIES} tries do not bring this person's pendulum up")


def worked(upswing: PersonUpswing) -> bool:
    """Whether the pendulum is up at the end, and the hand kept to its bounds."""
    return (
        abs(upswing.angle[-1]) < UPRIGHT[0]
        and abs(upswing.speed[-1]) < UPRIGHT[1]
        and float(np.max(np.abs(upswing.hand))) <= LARGEST_REACH
        and REVERSALS[0] <= reversals(upswing.hand) <= REVERSALS[1]
    )


def reversals(hand: NDArray[np.float64], least: float = _TURN) -> int:
    """How often a hand (n,) turns round and then goes back by more than the least distance [m]."""
    count, heading, extreme = 0, 0, float(hand[0])
    for x in hand.tolist():
        if heading == 0 and abs(x - extreme) > least:
            heading, extreme = (1 if x > extreme else -1), x
        elif heading != 0 and (x - extreme) * heading > 0:
            extreme = x
        elif heading != 0 and (extreme - x) * heading > least:
            count, heading, extreme = count + 1, -heading, x
    return count


def _try(
    person: UpswingPerson, plan: BSpline[np.float64], rng: np.random.Generator, number: int
) -> PersonUpswing:
    """Swing, straying from the plan and planning anew, look by look."""
    hand, acceleration = [np.zeros(1)], [np.zeros(1)]
    angle, speed = [np.array([HANGING])], [np.zeros(1)]
    looks = [*range(0, person.frames - _LAST_LOOK + 1, _LOOK), person.frames]
    for start, end in pairwise(looks):
        t = np.linspace(0.0, FRAME * (end - start), 2 * FINE * (end - start) + 1)
        stray = _stray(person.unsteadiness, t[-1], rng, at_rest=end == person.frames)
        moved = [plan(t, order) + stray(t, order)[:, 0] for order in range(3)]
        angles, speeds = person.swing(angle[-1][-1], speed[-1][-1], moved[2], FRAME / FINE)
        hand.append(moved[0][2::2])
        acceleration.append(moved[2][2::2])
        angle.append(angles[1:])
        speed.append(speeds[1:])
        if end < person.frames:
            plan = plan_anew(
                person.mind,
                person.frames - end,
                HandState(*(float(order[-1]) for order in moved)),
                SwingState(float(angles[-1]), float(speeds[-1])),
                plan,
                t[-1],
            )
    return PersonUpswing(
        np.linspace(0.0, FRAME * person.frames, FINE * person.frames + 1),
        np.concatenate(hand),
        np.concatenate(acceleration),
        np.concatenate(angle),
        np.concatenate(speed),
        person.length,
        number,
    )


def _stray(
    unsteadiness: float, duration: float, rng: np.random.Generator, *, at_rest: bool
) -> BSpline[np.float64]:
    """How a hand leaves its plan from one look to the next, smoothly from none on."""
    place, speed = unsteadiness * rng.normal(size=2)
    rest, end = np.zeros(1), np.array([0.0 if at_rest else 2 * speed / duration])
    return minimum_jerk([0.0, duration], [[0.0], [place]], EndMotion(rest, rest, end, rest))
