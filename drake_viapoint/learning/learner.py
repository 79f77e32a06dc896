"""The learner: ask it for via-points, execute them, tell it what came out.

It stands between any robot, real or simulated, and the subtasks of any task. It is deterministic:
the same outcomes told in the same order give the same proposals, so a run can be resumed by
telling a new learner what has been recorded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.errors import LearningError, OutcomeNotFiniteError
from drake_viapoint.learning.ask_tell import Outcome, Proposal, Purpose
from drake_viapoint.learning.exploration import Exploration
from drake_viapoint.learning.generalized_inverse import generalized_inverse
from drake_viapoint.learning.jacobian import Observation
from drake_viapoint.learning.subtask import Subtask
from drake_viapoint.motion.via_points import ViaPoints


@dataclass
class _Progress:
    """What the learner knows of one subtask."""

    jacobian: NDArray[np.float64] | None = None  # (m, k) [units of T a perturbation]
    explored_at: int = 0  # trials told when it was last explored
    observations: list[Observation] = field(default_factory=list)
    error: NDArray[np.float64] | None = None  # (m,) of the last trial at the current via-points
    exploration: Exploration | None = field(default=None)

    def distance(self) -> float:
        return float(np.linalg.norm(self.error)) if self.error is not None else np.inf


class Learner:
    """Learns a chain of subtasks by Newton-like steps (sections 2.1.2 and 2.1.3).

    The first trial executes the via-points as they are. Then, subtask by subtask: explore its
    Jacobian, and step S by J# B (Td - T) after every trial, with the Jacobian kept, explored again
    or re-estimated in the subtask's own way. A trial in which the preceding subtask fails (its
    error is not below the gate) serves that one instead.

    Args:
        via_points: Where to start.
        subtasks: In the order in which the movement meets them.
        successes_to_learn: The task is learned after so many successful trials in a row; never if
            0, and there is always a next trial.
        repeats: Trials of the learned movement executed unchanged afterwards.

    Raises:
        LearningError: No subtask, or a subtask without its components among the via-points.
    """

    def __init__(
        self,
        via_points: ViaPoints,
        subtasks: Sequence[Subtask],
        *,
        successes_to_learn: int = 3,
        repeats: int = 0,
    ) -> None:
        if not subtasks:
            raise LearningError("a task needs at least one subtask")
        for subtask in subtasks:
            via_points.select(subtask.control)  # raises if a component is unknown
        self._subtasks = tuple(subtasks)
        self._progress = [_Progress() for _ in subtasks]
        self._via_points = via_points
        self._last_good = via_points
        self._active = 0
        self._successes_to_learn = successes_to_learn
        self._streak = 0
        self._learned_at: int | None = None
        self._repeats_left = repeats
        self._trials = 0
        self._wasted = 0
        self._proposal: Proposal | None = None

    @property
    def trials(self) -> int:
        """Trials told so far, exploration included."""
        return self._trials

    @property
    def wasted(self) -> int:
        """Exploration trials of which no Jacobian was made, as far as that is known."""
        return self._wasted

    @property
    def learned_at(self) -> int | None:
        """The trial that completed the successes in a row, or None."""
        return self._learned_at

    @property
    def finished(self) -> bool:
        """Whether the task is learned and its repeats are done."""
        return self._learned_at is not None and self._repeats_left == 0

    @property
    def via_points(self) -> ViaPoints:
        """The current via-points, without any perturbation."""
        return self._via_points

    @property
    def jacobians(self) -> dict[str, NDArray[np.float64]]:
        """Estimated Jacobian (m, k) of each subtask that has one, by name."""
        return {
            subtask.name: progress.jacobian / np.asarray(subtask.perturbation)
            for subtask, progress in zip(self._subtasks, self._progress, strict=True)
            if progress.jacobian is not None
        }

    def ask(self) -> Proposal:
        """The next trial to execute; the same one until its outcome is told.

        Raises:
            LearningError: There is none, the run is finished.
        """
        if self.finished:
            raise LearningError(f"the task was learned at trial {self._learned_at}")
        if self._proposal is None:
            self._proposal = self._propose()
        return self._proposal

    def tell(self, outcome: Outcome) -> None:
        """Take in the outcome of the trial last asked for, and learn from it.

        Raises:
            LearningError: Nothing was asked for, or nothing can be learned from the outcome.
            OutcomeNotFiniteError: A task variable is not finite. The trial counts, nothing is
                learned from it, and the same via-points are asked for again.
        """
        proposal = self._proposal
        if proposal is None:
            raise LearningError("ask for a trial before telling its outcome")
        if outcome.broken_off:
            self._trials += 1
            self._streak = 0
            if proposal.purpose is Purpose.REPEAT:  # one less, or a task that breaks never ends
                self._repeats_left -= 1
            return
        try:
            errors = [outcome.error(subtask.task_variable) for subtask in self._subtasks]
        except OutcomeNotFiniteError as error:
            self._trials += 1
            self._streak = 0
            raise error.of_trial(self._trials) from None
        self._trials += 1
        self._proposal = None
        if proposal.purpose is Purpose.REPEAT:
            self._repeats_left -= 1
            return
        self._streak = self._streak + 1 if outcome.success else 0
        if outcome.success and self._streak == self._successes_to_learn:
            self._learned_at = self._trials
            self._via_points = proposal.via_points  # exactly what succeeded
            return
        self._observe(proposal.via_points, errors)
        if proposal.purpose is Purpose.EXPLORATION:
            self._learn_from_exploration(errors)
        else:
            self._learn_from(errors)

    def _observe(self, executed: ViaPoints, errors: list[NDArray[np.float64] | None]) -> None:
        for index, (subtask, error) in enumerate(zip(self._subtasks, errors, strict=True)):
            passed = index == 0 or _norm(errors[index - 1]) < subtask.gate
            if error is not None and passed:
                control = executed.select(subtask.control) / np.asarray(subtask.perturbation)
                self._progress[index].observations.append(Observation(control, error))

    def _propose(self) -> Proposal:
        subtask = self._subtasks[self._active]
        if self._learned_at is not None:
            return Proposal(self._via_points, Purpose.REPEAT, subtask.name)
        exploration = self._progress[self._active].exploration
        if exploration is not None:
            perturbed = self._via_points.moved(subtask.control, exploration.next_change())
            return Proposal(perturbed, Purpose.EXPLORATION, subtask.name)
        return Proposal(self._via_points, Purpose.LEARNING, subtask.name)

    def _learn_from_exploration(self, errors: list[NDArray[np.float64] | None]) -> None:
        progress = self._progress[self._active]
        exploration = progress.exploration
        if exploration is None:  # cannot be: exploration trials are proposed by one
            raise LearningError("an exploration trial without an exploration")
        served = self._served_by(errors)
        error = errors[served]
        if error is None:  # its perturbation loses what even the preceding subtask needs
            self._wasted += exploration.shrink()
        elif served < self._active:
            self._wasted += exploration.restart()
            self._step(served, errors)
            for known in self._progress:
                known.error = None  # nothing has been executed at the new via-points
        else:
            exploration.record(error)
            if exploration.complete:
                size = np.asarray(self._subtasks[self._active].perturbation)
                progress.jacobian = exploration.jacobian * size
                progress.explored_at = self._trials
                progress.exploration = None
                if progress.error is not None:
                    self._step(self._active, [p.error for p in self._progress])

    def _learn_from(self, errors: list[NDArray[np.float64] | None]) -> None:
        for progress, error in zip(self._progress, errors, strict=True):
            progress.error = error
        while (
            self._active + 1 < len(self._subtasks)
            and self._progress[self._active].jacobian is not None
            and self._progress[self._active].distance() < self._subtasks[self._active].reached
        ):
            self._active += 1
        served = self._served_by(errors)
        while served > 0 and errors[served] is None:
            served -= 1
        if self._explores(served, errors[served]):
            self._progress[served].exploration = Exploration(self._subtasks[served], errors[served])
            self._last_good = self._via_points
            return
        self._step(served, errors)

    def _explores(self, index: int, error: NDArray[np.float64] | None) -> bool:
        """Whether to explore around the trial just told, whose error this is."""
        subtask, progress = self._subtasks[index], self._progress[index]
        if progress.jacobian is None and error is None:
            raise LearningError(
                f"the first trial did not reach {subtask.task_variable}: there is nothing to "
                "learn from"
            )
        if progress.jacobian is None:
            return True
        # exploring serves the active subtask; an earlier one steps with what it has
        again = index == self._active and error is not None
        return again and subtask.jacobian.explores_again(self._trials, progress.explored_at)

    def _served_by(self, errors: list[NDArray[np.float64] | None]) -> int:
        """The latest subtask, up to the active one, whose gate the trial passed."""
        index = self._active
        while index > 0 and not _norm(errors[index - 1]) < self._subtasks[index].gate:
            index -= 1
        return index

    def _step(self, index: int, errors: list[NDArray[np.float64] | None]) -> None:
        error = errors[index]
        if error is None:
            self._back_off()
            return
        self._last_good = self._via_points
        subtask, progress = self._subtasks[index], self._progress[index]
        if progress.jacobian is None:
            raise LearningError(f"subtask {subtask.name!r} has no Jacobian yet")
        jacobian = subtask.jacobian.revised(progress.jacobian, progress.observations)
        progress.jacobian = jacobian
        preceding = _norm(errors[index - 1]) if index > 0 else 0.0
        tolerance = np.broadcast_to(subtask.tolerance, error.shape)
        inverse = generalized_inverse(jacobian / tolerance[:, None], subtask.regularization)
        step = inverse @ (np.asarray(subtask.gain(preceding)) * error / tolerance)
        change = step * np.asarray(subtask.perturbation)
        self._via_points = self._via_points.moved(subtask.control, change)

    def _back_off(self) -> None:
        """Go half the way back to the last via-points from which something could be learned."""
        components = self._via_points.components
        change = (self._last_good.select(components) - self._via_points.select(components)) / 2
        self._via_points = self._via_points.moved(components, change)


def _norm(error: NDArray[np.float64] | None) -> float:
    return float(np.linalg.norm(error)) if error is not None else np.inf
