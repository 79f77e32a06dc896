"""What long work tells whoever waits for it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Protocol


class Bar(Protocol):
    """A progress bar."""

    def update(self, n_steps: int) -> None:
        """So many steps are done."""
        ...


Progress = Callable[[str, int], AbstractContextManager[Bar]]
"""Makes a progress bar with a label and a number of steps."""
