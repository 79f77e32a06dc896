"""Tasks of an arm that follows a path, by way of one of ten lines: touch a place at a moment."""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from own_package import own_package
from touching import AHEAD, MOMENT, NOISE, ROBOT, SOFT, TIMES, WITH_POINTER, Touch, reach, touch

from drake_viapoint.errors import (
    ExtractionError,
    ModelFileError,
    OutcomeError,
    ScenarioError,
    UnreachableError,
    ViaPointsError,
)
from drake_viapoint.learning.ask_tell import Outcome
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.runs.run_folder import RunFolder
from drake_viapoint.tasks.arm_scene import ArmScene
from drake_viapoint.tasks.arm_task import ArmTask
from drake_viapoint.tasks.arm_trial import ArmTrial, Result
from drake_viapoint.tasks.arm_unknown import UnknownArm
from drake_viapoint.tasks.trial import FAILED, UNREACHABLE, RefusedTrial, Task

SEVEN = "package://drake_viapoint/arm_with_racket.dmd.yaml"


@pytest.fixture(scope="module")
def known() -> Touch:
    """With an arm that is as its controller believes."""
    return touch(unknown=UnknownArm())


@pytest.fixture(scope="module")
def task() -> Touch:
    return touch()


def test_it_is_a_task_like_any_other(task: Touch) -> None:
    learned: Task = task
    assert learned.name == "touch"
    assert [s.control for s in learned.subtasks] == [("x3", "y3", "z3")]
    assert (learned.successes, learned.repeats) == (3, 0)


# ---------------------------------------------------------------------------------- learning


@pytest.mark.parametrize("seed", range(5))
def test_it_is_learned_in_few_trials_on_any_robot(seed: int) -> None:
    task, log = touch(seed), MemoryLog("touch")
    result = learn(task, log, seed=seed, max_trials=40)
    first, *_, last = log.trials
    assert not first["success"], "there is something to learn"
    assert np.linalg.norm(np.subtract(first["T"], first["Td"])) > 0.005
    assert result.learned_at is not None
    assert 7 + task.successes - 1 <= result.learned_at <= 20
    assert np.linalg.norm(np.subtract(last["T"], last["Td"])) <= 0.005
    truth = task.execute(result.via_points, 0).tool(MOMENT).position
    assert np.linalg.norm(truth - task.place) < 0.005 + 3 * NOISE


def test_an_arm_that_is_as_believed_has_little_to_learn(known: Touch) -> None:
    trial = known.execute(known.via_points, 0)
    assert trial.success
    assert trial.tracking_error < 1e-3
    miss = trial.tool(MOMENT).position - known.place
    assert np.linalg.norm(miss) < 0.002, "via-points and retargeting alone"


def test_runs_go_on_in_a_folder_with_the_same_bits(tmp_path: Path) -> None:
    task, whole = touch(), MemoryLog("whole")
    learn(task, whole, seed=3, max_trials=11)
    with RunFolder.create(tmp_path / "run", "task: touch\n") as folder:
        learn(task, folder, seed=3, max_trials=4)
    with RunFolder.open(tmp_path / "run") as folder:
        learn(touch(), folder, seed=3, max_trials=11)
        assert list(folder.trials) == whole.trials


# ----------------------------------------------------------------------- trials: pure, honest


def test_a_trial_is_a_pure_function_of_via_points_and_seed(task: Touch) -> None:
    one = task.execute(task.via_points, 5).record()
    other = task.execute(task.via_points.moved(["z3"], [0.02]), 5).record()
    assert other["T"] != one["T"]
    assert task.execute(task.via_points, 5).record() == one
    assert touch().execute(task.via_points, 5).record() == one
    seen_again = task.execute(task.via_points, 6).record()
    assert seen_again["tracking_error"] == one["tracking_error"]
    assert 0 < np.linalg.norm(np.subtract(seen_again["T"], one["T"])) < 10 * NOISE


def test_another_seed_is_another_robot() -> None:
    places = [touch(s).execute(touch(s).via_points, 0).tool(MOMENT).position for s in (0, 1)]
    assert np.linalg.norm(places[0] - places[1]) > 1e-3


