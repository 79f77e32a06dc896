"""Our Fig. 4: via-points and the minimum-jerk path through them, in every dimension."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from drake_viapoint.motion.extraction import Extraction
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.reproduction.style import DEMONSTRATED, OURS, VIA_POINT


def draw(
    times: NDArray[np.float64],
    values: NDArray[np.float64],
    extraction: Extraction,
    labels: Sequence[str],
    *,
    title: str,
    hit_time: float | None = None,
    path: BSpline[np.float64] | None = None,
) -> Figure:
    """Draw what was watched, the via-points and the path generated from them.

    Args:
        times: (n,) of the samples [s].
        values: (n, d) samples.
        extraction: Via-points found in them.
        labels: Axis label of each dimension, with its unit.
        title: Of the figure.
        hit_time: t_HIT, if there is one [s].
        path: Generated path; at rest at both ends if None.
    """
    points = extraction.via_points
    generated = path or minimum_jerk(points.times, points.values)
    fine = np.linspace(points.times[0], points.times[-1], 500)
    columns = 2 if len(labels) > 3 else 1
    rows = int(np.ceil(len(labels) / columns))
    figure = Figure(figsize=(4.5 * columns + 1, 1.9 * rows + 0.8), layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, squeeze=False)
    for dimension, label in enumerate(labels):
        ax = axes[dimension % rows][dimension // rows]
        ax.plot(times, values[:, dimension], color=DEMONSTRATED, label="watched")
        ax.plot(fine, generated(fine)[:, dimension], color=OURS, label="minimum jerk")
        ax.plot(points.times, points.values[:, dimension], "o", color=VIA_POINT, label="via-points")
        for number, (t, value) in enumerate(
            zip(points.times, points.values[:, dimension], strict=True), start=1
        ):
            ax.annotate(
                str(number), (t, value), textcoords="offset points", xytext=(4, 5), fontsize=8
            )
        if hit_time is not None:
            ax.axvline(hit_time, color="0.3", linestyle="--", linewidth=0.9, label="$t_{HIT}$")
        ax.margins(y=0.18)
        ax.set_ylabel(label)
    axes[0][0].legend(fontsize=7)
    for ax in axes[-1]:
        ax.set_xlabel("time [s]")
    figure.suptitle(title, fontsize=10)
    return figure
