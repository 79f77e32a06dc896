"""Our Fig. 3: how via-points are found, one at a time where the error is largest."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from drake_viapoint.motion.extraction import Extraction
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.reproduction.style import DEMONSTRATED, OURS, VIA_POINT

_STEPS = 3


def draw(
    times: NDArray[np.float64],
    values: NDArray[np.float64],
    extraction: Extraction,
    *,
    note: str = "",
) -> Figure:
    """Draw the first steps of an extraction.

    Args:
        times: (n,) of the samples [s].
        values: (n, d) samples; the first three dimensions are drawn.
        extraction: What was found in them.
        note: Of the samples' origin, for the title.
    """
    names = extraction.via_points.names[:3]
    steps = min(_STEPS, len(extraction.found) - 1)
    figure = Figure(figsize=(9, 2 * len(names) + 0.6), layout="constrained")
    axes = figure.subplots(len(names), steps, sharex=True, sharey="row", squeeze=False)
    for step in range(steps):
        order = list(extraction.found[: step + 2])
        chosen = sorted(order)
        path = minimum_jerk(times[chosen], values[chosen])(times)
        axes[0][step].set_title(
            "ends alone" if step == 0 else f"{step} via-point{'s' if step > 1 else ''} added",
            fontsize=9,
        )
        for row, name in enumerate(names):
            ax = axes[row][step]
            ax.plot(times, values[:, row], color=DEMONSTRATED, label="watched")
            ax.plot(times, path[:, row], ":", color=OURS, label="minimum jerk")
            for number, index in enumerate(order, start=1):
                ax.plot(times[index], values[index, row], "o", color=VIA_POINT, markersize=4)
                ax.annotate(
                    str(number),
                    (times[index], values[index, row]),
                    textcoords="offset points",
                    xytext=(4, 4),
                    fontsize=8,
                )
            if step + 2 <= len(extraction.found) - 1:
                following = times[extraction.found[step + 2]]
                ax.axvline(following, color=VIA_POINT, linewidth=0.8, linestyle="--")
            if step == 0:
                ax.set_ylabel(f"{name} [m]")
            ax.label_outer()
    axes[0][0].legend(fontsize=7)
    for ax in axes[-1]:
        ax.set_xlabel("time [s]")
    figure.suptitle(f"Dashed: largest error, where the next via-point is added{note}", fontsize=9)
    return figure
