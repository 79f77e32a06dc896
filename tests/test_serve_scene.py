"""The scene: where cup, ball and goal are, and what weighs on the arm when."""

from pathlib import Path

import numpy as np
import pytest
from own_package import NAME, own_package
from pydrake.multibody.plant import MultibodyPlant

from drake_viapoint.errors import ModelFileError, ScenarioError
from drake_viapoint.packages import models_path
from drake_viapoint.tasks.catalogue import build_task
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene, scene_path


@pytest.fixture(scope="module")
def scene() -> ServeScene:
    return ServeScene(ServeScenario())


def test_addresses_and_paths() -> None:
    assert scene_path("package://drake_viapoint/serve.dmd.yaml") == models_path() / "serve.dmd.yaml"
    assert scene_path("of/ones/own.dmd.yaml") == Path("of/ones/own.dmd.yaml")


def test_the_goal_is_where_the_model_has_it(scene: ServeScene) -> None:
    np.testing.assert_allclose(scene.ring, [0.4, 2.35, 0.5], atol=1e-12)


def test_the_cup_is_by_the_hand_and_opens_along_minus_x(scene: ServeScene) -> None:
    np.testing.assert_allclose(scene.cup.opening, [-1, 0, 0], atol=1e-12)
    x, y, z = scene.cup.centre
    assert x < -0.05
    assert abs(y) < 0.05
    assert z < -0.3


def test_a_loaded_ball_lies_in_the_cup_wherever_the_arm_is(scene: ServeScene) -> None:
    context = scene.diagram.CreateDefaultContext()
    own = scene.plant.GetMyMutableContextFromRoot(context)
    scene.load_ball(own)
    rng = np.random.default_rng(0)
    for _ in range(5):
        q = scene.arm.rest + rng.uniform(-0.5, 0.5, 7)
        v = rng.normal(size=7)
        scene.plant.SetPositions(own, scene.instance, q)
        scene.plant.SetVelocities(own, scene.instance, v)
        racket = scene.arm.tool_motion(q, v)
        ball = scene.ball.EvalPoseInWorld(own).translation()
        np.testing.assert_allclose(
            ball, racket.position + racket.rotation @ scene.cup.centre, atol=1e-12
        )
        lever = racket.rotation @ scene.cup.centre
        np.testing.assert_allclose(
            scene.ball.EvalSpatialVelocityInWorld(own).translational(),
            racket.velocity + np.cross(racket.angular_velocity, lever),
            atol=1e-12,
        )


def test_the_ball_weighs_what_the_scenario_says_until_it_is_unloaded() -> None:
    scenario = ServeScenario()
    scenario.ball.mass, scenario.ball.radius = 0.1, 0.04
    scene = ServeScene(scenario)
    context = scene.diagram.CreateDefaultContext()
    own = scene.plant.GetMyMutableContextFromRoot(context)
    scene.load_ball(own)
    inertia = scene.ball.CalcSpatialInertiaInBodyFrame(own)
    assert inertia.get_mass() == 0.1
    shell = 2 / 3 * 0.1 * 0.04**2
    np.testing.assert_allclose(inertia.CalcRotationalInertia().get_moments(), shell)
    scene.unload_ball(own)
    assert scene.ball.get_mass(own) == 0.0


def test_an_unloaded_scene_has_the_mass_matrix_of_the_arm_alone(scene: ServeScene) -> None:
    context = scene.diagram.CreateDefaultContext()
    own = scene.plant.GetMyMutableContextFromRoot(context)
    scene.load_ball(own)
    q = scene.arm.rest + 0.2
    scene.plant.SetPositions(own, scene.instance, q)
    arm: MultibodyPlant = scene.arm.plant
    alone = arm.CreateDefaultContext()
    arm.SetPositions(alone, q)
    joints = slice(*np.nonzero(scene.plant.MakeActuationMatrix().any(axis=1))[0][[0, -1]] + [0, 1])

    def heavier() -> float:
        mass = scene.plant.CalcMassMatrix(own)[joints, joints]
        return float(np.max(np.abs(mass - arm.CalcMassMatrix(alone))))

    assert heavier() > 1e-3
    scene.unload_ball(own)
    assert heavier() < 1e-12


def test_no_geometry_is_registered_where_nobody_looks(scene: ServeScene) -> None:
    assert not scene.plant.geometry_source_is_registered()


def test_two_scenes_are_alike(scene: ServeScene) -> None:
    other = ServeScene(ServeScenario())
    np.testing.assert_array_equal(scene.cup.centre, other.cup.centre)
    np.testing.assert_array_equal(scene.ring, other.ring)


@pytest.mark.parametrize(
    ("where", "name"),
    [
        ("scene", "package://drake_viapoint/none.dmd.yaml"),
        ("robot.directives", "package://drake_viapoint/none.dmd.yaml"),
        ("robot.directives", "none.dmd.yaml"),
        ("robot.arm", "leg"),
        ("robot.tool_frame", "paddle"),
        ("robot.cup_frame", "saucer"),
        ("ball.body", "shuttlecock"),
        ("ring_frame", "hoop"),
    ],
)
def test_what_the_models_lack_is_named(where: str, name: str) -> None:
    scenario = ServeScenario()
    *above, last = where.split(".")
    setattr(getattr(scenario, above[0]) if above else scenario, last, name)
    with pytest.raises(ModelFileError) as caught:
        ServeScene(scenario)
    assert name.removeprefix("package://drake_viapoint/") in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_scene_without_its_arms_joints_is_refused(tmp_path: Path) -> None:
    """A scene that holds a ball and a goal, and nothing to serve with."""
    file = tmp_path / "empty.dmd.yaml"
    file.write_text(
        "directives:\n"
        "- add_model: {name: ball, file: package://drake_viapoint/ball/ball.urdf}\n"
        "- add_model: {name: goal, file: package://drake_viapoint/goal/goal.urdf}\n"
    )
    scenario = ServeScenario()
    scenario.scene = str(file)
    with pytest.raises(ModelFileError, match="empty"):
        ServeScene(scenario)


