"""Another arm than the serve's: the same code reads it, poses it, moves it and serves with it."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from touching import WITH_POINTER, pointer_arm

from drake_viapoint.errors import UnreachableError
from drake_viapoint.motion.orientation import zyz_from_rotation
from drake_viapoint.packages import resolve
from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.inverse_kinematics import InverseKinematics
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.tasks.catalogue import build_task, task_scenario
from drake_viapoint.tasks.trial import UNREACHABLE, RefusedTrial

SERVING = {
    "robot.directives": "package://drake_viapoint/six_joint_arm_with_racket.dmd.yaml",
    "scene": "package://drake_viapoint/six_joint_serve.dmd.yaml",
}
"""What a serve's scenario needs to be told of it."""


@pytest.fixture(scope="module")
def six() -> Arm:
    return pointer_arm()


def test_it_is_another_arm(six: Arm, arm: Arm) -> None:
    assert six.joint_names == ("J1", "J2", "J3", "J4", "J5", "J6")
    assert (six.num_joints, arm.num_joints) == (6, 7)
    for ours, theirs in zip(six.limits, arm.limits, strict=True):
        assert np.all(np.isfinite(ours))
        assert set(ours) != set(theirs)
    assert np.all((six.limits.lower < six.rest) & (six.rest < six.limits.upper))


def test_the_pointer_rests_level_and_points_forward(six: Arm) -> None:
    rest = six.tool_pose(six.rest)
    assert_allclose(rest.rotation[:, 2], [0.0, 1.0, 0.0], atol=1e-12)
    flange = six.joint_positions(six.rest)[-2]  # the last joint
    assert_allclose(rest.position - flange, [0.0, 0.03 + 0.2, 0.0], atol=1e-12)


def test_wrist_axes_meet_in_a_point(six: Arm) -> None:
    """So J4 to J6 leave one point of the forearm where it is, whatever they do."""
    rng = np.random.default_rng(0)
    for _ in range(20):
        q = rng.uniform(six.limits.lower, six.limits.upper)
        turned = q.copy()
        turned[3:] = rng.uniform(six.limits.lower[3:], six.limits.upper[3:])
        one, other = six.joint_positions(q), six.joint_positions(turned)
        assert_allclose(one[4], other[4], atol=1e-12)


def test_the_pose_of_any_posture_is_met_again(six: Arm) -> None:
    rng = np.random.default_rng(1)
    ik = InverseKinematics(six, six.rest)
    postures = rng.uniform(six.limits.lower, six.limits.upper, (12, 6))
    poses = [six.tool_pose(q) for q in postures]
    found = ik.solve([p.rotation for p in poses], [p.position for p in poses], ["pose"] * 12)
    assert np.all((found >= six.limits.lower) & (found <= six.limits.upper))
    for pose, q in zip(poses, found, strict=True):
        again = six.tool_pose(q)
        assert_allclose(again.position, pose.position, atol=1e-4)
        assert_allclose(again.rotation, pose.rotation, atol=2e-4)


def test_what_is_too_far_is_refused_with_how_far(six: Arm) -> None:
    """From the axis of J2 the wrist's centre reaches 0.68 m, and the tip 0.3 m further."""
    rest = six.tool_pose(six.rest)
    shoulder = six.joint_positions(six.rest)[1]
    longest = np.hypot(0.34, 0.03) + 0.34 + 0.07 + 0.03 + 0.2
    beyond = np.array([0.0, 0.1, 0.0])
    far = shoulder + [0.0, longest, 0.0] + beyond
    with pytest.raises(UnreachableError, match=r"^far is out of reach: missed by \d+") as caught:
        InverseKinematics(six, six.rest).solve([rest.rotation], [far], ["far"])
    assert caught.value.distance > 0.1 - 1e-9
    assert "\n" not in str(caught.value)


def test_reflected_inertia_of_the_motors_is_felt(six: Arm) -> None:
    """What the URDF says of rotors and gears is on the diagonal of the mass matrix."""
    bare = pointer_arm().plant
    motors = np.array([0.3] * 3 + [0.02] * 3)
    context, own = six.plant.CreateDefaultContext(), bare.CreateDefaultContext()
    for index in bare.GetJointActuatorIndices():
        bare.get_joint_actuator(index).SetRotorInertia(own, 0.0)
    felt = six.plant.CalcMassMatrix(context) - bare.CalcMassMatrix(own)
    assert_allclose(felt, np.diag(motors), atol=1e-12)
    assert np.all(np.linalg.eigvalsh(bare.CalcMassMatrix(own)) > 0)


@pytest.fixture(scope="module")
def serving() -> Any:
    return build_task(task_scenario("serve", changes=SERVING))


def test_the_racket_rests_as_in_the_other_hand(serving: Any, arm: Arm) -> None:
    six, seven = (a.tool_pose(a.rest) for a in (serving.scene.arm, arm))
    assert_allclose(six.rotation, seven.rotation, atol=1e-12)
    assert_allclose(six.position, seven.position, atol=1e-4)
    assert_allclose(zyz_from_rotation(six.rotation), [0.0, np.pi / 2, 0.0], atol=1e-12)


def test_it_serves_from_the_same_demonstration(serving: Any) -> None:
    first = serving.execute(serving.via_points, 0)
    assert [event.name for event in first.events] == ["release", "hit", "landing"]
    assert first.saturated == ()
    assert first.beyond_limits == ()
    assert first.happened.landing_error > 0.125, "there is something to learn"
    assert serving.retargeting.first.angles.shape[1] == 6


def test_it_learns_the_serve(serving: Any) -> None:
    log = MemoryLog("six joints")
    result = learn(serving, log, seed=0, max_trials=60)
    assert result.learned_at is not None
    assert result.learned_at <= 40
    assert log.trials[-1]["landing_error"] < 0.125


def test_a_serve_too_far_for_it_is_refused_by_name(serving: Any) -> None:
    far = serving.via_points.moved(["y6"], [1.0])
    refused = serving.execute(far, 0)
    assert isinstance(refused, RefusedTrial)
    assert refused.outcome == UNREACHABLE
    assert refused.reason.startswith("via-point 6 is out of reach: missed by ")


def test_the_models_name_one_another_by_address() -> None:
    assert resolve(WITH_POINTER).is_file()
    text = resolve(SERVING["scene"]).read_text()
    assert SERVING["robot.directives"] in text
