"""Virtual persons: everyone's own serve succeeds, in laws of its own, and the same every time."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from virtual_persons import GOAL, person_and_serve

from drake_viapoint.errors import DemonstrationError
from drake_viapoint.motion.extraction import extract_via_points
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.serve_person import PersonServe, ServePerson, draw_person, practise


@pytest.fixture(scope="module")
def served() -> list[tuple[ServePerson, PersonServe]]:
    return [person_and_serve(number) for number in range(5)]


def test_the_ball_is_met_within_the_face_where_aimed(
    served: list[tuple[ServePerson, PersonServe]],
) -> None:
    for person, serve in served:
        state = serve.racket([serve.hit])
        local = state.rotation[0].T @ (serve.thrown.position(serve.hit) - state.position[0])
        assert person.face.contains(local)
        assert local[1] == pytest.approx(person.ball_radius, abs=1e-12)
        np.testing.assert_allclose(local[[0, 2]], person.aim, atol=1e-5)


def test_the_ball_lands_within_the_ring(served: list[tuple[ServePerson, PersonServe]]) -> None:
    for person, serve in served:
        landing = serve.struck.position(serve.landing)
        assert landing[2] == pytest.approx(GOAL[2], abs=1e-12)
        assert serve.struck.velocity(serve.landing)[2] < 0
        assert np.linalg.norm(landing[:2] - GOAL[:2]) < 0.125
        np.testing.assert_allclose(landing[:2] - GOAL[:2], person.miss, atol=1e-5)


def test_the_ball_obeys_the_laws_the_robots_ball_obeys(
    served: list[tuple[ServePerson, PersonServe]],
) -> None:
    """Reckoned here once more: the release, the flight and the bounce."""
    for person, serve in served:
        assert 0 < serve.release < serve.hit < serve.landing
        h = 1e-6
        cup = [person.cup.ball(serve.racket, [serve.release + d]) for d in (-h, 0.0, h)]
        acceleration = (cup[2].velocity - cup[0].velocity)[0] / (2 * h)
        push = cup[1].opening[0] @ (acceleration + [0, 0, GRAVITY])
        assert push == pytest.approx(0.0, abs=1e-5)
        earlier = person.cup.support(serve.racket, np.linspace(0.01, serve.release - 1e-3, 300))
        assert np.all(earlier > 0)
        np.testing.assert_array_equal(serve.thrown.position(serve.release), cup[1].position[0])

        state = serve.racket([serve.hit])
        normal, centre = state.normal[0], serve.thrown.position(serve.hit)
        surface = state.point_velocity((centre - person.ball_radius * normal)[None])[0]
        before = serve.thrown.velocity(serve.hit) - surface
        after = serve.struck.velocity(serve.hit) - surface
        assert normal @ after == pytest.approx(-person.restitution * (normal @ before), abs=1e-12)
        np.testing.assert_allclose(np.cross(normal, after - before), 0, atol=1e-12)


def test_everyone_has_a_body_and_tools_of_their_own() -> None:
    people = [draw_person(number) for number in range(20)]
    robot_cup = np.array([-0.10, 0.0, -0.43])
    for lengths in ("upper_arm", "forearm", "hand", "handle", "restitution", "pace", "ball_radius"):
        drawn = [getattr(person, lengths) for person in people]
        assert len(set(drawn)) == 20
    for person in people:
        assert 0.05 <= np.linalg.norm(person.cup.centre - robot_cup) <= 0.10
        assert 0.25 < person.forearm < 0.28 <= person.upper_arm < 0.32
        assert 0.0327 < person.ball_radius < 0.0343
        assert 0.75 < person.restitution < 0.85


def test_limbs_and_racket_are_rigid(served: list[tuple[ServePerson, PersonServe]]) -> None:
    for person, serve in served:
        times = np.linspace(0, serve.racket.end, 100)
        body = person.body(serve.joints(times))
        hand_to_face = person.handle * body.racket.as_matrix()[:, :, 2]

        def length(vectors: NDArray) -> NDArray:
            return np.linalg.norm(vectors, axis=1)

        np.testing.assert_allclose(length(body.elbow - person.shoulder), person.upper_arm)
        np.testing.assert_allclose(body.centre - body.hand, hand_to_face, atol=1e-12)
        reach = length(body.hand - body.elbow)
        assert np.all(reach <= person.forearm + person.hand + 1e-12)
        assert np.all(reach >= person.forearm - person.hand - 1e-12)


def test_the_rackets_spline_carries_the_bodys_movement(
    served: list[tuple[ServePerson, PersonServe]],
) -> None:
    """Between the points that it interpolates, too."""
    for person, serve in served:
        times = np.linspace(0, serve.racket.end, 1234)
        body, state = person.body(serve.joints(times)), serve.racket(times)
        assert np.max(np.linalg.norm(body.centre - state.position, axis=1)) < 2e-5
        turn = (Rotation.from_matrix(state.rotation).inv() * body.racket).magnitude()
        assert np.max(turn) < 1e-4


def test_the_path_is_smooth_and_no_minimum_jerk_curve_of_eight_via_points(
    served: list[tuple[ServePerson, PersonServe]],
) -> None:
    """At the eight times that FIRM finds, even with the values that fit best."""
    for _, serve in served:
        times = np.linspace(0, serve.racket.end, 400)
        path = serve.racket.spline(times)
        extraction = extract_via_points(
            times,
            path,
            ("x", "y", "z", "phi", "theta", "psi"),
            number=8,
            weights=[1, 1, 1, 0.3, 0.3, 0.3],
        )
        via_times = extraction.via_points.times
        curves = minimum_jerk(via_times, np.eye(8))(times)  # it is linear in the values
        best = np.linalg.lstsq(curves, path, rcond=None)[0]
        for values in (extraction.via_points.values, best):
            off = np.linalg.norm((curves @ values - path)[:, :3], axis=1)
            assert 5e-3 < off.max() < 0.1
        assert np.max(np.abs(serve.racket.spline(times, 2)[:, :3])) < 60  # [m/s2]
        assert np.max(np.abs(np.sin(path[:, 4]))) <= 1
        assert np.min(np.sin(path[:, 4])) > 0.8  # far from the singularity of the angles


def test_the_same_person_serves_the_same_to_the_bit(
    served: list[tuple[ServePerson, PersonServe]],
) -> None:
    first, again = served[2][1], practise(draw_person(2), GOAL)
    assert again.joints.c.tobytes() == first.joints.c.tobytes()
    assert again.racket.spline.c.tobytes() == first.racket.spline.c.tobytes()
    assert (again.release, again.hit, again.landing) == (first.release, first.hit, first.landing)


def test_other_populations_are_other_people() -> None:
    assert draw_person(3, seed=1).upper_arm != draw_person(3).upper_arm


def test_a_goal_elsewhere_is_aimed_at() -> None:
    goal = GOAL + [0.1, -0.15, 0.1]
    person = draw_person(1)
    serve = practise(person, goal)
    landing = serve.struck.position(serve.landing)
    np.testing.assert_allclose(landing[:2] - goal[:2], person.miss, atol=1e-5)
    assert landing[2] == pytest.approx(0.6, abs=1e-12)


@pytest.mark.parametrize("goal", [[0.4, -3.0, 0.5], [0.4, 2.35, 5.0]])
def test_a_goal_nobody_can_reach_is_an_error(goal: list[float]) -> None:
    with pytest.raises(DemonstrationError):
        practise(draw_person(0), goal)
