"""A scene that moves, as one HTML page that plays in any browser, offline."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.geometry import Meshcat, MeshcatParams
from pydrake.systems.framework import Context, Diagram

FRAME = 1 / 64
"""Time between two pictures [s]; Meshcat's own, and its multiples are exact."""


_NO_ICON = '<link rel="icon" href="data:,">'  # or browsers ask the server for one
_AGAIN = 10_000  # times that it plays: as long as somebody looks


def new_page() -> Meshcat:
    """An empty page to draw on."""
    return Meshcat(MeshcatParams(host="localhost"))  # its server is not for others to see


def frame_times(duration: float) -> NDArray[np.float64]:
    """Times (n,) of the pictures that show a movement and at least its end [s]."""
    return FRAME * np.arange(int(np.ceil(duration / FRAME)) + 1, dtype=np.float64)


def page_of(draw: Callable[[Meshcat], object]) -> str:
    """What is drawn on an empty page, as one HTML page."""
    meshcat = new_page()
    draw(meshcat)
    page: str = meshcat.StaticHtml()
    return page.replace("<head>", f"<head>{_NO_ICON}", 1)


def look(meshcat: Meshcat, camera: ArrayLike, target: ArrayLike) -> None:
    """Look from a place (3,) [m] at another; a page with paths stays as somebody has turned it."""
    if not meshcat.HasPath("paths"):
        meshcat.SetCameraPose(camera, target)


def play(
    meshcat: Meshcat,
    diagram: Diagram,
    times: NDArray[np.float64],
    pose: Callable[[Context, int], None],
) -> float:
    """Let a diagram move on a page, at true speed; in place of whatever moved there before.

    Args:
        meshcat: What is drawn so far; the diagram shows itself there.
        diagram: Whose bodies move.
        times: (n,) of the pictures, from 0 on, multiples of ``FRAME`` [s].
        pose: Puts the bodies, in the diagram's context, to where they are in a picture.

    Returns:
        How long it moves [s].
    """
    context = diagram.CreateDefaultContext()
    meshcat.DeleteRecording()
    meshcat.StartRecording(1 / FRAME, set_visualizations_while_recording=False)
    for number, time in enumerate(times):
        context.SetTime(time)
        pose(context, number)
        diagram.ForcedPublish(context)
    meshcat.StopRecording()
    meshcat.get_mutable_recording().set_repetitions(_AGAIN)
    meshcat.PublishRecording()
    return float(times[-1])
