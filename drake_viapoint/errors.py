"""What can go wrong, as data: every error a user's input can cause, and what it names."""

from __future__ import annotations

from pathlib import Path


class ViapointError(Exception):
    """Root of every error this package raises on purpose; its message is one line."""


class MarkerFileError(ViapointError):
    """A marker file that cannot be read.

    Attributes:
        path: The file.
        row: Line of the file, from 1, where a line is to blame.
    """

    def __init__(self, path: Path, reason: str, row: int | None = None) -> None:
        where = f"{path}" if row is None else f"{path}, line {row}"
        super().__init__(f"{where}: {reason}")
        self.path = path
        self.row = row


class ViaPointsError(ViapointError):
    """Via-points that make no movement, or a component that does not exist."""


class ExtractionError(ViapointError):
    """A movement from which the via-points asked for cannot be extracted."""


class LearningError(ViapointError):
    """A learner that was given what it cannot learn from."""


class ModelFileError(ViapointError):
    """A model or scene that is not where its address says.

    Attributes:
        uri: The address, ``package://drake_viapoint/...``.
    """

    def __init__(self, uri: str, reason: str) -> None:
        super().__init__(f"{uri}: {reason}")
        self.uri = uri
