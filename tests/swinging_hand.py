"""Movements of a hand that swing a pendulum of 0.35 m up, or nearly."""

import numpy as np
from numpy.typing import NDArray

TIMES = np.linspace(0, 2, 8)
INVERTING = np.array([0, -0.136, -0.301, -0.167, 0.137, 0.052, -0.067, 0.089])
"""Via-points [m] at TIMES [s]; the pendulum ends 0.04 rad from inverted, nearly at rest."""


def movements(number: int, seed: int = 0) -> list[NDArray[np.float64]]:
    """Via-points near those that invert, and oscillations that grow; peaks of 7 to 15 m/s2."""
    rng = np.random.default_rng(seed)
    near = [INVERTING + np.r_[0, rng.normal(scale=0.01, size=7)] for _ in range(number // 2)]
    growing = [
        np.r_[0, 0.12 * np.linspace(0.3, 1, 6) * np.cos(np.pi * np.arange(6)), 0]
        + np.r_[0, rng.normal(scale=0.03, size=7)]
        for _ in range(number - number // 2)
    ]
    return near + growing