@pytest.mark.parametrize(
    "unknown",
    [{"inertia": 0.3}, {"viscous_friction": 0.02}, {"shift": 0.01}, {"turn": 0.1}],
    ids=lambda given: next(iter(given)),
)
def test_each_unknown_makes_the_tool_be_elsewhere(known: Touch, unknown: dict[str, float]) -> None:
    expected = known.execute(known.via_points, 0).tool(MOMENT)
    there = touch(unknown=UnknownArm(**unknown)).execute(known.via_points, 0).tool(MOMENT)
    turned = np.linalg.norm(there.rotation - expected.rotation)
    moved = np.linalg.norm(there.position - expected.position)
    assert (turned if "turn" in unknown else moved) > 2e-4


def test_the_tools_velocity_is_the_slope_of_its_path(task: Touch) -> None:
    tool = task.execute(task.via_points, 0).tool
    assert np.linalg.norm(tool.mount.translation()) > 1e-3
    for time in (0.3, 0.61, 1.2):
        ahead, back = (tool(time + h).position for h in (1e-5, -1e-5))
        assert_allclose(tool(time).velocity, (ahead - back) / 2e-5, atol=1e-6)
    for still in (-1.0, 2.0):
        assert not tool(still).velocity.any()
    assert_allclose(tool.path([2.0]), tool.path([tool.motion.end]))


def test_torques_are_clamped_at_the_efforts_and_speeds_reported() -> None:
    """The same reach in a quarter of the time."""
    scene = ArmScene(WITH_POINTER, "tip")
    path = reach(scene.arm.tool_pose(scene.arm.rest).position)

    class Hasty(Touch):
        def __init__(self) -> None:
            self.place = np.zeros(3)
            ArmTask.__init__(self, scene, TIMES / 8, path, via_points=5)

        def learns(self):
            return [self.correction("T", self.nearest(MOMENT / 8), tolerance=0.005)]

    trial = Hasty().execute(Hasty().via_points, 0)
    assert trial.saturated
    assert set(trial.saturated) | set(trial.beyond_limits) <= set(scene.arm.joint_names)
    assert trial.tracking_error > 0.01
    assert "torque clamped: " + " ".join(trial.saturated) in trial.summary()
    speeds = np.abs(np.concatenate([segment.v for segment in trial.motion.segments]))
    fast = scene.arm.named(np.any(speeds > scene.arm.limits.speed, axis=0))
    assert set(fast) <= set(trial.beyond_limits)


def test_a_record_says_what_happened_and_tells_it_again(task: Touch) -> None:
    trial = task.execute(task.via_points, 0)
    record = trial.record()
    assert record["outcome"] == ("succeeded" if trial.success else "missed")
    told: Outcome = task.outcome(record)
    assert_allclose(told.error("T"), trial.results["T"].error)
    assert told.success == trial.success


# ---------------------------------------------------------------------- refusals and mistakes


def test_what_is_out_of_reach_is_refused_and_told_as_nothing(task: Touch) -> None:
    refused = task.execute(task.via_points.moved(["y3"], [1.0]), 0)
    assert isinstance(refused, RefusedTrial)
    assert refused.outcome == UNREACHABLE
    assert refused.reason.startswith("via-point 3 is out of reach: missed by ")
    told = task.outcome(refused.record())
    assert told.error("T") is None
    assert not told.broken_off


