"""Racket recordings with a known truth: smooth random swings, marker noise, an impact's jolt."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.demonstration.markers import MarkerRecording
from drake_viapoint.motion.orientation import rotation_from_zyz

NAMES = ("racket_upper", "racket_lower", "wrist")
PLACES = np.array([[-0.13, 0.0, 0.0], [0.13, 0.0, 0.0], [0.0, 0.0, -0.45]])  # (3, 3) racket [m]
FASTEST = 4.0  # [m/s]
HARDEST = 60.0  # [m/s2]


@dataclass(frozen=True)
class Swing:
    """A recording and the pose (n, 3), (n, 3), the hit [s] and the noise-free markers behind it."""

    recording: MarkerRecording
    position: NDArray[np.float64]
    zyz: NDArray[np.float64]
    t_hit: float


def random_swing(
    seed: int,
    rate: float = 250.0,
    noise: float = 1.5e-3,
    jump: float | None = 1.25,
    ring: float = 6e-3,
    frequency: float = 40.0,
    kick: float = 0.0,
    duration: float = 1.35,
    start: float = 0.0,
) -> Swing:
    """A swing up to 4 m/s and 60 m/s2, whichever comes first.

    Args:
        seed: Of everything random.
        rate: [Hz].
        noise: Of a marker, root mean square over three dimensions [m].
        jump: Of the face's velocity along -y_racket, recovering within 60 ms [m/s]; None: no hit.
        ring: Amplitude of the damped oscillation after it, time constant 15 ms [m].
        frequency: Of that oscillation [Hz].
        kick: Of the face's velocity, that takes it off its path and back within 20 ms [m/s].
        duration: [s].
        start: Time of the first sample [s].
    """
    rng = np.random.default_rng(seed)
    t = np.arange(round(duration * rate) + 1) / rate
    omega = 2.0 * np.pi * np.array([0.5, 1.0, 1.6, 2.4])[:, None]  # [rad/s]
    phase = rng.uniform(0.0, 2.0 * np.pi, (4, 6))
    size = rng.normal(size=(4, 6)) / omega**2
    fine = np.linspace(0.0, duration, 1000)[:, None, None]
    speed = np.linalg.norm((size * omega * np.cos(omega * fine + phase)).sum(1)[:, :3], axis=1)
    force = np.linalg.norm((size * omega**2 * np.sin(omega * fine + phase)).sum(1)[:, :3], axis=1)
    scale = min(FASTEST / speed.max(), HARDEST / force.max()) * rng.uniform(0.5, 1.0)
    path = (size * np.sin(omega * t[:, None, None] + phase)).sum(axis=1)  # (n, 6)
    position = scale * path[:, :3] + np.array([0.3, 0.4, 1.2])
    zyz = 0.7 * path[:, 3:] / np.abs(path[:, 3:]).max() + np.array([0.0, np.pi / 2, 0.3])

    rotation = rotation_from_zyz(zyz)
    markers = position[:, None] + np.einsum("nij,mj->nmi", rotation, PLACES)
    t_hit = float(rng.uniform(0.25, duration - 0.2))
    if jump is not None:
        since = np.maximum(t - t_hit, 0.0)
        recoil = 0.06 * jump * (1.0 - np.exp(-since / 0.06))
        recoil += ring * np.exp(-since / 0.015) * np.sin(2.0 * np.pi * frequency * since)
        recoil += kick * since * np.exp(-since / 0.02)
        # The hand holds the wrist end: only the two markers on the head are knocked back.
        markers[:, :2] -= (recoil[:, None] * rotation[:, :, 1])[:, None]
    markers += noise / np.sqrt(3.0) * rng.normal(size=markers.shape)
    return Swing(MarkerRecording(NAMES, start + t, markers), position, zyz, start + t_hit)
