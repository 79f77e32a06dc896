"""Poses are met, the nearest posture is chosen, limits hold, and what is out of reach says so."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_viapoint.errors import UnreachableError
from drake_viapoint.robot.arm import Arm, ToolPose
from drake_viapoint.robot.inverse_kinematics import InverseKinematics


@pytest.fixture(scope="module")
def ik(arm: Arm) -> InverseKinematics:
    return InverseKinematics(arm, arm.rest)


def miss(arm: Arm, q: NDArray, pose: ToolPose) -> tuple[float, float]:
    """Distance [m] and angle [rad] between the tool at q and a pose."""
    reached = arm.tool_pose(q)
    turn = Rotation.from_matrix(pose.rotation @ reached.rotation.T).magnitude()
    return float(np.linalg.norm(pose.position - reached.position)), float(turn)


def self_motion(arm: Arm, q: NDArray) -> NDArray:
    """Direction (k,) in which the joints can move and the tool stays."""
    return np.linalg.svd(arm.tool_jacobian(q))[2][-1]


def random_poses(arm: Arm, seed: int, n: int, share: float = 1.0) -> list[ToolPose]:
    """Poses of postures drawn from the middle ``share`` of every joint's range."""
    rng = np.random.default_rng(seed)
    middle = (arm.limits.lower + arm.limits.upper) / 2
    half = (arm.limits.upper - arm.limits.lower) / 2
    return [arm.tool_pose(middle + share * half * rng.uniform(-1, 1, 7)) for _ in range(n)]


def solve(ik: InverseKinematics, poses: list[ToolPose], near: NDArray | None = None) -> NDArray:
    return ik.solve(
        [pose.rotation for pose in poses],
        [pose.position for pose in poses],
        [f"pose {i}" for i in range(len(poses))],
        near,
    )


def test_every_reachable_pose_is_met_within_the_limits(arm: Arm, ik: InverseKinematics) -> None:
    """Postures from all over the joints' ranges, most of them far from the reference."""
    poses = random_poses(arm, seed=1, n=30)
    for q, pose in zip(solve(ik, poses), poses, strict=True):
        distance, angle = miss(arm, q, pose)
        assert distance < 1e-7
        assert angle < 1e-7
        assert np.all(q >= arm.limits.lower)
        assert np.all(q <= arm.limits.upper)


def test_the_reference_does_not_pull_along_the_self_motion(arm: Arm, ik: InverseKinematics) -> None:
    poses = random_poses(arm, seed=2, n=40, share=0.5)
    solutions = solve(ik, poses)
    inside = np.all((solutions > arm.limits.lower) & (solutions < arm.limits.upper), axis=1)
    assert inside.sum() > 30
    for q in solutions[inside]:
        assert abs(self_motion(arm, q) @ (q - arm.rest)) < 1e-8


def test_no_posture_along_the_self_motion_is_nearer(arm: Arm, ik: InverseKinematics) -> None:
    """Also where a limit holds: there the way to nearer postures leads out of it."""
    at_limit = 0
    for pose in random_poses(arm, seed=3, n=40):
        q = solve(ik, [pose])[0]
        null = self_motion(arm, q)
        for side in (-1e-3, 1e-3):
            try:
                moved = solve(ik, [pose], (q + side * null)[None])[0]
            except UnreachableError:
                continue
            if miss(arm, moved, pose)[0] < 1e-9 and np.linalg.norm(moved - q) > 5e-4:
                assert np.linalg.norm(moved - arm.rest) > np.linalg.norm(q - arm.rest) - 1e-6
        at_limit += bool(np.any((q == arm.limits.lower) | (q == arm.limits.upper)))
    assert at_limit > 2


def test_a_start_nearby_is_kept_to(arm: Arm, ik: InverseKinematics) -> None:
    """With postures to start from, theirs is the pull: at their own poses nothing moves."""
    rng = np.random.default_rng(4)
    postures = arm.rest + rng.uniform(-0.3, 0.3, (20, 7))
    poses = [arm.tool_pose(q) for q in postures]
    np.testing.assert_allclose(solve(ik, poses, postures), postures, atol=1e-12)
    moved = [ToolPose(pose.rotation, pose.position + 0.01) for pose in poses]
    for q, near, pose in zip(solve(ik, moved, postures), postures, moved, strict=True):
        assert miss(arm, q, pose)[0] < 1e-10
        assert abs(self_motion(arm, q) @ (q - near)) < 1e-9


