"""Integrating a diagram by steps of one length, so short that the integrator rejects none.

After a step that Drake (1.51) rejects for its error it starts the next one with what it had cached
at the rejected step's end, at the cost of a hundred times the error. So the steps are the longest
allowed if all of them are accepted, else half as long, and so on.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import Context, Diagram, EventStatus

T = TypeVar("T")

_SHORTEST_STEP = 1e-9  # [s]
_MOST_HALVINGS = 4  # of the step; a torque that is clamped makes kinks that no step resolves


class _RejectedError(Exception):
    """A step was rejected; never leaves this file."""


class Stepping:
    """Integrates one diagram again and again, each time as if it were the first.

    Args:
        diagram: What moves.
        config: Integrator, accuracy and longest step.

    Attributes:
        context: The diagram's, which all steps change in place.
    """

    def __init__(self, diagram: Diagram, config: SimulatorConfig) -> None:
        self._diagram = diagram
        self._config = copy(config)  # it is mutable, and a trial shall not depend on that
        self._simulator = Simulator(diagram)
        self.context: Context = self._simulator.get_mutable_context()
        self._longest_step = config.max_step_size
        self._tolerant = False  # of rejected steps

    def until_accepted(self, attempt: Callable[[], T]) -> T:
        """The outcome of the first attempt in which no step is rejected, or of the last made.

        Args:
            attempt: Calls ``reset`` and then ``advance`` or ``go``, as often as it likes; it is
                broken off at a rejected step.
        """
        for halvings in range(_MOST_HALVINGS):
            self._longest_step = self._config.max_step_size / 2**halvings
            try:
                return attempt()
            except _RejectedError:
                continue
        self._longest_step = self._config.max_step_size / 2**_MOST_HALVINGS
        self._tolerant = True
        try:
            return attempt()
        finally:
            self._tolerant = False

    def reset(self, time: float) -> None:
        """Bring the context to its default state at a time [s], and forget earlier steps."""
        self._diagram.SetDefaultContext(self.context)
        # an integrator keeps the step it adapted to in the trial before; this makes it forget
        ApplySimulatorConfig(self._config, self._simulator)
        self._simulator.get_mutable_integrator().set_maximum_step_size(self._longest_step)
        self.context.SetTime(time)  # the configuration has a time of its own

    def advance(self, end: float, watch: Callable[[], bool]) -> None:
        """Integrate to a time [s], or to the first step at which a watch says stop.

        Args:
            end: When to stop at the latest.
            watch: Called before the first step and after each; true to stop there.
        """
        go_on = EventStatus.DidNothing()
        stop = EventStatus.ReachedTermination(self._diagram, "the watch says stop")
        stopped = False

        def monitor(_: Context) -> EventStatus:
            nonlocal stopped
            stopped = self._spoilt() or watch()
            return stop if stopped else go_on

        self._simulator.set_monitor(monitor)
        self._simulator.Initialize()  # also reports the first state to the monitor
        if not stopped:
            self._simulator.AdvanceTo(end)
        self._simulator.clear_monitor()
        self._check()

    def go(self, start: float, state: NDArray[np.float64], end: float) -> None:
        """Integrate from a continuous state at one time [s] to another, with nobody watching."""
        self.context.SetTime(start)
        self.context.SetContinuousState(state)
        self._simulator.Initialize()
        self._simulator.AdvanceTo(end)
        self._check()

    def set_clock(self, time: float) -> None:
        """Say that it is another time [s], with everything else as it is."""
        self.context.SetTime(time)
        self._simulator.Initialize()

    def march(self, end: float, step: float) -> None:
        """Integrate to a time [s] from where the context is, with nobody watching.

        Steps are no longer than ``step`` [s]; where the integrator controls its error it may reject
        some, and goes on.

        Raises:
            RuntimeError: The integrator, Drake's, does not get on: its steps would have to be
                shorter than a nanosecond.
        """
        integrator = self._simulator.get_mutable_integrator()
        integrator.set_maximum_step_size(step)
        integrator.set_requested_minimum_step_size(_SHORTEST_STEP)
        self._simulator.AdvanceTo(end)

    def _spoilt(self) -> bool:
        """Whether a step was rejected since the integrator's initialisation, and it matters."""
        integrator = self._simulator.get_integrator()
        return not self._tolerant and integrator.get_num_step_shrinkages_from_error_control() > 0

    def _check(self) -> None:
        if self._spoilt():
            raise _RejectedError
