"""How a virtual person plans an upswing: where the hand should go, by the pendulum in the mind.

A plan is a minimum-jerk path of the hand through a few points, to rest at the end. In the mind the
hinge has no dry friction. Many paths are followed there at once, so that the slopes by finite
differences cost hardly more than one path.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.optimize import least_squares

from drake_viapoint.motion.minimum_jerk import EndMotion, minimum_jerk
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.pendulum import HANGING

FRAME = 1 / 60
"""A duration is so many times this, and the mind reckons in such steps: the cameras' period [s]."""

_SPACING = 0.36  # [s] about, between the points of a plan
_IDEAS = 400  # paths that come to mind before one is worked out
_WORKED_OUT = 8  # of them, at most
_UPRIGHT = np.array([0.02, 0.1])  # [rad], [rad/s] a plan ends about so near to inverted and still
_ENOUGH = 2.0  # times that far from it, and the plan will do
_JERK = 60.0  # [m/s3] weighs the hand's jerk in a frame
_BRISK = 11.0, 2.0  # [m/s2] acceleration that one likes to stay below, and leeway past it
_LEEWAY = 0.02  # [m] past the reach that one likes
_FIRST_CHANGE = 0.1  # [m] by which a path is changed when it is worked out
_CHANGE = 0.03  # [m] by which a plan is changed on the way
_PROBE = 1e-5  # [m] of the finite differences


class HandState(NamedTuple):
    """Of the hand along its line."""

    position: float  # [m]
    velocity: float  # [m/s]
    acceleration: float  # [m/s2]


class SwingState(NamedTuple):
    """Of the pendulum."""

    angle: float  # theta [rad]
    speed: float  # omega [rad/s]


@dataclass(frozen=True)
class Mind:
    """What a person believes and likes.

    Attributes:
        length: Of the pendulum [m].
        damping: Of its swinging, as a share of the speed lost in a second [1/s].
        reach: How far the hand may go [m].
    """

    length: float
    damping: float
    reach: float


