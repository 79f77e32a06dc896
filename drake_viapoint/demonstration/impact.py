"""The time of the hit, from the spike in the racket's acceleration (paper 2.1.1, Fig. 2).

The ball strikes the face along its normal: the velocity of the face jumps back, the hand recovers
the velocity (a jump) or even the path (a kick) within some tens of milliseconds, and the racket
rings. `find_impact` looks for an onset of that shape in the unfiltered path of the face's centre
along the normal, in two steps. First, around every instant, the path is fitted by a cubic, which
stands for the movement, plus a ring and a jump, or a ring and a kick, that begin there; the score
is how much the two add to the fit, in units of what they add elsewhere (median over the recording).
So the threshold needs no knowledge of the noise or of the rate. Second, the onset is moved within
the same data, around the best score, to where the fit is best: the score alone tells that there was
an impact, but is as high on its flanks.

Taking the largest peak of a second derivative over 28 ms instead misplaces the hit by more than
8 ms in a quarter of recordings with 2 mm of noise: the ring's later swings are peaks as well.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.demonstration.racket_pose import (
    RACKET_MARKERS,
    BodyMarkers,
    even_marker_paths,
    fit_rigid_body,
    low_passed,
)
from drake_viapoint.errors import ImpactNotFoundError, RacketPoseError

THRESHOLD = 5.0
"""Score that an impact needs [-]; see `find_impact` for the rates that follow."""
DETECTION_REACH = 0.06
"""Reach of the first fit before and after an onset, with a cubic for the movement [s]."""
TIMING_REACH = 0.12
"""Reach of the second fit around the best score, with a quintic for the movement [s]."""
TIMING_SEARCH = 0.04
"""The onset is sought this far from the best score [s]."""
ONSET_STEP = 1e-3
"""Onsets are tried this far apart [s]."""
RING_FREQUENCY = 40.0
"""Frequency of a hand-held racket's ring; 30-60 Hz are found as well [Hz, assumed]."""
RING_DECAY = 0.015
"""Time constant of the ring; 10-25 ms are found as well [s, assumed]."""
JUMP_RECOVERY = 0.06
"""Time constant of a velocity that recovers from its jump, the path staying displaced
[s, assumed]."""
KICK_RETURN = 0.02
"""Time constant of a path that is left at once and returned to; 12-30 ms are found as well
[s, assumed]."""
SMALLEST_NOISE = 1e-4
"""Noise of the face's centre assumed at the least, so that a recording without any is not all
spikes [m]."""
SLOWEST_RATE = 2.0 * RING_FREQUENCY
"""Below this the ring is not sampled [Hz]."""
DERIVATIVE_WINDOW = 0.028
"""Width of the parabola whose derivatives `racket_centre_derivatives` takes [s]."""
MEDIAN_OF_TWO = float(np.sqrt(2.0 * np.log(2.0)))
"""Median length of a vector of two independent standard normal numbers [-]."""


class Recovery(Enum):
    """What the hand gives back to the racket after the ball has struck it."""

    JUMP = "its velocity"
    KICK = "its path"


class RacketCentreDerivatives(NamedTuple):
    """Motion of the face's centre, unfiltered but for the differentiation.

    Attributes:
        times: (n,) [s].
        position: (n, 3) [m].
        velocity: (n, 3) [m/s].
        acceleration: (n, 3) [m/s2].
    """

    times: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]


