"""The simply regularised generalised inverse, ``#`` in Eqs. 1, 4, 12 and 15."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_viapoint.errors import LearningError


def generalized_inverse(matrix: ArrayLike, regularization: float) -> NDArray[np.float64]:
    """A# = A^T (A A^T + lambda I)^-1.

    Args:
        matrix: A, of shape (m, k).
        regularization: lambda >= 0, in the units of A squared. It bounds the step along a
            direction of singular value s to s / (s^2 + lambda) <= 1 / (2 sqrt(lambda)).

    Returns:
        A#, of shape (k, m); the Moore-Penrose inverse as lambda goes to 0.

    Raises:
        LearningError: A is not a finite matrix, or lambda is negative.
    """
    a = np.asarray(matrix, dtype=np.float64)
    if a.ndim != 2 or not np.all(np.isfinite(a)):
        raise LearningError(f"a Jacobian must be a finite matrix, got {a.tolist()}")
    if not regularization >= 0:
        raise LearningError(f"the regularization must not be negative, got {regularization:g}")
    # by singular values, so that lambda = 0 and rank-deficient matrices are no special case
    u, s, vt = np.linalg.svd(a, full_matrices=False)
    tiny = s <= np.finfo(np.float64).eps * max(a.shape) * (s[0] if s.size else 0.0)
    gains = np.where(tiny, 0.0, s / np.where(tiny, 1.0, s**2 + regularization))
    inverse: NDArray[np.float64] = vt.T @ (gains[:, None] * u.T)
    return inverse
