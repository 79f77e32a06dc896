"""How many trials runs need, where some of them never get there."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def trials_percentile(trials: ArrayLike, percent: float) -> float | None:
    """Trials within which so many of the runs get there.

    Args:
        trials: Of each run (n,); infinity where it never did.
        percent: Share of the runs [%].

    Returns:
        The number of trials of one of the runs, the later where it lies between two; None if that
        run never gets there.
    """
    value = float(np.percentile(np.asarray(trials, float), percent, method="higher"))
    return value if np.isfinite(value) else None


def trials_in_words(trials: float | None) -> str:
    """The number, or a dash if they never get there."""
    return "-" if trials is None else f"{trials:g}"
