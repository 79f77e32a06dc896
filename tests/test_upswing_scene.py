"""The scene: where arm and pendulum are, and whether a second simulator agrees on how they move."""

import mujoco
import numpy as np
import pytest
from pydrake.geometry import Meshcat, MeshcatParams
from pydrake.math import RigidTransform

from drake_viapoint.errors import ModelFileError, ScenarioError, UnreachableError
from drake_viapoint.packages import models_path
from drake_viapoint.tasks.pendulum import HANGING
from drake_viapoint.tasks.upswing_scenario import UpswingScenario
from drake_viapoint.tasks.upswing_scene import UpswingScene


@pytest.fixture(scope="module")
def scene() -> UpswingScene:
    return UpswingScene(UpswingScenario())


@pytest.mark.parametrize("x", [-0.4, 0.0, 0.23])
@pytest.mark.parametrize("angle", [HANGING, -2.0, 0.0, 1.2, 7.0])
def test_the_joints_angle_is_theta(scene: UpswingScene, x: float, angle: float) -> None:
    """The bob is at l (-sin theta, 0, cos theta) from the hand, and turns with theta's rate."""
    context = scene.diagram.CreateDefaultContext()
    own = scene.plant.GetMyMutableContextFromRoot(context)
    scene.put(own, x, angle)
    length = UpswingScenario().pendulum.length
    body = scene.plant.GetBodyByName("pendulum")
    bob = scene.plant.CalcPointsPositions(
        own, body.body_frame(), [0, 0, length], scene.plant.world_frame()
    )[:, 0]
    hand = np.array(UpswingScenario().robot.line) + [x, 0, 0]
    expected = hand + length * np.array([-np.sin(angle), 0, np.cos(angle)])
    np.testing.assert_allclose(bob, expected, atol=1e-9)
    scene.joint.set_angular_rate(own, 3.0)
    spin = body.EvalSpatialVelocityInWorld(own).rotational()
    np.testing.assert_allclose(spin, [0, -3.0, 0], atol=1e-9)


def test_it_hangs_from_an_arm_at_rest_by_default(scene: UpswingScene) -> None:
    context = scene.plant.CreateDefaultContext()
    assert scene.joint.get_angle(context) == HANGING
    np.testing.assert_array_equal(scene.plant.GetPositions(context, scene.instance), scene.arm.rest)


def test_the_pendulum_is_a_point_on_a_rod_without_mass(scene: UpswingScene) -> None:
    context = scene.plant.CreateDefaultContext()
    pendulum = UpswingScenario().pendulum
    body = scene.plant.GetBodyByName("pendulum")
    assert body.get_mass(context) == pendulum.mass
    inertia = body.CalcSpatialInertiaInBodyFrame(context)
    np.testing.assert_allclose(inertia.get_com(), [0, 0, pendulum.length])
    central = inertia.Shift(inertia.get_com()).CopyToFullMatrix6()[:3, :3]
    np.testing.assert_allclose(central, 0, atol=1e-15)


def test_the_controller_knows_no_pendulum(scene: UpswingScene) -> None:
    assert scene.arm.plant.num_positions() == 7
    assert scene.plant.num_positions() == 8
    assert not scene.arm.plant.HasBodyNamed("pendulum")


def test_the_pendulum_swings_clear_of_the_arm(scene: UpswingScene) -> None:
    """Its plane is in front of every joint, and above the floor."""
    nearest = UpswingScenario().robot.line[1] - 0.03  # the bob's back
    for x in np.linspace(-0.45, 0.45, 19):
        joints = scene.arm.joint_positions(scene.line.posture(x))[:-1]
        assert joints[:, 1].max() + 0.04 < nearest
    assert UpswingScenario().robot.line[2] - UpswingScenario().pendulum.length > 0.5


def test_no_geometry_is_registered_where_nobody_looks(scene: UpswingScene) -> None:
    assert not scene.plant.geometry_source_is_registered()


def test_what_is_shown_has_looks_and_no_contact() -> None:
    shown = UpswingScene(UpswingScenario(), Meshcat(MeshcatParams(host="localhost"))).plant
    pendulum = shown.GetBodyByName("pendulum")
    assert len(shown.GetVisualGeometriesForBody(pendulum)) == 3
    assert not shown.GetCollisionGeometriesForBody(pendulum)
    assert shown.GetVisualGeometriesForBody(shown.GetBodyByName("forearm"))


