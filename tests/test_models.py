"""The models: what they weigh, where their frames are, and whether a second simulator agrees."""

import importlib.util
import re
from types import ModuleType
from typing import NamedTuple

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from pydrake.geometry import SceneGraph
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, SpatialInertia
from pydrake.systems.framework import Context
from scipy.spatial.transform import Rotation

from drake_viapoint.errors import ModelFileError
from drake_viapoint.packages import models_path, package_map, resolve

REST = np.array([0.0, -0.3, 0.0, 1.57, 0.0, 0.0, 0.0])
SERVE = "serve.dmd.yaml"
LINKS = (
    "shoulder_block",
    "shoulder_yoke",
    "upper_arm",
    "elbow",
    "forearm",
    "wrist",
    "palm",
    "hand",
)
MODEL_FILES = sorted(
    str(path.relative_to(models_path()))
    for pattern in ("*/*.urdf", "*.dmd.yaml")
    for path in models_path().glob(pattern)
)


def load(file: str, weld: str | None = None) -> tuple[MultibodyPlant, Context]:
    plant = MultibodyPlant(time_step=0.0)
    parser = Parser(plant)
    parser.package_map().AddMap(package_map())
    parser.SetStrictParsing()
    parser.AddModels(resolve(f"package://drake_viapoint/{file}"))
    if weld is not None:
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(weld))
    plant.Finalize()
    return plant, plant.CreateDefaultContext()


def pose(plant: MultibodyPlant, context: Context, frame: str) -> RigidTransform:
    return plant.GetFrameByName(frame).CalcPoseInWorld(context)


@pytest.fixture(scope="module")
def serve() -> tuple[MultibodyPlant, Context]:
    return load(SERVE)


@pytest.mark.parametrize("file", MODEL_FILES)
def test_inertias_are_physically_valid(file: str) -> None:
    plant, context = load(file)
    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    assert bodies
    for body in bodies:
        assert body.get_mass(context) > 0.0, body.name()
        inertia = body.CalcSpatialInertiaInBodyFrame(context)
        assert inertia.IsPhysicallyValid(), body.name()
        # Drake grants a tolerance; here every principal moment stays inside the triangle.
        central = inertia.Shift(inertia.get_com()).CalcRotationalInertia()
        moments = np.sort(central.CalcPrincipalMomentsOfInertia())
        assert moments[0] > 0.0
        assert moments[2] < moments[0] + moments[1], body.name()


def test_every_model_of_the_folder_is_known() -> None:
    assert {"arm/arm.urdf", "ball/ball.urdf", "goal/goal.urdf", "racket/racket.urdf", SERVE} <= set(
        MODEL_FILES
    )


class JointRow(NamedTuple):
    """One line of the arm's table."""

    lower: float
    upper: float
    effort: float
    velocity: float
    xyz: tuple[float, float, float]
    rpy: tuple[float, float, float]


HALF = np.pi / 2.0
JOINTS = {
    "SFE": JointRow(-1.0, 2.8, 100.0, 12.0, (0.28284, 0.0, 0.28284), (0.0, np.pi / 4.0, 0.0)),
    "SAA": JointRow(-1.6, 0.6, 100.0, 12.0, (0.0, 0.0, 0.0), (-HALF, np.pi / 4.0, 0.0)),
    "HR": JointRow(-1.6, 1.6, 60.0, 12.0, (0.0, -0.0381, 0.0), (0.0, HALF, 0.0)),
    "EB": JointRow(0.05, 2.5, 60.0, 12.0, (0.0, 0.0, 0.287), (HALF, HALF, 0.0)),
    "WR": JointRow(-1.8, 1.8, 25.0, 15.0, (0.0, 0.0, -0.0025), (0.0, -HALF, 0.0)),
    "WFE": JointRow(-1.4, 1.4, 25.0, 15.0, (0.0, 0.0, 0.2781), (-HALF, 0.0, 0.0)),
    "WAA": JointRow(-1.3, 1.3, 25.0, 15.0, (0.0, 0.0, 0.0081), (np.pi, -HALF, 0.0)),
}


def test_joints_are_those_of_the_table() -> None:
    plant, context = load("arm/arm.urdf")
    names = [
        plant.get_joint(i).name()
        for i in plant.GetJointIndices(plant.GetModelInstanceByName("arm"))
    ]
    assert [name for name in names if name in JOINTS] == list(JOINTS)
    for name, row in JOINTS.items():
        joint = plant.GetJointByName(name)
        assert joint.position_lower_limits() == [row.lower]
        assert joint.position_upper_limits() == [row.upper]
        assert joint.velocity_upper_limits() == [row.velocity]
        assert plant.GetJointActuatorByName(name).effort_limit() == row.effort
        assert_allclose(joint.revolute_axis(), [0.0, 0.0, 1.0])
        placed = joint.frame_on_parent().GetFixedPoseInBodyFrame()
        assert_allclose(placed.translation(), row.xyz, atol=1e-12)
        expected = RollPitchYaw(row.rpy).ToRotationMatrix()
        assert_allclose(placed.rotation().matrix(), expected.matrix(), atol=1e-12)
        assert joint.default_damping() == 0.0
    masses = [plant.GetBodyByName(link).get_mass(context) for link in LINKS]
    assert_allclose(masses, [2.0, 1.5, 3.0, 0.5, 2.0, 0.6, 0.3, 0.5])