SIX = "package://drake_viapoint/six_joint_"
SEVEN_NAMES, SIX_NAMES = "SFE SAA HR EB WR WFE WAA", "J1 J2 J3 J4 J5 J6"


@pytest.mark.parametrize("execution", ["event", "contact"])
@pytest.mark.parametrize(
    ("key", "address", "fault"),
    [
        ("directives", f"{SIX}arm_with_racket.dmd.yaml", (SIX_NAMES, SEVEN_NAMES)),
        ("scene", f"{SIX}serve.dmd.yaml", (SEVEN_NAMES, SIX_NAMES)),
    ],
)
def test_two_arms_are_refused(
    execution: str, key: str, address: str, fault: tuple[str, str]
) -> None:
    """One key changed, and the other forgotten."""
    scenario = ServeScenario(execution=execution)
    setattr(scenario.robot if key == "directives" else scenario, key, address)
    with pytest.raises(ScenarioError) as caught:
        ServeScene(scenario)
    assert str(caught.value) == (
        f"the arm of robot.directives ({fault[0]}) is not the arm of scene ({fault[1]}); change "
        "robot.directives and scene together"
    )


ARM_FILE, URDF = "config/arm_with_racket.dmd.yaml", "arm/arm.urdf"


@pytest.mark.parametrize(
    ("file", "old", "new", "fault"),
    [
        (ARM_FILE, "[-0.28284, 0.0", "[-0.28284, 0.1", r"at rest racket is at \(.*\) m and at "),
        (ARM_FILE, "72.81120741827469", "73.0", r"at rest racket is at \(.*\) m and at "),
        (ARM_FILE, "SAA: [-0.3]", "SAA: [-0.2]", "angle at rest of SAA -0.2 and -0.3"),
        (URDF, 'velocity="', 'velocity="1', "greatest speed of SFE"),
        (URDF, 'lower="-', 'lower="-1', "lower limit of SFE"),
        (URDF, '<mass value="', '<mass value="1', "mass of .* kg and "),
    ],
)
def test_an_arm_that_differs_from_the_scenes_is_refused(
    tmp_path: Path, file: str, old: str, new: str, fault: str
) -> None:
    """The same joints, but not the same place, rest, limits or mass."""
    changed = own_package(tmp_path).parent / file
    text = changed.read_text()
    assert old in text
    changed.write_text(text.replace(old, new))
    scenario = ServeScenario()
    scenario.robot.directives = str(tmp_path / NAME / ARM_FILE)
    with pytest.raises(ScenarioError, match=f"is not the arm of scene: {fault}"):
        ServeScene(scenario)


def test_a_tool_turned_about_its_centre_is_refused(tmp_path: Path) -> None:
    """Where the tool is does not show it, and its angle is said."""
    scenario = ServeScenario()
    scenario.robot.directives = str(own_package(tmp_path) / "arm_with_racket.dmd.yaml")
    racket = tmp_path / NAME / "racket" / "racket.urdf"
    turned = '<frame name="blade" link="racket" xyz="0 0 0" rpy="0 0 {}"/></robot>'
    scenario.robot.tool_frame = "blade"
    for angle in (0.0, 0.3):
        scene = own_package(tmp_path / f"scene{angle}") / "serve.dmd.yaml"
        scenario.scene = str(scene)
        text = (models_path() / "racket" / "racket.urdf").read_text()
        for file, by in ((racket, 0.0), (scene.parents[1] / "racket" / "racket.urdf", angle)):
            file.write_text(text.replace("</robot>", turned.format(by)))
        if angle:
            with pytest.raises(ScenarioError, match=r"at rest blade is turned by 0\.3 rad"):
                ServeScene(scenario)
        else:
            ServeScene(scenario)


def test_a_tool_that_the_scene_lacks_is_named_without_all_there_are() -> None:
    scenario = ServeScenario()
    scenario.robot.directives = "package://drake_viapoint/arm_with_axle.dmd.yaml"
    scenario.robot.tool_frame = "axle"
    with pytest.raises(ModelFileError, match="'axle'") as caught:
        ServeScene(scenario)
    assert len(str(caught.value)) < 150


@pytest.mark.parametrize(
    ("arm", "scene"),
    [
        ("arm_with_racket", "serve"),
        ("six_joint_arm_with_racket", "six_joint_serve"),
    ],
)
def test_a_scene_in_a_package_of_ones_own_serves_the_same(
    tmp_path: Path, arm: str, scene: str
) -> None:
    config = own_package(tmp_path)
    trials = []
    for folder in ("package://drake_viapoint", str(config)):
        scenario = ServeScenario()
        scenario.robot.directives = f"{folder}/{arm}.dmd.yaml"
        scenario.scene = f"{folder}/{scene}.dmd.yaml"
        task = build_task(scenario)
        trials.append(task.execute(task.via_points, 0).record())
    assert trials[0] == trials[1]


def test_a_scene_names_the_package_it_does_not_know(tmp_path: Path) -> None:
    config = own_package(tmp_path)
    (config.parent / "package.xml").unlink()
    scenario = ServeScenario()
    scenario.scene = str(config / "serve.dmd.yaml")
    with pytest.raises(ModelFileError, match=r"serve\.dmd\.yaml: .*unknown package 'my_robot'"):
        ServeScene(scenario)
