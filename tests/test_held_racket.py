"""The racket in the arm's hand: where the scene's plant has it, also in a mount that gave way."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.math import RigidTransform
from scipy.spatial.transform import Rotation

from drake_viapoint.robot.arm_motion import ArmMotion
from drake_viapoint.tasks.held_racket import HeldRacket, LooseRacket
from drake_viapoint.tasks.racket import RacketStates
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_contact_scene import ContactScene
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_trial import ServeTrial
from drake_viapoint.tasks.serve_unknown import TrialDraw

MOUNTS = [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, -0.2, 0.0), (0.05, 0.3, -0.4)]
TIMES = np.linspace(0.02, 1.34, 12)


@pytest.fixture(scope="module")
def motion(serve_task: ServeTask) -> ArmMotion:
    """The shipped serve's."""
    trial = serve_task.execute(serve_task.via_points, 0)
    assert isinstance(trial, ServeTrial)
    return trial.motion


@pytest.fixture(scope="module")
def scene() -> ContactScene:
    return ContactScene(ServeScenario(execution="contact"))


def loose(scene: ContactScene, motion: ArmMotion, mount: tuple[float, float, float]) -> LooseRacket:
    return LooseRacket(scene.arm, motion, scene.loosened(TrialDraw(np.array(mount), 1.0)))


def turned_by(states: RacketStates) -> NDArray:
    """From the first of two poses to the second: a rotation vector in the world."""
    return Rotation.from_matrix(states.rotation[1] @ states.rotation[0].T).as_rotvec()


@pytest.mark.parametrize("mount", MOUNTS)
def test_a_loose_racket_is_where_the_plant_has_it(
    scene: ContactScene, motion: ArmMotion, mount: tuple[float, float, float]
) -> None:
    """With its velocity: the plant's mount has given way, the arm's model knows nothing of it."""
    context = scene.diagram.CreateDefaultContext()
    scene.differ(context, scene.unknown(0), TrialDraw(np.array(mount), 1.0))
    own = scene.plant.GetMyMutableContextFromRoot(context)
    states = loose(scene, motion, mount)(TIMES)
    for number, time in enumerate(TIMES):
        scene.plant.SetPositions(own, scene.instance, motion.q(time))
        scene.plant.SetVelocities(own, scene.instance, motion.v(time))
        pose = scene.racket_frame.CalcPoseInWorld(own)
        moving = scene.racket_frame.CalcSpatialVelocityInWorld(own)
        by_plant = (
            pose.rotation().matrix(),
            pose.translation(),
            moving.rotational(),
            moving.translational(),
        )
        for found, expected in zip(states, by_plant, strict=True):
            np.testing.assert_allclose(found[number], expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("mount", MOUNTS)
def test_a_loose_racket_is_turned_where_it_is_held(
    scene: ContactScene, motion: ArmMotion, mount: tuple[float, float, float]
) -> None:
    """By the angle drawn, about the grip, which stays where the hand is."""
    held = HeldRacket(scene.arm, motion)(TIMES)
    states = loose(scene, motion, mount)(TIMES)
    grip = np.array([0.0, 0.0, -0.43])
    np.testing.assert_allclose(
        states.position + states.rotation @ grip, held.position + held.rotation @ grip, atol=1e-12
    )
    for one, other in zip(held.rotation, states.rotation, strict=True):
        angle = Rotation.from_matrix(one.T @ other).magnitude()
        assert angle == pytest.approx(np.linalg.norm(mount), abs=1e-7)


@pytest.mark.parametrize("mount", MOUNTS)
def test_velocities_are_those_of_the_poses(
    scene: ContactScene, motion: ArmMotion, mount: tuple[float, float, float]
) -> None:
    racket, h = loose(scene, motion, mount), 1e-5
    states = racket(TIMES)
    for number, time in enumerate(TIMES):
        around = racket([time - h, time + h])
        velocity = np.diff(around.position, axis=0)[0] / (2 * h)
        np.testing.assert_allclose(states.velocity[number], velocity, atol=1e-6)
        np.testing.assert_allclose(
            states.angular_velocity[number], turned_by(around) / (2 * h), atol=1e-6
        )
    assert np.max(np.linalg.norm(states.velocity, axis=1)) > 2  # it is a swing


def test_a_tight_racket_is_where_the_model_has_it(scene: ContactScene, motion: ArmMotion) -> None:
    held = HeldRacket(scene.arm, motion)
    for racket in (
        LooseRacket(scene.arm, motion, RigidTransform()),
        loose(scene, motion, (0.0, 0.0, 0.0)),
    ):
        assert (racket.start, racket.end) == (held.start, held.end) == (motion.start, motion.end)
        for found, expected in zip(racket(TIMES), held(TIMES), strict=True):
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


def test_a_held_racket_is_the_arms_tool(scene: ContactScene, motion: ArmMotion) -> None:
    states = HeldRacket(scene.arm, motion)(TIMES)
    assert [field.shape for field in states] == [(12, 3, 3), (12, 3), (12, 3), (12, 3)]
    for number, time in enumerate(TIMES):
        pose = scene.arm.tool_pose(motion.q(time))
        np.testing.assert_array_equal(states.rotation[number], pose.rotation)
        np.testing.assert_array_equal(states.position[number], pose.position)
        # the arm's Jacobian is another way to its velocity
        twist = scene.arm.tool_jacobian(motion.q(time)) @ motion.v(time)
        moving = np.concatenate([states.angular_velocity[number], states.velocity[number]])
        np.testing.assert_allclose(moving, twist, atol=1e-12)
