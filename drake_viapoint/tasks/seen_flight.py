"""Flights found in samples of a ball: parabolas, before and after a bounce.

Without drag a flight minus gravity's part is a straight line in time, so fits are linear. They are
robust: a sample taken while the ball was on the strings bends none. Where a struck ball touches the
goal's ring its flight ends: what is found is where it headed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from drake_viapoint.tasks.cameras import Samples
from drake_viapoint.tasks.flight import GRAVITY, Parabola

_LOOK = 0.2  # [s] of samples looked at to either side of a bounce; any throw flies longer
_FEWEST = 4  # samples a flight must have
_SEARCHED = 0.15  # [s] around its expected time in which a bounce is looked for
_BENT = 3.0  # a bounce divides the variance left by a single parabola by more than this
_HELD = 0.5  # of gravity: what is accelerated otherwise by more than this does not fly
_FAR = 4.5  # times the noise, farther than which a coordinate is not where it is expected
_FINEST = 1e-3  # [m] cameras are not trusted to be better than this


class SeenFlights(NamedTuple):
    """What was seen of a ball's way; None where there was no flight to be seen."""

    thrown: Parabola | None
    struck: Parabola | None


def fit_flight(samples: Samples, noise: float) -> Parabola:
    """The parabola that fits samples of a flight, those that do not belong to it disregarded.

    Args:
        samples: At least two.
        noise: Of a coordinate [m]; samples much farther away count little.
    """
    basis, straight = _straightened(samples)
    scale = max(noise, _FINEST)
    slope = np.asarray(np.kron(basis, np.eye(3)) / scale, dtype=np.float64)

    def residual(line: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(slope @ line - straight.ravel() / scale, dtype=np.float64)

    def jacobian(_: NDArray[np.float64]) -> NDArray[np.float64]:
        return slope

    start = _line(basis, straight).ravel()
    line = least_squares(residual, start, jacobian, loss="soft_l1").x.reshape(2, 3)
    return Parabola(float(samples.times[0]), line[0], line[1])


def find_flights(
    ball: Samples, expected: float, noise: float, ring_height: float, rate: float
) -> SeenFlights:
    """The flights before and after the bounce nearest to when it is expected.

    Args:
        ball: Where it was seen.
        expected: When it should be struck [s].
        noise: Of a coordinate [m].
        ring_height: Below this height [m] the struck ball is not looked at.
        rate: Samples a second.
    """
    many = max(_FEWEST, round(_LOOK * rate))
    bounce = _bounce(ball, expected, many)
    if bounce is None:  # nothing happens around the time: one flight, or none
        around = int(np.searchsorted(ball.times, expected))
        before = _between(ball, around - many, around + many // 2)
        return SeenFlights(fit_flight(before, noise) if _falls(before, noise) else None, None)
    before = _between(ball, bounce - many, bounce)
    thrown = fit_flight(before, noise) if _falls(before, noise) else None
    after = _between(ball, bounce, ball.times.size)
    after = after.within(after.positions[:, 2] > ring_height)
    if not _falls(_between(after, 0, many), noise):
        return SeenFlights(thrown, None)
    return SeenFlights(thrown, fit_flight(_undisturbed(after, many, noise), noise))


def _undisturbed(samples: Samples, many: int, noise: float) -> Samples:
    """The first samples of a flight, up to where it is disturbed, as by the goal's ring.

    As long as the next one is where those before it say, it belongs to them.
    """
    count = min(many, samples.times.size)
    while count < samples.times.size:
        expected = fit_flight(_between(samples, 0, count), noise).position(samples.times[count])
        if np.max(np.abs(samples.positions[count] - expected)) > _FAR * max(noise, _FINEST):
            return _between(samples, 0, count - 1)  # the last one may be disturbed already
        count += 1
    return samples


def _falls(samples: Samples, noise: float) -> bool:
    """Whether what samples show falls like a ball that nothing holds, as far as they can tell."""
    if samples.times.size < _FEWEST:
        return False
    t = samples.times - samples.times[0]
    basis = np.stack([np.ones_like(t), t, t**2 / 2], axis=1)
    acceleration = float(np.linalg.lstsq(basis, samples.positions[:, 2], rcond=None)[0][2])
    uncertain = noise * float(np.sqrt(np.linalg.inv(basis.T @ basis)[2, 2]))
    return abs(acceleration + GRAVITY) < max(_HELD * GRAVITY, 3.0 * uncertain)


def _bounce(ball: Samples, expected: float, many: int) -> int | None:
    """The first sample after a bounce; None if a single parabola does as well."""
    count = ball.times.size
    near = np.flatnonzero(np.abs(ball.times - expected) < _SEARCHED).tolist()
    splits: list[int] = [i for i in near if _FEWEST <= i <= count - _FEWEST]
    if not splits:
        return None
    alone = [_squares(ball, i - many, i + many) for i in splits]
    apart = [_squares(ball, i - many, i) + _squares(ball, i, i + many) for i in splits]
    # not the split that leaves least: far from a bounce there is one flight, and nothing is left
    most = int(np.argmax(np.subtract(alone, apart)))
    best = splits[most]
    seen = _between(ball, best - many, best + many).times.size
    freedom = 3 * seen  # of coordinates, less those that fix one line, or two
    before = alone[most] / (freedom - 6)
    after = max(apart[most], seen * _FINEST**2 / 100) / (freedom - 12)
    return best if before / after > _BENT else None


def _between(ball: Samples, start: int, end: int) -> Samples:
    """Samples from one to before another, as far as there are any."""
    chosen = slice(max(0, start), max(0, end))
    return Samples(ball.times[chosen], ball.positions[chosen])


def _squares(ball: Samples, start: int, end: int) -> float:
    """What a parabola leaves of samples, squared and summed [m2]."""
    basis, straight = _straightened(_between(ball, start, end))
    return float(np.sum((basis @ _line(basis, straight) - straight) ** 2))


def _straightened(samples: Samples) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Flights as lines: (n, 2) of 1 and time, and (n, 3) positions without gravity's part."""
    t = samples.times - samples.times[0]
    straight = samples.positions + np.array([0.0, 0.0, GRAVITY / 2]) * t[:, None] ** 2
    return np.stack([np.ones_like(t), t], axis=1), straight


def _line(basis: NDArray[np.float64], straight: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.lstsq(basis, straight, rcond=None)[0], dtype=np.float64)