def racket_centre_derivatives(
    recording: MarkerRecording,
    markers: BodyMarkers = RACKET_MARKERS,
    window: float = DERIVATIVE_WINDOW,
) -> RacketCentreDerivatives:
    """Position, velocity and acceleration of the face's centre, for the paper's Fig. 2.

    Derivatives are those of the parabola fitted around each sample (Savitzky & Golay 1964).

    Args:
        recording: The markers.
        markers: Which markers, in which roles.
        window: Width of the parabola [s]; five samples at the least, the recording at the most.

    Raises:
        MarkerMissingError: A marker is not in the recording.
        GapError: A marker is missing for too long.
        RacketPoseError: Fewer than five samples.
    """
    body = BodyMarkers(*markers)
    times, points = even_marker_paths(recording, (body.upper, body.lower))
    if len(times) < 5:
        raise RacketPoseError(f"{len(times)} samples are too few to differentiate, 5 are needed")
    centre = points.mean(axis=1)
    period = float(times[-1] - times[0]) / (len(times) - 1)
    longest = len(times) - 1 + len(times) % 2
    length = min(max(5, round(window / period) // 2 * 2 + 1), longest)
    velocity, acceleration = (
        savgol_filter(centre, length, 2, deriv=order, delta=period, axis=0) for order in (1, 2)
    )
    return RacketCentreDerivatives(times, centre, velocity, acceleration)


def find_impact(
    recording: MarkerRecording,
    markers: BodyMarkers = RACKET_MARKERS,
    threshold: float = THRESHOLD,
) -> float:
    """Time of the hit, t_HIT.

    Measured on the 300 swings of tests/synthetic_swing.py with seeds 1000-1299, at 250 Hz with 2 mm
    of marker noise (root mean square over three dimensions), as found / within 8 ms / median error:
    a jump of 1 m/s with a ring of 6 mm 300 / 300 / 0.3 ms, a kick of 1.5 m/s 300 / 300 / 0.5 ms,
    the ring alone 287 / 284 / 0.4 ms, no hit 0. With 1 mm of noise: the ring alone 300 / 300 /
    0.3 ms, no hit 0. Of 100 at 100 Hz with 2 mm: jump 99 / 98, kick 100 / 99, ring 34 / 31, no hit
    0; of 100 at 500 Hz with 2 mm, no hit 1.

    Args:
        recording: The markers; the hit is at least `DETECTION_REACH` from both ends.
        markers: Which markers, in which roles.
        threshold: Score that an impact needs [-].

    Returns:
        The beginning of the impact, on the recording's clock [s].

    Raises:
        ImpactNotFoundError: Nothing reaches the threshold, or the recording is too short or slow.
        MarkerMissingError: A marker is not in the recording.
        GapError: A marker is missing for too long.
        RacketPoseError: The markers give no pose, so no face normal.
    """
    body = BodyMarkers(*markers)
    times, points = even_marker_paths(recording, body.names)
    rate = (len(times) - 1) / float(times[-1] - times[0])
    if rate < SLOWEST_RATE:
        raise ImpactNotFoundError(
            f"{rate:.4g} Hz is too slow to see one, {SLOWEST_RATE:.0f} Hz are needed"
        )
    reach = int(np.ceil(DETECTION_REACH * rate))
    if len(times) < 4 * reach:
        raise ImpactNotFoundError(f"{len(times)} samples at {rate:.4g} Hz are too few to see one")
    rotation, _ = fit_rigid_body(low_passed(points, rate), body)
    normals = rotation[:, :, 1]
    centre = points[:, :2].mean(axis=1)
    delays = np.arange(0.0, 1.0 / rate - 1e-9, ONSET_STEP)
    scores = np.stack([_scores(centre, normals, rate, reach, delay) for delay in delays])
    delay, start = np.unravel_index(np.argmax(scores), scores.shape)
    best, sample = float(scores[delay, start]), reach + int(start)
    if best < threshold:
        raise ImpactNotFoundError(
            f"the strongest spike, at {times[sample]:.3f} s, scores {best:.1f} where {threshold:g} "
            "is needed"
        )
    offset = times - times[sample]
    near = np.abs(offset) <= TIMING_REACH
    path = centre[near] @ normals[sample]
    return float(times[sample]) + _onset(offset[near], path, float(delays[delay]))


def _scores(
    centre: NDArray[np.float64],
    normals: NDArray[np.float64],
    rate: float,
    reach: int,
    delay: float,
) -> NDArray[np.float64]:
    """Scores of an onset `delay` after each sample that is `reach` samples from both ends."""
    time = np.arange(-reach, reach + 1) / rate
    windows = np.lib.stride_tricks.sliding_window_view(centre, 2 * reach + 1, axis=0)
    # Within a window the normal is that of its middle: turning it would bend a straight path.
    along_normal = np.einsum("nal,na->nl", windows, normals[reach:-reach])
    scores = np.zeros(len(along_normal))
    for recovery in Recovery:
        shapes = _impact_shapes(time, delay, recovery, degree=3)
        gain = np.linalg.norm(along_normal @ shapes, axis=1)  # [m]
        noise = max(float(np.median(gain)) / MEDIAN_OF_TWO, SMALLEST_NOISE)
        scores = np.maximum(scores, gain / noise)
    return scores


def _onset(time: NDArray[np.float64], path: NDArray[np.float64], guess: float) -> float:
    """The onset near a guess at which the shapes fit a path (n,) [m] best, by least squares."""
    onsets = guess + np.arange(-TIMING_SEARCH, TIMING_SEARCH + ONSET_STEP / 2, ONSET_STEP)
    # A jump and a kick together would fit too much: either of them, from a wrong onset, as well.
    gains = [
        max(
            float(np.linalg.norm(path @ _impact_shapes(time, onset, recovery, degree=5)))
            for recovery in Recovery
        )
        for onset in onsets
    ]
    return float(onsets[np.argmax(gains)])


def _impact_shapes(
    time: NDArray[np.float64], onset: float, recovery: Recovery, degree: int
) -> NDArray[np.float64]:
    """Ring, and jump or kick, from an onset, orthonormal and clear of polynomials: (n, 2) [-]."""
    since = np.maximum(time - onset, 0.0)
    ring = np.exp(-since / RING_DECAY) * np.sin(2.0 * np.pi * RING_FREQUENCY * since)
    if recovery is Recovery.JUMP:
        recoil = 1.0 - np.exp(-since / JUMP_RECOVERY)
    else:
        recoil = since / KICK_RETURN * np.exp(-since / KICK_RETURN)
    movement = np.vander(time / np.max(np.abs(time)), degree + 1)
    basis, _ = np.linalg.qr(np.column_stack([movement, ring, recoil]))
    return basis[:, degree + 1 :]
