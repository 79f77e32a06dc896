"""Via-points out of a measured movement.

The algorithm of FIRM (Wada & Kawato, 1993, 1995; section 2.1.1 and Fig. 3 of the paper): join the
ends by a minimum-jerk movement, add a via-point where the squared error is largest, and go on
until the error is small. Greedy, so the number of points is small but not proved minimal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.errors import ExtractionError
from drake_viapoint.motion.minimum_jerk import EndMotion, minimum_jerk
from drake_viapoint.motion.via_points import ViaPoints


@dataclass(frozen=True)
class Extraction:
    """Via-points in the order they were found, and how the error fell.

    Attributes:
        via_points: The result, in time order, end points included.
        found: Sample indices in the order found: first, last, then one an iteration.
        worst_errors: Largest weighted error after each iteration, from the ends alone on.
        rms_errors: Root mean square weighted error after each iteration.
    """

    via_points: ViaPoints
    found: tuple[int, ...]  # (n,)
    worst_errors: NDArray[np.float64]  # (n - 1,)
    rms_errors: NDArray[np.float64]  # (n - 1,)


def extract_via_points(
    times: ArrayLike,
    values: ArrayLike,
    names: Sequence[str],
    *,
    threshold: float | None = None,
    number: int | None = None,
    weights: ArrayLike | None = None,
    end_motion: EndMotion | None = None,
) -> Extraction:
    """Extract via-points from a sampled movement.

    Args:
        times: (n,) strictly increasing sample times [s].
        values: (n, d) samples, any number of dimensions.
        names: Names of the d dimensions.
        threshold: Stop when the largest weighted error is no larger than this.
        number: Stop at this many via-points, ends included. Give one of the two.
        weights: (d,) the error is the root of the sum of (weight * difference)^2; ones if None.
            A lever of 0.3 m/rad makes angles comparable with positions in metres.
        end_motion: Velocity and acceleration at the ends; at rest if None.

    Raises:
        ExtractionError: Neither or both ways to stop given; fewer samples than via-points asked
            for; a threshold that is not positive; shapes that disagree or values not finite.
    """
    t = np.asarray(times, dtype=np.float64)
    y = np.asarray(values, dtype=np.float64)
    y = y[:, None] if y.ndim == 1 else y
    w = np.ones(len(names)) if weights is None else np.asarray(weights, dtype=np.float64)
    _check(t, y, w, names, threshold, number)

    found = [0, t.size - 1]
    worst: list[float] = []
    rms: list[float] = []
    while True:
        chosen = sorted(found)
        error = w * (minimum_jerk(t[chosen], y[chosen], end_motion)(t) - y)
        squared = np.sum(error**2, axis=1)
        squared[chosen] = 0.0  # a via-point is never chosen twice, whatever the rounding
        worst.append(float(np.sqrt(np.max(squared))))
        rms.append(float(np.sqrt(np.mean(squared))))
        enough = len(found) == number if number is not None else worst[-1] <= (threshold or 0.0)
        if enough or len(found) == t.size:
            break
        found.append(int(np.argmax(squared)))
    points = ViaPoints(t[chosen], y[chosen], tuple(names))
    return Extraction(points, tuple(found), np.array(worst), np.array(rms))


def _check(
    t: NDArray[np.float64],
    y: NDArray[np.float64],
    w: NDArray[np.float64],
    names: Sequence[str],
    threshold: float | None,
    number: int | None,
) -> None:
    if t.ndim != 1 or y.shape != (t.size, len(names)) or w.shape != (len(names),):
        raise ExtractionError(
            f"need times (n,), values (n, {len(names)}) and weights ({len(names)},) for "
            f"{', '.join(names)}; got {t.shape}, {y.shape} and {w.shape}"
        )
    if not (np.all(np.isfinite(t)) and np.all(np.isfinite(y))):
        raise ExtractionError("the samples hold values that are not finite; fill gaps first")
    if t.size < 2 or not np.all(np.diff(t) > 0):
        raise ExtractionError(f"need at least 2 samples at increasing times, got {t.size}")
    if (threshold is None) == (number is None):
        raise ExtractionError("give either a threshold or a number of via-points")
    if threshold is not None and not threshold > 0:
        raise ExtractionError(f"the error threshold must be positive, got {threshold:g}")
    if number is not None and not 2 <= number <= t.size:
        raise ExtractionError(
            f"{number} via-points from {t.size} samples: need at least 2, and no more than samples"
        )
