"""The bounce's laws, and who meets the ball: the face, its back, or nobody."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from moving_racket import Gliding
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_viapoint.tasks.flight import GRAVITY, fly
from drake_viapoint.tasks.racket import Face
from drake_viapoint.tasks.struck_ball import Encounter, bounce, first_encounter, strike

RADIUS = 0.033
FACE = Face(half_width=0.115, half_length=0.155)
vectors = st.tuples(*[st.floats(-5, 5)] * 3).map(np.array)
restitutions = st.floats(0, 1)


@st.composite
def normals(draw: st.DrawFn) -> NDArray:
    vector = draw(vectors)
    length = np.linalg.norm(vector)
    assume(length > 0.1)
    return vector / length


@given(vectors, vectors, normals(), restitutions)
def test_laws_of_the_bounce(v: NDArray, surface: NDArray, n: NDArray, e: float) -> None:
    after = bounce(v, surface, n, e)
    # the normal relative velocity is reversed and scaled, nothing else changes
    assert n @ (after - surface) == pytest.approx(-e * (n @ (v - surface)), abs=1e-12)
    np.testing.assert_allclose(np.cross(n, after - v), 0, atol=1e-12)


@given(vectors, vectors, normals(), restitutions, vectors)
def test_a_bounce_looks_the_same_from_a_moving_room(
    v: NDArray, surface: NDArray, n: NDArray, e: float, room: NDArray
) -> None:
    shifted = bounce(v + room, surface + room, n, e)
    np.testing.assert_allclose(shifted, bounce(v, surface, n, e) + room, atol=1e-11)


@given(vectors, normals())
def test_an_elastic_bounce_keeps_the_energy_and_undoes_itself(v: NDArray, n: NDArray) -> None:
    after = bounce(v, np.zeros(3), n, 1.0)
    assert after @ after == pytest.approx(v @ v, abs=1e-11)
    np.testing.assert_allclose(bounce(after, np.zeros(3), n, 1.0), v, atol=1e-12)


@given(vectors, vectors, normals(), restitutions)
def test_the_energy_lost_is_that_of_the_normal_motion(
    v: NDArray, surface: NDArray, n: NDArray, e: float
) -> None:
    """In the surface's frame: (1 - e^2) of it."""
    before, after = v - surface, bounce(v, surface, n, e) - surface
    lost = before @ before - after @ after
    assert lost == pytest.approx((1 - e**2) * (n @ before) ** 2, abs=1e-10)


@given(vectors, vectors, normals(), restitutions)
def test_the_side_of_the_normal_does_not_matter(
    v: NDArray, surface: NDArray, n: NDArray, e: float
) -> None:
    np.testing.assert_allclose(bounce(v, surface, -n, e), bounce(v, surface, n, e), atol=1e-13)


def level(
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    turning: tuple[float, float, float] = (0.0, 0.0, 0.0),
    end: float = 2.0,
    turned: float = 0.0,
) -> Gliding:
    """A racket at the origin with its face up, long along y; turned about y."""
    face_up = Rotation.from_euler("Y", turned) * Rotation.from_matrix(
        np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    )
    return Gliding(face_up, np.zeros(3), np.array(turning), np.array(velocity), end=end)


def test_dropped_on_a_face_that_lies_still() -> None:
    """From 1 m: the ball's centre is met one radius over the face."""
    np.testing.assert_allclose(level()([0.0]).normal[0], [0, 0, 1], atol=1e-15)
    flight = fly(0.0, np.array([0.02, 0.03, 1.0]), np.zeros(3))
    met = first_encounter(flight, level(), FACE, RADIUS)
    assert met is not None
    assert not met.from_behind
    assert met.time == pytest.approx(np.sqrt(2 * (1 - RADIUS) / GRAVITY), abs=1e-12)
    bounced = strike(flight, level(), met.time, RADIUS, 0.8, 0.0)
    speed = GRAVITY * met.time
    np.testing.assert_allclose(bounced.velocity(met.time), [0, 0, 0.8 * speed], atol=1e-9)
    # up to e^2 of the height it fell
    top = bounced.position(met.time + 0.8 * speed / GRAVITY)[2]
    assert top - RADIUS == pytest.approx(0.64 * (1 - RADIUS), abs=1e-9)


