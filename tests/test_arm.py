"""The arm's kinematics against finite differences of itself, and models that are no arms."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_viapoint.errors import ModelFileError
from drake_viapoint.packages import resolve
from drake_viapoint.robot.arm import Arm, load_plant

DIRECTIVES = resolve("package://drake_viapoint/arm_with_racket.dmd.yaml")


def random_state(arm: Arm, seed: int) -> tuple[NDArray, NDArray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(arm.limits.lower, arm.limits.upper), rng.normal(size=arm.num_joints)


@pytest.mark.parametrize("seed", range(20))
def test_jacobian_against_finite_differences(arm: Arm, seed: int) -> None:
    q, _ = random_state(arm, seed)
    h = 1e-5
    columns = []
    for joint in np.eye(arm.num_joints):
        after, before = arm.tool_pose(q + h * joint), arm.tool_pose(q - h * joint)
        turn = Rotation.from_matrix(after.rotation @ before.rotation.T).as_rotvec()
        columns.append(np.concatenate([turn, after.position - before.position]) / (2 * h))
    np.testing.assert_allclose(arm.tool_jacobian(q), np.transpose(columns), atol=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_tool_moves_by_the_jacobian(arm: Arm, seed: int) -> None:
    q, v = random_state(arm, seed)
    motion = arm.tool_motion(q, v)
    np.testing.assert_allclose(
        np.concatenate([motion.angular_velocity, motion.velocity]),
        arm.tool_jacobian(q) @ v,
        atol=1e-13,
    )
    pose = arm.tool_pose(q)
    np.testing.assert_array_equal(motion.position, pose.position)
    np.testing.assert_array_equal(motion.rotation, pose.rotation)
    np.testing.assert_allclose(pose.rotation.T @ pose.rotation, np.eye(3), atol=1e-14)


def test_asking_for_one_pose_does_not_change_another(arm: Arm) -> None:
    (q, _), (other, v) = random_state(arm, 0), random_state(arm, 1)
    before = arm.tool_pose(q)
    arm.tool_motion(other, v)
    arm.tool_jacobian(other)
    np.testing.assert_array_equal(arm.tool_pose(q).position, before.position)


def test_joints_and_their_limits_are_those_of_the_model(arm: Arm) -> None:
    assert arm.joint_names == ("SFE", "SAA", "HR", "EB", "WR", "WFE", "WAA")
    assert arm.num_joints == 7
    np.testing.assert_array_equal(arm.limits.lower, [-1, -1.6, -1.6, 0.05, -1.8, -1.4, -1.3])
    np.testing.assert_array_equal(arm.limits.upper, [2.8, 0.6, 1.6, 2.5, 1.8, 1.4, 1.3])
    np.testing.assert_array_equal(arm.limits.speed, [12, 12, 12, 12, 15, 15, 15])
    np.testing.assert_array_equal(arm.limits.effort, [100, 100, 60, 60, 25, 25, 25])


def test_rest_holds_the_racket_to_the_right_facing_forward(arm: Arm) -> None:
    np.testing.assert_array_equal(arm.rest, [0, -0.3, 0, 1.57, 0, 0, 0])
    right, forward, up = np.eye(3)
    rotation = arm.tool_pose(arm.rest).rotation
    np.testing.assert_allclose(rotation, np.column_stack([-up, forward, right]), atol=1e-12)
    with pytest.raises(ValueError, match="read-only"):
        arm.rest[0] = 1.0


def test_a_frame_that_is_not_there_is_named() -> None:
    with pytest.raises(ModelFileError, match=r"arm_with_racket.*no frame named 'paddle'"):
        Arm(DIRECTIVES, "paddle")


@pytest.mark.parametrize(
    "text",
    [
        "directives: [",
        "directives:\n- add_model: {name: arm, file: package://drake_viapoint/none.urdf}\n",
        "directives:\n- add_weld: {parent: world, child: nowhere::link}\n",
        "directives:\n- juggle: {}\n",
        "joints: 7\n",
    ],
)
def test_broken_directives_are_one_line_that_names_the_file(tmp_path: Path, text: str) -> None:
    broken = tmp_path / "broken.dmd.yaml"
    broken.write_text(text)
    with pytest.raises(ModelFileError) as caught:
        load_plant(broken)
    message = str(caught.value)
    assert message.startswith(f"{broken}: ")
    assert "\n" not in message


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModelFileError, match=r"none\.dmd\.yaml: "):
        load_plant(tmp_path / "none.dmd.yaml")


@pytest.mark.parametrize("model", ["ball/ball.urdf", "goal/goal.urdf"])
def test_joints_without_motors_are_no_arm(tmp_path: Path, model: str) -> None:
    file = tmp_path / "no_arm.dmd.yaml"
    file.write_text(
        f"directives:\n- add_model: {{name: it, file: package://drake_viapoint/{model}}}\n"
    )
    with pytest.raises(ModelFileError, match="6 degrees of freedom, 0 actuators"):
        Arm(file, "ball")


@pytest.mark.parametrize("seed", range(5))
def test_the_stick_figure_is_rigid_and_ends_at_the_tool(arm: Arm, seed: int) -> None:
    (q, _), (other, _) = random_state(arm, seed), random_state(arm, seed + 100)
    figure = arm.joint_positions(q)
    assert figure.shape == (arm.num_joints + 1, 3)
    np.testing.assert_array_equal(figure[-1], arm.tool_pose(q).position)
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(figure, axis=0), axis=1),
        np.linalg.norm(np.diff(arm.joint_positions(other), axis=0), axis=1),
        atol=1e-12,
    )
    # no joint moves those before it, nor the place it turns about
    moved = arm.joint_positions(q + 0.1 * np.eye(arm.num_joints)[3])
    np.testing.assert_allclose(moved[:4], figure[:4], atol=1e-12)
    assert np.linalg.norm(moved[-1] - figure[-1]) > 1e-3
