"""The scene with contact: bounces as Hunt and Crossley have them, a cup that holds a ball."""

from __future__ import annotations

import numpy as np
import pytest
from contact_scenes import AVERAGE, NOTHING_UNKNOWN, FixedRacket, robot_scenario

from drake_viapoint.errors import ModelFileError
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.hunt_crossley import restitution
from drake_viapoint.tasks.serve_contact_scene import ContactScene

RADIUS = 0.033
FRONT = RADIUS + 0.002 + 1e-4  # of the face; the strings are 4 mm thick


@pytest.fixture(scope="module")
def racket() -> FixedRacket:
    return FixedRacket(robot_scenario(NOTHING_UNKNOWN))


def bounced(racket: FixedRacket, *, most: float = 0.02) -> None:
    """Integrate until the ball is away from the strings again."""
    time = 0.0
    while time < most:
        time += 5e-4
        racket.go(time)
        centre, velocity, _ = racket.ball()
        if abs(centre[1]) > FRONT and centre[1] * velocity[1] > 0:
            return
    raise AssertionError("the ball stays on the strings")


@pytest.mark.parametrize("speed", [1.0, 2.0, 3.5, 5.0, 6.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_restitution_is_hunt_and_crossleys(racket: FixedRacket, speed: float, side: float) -> None:
    racket.throw(np.array([0.02, side * FRONT, -0.03]), np.array([0.0, -side * speed, 0.0]))
    approach = abs(racket.ball()[1][1])
    bounced(racket)
    away = side * racket.ball()[1][1]
    lost = racket.scene.dissipation
    assert away / approach == pytest.approx(restitution(lost, speed), rel=0.02)


def test_restitution_is_the_scenarios_at_its_speed(racket: FixedRacket) -> None:
    contact, ball = racket.scenario.contact, racket.scenario.ball
    racket.throw(np.array([0.0, FRONT, 0.0]), np.array([0.0, -contact.speed, 0.0]))
    bounced(racket)
    assert racket.ball()[1][1] / contact.speed == pytest.approx(ball.restitution, rel=0.005)


def test_the_ball_is_pressed_as_deep_as_by_the_spring(racket: FixedRacket) -> None:
    contact, ball = racket.scenario.contact, racket.scenario.ball
    elastic = FixedRacket(robot_scenario({**NOTHING_UNKNOWN, "ball.restitution": 1.0}))
    elastic.throw(np.array([0.0, FRONT, 0.0]), np.array([0.0, -contact.speed, 0.0]))
    deepest = FRONT
    for time in np.arange(1, 60) * 1e-4:
        elastic.go(time)
        deepest = min(deepest, elastic.ball()[0][1])
    spring = contact.speed * np.sqrt(ball.mass / contact.strings_stiffness)
    assert RADIUS + 0.002 - deepest == pytest.approx(spring, rel=0.03)


@pytest.mark.parametrize("number", range(6))
def test_a_passive_bounce_gains_no_energy(racket: FixedRacket, number: int) -> None:
    rng = np.random.default_rng(number)
    centre = np.array([rng.uniform(-0.06, 0.06), FRONT, rng.uniform(-0.08, 0.08)])
    velocity = np.array([rng.uniform(-3, 3), -rng.uniform(1, 6), rng.uniform(-3, 3)])
    racket.throw(centre, velocity, rng.uniform(-60, 60, 3))
    before = racket.energy()
    least, times = before, []
    for time in np.arange(1, 100) * 2e-4:
        racket.go(time)
        gone = abs(racket.ball()[0][1]) > FRONT
        if gone:
            times.append(time)
            # nothing is stored any more: all that is missing is lost, and nothing comes back
            assert racket.energy() <= least + 1e-9
            least = racket.energy()
    assert times, "it bounced"
    assert least < before - 0.01


def test_friction_turns_a_sliding_ball(racket: FixedRacket) -> None:
    """Coulomb: sliding all along, the tangential impulse is mu times the normal one."""
    mu = racket.scenario.contact.strings_friction
    # along the handle, which lies level: gravity has no part in it
    racket.throw(np.array([0.0, FRONT, 0.0]), np.array([0.0, -2.0, 6.0]))
    bounced(racket)
    _, velocity, spin = racket.ball()
    slowed = 6.0 - velocity[2]
    assert slowed == pytest.approx(mu * (velocity[1] + 2.0), rel=0.02)
    # the same impulse turns a hollow sphere, by a lever a little shorter than the radius: the
    # ball is pressed in, and presses harder where it rolls in than where it rolls out
    assert 0.8 < abs(spin[0]) / (1.5 * slowed / RADIUS) < 1.0


def test_beyond_the_oval_the_ball_flies_by(racket: FixedRacket) -> None:
    corner = np.array([0.115, FRONT, 0.155]) * [0.99, 1.0, 0.99]  # of the box around the oval
    racket.throw(corner, np.array([0.0, -4.0, 0.0]))
    racket.go(0.02)
    centre, velocity, _ = racket.ball()
    assert centre[1] < -0.04
    assert velocity[1] == pytest.approx(-4.0, abs=0.01)


def test_a_ball_at_rest_in_the_cup_stays(racket: FixedRacket) -> None:
    scene = racket.scene
    racket.throw(scene.cup.centre, np.zeros(3), step=2e-3)
    racket.go(0.5)
    rested, _, _ = racket.ball()
    assert np.linalg.norm(rested - scene.cup.centre) < 1e-3
    racket.go(10.5)
    centre, velocity, spin = racket.ball()
    assert np.linalg.norm(centre - rested) < 1e-4
    assert np.linalg.norm(velocity) < 1e-5
    assert np.linalg.norm(spin) < 1e-3


def test_the_cup_bears_the_balls_weight_and_no_more(racket: FixedRacket) -> None:
    scene, plant = racket.scene, racket.scene.plant
    racket.throw(scene.cup.centre, np.zeros(3), step=2e-3)
    racket.go(1.0)
    results = plant.get_contact_results_output_port().Eval(racket.own)
    assert results.num_point_pair_contacts() == 8
    assert results.num_hydroelastic_contacts() == 0
    forces = [
        results.point_pair_contact_info(i).contact_force()
        * (1 if results.point_pair_contact_info(i).bodyB_index() == scene.ball.index() else -1)
        for i in range(8)
    ]
    total = np.sum(forces, axis=0)
    np.testing.assert_allclose(total, [0, 0, racket.scenario.ball.mass * GRAVITY], atol=1e-3)


def test_the_controller_knows_nothing_of_what_differs() -> None:
    scenario = robot_scenario({"unknown.inertia": 0.2})
    scene = ContactScene(scenario)
    context = scene.diagram.CreateDefaultContext()
    scene.differ(context, scene.unknown(3), AVERAGE)
    own = scene.plant.GetMyContextFromRoot(context)
    known = scene.arm.plant
    bodies = [scene.plant.get_body(i) for i in scene.plant.GetBodyIndices(scene.instance)]
    bodies.append(scene.plant.GetBodyByName("racket"))
    for body in bodies:
        modelled = known.GetBodyByName(body.name()).default_mass()
        assert body.get_mass(own) != modelled
        assert abs(body.get_mass(own) / modelled - 1) <= 0.2


def test_a_rough_ball_bounces_less(racket: FixedRacket) -> None:
    scene = racket.scene
    speeds = []
    for share in (1.0, 0.9):
        racket.throw(np.array([0.0, FRONT, 0.0]), np.array([0.0, -4.0, 0.0]))
        scene.differ(racket.context, scene.unknown(0), AVERAGE._replace(restitution=share))
        bounced(racket)
        speeds.append(racket.ball()[1][1])
    assert speeds[1] / speeds[0] == pytest.approx(0.9, rel=0.01)


def test_a_tool_without_a_mount_is_refused() -> None:
    with pytest.raises(ModelFileError, match="by which the arm holds it"):
        ContactScene(robot_scenario({"robot.mount_frame": "racket"}))