def test_an_elastic_ball_comes_back_to_where_it_was_dropped() -> None:
    flight = fly(0.0, np.array([0.0, 0.0, 1.0]), np.zeros(3))
    met = first_encounter(flight, level(), FACE, RADIUS)
    assert met is not None
    bounced = strike(flight, level(), met.time, RADIUS, 1.0, 0.0)
    np.testing.assert_allclose(bounced.position(2 * met.time), [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(bounced.velocity(2 * met.time), 0, atol=1e-9)


@given(
    st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1.5, 1.5)),
    st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-2, 2)),
)
def test_a_moving_face_is_a_still_one_seen_from_a_moving_room(
    room: tuple[float, float, float], thrown: tuple[float, float, float]
) -> None:
    position, velocity = np.array([0.0, 0.0, 0.6]), np.array(thrown)
    seen_still = first_encounter(fly(0.0, position, velocity), level(), FACE, RADIUS)
    moving = level(velocity=room)
    flight = fly(0.0, position, velocity + room)
    seen_moving = first_encounter(flight, moving, FACE, RADIUS)
    if seen_still is None or seen_moving is None:
        # at the very rim rounding decides
        assert seen_still is seen_moving or near_the_rim(position, velocity)
        return
    assert seen_moving.time == pytest.approx(seen_still.time, abs=1e-11)
    t = seen_still.time
    still = strike(fly(0.0, position, velocity), level(), t, RADIUS, 0.8, 0.0)
    shifted = strike(flight, moving, t, RADIUS, 0.8, 0.0)
    np.testing.assert_allclose(shifted.velocity(t), still.velocity(t) + room, atol=1e-9)
    expected = still.position(1.5) + np.multiply(room, 1.5)
    np.testing.assert_allclose(shifted.position(1.5), expected, atol=1e-12)


def near_the_rim(position: NDArray, velocity: NDArray) -> bool:
    up = velocity[2]
    time = (up + np.sqrt(up**2 + 2 * GRAVITY * (position[2] - RADIUS))) / GRAVITY
    x, y, _ = position + velocity * time
    return abs((x / 0.115) ** 2 + (y / 0.155) ** 2 - 1) < 1e-9


def test_a_turning_face_strikes_with_the_velocity_of_the_point_of_contact() -> None:
    """The handle turns about the face's centre: 0.1 m off it the face moves at 0.1 w."""
    racket = level(turning=(-3.0, 0.0, 0.0))
    flight = fly(0.0, np.array([0.0, 0.1, RADIUS + 1e-9]), np.array([0.0, 0.0, -2.0]))
    met = first_encounter(flight, racket, FACE, RADIUS)
    assert met is not None
    state = racket([met.time])
    contact = flight.position(met.time) - RADIUS * state.normal[0]
    surface = np.cross(state.angular_velocity[0], contact - state.position[0])
    before = state.normal[0] @ (flight.velocity(met.time) - surface)
    after = strike(flight, racket, met.time, RADIUS, 0.8, 0.0).velocity(met.time)
    assert state.normal[0] @ (after - surface) == pytest.approx(-0.8 * before, abs=1e-12)
    assert abs(state.normal[0] @ surface) == pytest.approx(0.3, rel=1e-3)


@pytest.mark.parametrize(
    ("x", "y", "hit"),
    [(0.114, 0.0, True), (0.116, 0.0, False), (0.0, 0.154, True), (0.0, 0.156, False)],
)
def test_a_ball_outside_the_oval_passes_by(x: float, y: float, hit: bool) -> None:
    flight = fly(0.0, np.array([x, y, 0.5]), np.zeros(3))
    assert (first_encounter(flight, level(), FACE, RADIUS) is not None) is hit


