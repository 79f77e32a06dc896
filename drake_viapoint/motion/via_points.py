"""A movement as a handful of points in time, and the names of their components.

Via-points are numbered from 1 in time order, end points included, and a component carries the
name of its dimension and the number of its via-point: ``x3`` is x of via-point 3. The column
order of a full Jacobian is via-point by via-point (section 2.2.1 of Miyamoto & Kawato, 1998).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.errors import ViaPointsError

_COMPONENT = re.compile(r"(?P<name>[A-Za-z_]+)(?P<number>\d+)")


@dataclass(frozen=True, eq=False)
class ViaPoints:
    """Times and values of n via-points in d dimensions.

    Attributes:
        times: Strictly increasing times [s].
        values: One row a via-point, in the units of each dimension.
        names: Name of each dimension, such as ``("x", "y", "z", "phi", "theta", "psi")``.

    Raises:
        ViaPointsError: The shapes disagree, a value is not finite, times do not increase.
    """

    times: NDArray[np.float64]  # (n,)
    values: NDArray[np.float64]  # (n, d)
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        times = np.array(self.times, dtype=np.float64)
        values = np.array(self.values, dtype=np.float64)
        names = tuple(self.names)
        if times.ndim != 1 or values.shape != (times.size, len(names)):
            raise ViaPointsError(
                f"via-points need times (n,) and values (n, {len(names)}) for {', '.join(names)}; "
                f"got {times.shape} and {values.shape}"
            )
        if times.size < 2:
            raise ViaPointsError(f"a movement needs at least 2 via-points, got {times.size}")
        for number in range(1, times.size + 1):
            row = values[number - 1]
            if not (np.isfinite(times[number - 1]) and np.all(np.isfinite(row))):
                raise ViaPointsError(f"via-point {number} is not finite: {row.tolist()}")
            if number > 1 and not times[number - 1] > times[number - 2]:
                raise ViaPointsError(
                    f"times of via-points must increase: via-point {number} is at "
                    f"{times[number - 1]:g} s, via-point {number - 1} at {times[number - 2]:g} s"
                )
        times.flags.writeable = False
        values.flags.writeable = False
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "names", names)

    @property
    def components(self) -> tuple[str, ...]:
        """Names of all n d components, via-point by via-point (columns 1, 2, ... of Eq. 5)."""
        return tuple(f"{name}{i}" for i in range(1, self.times.size + 1) for name in self.names)

    def column(self, component: str) -> int:
        """Index of a component in ``components``, from 0.

        Raises:
            ViaPointsError: There is no such component.
        """
        match = _COMPONENT.fullmatch(component)
        if match and match["name"] in self.names and 1 <= int(match["number"]) <= self.times.size:
            return (int(match["number"]) - 1) * len(self.names) + self.names.index(match["name"])
        raise ViaPointsError(
            f"no component {component!r}: dimensions are {', '.join(self.names)}, "
            f"via-points 1 to {self.times.size}"
        )

    def select(self, components: Sequence[str]) -> NDArray[np.float64]:
        """Values of the named components: the control variable S. Shape (k,)."""
        return self.values.ravel()[[self.column(name) for name in components]]

    def moved(self, components: Sequence[str], change: ArrayLike) -> ViaPoints:
        """These via-points with ``change`` (k,) added to the named components."""
        values = self.values.copy().ravel()
        np.add.at(values, [self.column(name) for name in components], np.asarray(change))
        return replace(self, values=values.reshape(self.values.shape))

    def __eq__(self, other: object) -> bool:
        """Whether the other is the same movement, to the last bit."""
        if not isinstance(other, ViaPoints):
            return NotImplemented
        return (
            self.names == other.names
            and np.array_equal(self.times, other.times)
            and np.array_equal(self.values, other.values)
        )

    def __hash__(self) -> int:
        return hash((self.names, self.values.shape))
