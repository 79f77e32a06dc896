"""The joints move the tool along its path, and smoothly follow the via-points."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_viapoint.errors import RetargetingError, UnreachableError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.orientation import rotation_from_zyz
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.inverse_kinematics import InverseKinematics
from drake_viapoint.robot.retargeting import POSE_NAMES, JointMovement, Retargeting
from drake_viapoint.tasks.serve import ServeTask


@pytest.fixture(scope="module")
def ik(arm: Arm) -> InverseKinematics:
    return InverseKinematics(arm, arm.rest)


@pytest.fixture(scope="module")
def sweep() -> ViaPoints:
    """Up, across and turning: a movement nobody demonstrated."""
    values = [
        [0.55, 0.36, 0.95, 0.0, np.pi / 2, 0.0],
        [0.60, 0.45, 1.20, 0.1, np.pi / 2 - 0.1, 0.3],
        [0.45, 0.30, 1.05, -0.1, np.pi / 2 + 0.1, 0.5],
        [0.50, 0.50, 1.25, 0.1, np.pi / 2, 0.2],
    ]
    return ViaPoints(np.array([0.0, 0.4, 0.7, 1.1]), np.array(values), POSE_NAMES)


def straying(
    arm: Arm, via_points: ViaPoints, movement: JointMovement, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Distance [m] and angle [rad] from the Cartesian path, reckoned apart from the class."""
    path = minimum_jerk(via_points.times, via_points.values)(times)
    poses = [arm.tool_pose(q) for q in movement.trajectory(times)]
    wanted = Rotation.from_matrix(rotation_from_zyz(path[:, 3:]))
    reached = Rotation.from_matrix([pose.rotation for pose in poses])
    distance = np.linalg.norm([pose.position for pose in poses] - path[:, :3], axis=1)
    return distance, (wanted.inv() * reached).magnitude()


@pytest.mark.parametrize(("millimetres", "radians"), [(1.0, 1e-2), (0.2, 2e-3)])
def test_the_tool_keeps_to_its_path_within_the_thresholds(
    arm: Arm, ik: InverseKinematics, sweep: ViaPoints, millimetres: float, radians: float
) -> None:
    retargeting = Retargeting(
        ik, sweep, position_threshold=1e-3 * millimetres, rotation_threshold=radians
    )
    times = np.linspace(0, 1.1, 2001)
    distance, angle = straying(arm, sweep, retargeting.first, times)
    # it looks at 201 places; between them the tool can stray a little further
    assert distance.max() <= 1.03e-3 * millimetres
    assert angle.max() <= 1.03 * radians
    own = retargeting.straying(sweep, retargeting.first)
    assert own.distance.max() <= 1e-3 * millimetres
    np.testing.assert_allclose(
        straying(arm, sweep, retargeting.first, own.times), (own.distance, own.angle), atol=1e-8
    )


def test_supplemental_via_points_are_needed_and_suffice(
    ik: InverseKinematics, sweep: ViaPoints
) -> None:
    """Each is put where the tool strays most without it; the last one is not superfluous."""
    retargeting = Retargeting(ik, sweep)
    added = retargeting.supplemental_times
    assert added
    assert set(added).isdisjoint(sweep.times)
    np.testing.assert_array_equal(retargeting.first.times, np.sort([*sweep.times, *added]))
    kept = retargeting.first.times != added[-1]
    without = JointMovement(
        retargeting.first.times[kept],
        retargeting.first.angles[kept],
        minimum_jerk(retargeting.first.times[kept], retargeting.first.angles[kept]),
    )
    before = retargeting.straying(sweep, without)
    error = np.maximum(before.distance / 1e-3, before.angle / 1e-2)
    assert error.max() > 1
    assert before.times[np.argmax(error)] == added[-1]


def test_the_shipped_serve_starts_within_two_millimetres(serve_task: ServeTask) -> None:
    movement = serve_task.retargeting(serve_task.via_points)
    times = np.linspace(0, movement.times[-1], 1000)
    distance, angle = straying(serve_task.scene.arm, serve_task.via_points, movement, times)
    assert distance.max() < 2e-3
    assert angle.max() < 2e-2


def test_the_tool_passes_through_every_via_point(serve_task: ServeTask) -> None:
    moved = serve_task.via_points.moved(["x3", "phi6"], [0.03, -0.1])
    distance, angle = straying(
        serve_task.scene.arm, moved, serve_task.retargeting(moved), moved.times
    )
    assert distance.max() < 1e-9
    assert angle.max() < 1e-7


def test_the_first_movements_postures_are_kept_near_to(serve_task: ServeTask) -> None:
    """Their pull is what the redundant joint follows, along no via-point's self-motion."""
    moved = serve_task.via_points.moved(["x3", "z4", "phi6", "psi7"], [0.02, -0.02, 0.1, 0.1])
    first, movement = serve_task.retargeting.first, serve_task.retargeting(moved)
    arm = serve_task.scene.arm
    inside = np.all(
        (movement.angles > arm.limits.lower) & (movement.angles < arm.limits.upper), axis=1
    )
    assert inside.sum() > 10
    change = movement.angles - first.angles
    assert np.abs(change).max() > 0.05
    for q, along in zip(movement.angles[inside], change[inside], strict=True):
        self_motion = np.linalg.svd(arm.tool_jacobian(q))[2][-1]
        assert abs(self_motion @ along) < 1e-9


