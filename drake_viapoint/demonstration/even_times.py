"""Times of even samples that a file has rounded.

At 120 Hz a sample lasts 8.33 ms; written to the millisecond, most last 8 and some 9. Their median
says 125 Hz, and samples that were even would be resampled. Of 40 swings of tests/synthetic_swing.py
(seeds 100-139) so written, the impact is found within 0.8 ms at 120 Hz (median) when the times are
taken at their word, and within 0.5 ms as here, as from times with all their digits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

EVEN = 1e-3
"""Samples whose periods differ by no more than this share of one are even as they are [-]."""
DECIMALS = 8
"""Times with more decimals than this are not taken for rounded ones [-]."""

COARSEST = 4
"""Missing samples are counted where a period has more than so many last decimals [-]: else there
would be a count to suit any times [assumed]."""


def unrounded(times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Even times that a file has rounded, as they were; any others as they are.

    Times are taken for even ones if a line through them, against the numbers of their samples,
    misses none by more than its last decimal. Samples may be missing in between.

    Args:
        times: (n,) strictly increasing, n >= 2 [s].

    Returns:
        (n,) times of even samples, none further than the last decimal from what it was; or the
        times given, bit for bit, where they are even already or are no even times rounded.
    """
    steps = np.diff(times)
    if _are_whole(steps / np.median(steps)):
        return times
    resolution = _resolution(times)
    if resolution is None:
        return times
    all_there = np.arange(len(times), dtype=np.float64)
    for numbers in (all_there, _counted(steps)):
        period, start = np.polyfit(numbers, times - times[0], 1)
        even: NDArray[np.float64] = times[0] + (start + period * numbers)
        told_apart = numbers is all_there or period > COARSEST * resolution
        if told_apart and np.max(np.abs(even - times)) <= resolution:
            return even
    return times


def _are_whole(periods: NDArray[np.float64]) -> bool:
    """Whether every step is a whole number of periods."""
    return bool(np.max(np.abs(periods - np.round(periods).clip(1))) < EVEN)


def _resolution(times: NDArray[np.float64]) -> float | None:
    """The last decimal of the times [s]; None if they have too many."""
    slack = 4 * np.finfo(np.float64).eps * np.max(np.abs(times))
    shortest = np.min(np.diff(times))
    for decimals in range(DECIMALS + 1):
        last = 10.0**-decimals
        if last > (1 + EVEN) * shortest + slack:
            continue  # times that differ cannot have so few
        if np.max(np.abs(times - np.round(times, decimals))) <= 1e-3 * last + slack:
            return last
    return None


def _counted(steps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Numbers of the samples (n,) if some are missing, from the steps between them (n - 1,)."""
    period = np.mean(steps[steps < 1.5 * np.median(steps)])
    return np.concatenate([[0.0], np.cumsum(np.round(steps / period).clip(1))])
