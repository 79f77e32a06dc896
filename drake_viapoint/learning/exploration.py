"""A Jacobian from trials made for nothing else: each component moved up and down (Eqs. 2, 3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.subtask import Subtask

_LARGEST_NUMBER_OF_HALVINGS = 4


class Exploration:
    """Central differences, one pair of trials a component.

    A trial that does not reach the task variable makes its pair start again at half the size: a
    perturbation that loses the ball says nothing about the slope.
    """

    def __init__(self, subtask: Subtask) -> None:
        self._subtask = subtask
        self._columns: list[NDArray[np.float64]] = []
        self._first_of_pair: NDArray[np.float64] | None = None
        self._halvings = 0

    @property
    def complete(self) -> bool:
        """Whether every component has been moved both ways."""
        return len(self._columns) == len(self._subtask.control)

    @property
    def jacobian(self) -> NDArray[np.float64]:
        """dT/dS, shape (m, k), once complete [units of T per unit of each component]."""
        return np.stack(self._columns, axis=1)

    def next_change(self) -> NDArray[np.float64]:
        """The change of S to try next. Shape (k,)."""
        change = np.zeros(len(self._subtask.control))
        change[len(self._columns)] = self._size if self._first_of_pair is None else -self._size
        return change

    def record(self, error: NDArray[np.float64]) -> None:
        """Take in Td - T (m,) of the trial that made ``next_change``."""
        if self._first_of_pair is None:
            self._first_of_pair = error
            return
        # the error falls as T rises, hence the order of the difference
        self._columns.append((error - self._first_of_pair) / (2 * self._size))
        self._first_of_pair = None
        self._halvings = 0

    def restart_pair(self) -> None:
        """Forget the half-made pair: the point it starts from has moved."""
        self._first_of_pair = None

    def shrink(self) -> None:
        """Start the pair again at half the size.

        Raises:
            LearningError: The perturbation has been halved too often.
        """
        self._halvings += 1
        self._first_of_pair = None
        if self._halvings > _LARGEST_NUMBER_OF_HALVINGS:
            component = self._subtask.control[len(self._columns)]
            raise LearningError(
                f"no slope of {self._subtask.task_variable} along {component}: even a "
                f"perturbation of {2 * self._size:g} does not reach it"
            )

    @property
    def _size(self) -> float:
        return self._subtask.perturbation[len(self._columns)] / 2.0**self._halvings
