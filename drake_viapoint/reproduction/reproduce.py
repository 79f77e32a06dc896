"""Everything of the paper that stands so far, from runs made here and now, in one folder."""

from __future__ import annotations

from pathlib import Path

from drake_viapoint.reproduction.conditions import reproduce_conditions
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.robot import reproduce_robot
from drake_viapoint.reproduction.serve_reproduction import reproduce_serve
from drake_viapoint.reproduction.upswing_reproduction import reproduce_upswing


def reproduce(
    out: Path,
    serve_persons: int,
    upswing_persons: int,
    progress: Progress,
    only: str | None = None,
    *,
    disturbed_runs: int = 100,
    robot_runs: int = 20,
) -> list[str]:
    """Reproduce the serve (sections 2 and 3.2), on a robot (2.1), and the upswing (3.3).

    What the folder holds already is gone on with, not done again.

    Args:
        out: Folder of figures, recordings and runs.
        serve_persons: Virtual persons from whom the serve is learned; no study if 0.
        upswing_persons: The same for the upswing.
        progress: Shows what goes on.
        only: "serve", "robot" or "upswing"; all if None.
        disturbed_runs: Of the serve under each condition of section 3.2; no study if 0.
        robot_runs: Of the robot experiment; none if 0.

    Returns:
        Lines that say what was found and where it is.

    Raises:
        ViapointError: The folder cannot be written or holds other runs.
    """
    lines = []
    if only in (None, "serve"):
        lines += reproduce_serve(out, serve_persons, progress)
        if disturbed_runs:
            lines += reproduce_conditions(out, disturbed_runs, progress)
    if only in (None, "robot") and robot_runs:
        lines += reproduce_robot(out, robot_runs, progress)
    if only in (None, "upswing"):
        lines += reproduce_upswing(out, upswing_persons, progress)
    return lines