def test_the_first_movement_is_given_back(serve_task: ServeTask) -> None:
    again = serve_task.retargeting(serve_task.via_points)
    np.testing.assert_array_equal(again.times, serve_task.retargeting.first.times)
    np.testing.assert_allclose(again.angles, serve_task.retargeting.first.angles, atol=1e-12)


def test_times_stay_whatever_moves(serve_task: ServeTask) -> None:
    rng = np.random.default_rng(0)
    names = serve_task.via_points.components
    for _ in range(5):
        moved = serve_task.via_points.moved(names, rng.uniform(-0.02, 0.02, len(names)))
        movement = serve_task.retargeting(moved)
        np.testing.assert_array_equal(movement.times, serve_task.retargeting.first.times)


def test_a_smooth_function_of_every_component(serve_task: ServeTask) -> None:
    """Slopes from steps ten times apart agree: no search, no switch, no noise in between."""
    times = np.linspace(0, serve_task.via_points.times[-1], 100)
    worst = 0.0
    for component in serve_task.via_points.components:
        slopes = []
        for step in (1e-3, 1e-4):
            up, down = (
                serve_task.retargeting(serve_task.via_points.moved([component], [change]))
                for change in (step, -step)
            )
            slopes.append((up.trajectory(times) - down.trajectory(times)) / (2 * step))
        difference = np.max(np.abs(slopes[0] - slopes[1])) / np.max(np.abs(slopes[1]))
        worst = max(worst, float(difference))
    assert worst < 1e-3  # a hundredth is asked; measured 1.4e-5


def test_the_order_of_calls_does_not_matter(serve_task: ServeTask) -> None:
    moved = serve_task.via_points.moved(["x3", "z4"], [0.05, -0.05])
    first = serve_task.retargeting(moved)
    serve_task.retargeting(serve_task.via_points.moved(["y3"], [0.08]))
    again = serve_task.retargeting(moved)
    assert first.angles.tobytes() == again.angles.tobytes()
    assert first.trajectory.c.tobytes() == again.trajectory.c.tobytes()


def test_two_made_alike_are_alike(ik: InverseKinematics, sweep: ViaPoints) -> None:
    one, other = Retargeting(ik, sweep), Retargeting(ik, sweep)
    assert one.supplemental_times == other.supplemental_times
    assert one.first.angles.tobytes() == other.first.angles.tobytes()


def test_other_times_are_refused(serve_task: ServeTask) -> None:
    times = serve_task.via_points.times.copy()
    times[2] += 1e-3
    with pytest.raises(RetargetingError, match=r"at the times of the first movement: 0, 0\.3"):
        serve_task.retargeting(replace(serve_task.via_points, times=times))


def test_other_dimensions_are_refused(
    serve_task: ServeTask, ik: InverseKinematics, sweep: ViaPoints
) -> None:
    flat = ViaPoints(sweep.times, sweep.values[:, :3], ("x", "y", "z"))
    with pytest.raises(RetargetingError, match="x, y, z, phi, theta, psi, got x, y, z"):
        Retargeting(ik, flat)
    swapped = replace(serve_task.via_points, names=("y", "x", "z", "phi", "theta", "psi"))
    with pytest.raises(RetargetingError, match="must be poses"):
        serve_task.retargeting(swapped)


@pytest.mark.parametrize(("metres", "radians"), [(0.0, 1e-2), (-1e-3, 1e-2), (1e-3, np.nan)])
def test_thresholds_must_be_positive(
    ik: InverseKinematics, sweep: ViaPoints, metres: float, radians: float
) -> None:
    with pytest.raises(RetargetingError, match="must be positive"):
        Retargeting(ik, sweep, position_threshold=metres, rotation_threshold=radians)


def test_thresholds_that_cannot_be_met_say_how_near_it_came(
    ik: InverseKinematics, sweep: ViaPoints
) -> None:
    with pytest.raises(RetargetingError, match="supplemental via-points leave the tool"):
        Retargeting(ik, sweep, position_threshold=1e-9)


def test_a_via_point_out_of_reach_is_named(serve_task: ServeTask) -> None:
    """And not one of the supplemental via-points about it, which cannot be reached either."""
    with pytest.raises(UnreachableError, match=r"^via-point 3 is out of reach") as caught:
        serve_task.retargeting(serve_task.via_points.moved(["z3"], [1.0]))
    assert caught.value.distance > 0.3


def test_a_point_between_out_of_reach_is_named_by_its_time(serve_task: ServeTask) -> None:
    """The path overshoots behind a via-point that is just in reach."""
    far = serve_task.via_points.moved(["y7"], [0.12])
    label = r"^supplemental via-point at (\d\.\d{3}) s is out of reach"
    with pytest.raises(UnreachableError, match=label) as caught:
        serve_task.retargeting(far)
    time = float(caught.value.label.split()[-2])
    assert np.min(np.abs(np.array(serve_task.retargeting.supplemental_times) - time)) < 1e-3