class _Paths:
    """All paths from one state of the hand to rest, through points at given times."""

    def __init__(self, frames: int, hand: HandState) -> None:
        duration = FRAME * frames
        self.times = np.linspace(0.0, duration, max(2, round(duration / _SPACING)) + 1)
        rows = np.eye(self.times.size + 2)
        rest = np.zeros(self.times.size + 2)
        ends = EndMotion(rows[-2], rows[-1], rest, rest)
        self._basis = minimum_jerk(self.times, rows[:-2], ends)
        self._hand = np.array(hand)
        frame = FRAME * np.arange(frames + 1)
        self.place = self._basis(frame)  # (frames + 1, m + 2)
        self.push = self._basis.derivative(2)(frame)
        self.jerk = self._basis.derivative(3)(frame[::3])

    def columns(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """What the basis is multiplied by (m + 2, b) for points (b, m - 1) after the first."""
        position, velocity, acceleration = self._hand
        column = np.ones((1, len(points)))
        return np.vstack([position * column, points.T, velocity * column, acceleration * column])

    def spline(self, points: NDArray[np.float64]) -> BSpline[np.float64]:
        """The path (scalar) through points (m - 1,)."""
        return BSpline(self._basis.t, self._basis.c @ self.columns(points[None])[:, 0], 5)


def first_plan(mind: Mind, frames: int, rng: np.random.Generator) -> BSpline[np.float64] | None:
    """A path of the hand that would bring a hanging pendulum up.

    Args:
        mind: Whose plan it is.
        frames: Duration in frames.
        rng: What comes to mind.

    Returns:
        The path, from time 0 on; None if nothing that comes to mind can be made to work.
    """
    paths = _Paths(frames, HandState(0.0, 0.0, 0.0))
    hanging = SwingState(HANGING, 0.0)
    t = paths.times[1:]
    rate = 2 * np.pi * rng.uniform(0.6, 1.4, (_IDEAS, 1))
    phase = rng.uniform(-np.pi, np.pi, (_IDEAS, 1))
    ideas = np.sin(rate * t + phase) - np.sin(phase)
    ideas *= (
        mind.reach * rng.uniform(0.6, 1.0, (_IDEAS, 1)) / np.max(np.abs(ideas), axis=1)[:, None]
    )
    promise = np.sum(_misses(paths, mind, hanging, ideas, ideas, _FIRST_CHANGE) ** 2, 1)
    for idea in ideas[np.argsort(promise)[:_WORKED_OUT]]:
        points, miss = _work_out(paths, mind, hanging, idea, _FIRST_CHANGE)
        if np.max(np.abs(miss)) < _ENOUGH:
            return paths.spline(points)
    return None


def plan_anew(
    mind: Mind,
    frames: int,
    hand: HandState,
    pendulum: SwingState,
    wish: BSpline[np.float64],
    elapsed: float,
) -> BSpline[np.float64]:
    """The rest of a path, from where hand and pendulum are now; as little as needed is changed.

    Args:
        mind: Whose plan it is.
        frames: Until the end.
        hand: State of the hand now.
        pendulum: State of the pendulum now.
        wish: The path planned so far.
        elapsed: Its time now [s].

    Returns:
        The path, from time 0 on, which is now.
    """
    paths = _Paths(frames, hand)
    points = wish(np.minimum(elapsed + paths.times[1:], wish.t[-1]))
    return paths.spline(_work_out(paths, mind, pendulum, points, _CHANGE)[0])


def _work_out(
    paths: _Paths,
    mind: Mind,
    pendulum: SwingState,
    wish: NDArray[np.float64],
    change: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points (m - 1,) near to the wished ones, and how far the end misses, in shares of enough."""
    probes = np.vstack([np.zeros(wish.size), _PROBE * np.eye(wish.size)])
    slopes: dict[bytes, NDArray[np.float64]] = {}

    def misses(points: NDArray[np.float64]) -> NDArray[np.float64]:
        r = _misses(paths, mind, pendulum, points + probes, wish, change)
        slopes[points.tobytes()] = (r[1:] - r[0]).T / _PROBE
        return np.asarray(r[0])

    def slope(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return slopes[points.tobytes()]

    fit = least_squares(misses, wish, jac=slope, max_nfev=30, xtol=1e-6, ftol=1e-6)
    # rounding leaves the last bits of a fit to the machine; a file should not depend on them
    points = np.round(fit.x, 9)
    return points, misses(points)[:2]


def _misses(
    paths: _Paths,
    mind: Mind,
    pendulum: SwingState,
    points: NDArray[np.float64],
    wish: NDArray[np.float64],
    change: float,
) -> NDArray[np.float64]:
    """What is wrong with paths through points (b, m - 1): (b, r), each in shares of what may be."""
    columns = paths.columns(points)
    push = paths.push @ columns  # (frames + 1, b)
    place = (paths.place @ columns)[::3]
    angle, speed = _imagined(mind, pendulum, push)
    end = np.stack([angle, speed]) / _UPRIGHT[:, None]
    too_hard = np.maximum(np.abs(push) - _BRISK[0], 0.0) / _BRISK[1]
    jerk = paths.jerk @ columns / _JERK
    too_far = np.maximum(np.abs(place) - mind.reach, 0.0) / _LEEWAY
    return np.vstack([end, (points - wish).T / change, jerk, too_hard, too_far]).T


def _imagined(
    mind: Mind, pendulum: SwingState, push: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where the pendulum in the mind ends (b,), for the hand's acceleration (n, b): leapfrog."""
    angle = np.full(push.shape[1], pendulum.angle)
    speed = np.full(push.shape[1], pendulum.speed)
    gain = FRAME / mind.length
    kept = np.exp(-mind.damping * FRAME)
    kick = gain * push
    weight = np.full(len(push), gain * GRAVITY)
    kick[[0, -1]] *= 0.5
    weight[[0, -1]] *= 0.5
    pull, turn = np.empty_like(angle), np.empty_like(angle)
    for k in range(len(push)):
        np.sin(angle, out=pull)
        pull *= weight[k]
        speed += pull
        np.cos(angle, out=turn)
        turn *= kick[k]
        speed += turn
        if k + 1 < len(push):
            np.multiply(speed, FRAME, out=turn)
            angle += turn
            speed *= kept
    return angle, speed
