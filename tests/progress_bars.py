"""Progress bars that count what they are told."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class Bars:
    """Makes bars, and remembers each one's total and what it was told."""

    def __init__(self) -> None:
        self.seen: dict[str, list[int]] = {}

    @contextmanager
    def __call__(self, label: str, total: int) -> Iterator[Bars]:
        self.seen[label] = self.current = [total]
        yield self

    def update(self, n_steps: int) -> None:
        self.current.append(n_steps)
