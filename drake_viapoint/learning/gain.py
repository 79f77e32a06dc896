"""How far a learning step goes: the gain matrix B of Eqs. 1, 4 and 15."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


class Gain(Protocol):
    """The diagonal of B, as a function of how well the preceding subtask does."""

    def __call__(self, preceding_error: float) -> tuple[float, ...] | float:
        """Gain for one step.

        Args:
            preceding_error: Norm of Td - T of the preceding subtask (d in the paper), 0 if none.
        """
        ...


@dataclass(frozen=True)
class ConstantGain:
    """The same gain whatever happens, one value or one for each task variable."""

    value: tuple[float, ...] | float

    def __call__(self, preceding_error: float) -> tuple[float, ...] | float:
        """See ``Gain``."""
        del preceding_error
        return self.value


@dataclass(frozen=True)
class TaperedGain:
    """Full gain while the preceding subtask does well, none where it fails.

    alpha(d) of section 2.1.3, continuous: ``full`` up to ``taper_start``, linear down to 0 at
    ``taper_end``. With 0.4, 0.05 m and 0.1 m its middle branch is 0.8 - 8 d.
    """

    full: float
    taper_start: float
    taper_end: float

    def __call__(self, preceding_error: float) -> float:
        """See ``Gain``."""
        if preceding_error < self.taper_start:
            return self.full
        if preceding_error >= self.taper_end:
            return 0.0
        share = (self.taper_end - preceding_error) / (self.taper_end - self.taper_start)
        return self.full * share
