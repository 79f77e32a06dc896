"""A stage for trials in a notebook: live in Meshcat where a person looks on, a recording elsewhere.

A notebook that somebody has open gets Meshcat's own page, on which trial after trial is played
while learning goes on. One that is executed without anybody (by nbclient, nbconvert, papermill)
keeps a recording in its output, which plays without a kernel.
"""

from __future__ import annotations

import gc
import html
import os
import time
from collections.abc import Callable, Mapping
from typing import Any

from pydrake.geometry import Meshcat

from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction.page import new_page, page_of
from drake_viapoint.tasks.trial import RefusedTrial

_OPENED = ("JPY_SESSION_NAME", "VSCODE_PID")
"""Set where a person opened the notebook: by Jupyter's server (and VS Code of late) for a kernel
that belongs to a notebook in a browser, and by VS Code for all that it starts."""
_ELSEWHERE = (
    "JUPYTERHUB_API_URL",
    "COLAB_RELEASE_TAG",
    "DEEPNOTE_PROJECT_ID",
    "CODESPACES",
    "SSH_CONNECTION",
    "CI",
)
"""Set where the browser is on another machine, and does not reach Meshcat's port, or where none
is."""


def somebody_looks_on(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether a person has this notebook open in a browser on this machine, as far as one can tell.

    Args:
        environment: Of the kernel.
    """
    opened = any(name in environment for name in _OPENED)
    return opened and not any(name in environment for name in _ELSEWHERE)


class Stage:
    """Where the trials of a task are shown; displayed by the notebook whose cell it ends.

    Args:
        draw: Draws a trial on a page and says how long it plays [s], such as ``draw_serve``; under
            the same names each time, so that one trial takes the place of the other without the
            page going blank between them.
        of: What else it needs: the task's scenario, or the task.
        live: Whether to show them live; None to find out.
        height: Of the page [pixels].

    Attributes:
        live: Whether they are shown live.
    """

    def __init__(
        self,
        draw: Callable[[Meshcat, Any, Any, ViaPoints], float],
        of: Any,
        *,
        live: bool | None = None,
        height: int = 480,
    ) -> None:
        self.live = somebody_looks_on() if live is None else live
        self._draw = draw
        self._of = of
        self._height = height
        self._meshcat = new_page() if self.live else None
        self._last: tuple[Any, ViaPoints] | None = None

    def show(self, trial: Any, via_points: ViaPoints, *, wait: bool = False) -> Stage:
        """Show a trial, in place of the one before; a refused one changes nothing.

        Live it is played at once. Else it costs nothing until the stage is displayed.

        Args:
            trial: What to show.
            via_points: What it was asked to do.
            wait: Whether to come back only when it has been played, if anybody has the page open.
        """
        if isinstance(trial, RefusedTrial):
            return self
        self._last = trial, via_points
        if self._meshcat is not None:
            duration = self._draw(self._meshcat, self._of, trial, via_points)
            gc.collect()  # see _repr_html_
            if wait and self._meshcat.GetNumActiveConnections():
                time.sleep(duration)
        return self

    def _repr_html_(self) -> str:
        """What a notebook displays."""
        if self._meshcat is not None:
            url = self._meshcat.web_url()
            frame = f'<iframe src="{url}" width="100%" height="{self._height}" frameborder="0">'
            return (
                f'<div>{frame}</iframe><br/><small>Live at <a href="{url}">{url}</a>. If nothing '
                "is seen, this browser does not reach it: <code>Stage(..., live=False)</code> "
                "embeds a recording.</small></div>"
            )
        if self._last is None:
            return "<div>No trial has been shown yet.</div>"
        trial, via_points = self._last
        page = page_of(lambda meshcat: self._draw(meshcat, self._of, trial, via_points))
        # Meshcat has to end in the thread it began in, or Drake stops the process; left to itself
        # it ends wherever garbage happens to be collected
        gc.collect()
        frame = f'<iframe srcdoc="{html.escape(page)}" width="100%" height="{self._height}"'
        return f'<div>{frame} frameborder="0"></iframe></div>'