def test_from_below_it_is_caught_behind() -> None:
    flight = fly(0.0, np.array([0.0, 0.0, -0.5]), np.array([0.0, 0.0, 4.0]))
    met = first_encounter(flight, level(), FACE, RADIUS)
    assert met is not None
    assert met.from_behind
    assert flight.position(met.time)[2] == pytest.approx(-RADIUS, abs=1e-12)


def test_past_the_rim_from_below_it_is_struck_from_above() -> None:
    """Up beside the face, over it, and down on it: the passage beside does not count."""
    flight = fly(0.0, np.array([-0.2, 0.0, -0.3]), np.array([0.15, 0.0, 4.0]))
    met = first_encounter(flight, level(), FACE, RADIUS)
    assert met is not None
    assert not met.from_behind
    assert flight.velocity(met.time)[2] < 0


def test_a_ball_that_starts_within_reach_of_the_plane_must_leave_it_first() -> None:
    """As a ball in the cup does, whose seat lies in the plane of the face."""
    flight = fly(0.0, np.array([0.0, 0.0, 0.0]), np.array([0.0, 0.0, 3.0]))
    met = first_encounter(flight, level(), FACE, RADIUS)
    assert met is not None
    assert met.time > 3.0 / GRAVITY
    assert not met.from_behind
    staying = fly(0.0, np.array([0.0, 0.0, 0.0]), np.array([0.0, 0.0, 0.3]))
    assert first_encounter(staying, level(), FACE, RADIUS) is None


def test_the_search_ends_with_the_movement() -> None:
    flight = fly(0.0, np.array([0.0, 0.0, 1.0]), np.zeros(3))
    time = np.sqrt(2 * (1 - RADIUS) / GRAVITY)
    assert first_encounter(flight, level(end=time - 1e-6), FACE, RADIUS) is None
    assert first_encounter(flight, level(end=time + 1e-6), FACE, RADIUS) == Encounter(
        pytest.approx(time), False
    )


def test_released_at_the_very_end_of_the_movement() -> None:
    flight = fly(2.0, np.array([0.0, 0.0, 1.0]), np.zeros(3))
    assert first_encounter(flight, level(), FACE, RADIUS) is None


def test_a_fast_ball_does_not_slip_through() -> None:
    """At 60 m/s it crosses both sides of the face's reach between two looks."""
    flight = fly(0.0, np.array([0.0, 0.0, 10.0]), np.array([0.0, 0.0, -60.0]))
    met = first_encounter(flight, level(), FACE, RADIUS)
    assert met is not None
    assert not met.from_behind
    assert flight.position(met.time)[2] == pytest.approx(RADIUS, abs=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_the_first_of_dense_looks_is_the_first_encounter(seed: int) -> None:
    """Random turning rackets against looking every 20 microseconds."""
    rng = np.random.default_rng(seed)
    racket = Gliding(
        Rotation.from_rotvec(rng.normal(size=3)),
        rng.uniform(-0.1, 0.1, 3),
        rng.uniform(-3, 3, 3),
        rng.uniform(-1, 1, 3),
        end=0.8,
    )
    wide = Face(half_width=0.4, half_length=0.6)  # so that most are met
    start = rng.uniform(-0.1, 0.1, 3) + [0.0, 0.0, 0.7]
    flight = fly(0.0, start, rng.uniform(-0.5, 0.5, 3) * [1, 1, 2])
    times = np.arange(0, 0.8, 2e-5)
    state = racket(times)
    local = np.einsum("nji,nj->ni", state.rotation, flight.position(times) - state.position)
    x, height, z = local.T
    inside = (x / 0.4) ** 2 + (z / 0.6) ** 2 <= 1
    came = (np.abs(height) <= RADIUS) & (np.abs(np.r_[np.inf, height[:-1]]) > RADIUS) & inside
    met = first_encounter(flight, racket, wide, RADIUS)
    if came.any():
        first = int(np.argmax(came))
        assert met is not None
        assert met.time == pytest.approx(times[first], abs=2.1e-5)
        assert met.from_behind == bool(height[first] < 0)
    else:
        assert met is None
