"""A ball carried in a cup: it stays while the cup pushes it, and leaves when the cup would pull.

The cup pushes along its opening only; across it, its walls hold the ball. Once out, the ball is
taken to be clear of the cup for good.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.racket import RacketMotion

_SEARCH_STEP = 0.004  # [s]
_DIFFERENCE = 1e-5  # [s] of the central difference of velocity, good to 1e-9 m/s2


class CarriedBall(NamedTuple):
    """A ball in the cup at n times."""

    position: NDArray[np.float64]  # (n, 3) [m]
    velocity: NDArray[np.float64]  # (n, 3) [m/s]
    opening: NDArray[np.float64]  # (n, 3) unit vector out of the cup


@dataclass(frozen=True)
class Cup:
    """Where the ball rests and which way it can leave, in the racket's frame."""

    centre: NDArray[np.float64]  # (3,) of the resting ball [m]
    opening: NDArray[np.float64]  # (3,) unit vector

    def ball(self, racket: RacketMotion, times: ArrayLike) -> CarriedBall:
        """The carried ball at times (n,) [s]."""
        state = racket(times)
        position = state.position + state.rotation @ self.centre
        return CarriedBall(position, state.point_velocity(position), state.rotation @ self.opening)

    def support(self, racket: RacketMotion, times: ArrayLike) -> NDArray[np.float64]:
        """Push of the cup along its opening, per mass of the ball (n,) [m/s2]; a pull if < 0."""
        t = np.atleast_1d(np.asarray(times, dtype=np.float64))
        after = self.ball(racket, np.minimum(t + _DIFFERENCE, racket.end))
        before = self.ball(racket, np.maximum(t - _DIFFERENCE, racket.start))
        span = np.minimum(t + _DIFFERENCE, racket.end) - np.maximum(t - _DIFFERENCE, racket.start)
        acceleration = (after.velocity - before.velocity) / span[:, None]
        push = acceleration + np.array([0.0, 0.0, GRAVITY])
        support: NDArray[np.float64] = np.einsum("ni,ni->n", self.ball(racket, t).opening, push)
        return support

    def release_time(self, racket: RacketMotion) -> float | None:
        """When the cup first would have to pull [s]; None if it never does."""
        count = int(np.ceil((racket.end - racket.start) / _SEARCH_STEP)) + 1
        times = np.linspace(racket.start, racket.end, count)
        support = self.support(racket, times)
        pulled = np.nonzero(support < 0)[0]
        if not pulled.size:
            return None
        last = int(pulled[0])
        if last == 0:
            return float(times[0])

        def push(t: float) -> float:
            return float(self.support(racket, [t])[0])

        return float(brentq(push, times[last - 1], times[last], xtol=1e-13))
