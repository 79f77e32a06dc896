"""A marker recording: named points along time."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.demonstration.even_times import unrounded
from drake_viapoint.errors import MarkerMissingError, RecordingError


@dataclass(frozen=True)
class MarkerRecording:
    """Positions of named markers along time.

    A sample with any coordinate missing is missing whole. The arrays are copied and read-only.

    Attributes:
        names: (m,) names of the markers, no two alike.
        times: (n,) strictly increasing times [s], n >= 2.
        positions: (n, m, 3) positions in the laboratory's axes [m], NaN where invalid.
        source: The file it came from, if any.

    Raises:
        RecordingError: Shapes disagree, a name appears twice or is empty, times do not increase, or
            a value is infinite.
    """

    names: tuple[str, ...]
    times: NDArray[np.float64]
    positions: NDArray[np.float64]
    source: Path | None = None

    def __post_init__(self) -> None:
        """Copy, check and freeze the arrays."""
        names = tuple(self.names)
        times = np.array(self.times, dtype=np.float64)
        positions = np.array(self.positions, dtype=np.float64)
        _check_names(names)
        _check_times(times)
        if positions.shape != (len(times), len(names), 3):
            raise RecordingError(
                f"positions have shape {positions.shape}, not {(len(times), len(names), 3)} for "
                f"{len(times)} times and {len(names)} markers"
            )
        infinite = np.isinf(positions).any(axis=2)
        if infinite.any():
            sample, marker = np.argwhere(infinite)[0]
            raise RecordingError(f"marker {names[marker]!r} is infinite", int(sample))
        positions[np.isnan(positions).any(axis=2)] = np.nan
        times.flags.writeable = False
        positions.flags.writeable = False
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "positions", positions)

    @property
    def rate(self) -> float:
        """Samples per second, from the median time between samples [Hz].

        Of even times that the file has rounded, it is the rate they had: see ``unrounded``.
        """
        return float(1.0 / np.median(np.diff(unrounded(self.times))))

    def index(self, name: str) -> int:
        """Column of a marker.

        A capture system may put the subject before the name, as in "Derrick:RFIN"; the bare name is
        enough where only one subject has that marker.

        Raises:
            MarkerMissingError: No such marker, or one for each of several subjects.
        """
        if name in self.names:
            return self.names.index(name)
        matches = [i for i, full in enumerate(self.names) if full.endswith(f":{name}")]
        if len(matches) != 1:
            raise MarkerMissingError(name, self.names, self.source)
        return matches[0]

    def marker(self, name: str) -> NDArray[np.float64]:
        """Positions of one marker, (n, 3) [m], NaN where invalid.

        Raises:
            MarkerMissingError: No such marker, or one for each of several subjects.
        """
        return self.positions[:, self.index(name)]


def _check_names(names: tuple[str, ...]) -> None:
    if not names:
        raise RecordingError("no markers")
    for name in names:
        if not name.strip():
            raise RecordingError("a marker has no name")
        if names.count(name) > 1:
            raise RecordingError(f"marker {name!r} appears {names.count(name)} times")


def _check_times(times: NDArray[np.float64]) -> None:
    if times.ndim != 1 or len(times) < 2:
        raise RecordingError(f"a recording needs two samples or more, not shape {times.shape}")
    if not np.isfinite(times).all():
        raise RecordingError("time is not a number", int(np.argmin(np.isfinite(times))))
    stalled = np.flatnonzero(np.diff(times) <= 0.0)
    if len(stalled):
        sample = int(stalled[0]) + 1
        raise RecordingError(
            f"times do not increase: {times[sample]:g} s after {times[sample - 1]:g} s", sample
        )
