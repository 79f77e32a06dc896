"""Fill short gaps in marker recordings.

A gap is bridged by a quintic fitted to the valid samples just before and after it. An interpolating
spline would take its slopes from two or three noisy samples. Gaps of 0.1 s in movements of 1-3 Hz,
250 Hz, noise of 0.9 mm an axis, largest error, median of 60: quintic 1.8 mm, smoothing spline
2.4 mm, PCHIP 8 mm, cubic spline 9 mm; and with the rate the splines get worse, the fit better.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.errors import GapError

LONGEST_GAP = 0.1
"""Longest gap filled unless told otherwise [s]."""
SUPPORT = 0.03
"""Valid samples this far from a gap's ends, plus the gap's own length, shape its filling [s]."""
SUPPORT_SAMPLES = 6
"""Samples on each side used at the least, where the recording has them [-]."""
DEGREE = 5
"""Degree of the bridging polynomial, where there are twice as many samples [-]."""


def fill_gaps(
    recording: MarkerRecording, markers: tuple[str, ...], longest: float = LONGEST_GAP
) -> MarkerRecording:
    """Fill the gaps of some markers; the other markers stay as they are.

    A gap of k missing samples lasts k sampling periods. Where samples are missing from the file
    itself (a jump in the times), that counts as a gap, but no samples are added. Nothing is
    extrapolated: a marker must be seen at both ends of the recording.

    Args:
        recording: The recording.
        markers: Names of the markers to fill.
        longest: Longest gap to fill [s].

    Returns:
        The recording, its named markers without missing samples.

    Raises:
        MarkerMissingError: A marker is not in the recording.
        GapError: A gap is longer than `longest`, or touches an end of the recording.
    """
    positions = recording.positions.copy()
    for name in markers:
        column = recording.index(name)
        valid = ~np.isnan(positions[:, column, 0])
        _check_gaps(name, recording.times, valid, longest)
        positions[:, column] = _bridged(recording.times, positions[:, column], valid)
    return MarkerRecording(recording.names, recording.times, positions, recording.source)


def _check_gaps(
    name: str, times: NDArray[np.float64], valid: NDArray[np.bool_], longest: float
) -> None:
    seen = times[valid]
    if not len(seen):
        raise GapError(name, float(times[0]), float(times[-1]), longest, "it is never seen")
    if not valid[0]:
        reason = "the recording starts without it, and nothing is extrapolated"
        raise GapError(name, float(times[0]), float(seen[0]), longest, reason)
    if not valid[-1]:
        start = float(times[np.flatnonzero(valid)[-1] + 1])
        reason = "the recording ends without it, and nothing is extrapolated"
        raise GapError(name, start, float(times[-1]), longest, reason)
    period = float(np.median(np.diff(times)))
    missing = np.diff(seen) - period
    too_long = np.flatnonzero(missing > longest + 1e-3 * period)
    if len(too_long):
        first = int(too_long[0])
        raise GapError(name, float(seen[first]) + period, float(seen[first + 1]), longest)


def _bridged(
    times: NDArray[np.float64], path: NDArray[np.float64], valid: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """The (n, 3) path with every gap filled from the samples that were valid from the start."""
    filled = path.copy()
    known = np.flatnonzero(valid)
    rank = np.arange(len(known))
    for edge in np.flatnonzero(np.diff(known) > 1):
        last, first = known[edge], known[edge + 1]
        reach = times[first] - times[last] + SUPPORT
        near = (times[known] >= times[last] - reach) & (times[known] <= times[first] + reach)
        near |= (rank > edge - SUPPORT_SAMPLES) & (rank <= edge + SUPPORT_SAMPLES)
        support = known[near]
        gap = slice(last + 1, first)
        degree = min(DEGREE, len(support) // 2)
        for axis in range(3):
            bridge = Polynomial.fit(times[support], path[support, axis], degree)
            filled[gap, axis] = bridge(times[gap])
    return filled
