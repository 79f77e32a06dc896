"""Our Fig. 9: what moving each component of the via-points does to the serve's two subtasks."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from drake_viapoint.learning.component_effects import ComponentEffects
from drake_viapoint.learning.selection import Selection

_POSITION, _ANGLE = "0.25", "0.78"
_DIMENSIONS = 6  # of a pose
_GAP = "no ball: a gap"
_PAPERS = {"h": (13, 14, 15, 19, 20, 21), "ratio": (34, 40, 42)}


def draw(
    h: ComponentEffects,
    g: ComponentEffects,
    disturbance: ComponentEffects,
    throw: Selection,
    by_norm: Selection,
    by_ratio: Selection,
    perturbation: str,
) -> Figure:
    """Draw norms and ratios of all columns.

    Args:
        h: Effects on T_H around the unlearned movement.
        g: Effects on T_G once the throw is learned.
        disturbance: Effects on T_H there.
        throw: Components chosen for subtask 1.
        by_norm: Components chosen for subtask 2 by their effect alone.
        by_ratio: Components chosen for subtask 2 by the ratio.
        perturbation: Of positions and angles, in words.
    """
    figure = Figure(figsize=(9.5, 8.5), layout="constrained")
    upper, middle, lower = figure.subplots(3, 1, sharex=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = g.norms / disturbance.norms
    gaps = np.isnan(g.norms)
    _draw(upper, h.norms, throw, np.isnan(h.norms), _PAPERS["h"])
    _draw(middle, g.norms, by_norm, gaps, ())
    _draw(lower, ratio, by_ratio, gaps, _PAPERS["ratio"])
    lower.set_yscale("log")
    upper.set_ylabel(r"$\|h_j\|$ [m a perturbation]")
    middle.set_ylabel(r"$\|g_j\|$ [m a perturbation]")
    lower.set_ylabel(r"$\|g_j\| / \|h_j\|$")
    lower.set_xlabel(f"column $j$ (a perturbation: {perturbation})")
    above = upper.secondary_xaxis("top")
    number = h.norms.size // _DIMENSIONS
    above.set_xticks([_DIMENSIONS * i + 3.5 for i in range(number)], range(1, number + 1))
    above.set_xlabel("via-point")
    marks = {
        label: handle
        for ax in (upper, middle, lower)
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    bars = [
        Patch(color=_POSITION, label="$x, y, z$"),
        Patch(color=_ANGLE, label=r"$\phi, \theta, \psi$"),
    ]
    handles = [*bars, *marks.values()]
    figure.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=8)
    return figure


def _draw(
    ax: Axes,
    values: NDArray[np.float64],
    selection: Selection,
    gaps: NDArray[np.bool_],
    papers: tuple[int, ...],
) -> None:
    columns = np.arange(1, values.size + 1)
    position = (columns - 1) % _DIMENSIONS < 3
    shown = np.nan_to_num(values)
    ax.bar(columns, shown, color=np.where(position, _POSITION, _ANGLE), edgecolor="0.4", lw=0.3)
    chosen = [line.column for line in selection.table if line.chosen]
    for marked, height, mark, colour, label in (
        (chosen, 0.92, "v", "tab:red", "chosen here"),
        (papers, 0.97, "x", "tab:blue", "the paper's choice"),
        (columns[gaps], 0.04, "s", "tab:orange", _GAP),
    ):
        if len(marked):
            ax.plot(
                marked,
                [height] * len(marked),
                mark,
                color=colour,
                markersize=6,
                label=label,
                transform=ax.get_xaxis_transform(),  # so high, whatever the values
            )
    ax.margins(y=0.15)
    for edge in range(_DIMENSIONS, values.size, _DIMENSIONS):
        ax.axvline(edge + 0.5, color="0.85", linewidth=0.7, zorder=0)
    ax.set_xlim(0.3, values.size + 0.7)