def test_a_simulation_that_breaks_off_is_a_failed_trial(
    task: Touch, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise RuntimeError("steps\nare too short")

    monkeypatch.setattr(task.scene._stepping, "until_accepted", broken)
    failed = task.execute(task.via_points, 0)
    assert failed.record()["outcome"] == FAILED
    assert failed.summary().endswith("steps are too short")
    assert task.outcome(failed.record()).broken_off


def test_a_demonstration_out_of_reach_is_said_before_the_first_trial() -> None:
    class Far(Touch):
        def __init__(self, scene: ArmScene) -> None:
            self.place = np.zeros(3)
            ArmTask.__init__(self, scene, TIMES, reach(np.array([0.0, 1.5, 1.0])), via_points=5)

    with pytest.raises(UnreachableError, match=r"^via-point 1 is out of reach: missed by \d+"):
        Far(ArmScene(WITH_POINTER, "tip"))


def test_a_variable_that_is_not_measured() -> None:
    class Forgetful(Touch):
        def measure(self, _tool, _rng):
            return {"U": Result(np.zeros(3), np.zeros(3))}

    task = Forgetful(ArmScene(WITH_POINTER, "tip"))
    with pytest.raises(OutcomeError, match="touch: T was not measured, only U"):
        task.execute(task.via_points, 0)


@pytest.mark.parametrize(
    ("measured", "fault"),
    [
        ({"T": Result(np.zeros(2), np.zeros(3))}, "T: realized and desired .* (2,) and (3,)"),
        ({"T": Result(np.zeros((3, 1)), np.zeros(3))}, "T: realized .* got shape (3, 1)"),
        ({"T": Result(np.zeros(3), np.zeros((1, 3)))}, "T: desired .* got shape (1, 3)"),
        ({"T": Result(0.1, np.zeros(3))}, "T: realized .* got shape ()"),
        ({"T": Result(None, 0.1)}, "T: desired .* got shape ()"),
        ({"T": Result(np.zeros(0), np.zeros(0))}, "T: desired .* got shape (0,)"),
        ({"T": Result(["a", "b"], np.zeros(2))}, "T: realized .* got list"),
        ({"T": Result(np.zeros(2), np.zeros(2))}, "T must have 3 values, .* got shape (2,)"),
        ({"T": 0.1}, "T must be a Result(realized=..., desired=...), got float"),
        ({"T": np.zeros(3)}, "T must be a Result(realized=..., desired=...), got ndarray"),
        ({"T": Result(np.zeros(3), np.zeros(3)), "U": 1}, "U must be a Result(.*), got int"),
        (Result(np.zeros(3), np.zeros(3)), "measure must return results by name, got Result"),
        (None, "measure must return results by name, got NoneType"),
    ],
)
def test_what_is_measured_is_checked(measured: object, fault: str) -> None:
    class Odd(Touch):
        def learns(self):
            return [self.correction("T", self.nearest(MOMENT), tolerance=(0.005,) * 3)]

        def measure(self, _tool, _rng):
            return measured

    task = Odd(ArmScene(WITH_POINTER, "tip"))
    pattern = ".*".join(map(re.escape, fault.split(".*")))
    with pytest.raises(OutcomeError, match=f"^touch: {pattern}"):
        task.execute(task.via_points, 0)


def test_lists_are_vectors_too() -> None:
    class Listed(Touch):
        def measure(self, _tool, _rng):
            return {"T": Result([0.0, 0.0, 0.001], [0, 0, 0])}

    task = Listed(ArmScene(WITH_POINTER, "tip"))
    assert task.execute(task.via_points, 0).record()["success"]


def test_a_component_there_is_not() -> None:
    class Wrong(Touch):
        def learns(self):
            return [self.correction("T", ["x9"], tolerance=0.005)]

    with pytest.raises(ViaPointsError, match="no component 'x9'"):
        Wrong(ArmScene(WITH_POINTER, "tip"))


def test_models_and_unknowns_are_checked() -> None:
    with pytest.raises(ModelFileError, match="no frame named 'racket'"):
        ArmScene(WITH_POINTER, "racket")
    with pytest.raises(ModelFileError, match="no model has the joints J1, J2"):
        ArmScene(WITH_POINTER, "tip", surroundings=SEVEN)
    with pytest.raises(ScenarioError, match=r"unknown shift must be in \[0, 1\), got 1.5"):
        UnknownArm(shift=1.5)


def test_an_arm_in_a_package_of_ones_own_moves_the_same(tmp_path: Path) -> None:
    file = own_package(tmp_path) / "six_joint_arm_with_pointer.dmd.yaml"
    own = Touch(ArmScene(str(file), "tip"))
    shipped = Touch(ArmScene(WITH_POINTER, "tip"))
    trials = [it.execute(it.via_points, 0).record() for it in (own, shipped)]
    assert trials[0] == trials[1]


@pytest.mark.parametrize(
    ("times", "path"),
    [([], np.zeros((0, 3))), ([0.0, 1.0], np.zeros((2, 4)))],
    ids=["none", "four"],
)
def test_a_path_that_is_none(times: list[float], path: np.ndarray) -> None:
    class Bare(Touch):
        def __init__(self) -> None:
            ArmTask.__init__(self, ArmScene(WITH_POINTER, "tip"), times, path)

    with pytest.raises(ExtractionError):
        Bare()


# ------------------------------------------------------------------ what the base decides alone


def test_places_alone_keep_the_tools_orientation(task: Touch) -> None:
    assert np.ptp(task.via_points.values[:, 3:], axis=0).max() == 0
    assert_allclose(task.via_points.values[0, 3:5], np.pi / 2, atol=1e-12)


def test_poses_on_another_arm() -> None:
    """The seven-joint arm, with its racket, and a path that turns it."""
    scene = ArmScene(SEVEN, "racket")
    start = scene.arm.tool_pose(scene.arm.rest).position
    there = (reach(start) - start) / AHEAD  # 0 to 1 and back
    poses = np.hstack([start + 0.1 * there, [0.0, np.pi / 2, 0.0] + 0.2 * there])

    class Turn(ArmTask):
        name = "turn"

        def learns(self):
            control = self.nearest(MOMENT, ["phi", "psi"])
            return [self.correction("T", control, tolerance=(0.01, 0.02))]

        def measure(self, tool, _rng):
            normal = tool(MOMENT).rotation[:, 1]
            return {"T": Result(normal[[0, 2]], np.zeros(2))}

    task = Turn(scene, TIMES + 7.0, poses, via_points=5)
    assert task.via_points.times[[0, -1]].tolist() == pytest.approx([0.0, 1.6])
    assert task.subtasks[0].control == ("phi3", "psi3")
    assert learn(task, MemoryLog("turn"), seed=0, max_trials=40).learned_at is not None


def test_a_success_is_within_the_tolerance(task: Touch) -> None:
    def result(*error: float) -> dict[str, Result]:
        return {"T": Result(-np.array(error), np.zeros(len(error)))}

    assert task.succeeded(result(0.003, 0.003, 0.002))
    assert not task.succeeded(result(0.003, 0.003, 0.004)), "the length counts"
    assert not task.succeeded({"T": Result(None, np.zeros(3))})


def test_the_nearest_via_point_is_between_the_ends(task: Touch) -> None:
    for time, number in ((0.0, 2), (MOMENT, 3), (1.6, 4)):
        assert task.nearest(time, ("x", "phi")) == (f"x{number}", f"phi{number}")


@pytest.mark.parametrize("time", [-1.0, 1.7, 99.0, float("nan")])
def test_no_via_point_is_near_a_time_beyond_the_movement(task: Touch, time: float) -> None:
    with pytest.raises(ViaPointsError) as caught:
        task.nearest(time)
    assert str(caught.value) == (
        f"touch: no via-point is near {time:g} s, the movement is from 0 s to 1.6 s"
    )


def test_what_stands_around_changes_nothing(task: Touch, tmp_path: Path) -> None:
    around = tmp_path / "around.dmd.yaml"
    around.write_text(
        f"directives:\n- add_directives:\n    file: {WITH_POINTER}\n"
        "- add_model:\n    name: goal\n    file: package://drake_viapoint/goal/goal.urdf\n"
        "- add_weld:\n    parent: world\n    child: goal::ring\n"
    )
    given = {"unknown": ROBOT, "natural_frequency": SOFT}
    scene = ArmScene(WITH_POINTER, "tip", surroundings=str(around), **given)
    trial = Touch(scene).execute(task.via_points, 0)
    assert isinstance(trial, ArmTrial)
    assert_allclose(trial.results["T"].realized, task.execute(task.via_points, 0).results["T"][0])


def test_an_arm_among_surroundings_is_the_controllers(tmp_path: Path) -> None:
    around = own_package(tmp_path) / "six_joint_arm_with_pointer.dmd.yaml"
    assert ArmScene(WITH_POINTER, "tip", surroundings=str(around)).arm.num_joints == 6
    text = around.read_text()
    assert "J2: [" in text
    around.write_text(text.replace("J2: [", "J2: [1"))
    with pytest.raises(ScenarioError, match="arm of surroundings: angle at rest of J2"):
        ArmScene(WITH_POINTER, "tip", surroundings=str(around))
