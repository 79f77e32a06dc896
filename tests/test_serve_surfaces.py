"""What the ball can touch: its distances against Drake's, the seat that it rests on, the holes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydrake.geometry import GeometryInstance, ProximityProperties, SceneGraph, Shape
from pydrake.math import RigidTransform

from drake_viapoint.tasks.serve_surfaces import CapsuleRing, OvalPlate, cup_rings, goal_ring

BALL, CUP = 0.033, 0.0345
ROUNDING = 1e-12  # [m]
SHIPPED = (*cup_rings(CUP, BALL), goal_ring(0.125, 0.009))
STRINGS = OvalPlate(0.115, 0.155)
coordinates = st.floats(-1.0, 1.0)
places = st.tuples(coordinates, coordinates, coordinates).map(np.array)
angles = st.floats(0.0, 2 * np.pi)


@st.composite
def rings(draw: st.DrawFn) -> CapsuleRing:
    radius = draw(st.floats(0.01, 0.3))
    tube = radius * draw(st.floats(0.01, 0.4))
    return CapsuleRing(radius, draw(st.floats(-0.1, 0.1)), tube, draw(st.integers(3, 24)))


ovals = st.builds(OvalPlate, st.floats(0.05, 0.3), st.floats(0.05, 0.3), st.floats(0.001, 0.01))


def drakes_distances(shapes: list[tuple[RigidTransform, Shape]], points: NDArray) -> NDArray:
    """Signed distance (n, m) of n points from each of m shapes."""
    scene_graph = SceneGraph()
    source = scene_graph.RegisterSource("shapes")
    for number, (pose, shape) in enumerate(shapes):
        geometry = GeometryInstance(pose, shape, f"shape_{number}")
        geometry.set_proximity_properties(ProximityProperties())
        scene_graph.RegisterAnchoredGeometry(source, geometry)
    context = scene_graph.CreateDefaultContext()
    query = scene_graph.get_query_output_port().Eval(context)
    return np.array(
        [[found.distance for found in query.ComputeSignedDistanceToPoint(p)] for p in points]
    )


def around(size: float, number: int) -> NDArray:
    return np.random.default_rng(0).uniform(-size, size, (number, 3))


@pytest.mark.parametrize("ring", SHIPPED)
def test_a_ball_is_as_far_from_a_ring_as_drake_says(ring: CapsuleRing) -> None:
    points = around(1.5 * ring.radius, 300)
    by_drake = drakes_distances(ring.capsules(), points).min(axis=1) - BALL
    np.testing.assert_allclose(ring.gap(points, BALL), by_drake, rtol=0, atol=ROUNDING)
    assert np.any(by_drake < -BALL)  # some points lie in the tube


@given(rings(), places)
@settings(max_examples=50)
def test_any_ring_is_where_drake_has_it(ring: CapsuleRing, place: NDArray) -> None:
    points = 2 * ring.radius * np.array([place, [*place[:2], ring.height]])
    by_drake = drakes_distances(ring.capsules(), points).min(axis=1)
    np.testing.assert_allclose(ring.gap(points, 0.0), by_drake, rtol=0, atol=ROUNDING)


@given(ovals, places)
@settings(max_examples=50)
def test_a_ball_is_as_far_from_an_oval_as_drake_says(oval: OvalPlate, place: NDArray) -> None:
    """Outside: inside the plate it is nowhere nearer than touching."""
    points = np.array([place * 0.5, place * [0.3, oval.half_thickness, 0.3]])
    by_drake = drakes_distances([(RigidTransform(), oval.shape())], points)[:, 0]
    gap = oval.gap(points, BALL)
    np.testing.assert_allclose(gap, np.maximum(by_drake, 0.0) - BALL, rtol=0, atol=1e-9)


@given(rings(), places, st.floats(0.0, 0.1))
def test_the_cheap_gap_to_a_ring_is_never_too_large_and_hardly_too_small(
    ring: CapsuleRing, place: NDArray, ball: float
) -> None:
    """By twice what the corners stand out, at most."""
    centre = place * 2 * ring.radius
    missing = float(ring.gap(centre[None], ball)[0]) - ring.least_gap(centre, ball)
    corners = ring.radius * (1 / np.cos(np.pi / ring.sides) - 1)
    assert -ROUNDING <= missing <= 2 * corners + ROUNDING


@given(ovals, places, st.floats(0.0, 0.1))
def test_the_cheap_gap_to_an_oval_is_never_too_large_and_hardly_too_small(
    oval: OvalPlate, place: NDArray, ball: float
) -> None:
    """By as much as the corners of a box around the oval stand out, at most."""
    centre = place * 0.5
    missing = float(oval.gap(centre[None], ball)[0]) - oval.least_gap(centre, ball)
    corner = np.array([[oval.half_width, 0.0, oval.half_length]])
    assert -ROUNDING <= missing <= oval.gap(corner, 0.0)[0] + ROUNDING


@given(st.floats(0.0, 0.3))
def test_the_cheap_gap_is_exact_in_front_of_the_strings_and_along_a_rings_axis(
    away: float,
) -> None:
    """There the ball comes from, and would be slowed for nothing."""
    in_front = np.array([0.0, away, 0.0])
    assert STRINGS.least_gap(in_front, BALL) == pytest.approx(STRINGS.gap(in_front[None], BALL)[0])
    fine = CapsuleRing(0.1, 0.0, 0.01, 1000)
    over = np.array([0.0, 0.0, away])
    assert fine.least_gap(over, BALL) == pytest.approx(fine.gap(over[None], BALL)[0], abs=1e-6)


def test_gaps_of_many_places_are_those_of_each() -> None:
    points = around(0.2, 5)
    for shape in (*SHIPPED, STRINGS):
        alone = [shape.gap(point[None], BALL)[0] for point in points]
        np.testing.assert_array_equal(shape.gap(points, BALL), alone)


@given(st.floats(0.025, 0.1), st.floats(1.0, 1.5))
def test_a_ball_at_rest_touches_all_of_the_seat_and_not_the_wall(ball: float, wider: float) -> None:
    seat, wall = cup_rings(ball * wider, ball)
    origin = np.zeros((1, 3))
    on_seat = drakes_distances(seat.capsules(), origin)[0]
    assert on_seat.shape == (8,)
    np.testing.assert_allclose(on_seat, ball, rtol=0, atol=ROUNDING)
    # the hollow is as wide as the cup
    at_wall = drakes_distances(wall.capsules(), origin)[0]
    np.testing.assert_allclose(at_wall, ball * wider, rtol=0, atol=ROUNDING)


@given(angles, st.floats(-np.pi / 2, 0.0))
def test_a_ball_that_moves_sideways_or_down_presses_into_the_seat(turn: float, tilt: float) -> None:
    """It lies 50 degrees off the axis: 1 mm presses by 0.64 mm straight down, else by more."""
    way = np.array([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)])
    seat, _ = cup_rings(CUP, BALL)
    assert seat.gap(1e-3 * way[None], BALL)[0] < -0.6e-3


def test_a_ball_leaves_the_cup_along_its_axis_touching_nothing() -> None:
    up = np.outer(np.linspace(0.0, 0.1, 200), [0.0, 0.0, 1.0])
    for ring in cup_rings(CUP, BALL):
        gap = ring.gap(up, BALL)
        assert gap[0] >= -ROUNDING
        assert np.all(np.diff(gap) > 0)


@given(ovals, angles, st.floats(0.0, 0.997), st.floats(1.001, 3.0))
def test_the_oval_ends_at_its_outline(
    oval: OvalPlate, turn: float, within: float, beyond: float
) -> None:
    """An ellipse, whose polygon of 48 sides leaves out 0.2 % at most."""
    rim = np.array([oval.half_width * np.cos(turn), 0.0, oval.half_length * np.sin(turn)])
    height = oval.half_thickness + BALL
    over = np.array([0.0, height, 0.0])
    gap = oval.gap(np.array([within * rim + over, within * rim - over, beyond * rim + over]), BALL)
    np.testing.assert_allclose(gap[:2], 0.0, rtol=0, atol=ROUNDING)
    assert gap[2] > 1e-9


def test_the_oval_reaches_to_its_half_width_and_half_length() -> None:
    tips = np.array([[0.115, 0.0, 0.0], [-0.115, 0.0, 0.0], [0.0, 0.0, 0.155], [0.0, 0.0, -0.155]])
    np.testing.assert_allclose(STRINGS.gap(tips * 1.5, 0.0), [0.0575, 0.0575, 0.0775, 0.0775])
    np.testing.assert_allclose(STRINGS.gap(tips, 0.0), 0.0, atol=ROUNDING)


@given(st.floats(0.05, 0.3), st.floats(0.001, 0.02))
def test_through_the_goal_fits_a_ball_as_wide_as_its_inner_radius(
    inner: float, tube: float
) -> None:
    ring = goal_ring(inner, tube)
    centre = np.zeros((1, 3))
    walls = drakes_distances(ring.capsules(), centre)[0]
    np.testing.assert_allclose(walls, inner, rtol=0, atol=ROUNDING)
    assert ring.gap(centre, inner)[0] == pytest.approx(0.0, abs=ROUNDING)
    # and nothing lies over or under it
    away = np.array([[0.0, 0.0, 0.1], [0.0, 0.0, -0.1]])
    assert np.all(ring.gap(away, inner) > 0)
