"""How our figures look: one size, one set of colours, the paper's symbols."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from drake_viapoint.errors import ViapointError

DEMONSTRATED = "0.45"
"""Colour of what was watched."""

OURS = "tab:blue"
"""Colour of what we made of it."""

VIA_POINT = "tab:red"
"""Colour of via-points."""

BALL = "tab:olive"
"""Colour of the ball."""

TIP = "tab:olive"
"""Colour of the pendulum's tip."""

POSE_LABELS = ("x [m]", "y [m]", "z [m]", "φ [rad]", "θ [rad]", "ψ [rad]")
"""Axis labels of a racket pose's six dimensions."""

SYNTHETIC = "synthetic demonstration, made by a virtual person"
"""Said in every figure that shows one."""


def save(figure: Figure, path: Path) -> Path:
    """Write a figure as a picture.

    Raises:
        ViapointError: It cannot be written there, or not as what its name says.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=130)
    except OSError as error:
        raise ViapointError(f"{path}: cannot be written: {error.strerror}") from error
    except ValueError as error:
        raise ViapointError(f"{path}: cannot be written: {error}") from error
    return path
