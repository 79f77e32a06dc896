"""A Jacobian from trials made for nothing else: each component moved by itself (Eqs. 2, 3, 16)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.subtask import Subtask

_LARGEST_NUMBER_OF_HALVINGS = 4


class Exploration:
    """Differences, component by component: central ones, or one-sided ones from where we stand.

    A trial that does not reach the task variable makes its component start again at half the size:
    a perturbation that loses the ball says nothing about the slope.

    Args:
        subtask: Whose components are moved, how far, and whether to one side only.
        error: Td - T (m,) of the trial explored around, if it reached T.
    """

    def __init__(self, subtask: Subtask, error: NDArray[np.float64] | None = None) -> None:
        self._subtask = subtask
        self._columns: list[NDArray[np.float64]] = []
        # Td - T that the next trial is compared with; None if that one is still to be executed
        self._compared = error if subtask.one_sided else None
        self._halvings = 0

    @property
    def complete(self) -> bool:
        """Whether every component has been moved."""
        return len(self._columns) == len(self._subtask.control)

    @property
    def jacobian(self) -> NDArray[np.float64]:
        """dT/dS, shape (m, k), once complete [units of T per unit of each component]."""
        return np.stack(self._columns, axis=1)

    def next_change(self) -> NDArray[np.float64]:
        """The change of S to try next. Shape (k,)."""
        change = np.zeros(len(self._subtask.control))
        if self._subtask.one_sided:
            change[len(self._columns)] = 0.0 if self._compared is None else self._size
        else:
            change[len(self._columns)] = self._size if self._compared is None else -self._size
        return change

    def record(self, error: NDArray[np.float64]) -> None:
        """Take in Td - T (m,) of the trial that made ``next_change``."""
        if self._compared is None:
            self._compared = error
            return
        # the error falls as T rises, hence the order of the differences
        if self._subtask.one_sided:
            self._columns.append((self._compared - error) / self._size)
        else:
            self._columns.append((error - self._compared) / (2 * self._size))
            self._compared = None
        self._halvings = 0

    def restart(self) -> int:
        """Forget what the next trial was to be compared with: the point explored around moved.

        Returns:
            How many trials that wastes: the last one, and the one it was compared with.
        """
        wasted = 1 + self._pair_begun
        self._compared = None
        return wasted

    def shrink(self) -> int:
        """Start the component again at half the size.

        Returns:
            How many trials that wastes, as above.

        Raises:
            LearningError: The perturbation has been halved too often.
        """
        wasted = 1 + self._pair_begun
        self._halvings += 1
        if not self._subtask.one_sided:
            self._compared = None
        if self._halvings > _LARGEST_NUMBER_OF_HALVINGS:
            component = self._subtask.control[len(self._columns)]
            raise LearningError(
                f"no slope of {self._subtask.task_variable} along {component}: even a "
                f"perturbation of {2 * self._size:g} does not reach it"
            )
        return wasted

    @property
    def _pair_begun(self) -> bool:
        """Whether the trial up of a pair has been made; one-sided differences come in no pairs."""
        return self._compared is not None and not self._subtask.one_sided

    @property
    def _size(self) -> float:
        return self._subtask.perturbation[len(self._columns)] / 2.0**self._halvings
