"""The joint movement that via-points ask for, or the refusal of an arm that cannot make it."""

from __future__ import annotations

from drake_viapoint.errors import UnreachableError
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.robot.retargeting import JointMovement, Retargeting
from drake_viapoint.tasks.trial import RefusedTrial


class ArmMovements:
    """Retargets via-points, and refuses those out of reach.

    The last movement is kept: the same via-points give the same one, so repeats need not be
    retargeted again.

    Args:
        retargeting: From via-points to joint movements.
        results: Names of what a refused trial does not reach.
    """

    def __init__(self, retargeting: Retargeting, results: tuple[str, ...]) -> None:
        self._retargeting = retargeting
        self._results = results
        self._last: tuple[ViaPoints, JointMovement | RefusedTrial] | None = None

    def __call__(self, via_points: ViaPoints) -> JointMovement | RefusedTrial:
        """The movement, or why there is none."""
        if self._last is None or self._last[0] != via_points:
            movement: JointMovement | RefusedTrial
            try:
                movement = self._retargeting(via_points)
            except UnreachableError as error:
                movement = RefusedTrial(str(error), self._results)
            self._last = via_points, movement
        return self._last[1]
