"""Trials kept in memory alone: for studies of many short runs that are cheaper to do again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from drake_viapoint.runs.trial_lines import as_read_back


class MemoryLog:
    """A learning run's records, gone when the process ends.

    Attributes:
        path: What to call the run in an error.
        trials: Records of the trials so far.
    """

    def __init__(self, name: str) -> None:
        self.path = Path(name)
        self.trials: list[dict[str, Any]] = []

    def append(self, record: dict[str, Any]) -> dict[str, Any]:
        """Keep a record, and give it back as a run folder would, bit for bit."""
        self.trials.append(as_read_back(record))
        return self.trials[-1]