def test_arm_hangs_straight_down_at_zero() -> None:
    plant, context = load("arm/arm.urdf")
    base = pose(plant, context, "base").translation()
    along = pose(plant, context, "upper_arm").rotation().col(2)
    assert_allclose(along, [0.0, 0.0, -1.0], atol=1e-12)
    hand = pose(plant, context, "hand").translation() - base
    shoulder = pose(plant, context, "shoulder_yoke").translation() - base
    assert_allclose(shoulder, [0.28284, 0.0, 0.28284], atol=1e-12)
    assert_allclose(hand - shoulder, [0.0356, -0.0081, -0.287 - 0.2781 - 0.085], atol=1e-12)


def test_scene_starts_at_rest_with_the_racket_to_the_right(
    serve: tuple[MultibodyPlant, Context],
) -> None:
    plant, context = serve
    arm = plant.GetModelInstanceByName("arm")
    assert_allclose(plant.GetPositions(context, arm), REST)
    shoulder = pose(plant, context, "shoulder_yoke").translation()
    assert_allclose(shoulder, [0.0, 0.0, 1.2], atol=1e-12)
    assert_allclose(pose(plant, context, "forearm").rotation().col(2), [0.0, 1.0, 0.0], atol=2e-3)
    racket = pose(plant, context, "racket")
    expected = Rotation.from_euler("ZYZ", [0.0, np.pi / 2.0, 0.0]).as_matrix()
    assert_allclose(racket.rotation().matrix(), expected, atol=1e-12)
    hand = pose(plant, context, "hand").translation()
    assert_allclose(racket.translation() - hand, [0.43, 0.0, 0.0], atol=1e-12)


def test_frames_are_where_the_models_say(serve: tuple[MultibodyPlant, Context]) -> None:
    plant, context = serve
    handle = plant.GetFrameByName("handle").GetFixedPoseInBodyFrame()
    assert_allclose(handle.translation(), [0.0, 0.0, -0.43])
    cup = plant.GetFrameByName("cup").GetFixedPoseInBodyFrame()
    assert_allclose(cup.translation(), [-0.10, 0.0, -0.43])
    assert_allclose(cup.rotation().col(2), [-1.0, 0.0, 0.0], atol=1e-12)
    # At rest the cup opens upwards, so the ball lies in it.
    assert_allclose(pose(plant, context, "cup").rotation().col(2), [0.0, 0.0, 1.0], atol=1e-12)
    ring = pose(plant, context, "ring")
    assert_allclose(ring.translation(), [0.4, 2.35, 0.5], atol=1e-12)
    assert_allclose(ring.rotation().matrix(), np.eye(3), atol=1e-12)
    assert pose(plant, context, "goal").translation()[2] == pytest.approx(0.0, abs=1e-12)


def test_racket_balances_and_swings_as_documented() -> None:
    plant, context = load("racket/racket.urdf")
    inertia: SpatialInertia = plant.GetBodyByName("racket").CalcSpatialInertiaInBodyFrame(context)
    assert inertia.get_mass() == 0.300
    butt = np.array([0.0, 0.0, 0.17 - 0.685])
    assert_allclose(inertia.get_com() - butt, [0.0, 0.0, 0.33], atol=1e-12)
    about_axis = inertia.Shift(butt + np.array([0.0, 0.0, 0.10])).CalcRotationalInertia()
    swing_weight = about_axis.get_moments()[0]  # about x: in the face's plane, across the handle
    assert swing_weight == pytest.approx(310e-4, abs=1e-5)  # 310 kg cm2


def test_ball_is_a_hollow_sphere() -> None:
    plant, context = load("ball/ball.urdf")
    inertia = plant.GetBodyByName("ball").CalcSpatialInertiaInBodyFrame(context)
    assert inertia.get_mass() == 0.058
    assert_allclose(inertia.get_com(), 0.0)
    expected = SpatialInertia.HollowSphereWithMass(mass=0.058, radius=0.033)
    assert_allclose(inertia.CopyToFullMatrix6(), expected.CopyToFullMatrix6(), atol=1e-9)


