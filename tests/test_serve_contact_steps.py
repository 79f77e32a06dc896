"""Integrating serves with contact: short steps only where needed, and what is said if it fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contact_scenes import AVERAGE, NOTHING_UNKNOWN, robot_scenario

from drake_viapoint.errors import BallFallsOutError, BrokenOffError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_contact_scene import ContactScene
from drake_viapoint.tasks.serve_contact_steps import ContactIntegration, ContactSteps


def assert_same_way(one: ContactSteps, other: ContactSteps, bound: float) -> None:
    """The struck balls are at the same place at the end of the movement."""
    places = []
    for ball in (one.ball, other.ball):
        look = int(np.searchsorted(ball.times, 1.3))
        t = 1.3 - ball.times[look]
        fall = np.array([0.0, 0.0, -GRAVITY / 2]) * t**2
        places.append(ball.position[look] + ball.velocity[look] * t + fall)
    np.testing.assert_allclose(*places, atol=bound)


def integration(changes: dict[str, object] | None = None) -> ContactIntegration:
    scenario = robot_scenario({**NOTHING_UNKNOWN, **(changes or {})})
    scene = ContactScene(scenario)
    return ContactIntegration(scenario, scene, scene.unknown(0))


@pytest.fixture(scope="module")
def movement(serve_task: ServeTask) -> JointMovement:
    return serve_task.retargeting.first


@pytest.fixture(scope="module")
def once(movement: JointMovement) -> ContactSteps:
    return integration()(movement, AVERAGE)


def test_steps_are_long_only_while_nothing_is_near(once: ContactSteps) -> None:
    steps, height = np.diff(once.ball.times), once.ball.position[:, 2]
    assert steps.min() > 0
    assert steps.max() <= 0.01 + 1e-12
    flying = (once.ball.times[:-1] > 0.6) & (height[:-1] > 1.4)
    carried = once.ball.times[:-1] < 0.45
    assert steps[flying].min() > 1.5e-3
    assert steps[carried].max() == pytest.approx(1e-3)


def test_gliding_over_the_flight_changes_nothing(
    movement: JointMovement, once: ContactSteps, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ContactIntegration, "_glide", lambda *_: 0.0)
    careful = integration()(movement, AVERAGE)
    assert careful.ball.times.size > 1.2 * once.ball.times.size
    assert_same_way(careful, once, 2e-4)


def test_the_default_lands_where_the_finest_steps_do(
    movement: JointMovement, once: ContactSteps
) -> None:
    fine = integration({"simulator.accuracy": 1e-5, "contact.step": 5e-4})(movement, AVERAGE)
    assert_same_way(fine, once, 1e-3)  # a tenth of what is asked of the landing


def test_the_ball_in_the_air_feels_gravity_alone(once: ContactSteps) -> None:
    ball = once.ball
    flying = np.flatnonzero((ball.times > 0.6) & (ball.times < 0.85))
    t = ball.times[flying] - ball.times[flying[0]]
    start, speed = ball.position[flying[0]], ball.velocity[flying[0]]
    parabola = start + speed * t[:, None] + np.array([0, 0, -GRAVITY / 2]) * t[:, None] ** 2
    np.testing.assert_allclose(ball.position[flying], parabola, atol=1e-9)


def test_it_ends_when_the_movement_is_over_and_the_ball_has_fallen(once: ContactSteps) -> None:
    assert once.ball.times[-1] >= 1.35 - 1e-9
    assert once.ball.position[-1, 2] < 0.5
    np.testing.assert_array_equal(once.arm.times, once.ball.times)


def test_the_same_again_to_the_bit(movement: JointMovement, once: ContactSteps) -> None:
    one = integration()
    trial = AVERAGE._replace(mount=np.array([0.01, -0.01, 0.005]), restitution=0.9)
    other = one(movement, trial)
    assert not np.array_equal(other.ball.position[-1], once.ball.position[-1])
    again = one(movement, AVERAGE)  # nothing is left of the trial between
    np.testing.assert_array_equal(again.ball.position, once.ball.position)
    np.testing.assert_array_equal(again.arm.q, once.arm.q)


def test_a_ball_that_falls_out_is_said_before_the_movement(movement: JointMovement) -> None:
    upright = movement.angles.copy()
    upright[:, 6] = 1.25  # the wrist turns the cup to the side
    upright[:, 4] = 1.7
    lying = JointMovement(movement.times, upright, minimum_jerk(movement.times, upright))
    one = integration()
    with pytest.raises(BallFallsOutError, match="the ball does not rest in the cup") as caught:
        one(lying, AVERAGE)
    assert caught.value.distance > 0.03
    one.settle(movement, AVERAGE)  # and the next one can begin


def test_a_simulation_that_fails_says_when_and_why(
    movement: JointMovement, once: ContactSteps
) -> None:
    glass = integration({"contact.strings_stiffness": 1e14})
    with pytest.raises(BrokenOffError, match=r"the simulation failed after 0\.\d+ s: ") as caught:
        glass(movement, AVERAGE)
    struck = once.ball.times[np.argmax(once.ball.velocity[:, 1] > 1.0)]
    assert caught.value.time == pytest.approx(struck, abs=0.01)
    assert "step" in caught.value.cause


def test_a_movement_that_never_lets_go_ends_all_the_same(movement: JointMovement) -> None:
    still = np.tile(movement.angles[0], (len(movement.times), 1))
    resting = replace(movement, angles=still, trajectory=minimum_jerk(movement.times, still))
    steps = integration({"contact.step": 2e-3})(resting, AVERAGE)
    assert steps.ball.times[-1] == pytest.approx(movement.times[-1] + 2.0)
    assert np.ptp(steps.ball.position, axis=0).max() < 1e-3