@pytest.mark.parametrize("joint", [1, 2, 4, 5])
def test_a_joint_stops_at_its_limit_and_the_others_go_on(
    arm: Arm, ik: InverseKinematics, joint: int
) -> None:
    """The tool is led where one joint would carry it over its limit: no jump, nothing missed."""
    near = arm.rest.copy()
    near[joint] = arm.limits.upper[joint] - 0.02
    pose = arm.tool_pose(near)
    away = arm.tool_jacobian(near)[:, joint]
    before, held = near, 0
    for s in np.linspace(0, 0.15, 151):
        turn = Rotation.from_rotvec(s * away[:3]).as_matrix()
        goal = ToolPose(turn @ pose.rotation, pose.position + s * away[3:])
        q = solve(ik, [goal], near[None])[0]
        assert miss(arm, q, goal)[0] < 1e-9
        assert q[joint] <= arm.limits.upper[joint]
        assert np.max(np.abs(q - before)) < 0.01
        held += bool(q[joint] == arm.limits.upper[joint])
        before = q
    assert 20 < held < 151


def test_a_posture_nearby_is_found_or_none(arm: Arm, ik: InverseKinematics) -> None:
    """Another bend of the arm may meet the pose, too: a movement could not jump there."""
    rng = np.random.default_rng(6)
    lower, upper = arm.limits.lower, arm.limits.upper
    found = 0
    for _ in range(40):
        near = rng.uniform(lower, upper)
        stuck = rng.choice(7, size=2, replace=False)
        near[stuck] = np.where(rng.random(2) < 0.5, lower[stuck], upper[stuck])
        pose = arm.tool_pose(near)
        moved = ToolPose(pose.rotation, pose.position + 5e-3 * rng.normal(size=3))
        try:
            q = solve(ik, [moved], near[None])[0]
        except UnreachableError:
            continue
        found += 1
        assert np.max(np.abs(q - near)) < 0.5
    assert found > 10


def test_a_pose_does_not_feel_its_neighbours(arm: Arm, ik: InverseKinematics) -> None:
    poses = random_poses(arm, seed=5, n=10)
    together = solve(ik, poses)
    alone = np.array([solve(ik, [pose])[0] for pose in poses])
    np.testing.assert_array_equal(together, alone)
    moved = [ToolPose(pose.rotation, pose.position + 1e-3) for pose in poses[:12]]
    kept = [q for q, pose in zip(together, moved, strict=False) if reaches(ik, pose, q)]
    moved = [pose for q, pose in zip(together, moved, strict=False) if reaches(ik, pose, q)]
    assert len(moved) > 3
    np.testing.assert_array_equal(
        solve(ik, moved, np.array(kept)),
        [solve(ik, [pose], q[None])[0] for pose, q in zip(moved, kept, strict=True)],
    )


def reaches(ik: InverseKinematics, pose: ToolPose, near: NDArray) -> bool:
    try:
        solve(ik, [pose], near[None])
    except UnreachableError:
        return False
    return True


def test_beyond_the_length_of_the_arm(arm: Arm, ik: InverseKinematics) -> None:
    """Three metres in front of the shoulder: about three less the arm's length is missing."""
    pose = arm.tool_pose(arm.rest)
    far = np.array([0.0, 3.0, 1.2])
    with pytest.raises(UnreachableError, match="via-point 3 is out of reach: missed by") as caught:
        ik.solve(
            [pose.rotation, pose.rotation],
            [pose.position, far],
            ["via-point 2", "via-point 3"],
            [arm.rest, arm.rest],
        )
    error = caught.value
    assert error.label == "via-point 3"
    assert 1.5 < error.distance < 3.0
    assert f"{1e3 * error.distance:.1f} mm" in str(error)


@pytest.mark.parametrize("angle", [1.5, 2.5, 3.1])
def test_the_limits_that_stop_it_are_named(arm: Arm, ik: InverseKinematics, angle: float) -> None:
    """The face turned about the handle, further than the wrist and the shoulder can turn."""
    pose = arm.tool_pose(arm.rest)
    turned = pose.rotation @ Rotation.from_euler("z", angle).as_matrix()
    with pytest.raises(UnreachableError) as caught:
        ik.solve(turned[None], pose.position[None], ["via-point 5"], arm.rest[None])
    assert caught.value.at_limit
    for name, bound in caught.value.at_limit:
        joint = arm.joint_names.index(name)
        assert bound in (arm.limits.lower[joint], arm.limits.upper[joint])
        assert f"{name} at its limit {bound:g} rad" in str(caught.value)


def test_tolerances_decide_what_is_accepted(arm: Arm) -> None:
    pose = arm.tool_pose(arm.rest)
    up = pose.position + [0.0, 0.0, 3.0]
    generous = InverseKinematics(arm, arm.rest, position_tolerance=3.0, rotation_tolerance=4.0)
    assert generous.solve(pose.rotation[None], up[None], ["up"]).shape == (1, 7)
    with pytest.raises(UnreachableError):
        InverseKinematics(arm, arm.rest).solve(pose.rotation[None], up[None], ["up"])