def test_models_are_looks_without_contact() -> None:
    plant = MultibodyPlant(time_step=0.0)
    scene_graph = SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    parser = Parser(plant)
    parser.package_map().AddMap(package_map())
    parser.AddModels(resolve(f"package://drake_viapoint/{SERVE}"))
    plant.Finalize()
    bodies = [plant.get_body(BodyIndex(i)) for i in range(1, plant.num_bodies())]
    assert all(plant.GetVisualGeometriesForBody(body) for body in bodies)
    assert not any(plant.GetCollisionGeometriesForBody(body) for body in bodies)


def relative(ours: NDArray[np.float64], theirs: NDArray[np.float64]) -> float:
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def test_arm_agrees_with_mujoco() -> None:
    plant, context = load("arm/arm.urdf", weld="base")
    spec = mujoco.MjSpec.from_file(str(resolve("package://drake_viapoint/arm/arm.urdf")))
    spec.compiler.fusestatic = False  # keep base and hand as bodies of their own
    model = spec.compile()
    data = mujoco.MjData(model)
    assert [model.joint(i).name for i in range(model.njnt)] == list(JOINTS)
    assert_allclose(model.opt.gravity, plant.gravity_field().gravity_vector())

    rng = np.random.default_rng(7)
    lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
    worst = dict.fromkeys(("position", "rotation", "mass", "bias"), 0.0)
    for _ in range(100):
        q, v = rng.uniform(lower, upper), rng.uniform(-10.0, 10.0, 7)
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(model, data)

        ours = [pose(plant, context, name) for name in LINKS]
        theirs = [data.body(name) for name in LINKS]
        figures = {
            "position": relative(
                np.array([X.translation() for X in ours]), np.array([b.xpos for b in theirs])
            ),
            "rotation": relative(
                np.array([X.rotation().matrix() for X in ours]),
                np.array([b.xmat.reshape(3, 3) for b in theirs]),
            ),
        }
        mass = np.empty((7, 7))
        for column, unit in zip(mass.T, np.eye(7), strict=True):
            result = np.empty(7)
            mujoco.mj_mulM(model, data, result, unit)
            column[:] = result
        figures["mass"] = relative(plant.CalcMassMatrix(context), mass)
        bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
        figures["bias"] = relative(bias, data.qfrc_bias)
        worst = {name: max(worst[name], figures[name]) for name in worst}
    assert max(worst.values()) < 1e-8, worst


@pytest.fixture(scope="module")
def make_meshes() -> ModuleType:
    script = models_path() / "make_meshes.py"
    if not script.is_file():
        pytest.skip("the meshes are made in a clone")
    spec = importlib.util.spec_from_file_location("make_meshes", script)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def numbers(path_text: str, key: str) -> NDArray[np.float64]:
    rows = re.findall(rf"^{key} (.*)$", path_text, re.MULTILINE)
    return np.array([[float(x) for x in row.split()] for row in rows])


def test_meshes_are_those_the_script_makes(make_meshes: ModuleType) -> None:
    made = make_meshes.meshes()
    shipped = {str(path.relative_to(models_path())) for path in models_path().glob("*/*.obj")}
    assert shipped == set(made)
    for name, mesh in made.items():
        vertices = numbers((models_path() / name).read_text(), "v")
        assert_allclose(vertices, mesh.vertices, atol=1e-5, err_msg=name)


def test_meshes_have_the_sizes_of_the_things(make_meshes: ModuleType) -> None:
    made = make_meshes.meshes()
    head = made["racket/frame.obj"].vertices
    assert np.abs(head[:, 0]).max() == pytest.approx(0.13, abs=1e-3)
    assert head[:, 2].max() == pytest.approx(0.17, abs=1e-3)
    assert made["racket/grip.obj"].vertices[:, 2].min() == pytest.approx(0.17 - 0.685)
    ring = made["goal/ring.obj"].vertices
    assert np.hypot(ring[:, 0], ring[:, 1]).min() == pytest.approx(0.125, abs=1e-3)
    assert made["goal/stand.obj"].vertices[:, 2].min() == 0.0
    # The resting ball fits the cup's hollow: nothing of the cup is nearer than its radius.
    assert np.linalg.norm(made["racket/cup.obj"].vertices, axis=1).min() > 0.033


@pytest.mark.parametrize(
    ("uri", "reason"),
    [
        ("package://drake_models/arm.urdf", "starts with"),
        ("arm/arm.urdf", "starts with"),
        ("package://drake_viapoint/../pyproject.toml", "leaves"),
        ("package://drake_viapoint/arm/leg.urdf", "no such file"),
    ],
)
def test_bad_address_is_named(uri: str, reason: str) -> None:
    with pytest.raises(ModelFileError, match=reason) as caught:
        resolve(uri)
    assert caught.value.uri == uri
    assert uri in str(caught.value)
    assert "\n" not in str(caught.value)
