"""Joint angles that bring the tool to a pose, as near as possible to a fixed reference posture.

A redundant arm has many; a fixed choice among them keeps retargeting a smooth function of the
via-points, which a choice by the last solution would not. The conditions solved are those of
    minimise |q - q_ref|^2 / 2   subject to   tool(q) = pose:
the pose itself, and no pull of q_ref along the arm's self-motion. Each step closes the pose error
by the pseudoinverse and follows the pull in the null space; near q_ref it converges as Newton's
method does. A joint that would leave its limits is held at the limit. All poses are solved
together: what costs is the Python call, not the arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import Bounds, NonlinearConstraint, least_squares, minimize
from scipy.spatial.transform import Rotation

from drake_viapoint.errors import UnreachableError
from drake_viapoint.robot.arm import Arm

_MAX_ITERATIONS = 200
_MAX_STEP = 0.3  # [rad] a joint and iteration; keeps steps from far away inside Newton's realm
_CONVERGED = 1e-11  # [m, rad] of the last step: finite differences of 1e-4 m need 1e-8 or better
_DRAWN, _STARTS = 300, 20  # postures drawn at random, and tried as starts of a search


@dataclass(frozen=True)
class InverseKinematics:
    """Inverse kinematics of one arm.

    Attributes:
        arm: The arm.
        reference: (k,) posture to stay near to [rad].
        position_tolerance: Largest accepted position error [m].
        rotation_tolerance: Largest accepted orientation error [rad].
    """

    arm: Arm
    reference: NDArray[np.float64]
    position_tolerance: float = 1e-4
    rotation_tolerance: float = 1e-4

    def solve(
        self,
        rotations: ArrayLike,
        positions: ArrayLike,
        labels: Sequence[str],
        near: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Joint angles for n poses.

        Args:
            rotations: (n, 3, 3) world from tool.
            positions: (n, 3) [m].
            labels: What to call each pose in an error, such as ``"via-point 3"``.
            near: (n, k) postures to start from and stay near to [rad], one a pose: a pose that can
                be met only by another bend of the arm is then out of reach. If None, the solutions
                are searched for and stay near to ``reference``.

        Returns:
            (n, k) joint angles [rad] within the limits.

        Raises:
            UnreachableError: A pose cannot be reached; names it, the distance missed and the
                joints at their limits.
        """
        target_r = np.asarray(rotations, dtype=np.float64)
        target_p = np.asarray(positions, dtype=np.float64)
        if near is None:
            q = np.array([self._search(r, p) for r, p in zip(target_r, target_p, strict=True)])
            reference = np.broadcast_to(self.reference, q.shape)
        else:
            q = reference = np.asarray(near, dtype=np.float64)
        lower, upper = self.arm.limits.lower, self.arm.limits.upper
        q = self._newton(q, reference, target_r, target_p, np.ones_like(q, dtype=bool))
        outside = (q < lower) | (q > upper)
        q = np.clip(q, lower, upper)
        held = outside.any(axis=1)  # of seven joints one can be held and the pose still be met
        if held.any():
            bounded = self._newton(
                q[held], reference[held], target_r[held], target_p[held], ~outside[held]
            )
            q[held] = np.clip(bounded, lower, upper)
        for i in np.flatnonzero(self._missed(q, target_r, target_p)).tolist():
            pose = target_r[i], target_p[i]
            start = self._search(*pose) if near is None else self._approach(*pose, reference[i])
            q[i] = self._nearest(labels[i], *pose, start, reference[i])
        return q

    def _newton(
        self,
        q: NDArray[np.float64],
        reference: NDArray[np.float64],
        target_r: NDArray[np.float64],
        target_p: NDArray[np.float64],
        free: NDArray[np.bool_],
    ) -> NDArray[np.float64]:
        """Newton's iteration from q (n, k) with the joints not free held where they are."""
        q = q.copy()
        rows = np.arange(len(q))  # those still moving: a pose must not feel the others
        for _ in range(_MAX_ITERATIONS):
            error = self._pose_error(q[rows], target_r[rows], target_p[rows])
            jacobian = np.array([self.arm.tool_jacobian(row) for row in q[rows]])
            jacobian *= free[rows, None, :]
            redundant = free[rows].sum(axis=1) > 6
            _, _, vt = np.linalg.svd(jacobian)
            null = vt[:, -1, :] * redundant[:, None]
            pull = np.sum(null * (q - reference)[rows], axis=1)
            step = (np.linalg.pinv(jacobian) @ error[:, :, None])[:, :, 0] - pull[:, None] * null
            largest = np.max(np.abs(step), axis=1)
            step *= (
                free[rows] * np.minimum(1.0, _MAX_STEP / np.maximum(largest, _CONVERGED))[:, None]
            )
            q[rows] += step
            rows = rows[largest >= _CONVERGED]
            if not rows.size:
                break
        return q

    def _nearest(
        self,
        label: str,
        target_r: NDArray[np.float64],
        target_p: NDArray[np.float64],
        start: NDArray[np.float64],
        reference: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """The same conditions with the limits as bounds, for a pose where Newton fails.

        Slower, and sure: it begins at a posture that meets the pose within the limits.
        """
        limits = self.arm.limits
        if self._missed(start[None], target_r[None], target_p[None])[0]:
            raise self._unreachable(label, start, target_r, target_p)

        def far(q: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
            return 0.5 * float(np.sum((q - reference) ** 2)), q - reference

        met = NonlinearConstraint(
            lambda q: self._pose_error(q[None], target_r[None], target_p[None])[0],
            0.0,
            0.0,
            jac=lambda q: -self.arm.tool_jacobian(q),
        )
        within = Bounds(limits.lower, limits.upper)
        fit = minimize(
            far, start, jac=True, bounds=within, constraints=met, method="SLSQP", tol=1e-12
        )
        near = np.clip(fit.x, limits.lower, limits.upper)
        free = (near > limits.lower + 1e-6) & (near < limits.upper - 1e-6)
        exact = self._newton(
            near[None], reference[None], target_r[None], target_p[None], free[None]
        )
        for q in np.clip(exact, limits.lower, limits.upper)[0], near:
            if not self._missed(q[None], target_r[None], target_p[None])[0]:
                return np.asarray(q)
        return start

    def _missed(
        self,
        q: NDArray[np.float64],
        target_r: NDArray[np.float64],
        target_p: NDArray[np.float64],
    ) -> NDArray[np.bool_]:
        """Which postures (n, k) miss their poses by more than is accepted (n,)."""
        error = self._pose_error(q, target_r, target_p)
        turned = np.linalg.norm(error[:, :3], axis=1) > self.rotation_tolerance
        return np.asarray(turned | (np.linalg.norm(error[:, 3:], axis=1) > self.position_tolerance))

    def _pose_error(
        self,
        q: NDArray[np.float64],
        target_r: NDArray[np.float64],
        target_p: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """(n, 6) rotation vector and translation from the tool to its target, in the world."""
        poses = [self.arm.tool_pose(row) for row in q]
        rotation = np.array([pose.rotation for pose in poses])
        position = np.array([pose.position for pose in poses])
        turn = Rotation.from_matrix(target_r @ rotation.transpose(0, 2, 1)).as_rotvec()
        return np.concatenate([turn, target_p - position], axis=1)

    def _search(
        self, target_r: NDArray[np.float64], target_p: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """A posture (k,) near the target, within the limits: the best of several approaches."""
        lower, upper = self.arm.limits.lower, self.arm.limits.upper
        rng = np.random.default_rng(0)  # the search must not depend on what was drawn before
        drawn = rng.uniform(lower, upper, (_DRAWN, self.arm.num_joints))
        wrong = self._pose_error(
            drawn, np.tile(target_r, (_DRAWN, 1, 1)), np.tile(target_p, (_DRAWN, 1))
        )
        promising = np.argsort(np.linalg.norm(wrong, axis=1))[: _STARTS - 1]
        best, best_cost = self.reference, np.inf
        for start in (self.reference, *drawn[promising]):
            found = self._approach(target_r, target_p, start)
            cost = float(np.sum(self._pose_error(found[None], target_r[None], target_p[None]) ** 2))
            if cost < best_cost:
                best, best_cost = found, cost
            if best_cost < 1e-12:
                break
        return best

    def _approach(
        self,
        target_r: NDArray[np.float64],
        target_p: NDArray[np.float64],
        start: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """From a posture (k,) to one nearer to the target, within the limits."""
        lower, upper = self.arm.limits.lower, self.arm.limits.upper
        inside = np.clip(start, lower + 1e-3, upper - 1e-3)

        def residual(q: NDArray[np.float64]) -> NDArray[np.float64]:
            return self._pose_error(q[None], target_r[None], target_p[None])[0]

        def slope(q: NDArray[np.float64]) -> NDArray[np.float64]:
            return -self.arm.tool_jacobian(q)

        fit = least_squares(residual, inside, slope, bounds=(lower, upper), max_nfev=100)
        return np.asarray(fit.x)

    def _unreachable(
        self,
        label: str,
        nearest: NDArray[np.float64],
        target_r: NDArray[np.float64],
        target_p: NDArray[np.float64],
    ) -> UnreachableError:
        error = self._pose_error(nearest[None], target_r[None], target_p[None])[0]
        limits = self.arm.limits
        at_limit = [
            (name, bound)
            for name, angle, low, high in zip(
                self.arm.joint_names, nearest, limits.lower, limits.upper, strict=True
            )
            for bound in (low, high)
            if abs(angle - bound) < 1e-3
        ]
        return UnreachableError(
            label,
            distance=float(np.linalg.norm(error[3:])),
            angle=float(np.linalg.norm(error[:3])),
            at_limit=tuple((name, float(bound)) for name, bound in at_limit),
        )