@pytest.mark.parametrize("damping", [0.0, 0.5])
def test_arm_and_pendulum_agree_with_mujoco(damping: float) -> None:
    """Mass matrix, bias and accelerations at random states and torques."""
    scenario = UpswingScenario()
    scenario.pendulum.damping, scenario.pendulum.length = damping, 0.4
    scene = UpswingScene(scenario)
    model = mujoco_model(scene, scenario)
    data = mujoco.MjData(model)
    plant = scene.plant
    context = scene.diagram.CreateDefaultContext()
    own = plant.GetMyMutableContextFromRoot(context)
    rng = np.random.default_rng(3)
    lower, upper = scene.arm.limits.lower, scene.arm.limits.upper
    for _ in range(50):
        q = np.r_[rng.uniform(lower, upper), rng.uniform(-7, 7)]
        v = rng.uniform(-5, 5, 8)
        torque = np.r_[rng.uniform(-20, 20, 7), 0.0]
        plant.SetPositions(own, q)
        plant.SetVelocities(own, v)
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, v, torque
        mujoco.mj_forward(model, data)
        mass = plant.CalcMassMatrix(own)
        theirs = np.empty((8, 8))
        for row, unit in zip(theirs, np.eye(8), strict=True):
            mujoco.mj_mulM(model, data, row, unit)
        np.testing.assert_allclose(mass, theirs, atol=1e-9 * np.abs(mass).max())
        bias = plant.CalcBiasTerm(own) - plant.CalcGravityGeneralizedForces(own)
        np.testing.assert_allclose(bias, data.qfrc_bias, atol=1e-9 * np.abs(bias).max())
        loss = np.r_[np.zeros(7), scene.joint.default_damping() * v[7]]
        acceleration = np.linalg.solve(mass, torque - bias - loss)
        np.testing.assert_allclose(acceleration, data.qacc, atol=1e-7 * np.abs(acceleration).max())


def mujoco_model(scene: UpswingScene, scenario: UpswingScenario) -> mujoco.MjModel:
    """The arm's own model file with a pendulum in its hand."""
    spec = mujoco.MjSpec.from_file(str(models_path() / "arm" / "arm.urdf"))
    spec.compiler.fusestatic = False
    context = scene.plant.CreateDefaultContext()
    place: RigidTransform = scene.plant.CalcRelativeTransform(
        context, scene.plant.GetFrameByName("hand"), scene.plant.GetFrameByName("hinge")
    )
    length, mass = scenario.pendulum.length, scenario.pendulum.mass
    body = spec.body("hand").add_body(
        name="pendulum",
        pos=place.translation(),
        quat=place.rotation().ToQuaternion().wxyz(),
        mass=mass,
        ipos=[0, 0, length],
        inertia=[1e-13] * 3,  # it takes no point
        explicitinertial=True,
    )
    joint = body.add_joint(name="pendulum", axis=[0, -1, 0])
    joint.type = mujoco.mjtJoint.mjJNT_HINGE
    damping = np.zeros_like(joint.damping)
    damping.flat[0] = scenario.pendulum.damping * mass * length**2
    joint.damping = damping
    return spec.compile()


def test_a_place_out_of_reach_is_refused(scene: UpswingScene) -> None:
    context = scene.plant.CreateDefaultContext()
    with pytest.raises(UnreachableError, match=r"the hand at x = 0\.800 m"):
        scene.put(context, 0.8, 0.0)


@pytest.mark.parametrize(
    ("key", "name"),
    [
        ("directives", "package://drake_viapoint/none.dmd.yaml"),
        ("directives", "none.dmd.yaml"),
        ("arm", "leg"),
        ("tool_frame", "paddle"),
    ],
)
def test_what_the_models_lack_is_named(key: str, name: str) -> None:
    scenario = UpswingScenario()
    setattr(scenario.robot, key, name)
    with pytest.raises(ModelFileError) as caught:
        UpswingScene(scenario)
    assert name.removeprefix("package://drake_viapoint/") in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_line_out_of_reach_is_refused() -> None:
    scenario = UpswingScenario()
    scenario.robot.line = [0.0, 1.5, 1.2]
    with pytest.raises(ScenarioError, match=r"robot\.line"):
        UpswingScene(scenario)
