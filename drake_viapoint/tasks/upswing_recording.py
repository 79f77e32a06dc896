"""What a camera would record of a virtual person's upswing. Synthetic, and named so.

Two markers at 60 Hz: the hand at the pendulum's hinge, and the tip. The hand's is a small marker
and seen well; the tip is a quick blob, whose place is known to some millimetres only.
"""

from __future__ import annotations

import numpy as np

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.tasks.upswing_person import FINE, PersonUpswing, draw_person, practise

RATE = 60.0
"""Of the camera [Hz]."""
HAND_NOISE = 0.0009
"""Standard deviation of the hand's marker, a coordinate; so 1.6 mm in space [m]."""
TIP_NOISE = 0.007
"""Of the tip's; so 0.02 rad of a pendulum of 0.35 m [m]."""

_START = np.array([0.25, 0.45, 1.2])  # of the hand, in the world [m]


def record_person(number: int, seed: int = 1998) -> MarkerRecording:
    """The recording of virtual person ``number`` swinging up; the same every time.

    Args:
        number: Of the person; 0 is the one in the shipped file.
        seed: Of the population.

    Raises:
        DemonstrationError: This person never succeeds.
    """
    return record_upswing(upswing_of(number, seed), np.random.default_rng([seed, number, 1]))


def upswing_of(number: int, seed: int = 1998) -> PersonUpswing:
    """What virtual person ``number`` really did, before any camera saw it."""
    return practise(draw_person(number, seed), np.random.default_rng([seed, number, 2]))


def record_upswing(upswing: PersonUpswing, rng: np.random.Generator) -> MarkerRecording:
    """Markers of an upswing as a camera sees them."""
    x, theta = upswing.hand[::FINE], upswing.angle[::FINE]
    still = np.zeros_like(x)
    hand = _START + np.stack([x, still, still], axis=1)
    rod = upswing.length * np.stack([-np.sin(theta), still, np.cos(theta)], axis=1)
    hand_noise = rng.normal(scale=HAND_NOISE, size=hand.shape)
    tip_noise = rng.normal(scale=TIP_NOISE, size=hand.shape)
    positions = np.stack([hand + hand_noise, hand + rod + tip_noise], axis=1)
    return MarkerRecording(("hand", "tip"), np.arange(x.size) / RATE, positions)
