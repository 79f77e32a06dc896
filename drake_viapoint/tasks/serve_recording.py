"""What cameras would record of a virtual person's serve. Synthetic, and named so.

Five markers at 250 Hz, as in section 2.1.1: shoulder, elbow, the hand's heel on the handle (called
wrist) and the upper and lower edge of the racket's head. Every marker has white noise; from the hit
on the racket recoils along the face's normal and rings, the wrist a third as much.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.tasks.serve_person import PersonServe, ServePerson, draw_person, practise

RATE = 250.0
"""Of the cameras [Hz]."""

_NOISE = 0.0009  # [m] a coordinate, so 1.6 mm in space
_HALF_HEAD = 0.125  # [m] from the face's centre to the markers at its edge
_RING = 0.0005, 120.0, 0.010  # [m], [Hz], [s]: amplitude, frequency and decay of the frame's ring
# [m/s], [s]: backward velocity given by the ball and time constant of the hand that brings the
# racket back. 58 g meeting the face at 3 m/s push 0.3 N s into a racket of 0.2 kg at its centre.
_RECOIL = 1.5, 0.020
_WRIST_SHARE = 0.3  # of the jolt that reaches the wrist


def record_person(number: int, goal: NDArray[np.float64], seed: int = 1998) -> MarkerRecording:
    """The recording of virtual person ``number`` serving into a goal; the same every time.

    Args:
        number: Of the person; 0 is the one in the shipped file.
        goal: (3,) centre of the goal's ring [m].
        seed: Of the population.

    Raises:
        DemonstrationError: This person cannot serve into this goal.
    """
    person = draw_person(number, seed)
    rng = np.random.default_rng([seed, number, 1])
    return record_serve(person, practise(person, goal), rng)


def record_serve(
    person: ServePerson, serve: PersonServe, rng: np.random.Generator
) -> MarkerRecording:
    """Markers of a serve as cameras see them."""
    count = int(np.floor(serve.racket.end * RATE)) + 1
    times = np.arange(count) / RATE
    body = person.body(serve.joints(times))
    edge = np.array([_HALF_HEAD, 0.0, 0.0])
    paths = {
        "shoulder": np.tile(person.shoulder, (count, 1)),
        "elbow": body.elbow,
        "wrist": body.hand,
        "racket_upper": body.centre + body.racket.apply(-edge),
        "racket_lower": body.centre + body.racket.apply(edge),
    }
    normal = body.racket.apply([0.0, 1.0, 0.0])
    jolt = _jolt(times - serve.hit)[:, None] * normal
    for name, share in (("racket_upper", 1.0), ("racket_lower", 1.0), ("wrist", _WRIST_SHARE)):
        paths[name] = paths[name] - share * jolt
    positions = np.stack(list(paths.values()), axis=1)
    noise = rng.normal(scale=_NOISE, size=positions.shape)
    return MarkerRecording(tuple(paths), times, positions + noise)


def _jolt(after: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far the racket is thrown back (n,) [m] at times (n,) [s] after the hit."""
    t = np.maximum(after, 0.0)
    amplitude, frequency, decay = _RING
    ring = amplitude * np.exp(-t / decay) * np.sin(2 * np.pi * frequency * t)
    speed, recovery = _RECOIL
    return np.asarray(ring + speed * t * np.exp(-t / recovery))
