"""Laws of the ZYZ angles: round trips, the singularity, continuity and angular velocity."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_viapoint.motion.orientation import (
    angular_velocity_from_zyz_rates,
    rotation_from_zyz,
    unwrap_zyz,
    zyz_from_rotation,
)

ANGLE = st.floats(-10.0, 10.0)
ZYZ = st.tuples(ANGLE, ANGLE, ANGLE).map(np.array)


@given(ZYZ)
def test_agrees_with_scipys_intrinsic_zyz(zyz: NDArray[np.float64]) -> None:
    expected = Rotation.from_euler("ZYZ", zyz).as_matrix()
    np.testing.assert_allclose(rotation_from_zyz(zyz), expected, atol=1e-14)


@given(ZYZ)
def test_matrix_to_angles_and_back(zyz: NDArray[np.float64]) -> None:
    matrix = rotation_from_zyz(zyz)
    angles = zyz_from_rotation(matrix)
    assert 0.0 <= angles[1] <= np.pi
    np.testing.assert_allclose(rotation_from_zyz(angles), matrix, atol=1e-14)


@given(st.floats(-3.1, 3.1), st.floats(0.01, 3.13), st.floats(-3.1, 3.1))
def test_angles_to_matrix_and_back(phi: float, theta: float, psi: float) -> None:
    zyz = np.array([phi, theta, psi])
    np.testing.assert_allclose(zyz_from_rotation(rotation_from_zyz(zyz)), zyz, atol=1e-12)


@given(ANGLE, st.floats(-12.0, 0.0), ANGLE, st.sampled_from([0.0, np.pi]))
def test_matrix_survives_the_singularity(phi: float, log: float, psi: float, pole: float) -> None:
    matrix = rotation_from_zyz(np.array([phi, pole - 10.0**log, psi]))
    np.testing.assert_allclose(rotation_from_zyz(zyz_from_rotation(matrix)), matrix, atol=5e-9)
    if log > -8.0:
        np.testing.assert_allclose(rotation_from_zyz(zyz_from_rotation(matrix)), matrix, atol=1e-14)


def test_phi_is_zero_at_the_singularity() -> None:
    for pole, turn in ((0.0, 0.7 + 0.4), (np.pi, 0.4 - 0.7)):
        angles = zyz_from_rotation(rotation_from_zyz(np.array([0.7, pole, 0.4])))
        np.testing.assert_allclose(angles, [0.0, pole, turn], atol=1e-12)


def test_named_racket_pose() -> None:
    """At (0, pi/2, 0) the handle points right, the face forward and x_racket down."""
    matrix = rotation_from_zyz(np.array([0.0, np.pi / 2, 0.0]))
    np.testing.assert_allclose(matrix.T, [[0, 0, -1], [0, 1, 0], [1, 0, 0]], atol=1e-15)


def test_leading_shape_is_kept() -> None:
    zyz = np.random.default_rng(0).uniform(0.1, 3.0, (4, 5, 3))
    matrix = rotation_from_zyz(zyz)
    assert matrix.shape == (4, 5, 3, 3)
    np.testing.assert_allclose(zyz_from_rotation(matrix), zyz, atol=1e-12)
    np.testing.assert_array_equal(
        angular_velocity_from_zyz_rates(zyz)[2, 3], angular_velocity_from_zyz_rates(zyz[2, 3])
    )


@given(st.integers(0, 2**32 - 1))
def test_unwrapping_gives_a_smooth_path_back(seed: int) -> None:
    """Any smooth path, started in the principal branch, returns after wrapping."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 1.0, 400)[:, None]
    amplitude, frequency, phase = rng.uniform(-4.0, 4.0, (3, 3))
    path = amplitude * np.sin(frequency * t + phase) - amplitude * np.sin(phase)
    path += np.array([0.3, 1.2, -0.4])  # theta crosses 0 and pi when its amplitude is large
    wrapped = zyz_from_rotation(rotation_from_zyz(path))
    np.testing.assert_allclose(wrapped[0], path[0], atol=1e-12)
    unwrapped = unwrap_zyz(wrapped)
    # Exactly at a pole any split of phi and psi is right; the rotations must agree everywhere.
    np.testing.assert_allclose(rotation_from_zyz(unwrapped), rotation_from_zyz(path), atol=1e-12)
    np.testing.assert_allclose(unwrapped, path, atol=1e-6)


def test_unwrapping_chooses_the_nearer_branch() -> None:
    crossing = np.array([[0.2, 0.1, 0.3], [0.2 - np.pi, 0.1, 0.3 - np.pi]])
    np.testing.assert_allclose(unwrap_zyz(crossing)[1], [0.2, -0.1, 0.3], atol=1e-15)


def test_unwrapping_leaves_its_input_alone() -> None:
    angles = np.array([[3.1, 1.0, 0.0], [-3.1, 1.0, 0.0]])
    kept = angles.copy()
    assert unwrap_zyz(angles)[1, 0] == pytest.approx(2 * np.pi - 3.1)
    np.testing.assert_array_equal(angles, kept)


@given(ZYZ, st.tuples(ANGLE, ANGLE, ANGLE).map(np.array))
def test_angular_velocity_against_finite_differences(
    zyz: NDArray[np.float64], rates: NDArray[np.float64]
) -> None:
    """omega's cross-product matrix is R_dot R^T; central differences with h = 1e-6 s."""
    h = 1e-6
    r_dot = (rotation_from_zyz(zyz + h * rates) - rotation_from_zyz(zyz - h * rates)) / (2 * h)
    cross = r_dot @ rotation_from_zyz(zyz).T
    omega = angular_velocity_from_zyz_rates(zyz) @ rates
    np.testing.assert_allclose([cross[2, 1], cross[0, 2], cross[1, 0]], omega, atol=2e-8)
