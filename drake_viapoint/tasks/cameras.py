"""Cameras that see the centres of things now and then, and not exactly (section 2.1.1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Samples(NamedTuple):
    """Where something was seen at n times."""

    times: NDArray[np.float64]  # (n,) [s]
    positions: NDArray[np.float64]  # (n, 3) [m]

    def within(self, chosen: NDArray[np.bool_]) -> Samples:
        """Those chosen (n,)."""
        return Samples(self.times[chosen], self.positions[chosen])


@dataclass(frozen=True)
class Cameras:
    """Sees every so often, each coordinate with noise of its own.

    Attributes:
        rate: Samples a second.
        noise: Standard deviation of a coordinate [m].
    """

    rate: float
    noise: float

    def moments(self, end: float, rng: np.random.Generator) -> NDArray[np.float64]:
        """When pictures are taken (n,), from 0 to an end [s]; cameras do not wait for a start."""
        first = rng.uniform(0.0, 1.0)
        count = int(np.ceil(end * self.rate - first))
        return np.asarray((first + np.arange(count)) / self.rate, dtype=np.float64)

    def sample(
        self,
        path: Callable[[NDArray[np.float64]], NDArray[np.float64]],
        times: NDArray[np.float64],
        rng: np.random.Generator,
    ) -> Samples:
        """What is seen of something on a path, at times (n,) [s]."""
        seen = path(times) + self.noise * rng.standard_normal((times.size, 3))
        return Samples(times, seen)
