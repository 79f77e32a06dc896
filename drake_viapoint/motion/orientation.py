"""Orientation as intrinsic ZYZ angles: R = Rz(phi) Ry(theta) Rz(psi), world from body.

Angles are ordered (phi, theta, psi) [rad] everywhere. The columns of R are the body's axes in world
coordinates. With z_body along the racket's handle, (phi, theta) is the direction of the handle and
psi the turn of the face about it (paper 2.1.1; the convention is settled in section 2.2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

SINGULAR_SIN_THETA = 1e-15
"""Below this sin(theta) phi and psi are not told apart: their axes coincide [-]."""


def rotation_from_zyz(zyz: ArrayLike) -> NDArray[np.float64]:
    """Rotation matrices of ZYZ angles.

    Args:
        zyz: (..., 3) angles phi, theta, psi [rad].

    Returns:
        (..., 3, 3) matrices R = Rz(phi) Ry(theta) Rz(psi).
    """
    phi, theta, psi = np.moveaxis(np.asarray(zyz, dtype=np.float64), -1, 0)
    cf, sf = np.cos(phi), np.sin(phi)
    ct, st = np.cos(theta), np.sin(theta)
    cp, sp = np.cos(psi), np.sin(psi)
    rows = (
        (cf * ct * cp - sf * sp, -cf * ct * sp - sf * cp, cf * st),
        (sf * ct * cp + cf * sp, -sf * ct * sp + cf * cp, sf * st),
        (-st * cp, st * sp, ct),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def zyz_from_rotation(matrix: ArrayLike) -> NDArray[np.float64]:
    """ZYZ angles of rotation matrices, with 0 <= theta <= pi and phi, psi in [-pi, pi].

    Where sin(theta) < `SINGULAR_SIN_THETA` only phi + psi (theta = 0) or phi - psi (theta = pi) is
    determined; phi = 0 is chosen there. psi is read after undoing phi, so that the angles give the
    matrix back to rounding error however close to the singularity it is.

    Args:
        matrix: (..., 3, 3) rotation matrices; orthonormality is not checked.

    Returns:
        (..., 3) angles phi, theta, psi [rad].
    """
    r = np.asarray(matrix, dtype=np.float64)
    sin_theta = np.hypot(r[..., 0, 2], r[..., 1, 2])
    theta = np.arctan2(sin_theta, r[..., 2, 2])
    phi = np.where(sin_theta < SINGULAR_SIN_THETA, 0.0, np.arctan2(r[..., 1, 2], r[..., 0, 2]))
    cf, sf = np.cos(phi), np.sin(phi)
    # The middle row of Rz(-phi) R = Ry(theta) Rz(psi) is (sin psi, cos psi, 0), for every theta.
    psi = np.arctan2(cf * r[..., 1, 0] - sf * r[..., 0, 0], cf * r[..., 1, 1] - sf * r[..., 0, 1])
    return np.stack([phi, theta, psi], axis=-1)


def unwrap_zyz(zyz: ArrayLike) -> NDArray[np.float64]:
    """Make angles continuous along time without changing the rotations.

    Each row is replaced by its nearest equal to the row before: whole turns are added, and the
    other branch (phi + pi, -theta, psi + pi), the same rotation, is taken where that is nearer. So
    theta may leave [0, pi]. The first row stays as it is.

    Args:
        zyz: (n, 3) angles phi, theta, psi along time [rad].

    Returns:
        (n, 3) the same rotations, continuous [rad].
    """
    unwrapped = np.array(zyz, dtype=np.float64)
    turn = 2.0 * np.pi
    for k in range(1, len(unwrapped)):
        phi, theta, psi = unwrapped[k]
        branches = np.array([[phi, theta, psi], [phi + np.pi, -theta, psi + np.pi]])
        before = unwrapped[k - 1]
        branches += turn * np.round((before - branches) / turn)
        nearest = np.argmin(np.sum((branches - before) ** 2, axis=1))
        unwrapped[k] = branches[nearest]
    return unwrapped


def angular_velocity_from_zyz_rates(zyz: ArrayLike) -> NDArray[np.float64]:
    """The matrix E that turns angle rates into angular velocity: omega_world = E(zyz) @ zyz_dot.

    Its columns are the three turning axes in the world: z, Rz(phi) y and Rz(phi) Ry(theta) z. Its
    determinant is -sin(theta), so near sin(theta) = 0 it must not be inverted.

    Args:
        zyz: (..., 3) angles phi, theta, psi [rad].

    Returns:
        (..., 3, 3) matrix E [-].
    """
    phi, theta, _ = np.moveaxis(np.asarray(zyz, dtype=np.float64), -1, 0)
    cf, sf = np.cos(phi), np.sin(phi)
    ct, st = np.cos(theta), np.sin(theta)
    zero, one = np.zeros_like(cf), np.ones_like(cf)
    rows = ((zero, -sf, cf * st), (zero, cf, sf * st), (one, zero, ct))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
