"""Rigid motion of the racket against finite differences, and the outline of its face."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from moving_racket import Gliding
from scipy.spatial.transform import Rotation

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.orientation import rotation_from_zyz
from drake_viapoint.tasks.racket import Face, PoseSpline


def swing(seed: int) -> PoseSpline:
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-0.5, 0.5, (6, 6)) + [0.5, 0.4, 1.1, 0.0, np.pi / 2, 0.3]
    return PoseSpline(minimum_jerk(np.linspace(0.2, 1.2, 6), poses))


@pytest.mark.parametrize("seed", range(5))
def test_velocities_are_the_slopes_of_the_pose(seed: int) -> None:
    racket = swing(seed)
    assert (racket.start, racket.end) == (0.2, 1.2)
    h = 1e-6
    t = np.linspace(0.2 + h, 1.2 - h, 60)
    now, after, before = racket(t), racket(t + h), racket(t - h)
    np.testing.assert_allclose(
        now.velocity, (after.position - before.position) / (2 * h), atol=1e-7
    )
    turn = Rotation.from_matrix(after.rotation @ before.rotation.transpose(0, 2, 1)).as_rotvec()
    np.testing.assert_allclose(now.angular_velocity, turn / (2 * h), atol=1e-7)
    np.testing.assert_allclose(now.rotation, rotation_from_zyz(racket.spline(t)[:, 3:]))


@pytest.mark.parametrize("seed", range(5))
def test_a_point_of_the_racket_moves_with_it(seed: int) -> None:
    """The velocity of its material is the slope of a point that is fixed in the racket."""
    racket = swing(seed)
    fixed = np.random.default_rng(seed).uniform(-0.3, 0.3, 3)
    h = 1e-6
    t = np.linspace(0.3, 1.1, 40)

    def place(times: np.ndarray) -> np.ndarray:
        state = racket(times)
        return state.position + state.rotation @ fixed

    slope = (place(t + h) - place(t - h)) / (2 * h)
    np.testing.assert_allclose(racket(t).point_velocity(place(t)), slope, atol=1e-7)


def test_the_normal_is_the_y_axis() -> None:
    turned = Rotation.from_euler("ZYZ", [0.3, 1.4, 0.2])
    racket = Gliding(turned, np.zeros(3), np.zeros(3), np.zeros(3))
    np.testing.assert_allclose(racket([0.0]).normal[0], turned.apply([0, 1, 0]), atol=1e-15)


def test_a_single_time_gives_one_row() -> None:
    state = swing(0)(0.5)
    assert state.rotation.shape == (1, 3, 3)
    assert state.normal.shape == (1, 3)


@given(st.floats(0, 2 * np.pi), st.floats(0, 2), st.floats(-1, 1))
def test_the_face_is_an_oval(angle: float, reach: float, height: float) -> None:
    """Half as wide as long along x and z, whatever the height over it."""
    face = Face(half_width=0.115, half_length=0.155)
    point = np.array([0.115 * reach * np.cos(angle), height, 0.155 * reach * np.sin(angle)])
    if abs(reach - 1) > 1e-9:
        assert face.contains(point) == (reach < 1)


def test_the_face_is_longer_along_the_handle() -> None:
    face = Face(half_width=0.115, half_length=0.155)
    assert face.contains(np.array([0.0, 0.0, 0.15]))
    assert not face.contains(np.array([0.15, 0.0, 0.0]))
