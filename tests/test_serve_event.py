"""Serves in event execution: laws of mechanics, convergence, the same bits, every ending."""

import copy
import json
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from pydrake.systems.analysis import SimulatorConfig

from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.packages import models_path
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.held_racket import HeldRacket
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_event import EventExecution
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_scene import ServeScene
from drake_viapoint.tasks.serve_trial import BallEvent, ServeOutcome, ServeTrial


def executed(task: ServeTask, via_points: ViaPoints | None = None) -> ServeTrial:
    trial = task.execute(task.via_points if via_points is None else via_points, seed=0)
    assert isinstance(trial, ServeTrial), trial.summary()
    return trial


def shrunk(via_points: ViaPoints, share: float) -> ViaPoints:
    """A smaller movement about the same middle."""
    middle = via_points.values.mean(axis=0)
    return replace(via_points, values=middle + share * (via_points.values - middle))


def event(trial: ServeTrial, name: str) -> BallEvent:
    return next(event for event in trial.events if event.name == name)


@pytest.fixture(scope="module")
def movement(serve_task: ServeTask) -> JointMovement:
    return serve_task.retargeting(serve_task.via_points)


@pytest.fixture(scope="module")
def trial(serve_task: ServeTask, movement: JointMovement) -> ServeTrial:
    return serve_task.execution.execute(movement)


def variants(task: ServeTask) -> list[ViaPoints]:
    """Via-points as learning visits them: the first, an exploration of each kind, a later one."""
    first = task.via_points
    return [
        first,
        first.moved(["z3"], [0.01]),
        first.moved(["psi7"], [-0.0175]),
        first.moved(["x3", "y4", "z4", "phi6"], [0.03, -0.02, 0.02, 0.1]),
    ]


# accuracy


def with_simulator(task: ServeTask, config: SimulatorConfig) -> EventExecution:
    scenario = ServeScenario()
    scenario.simulator = config
    return EventExecution(scenario, task.scene, task.watched.hit_time)


@pytest.mark.parametrize(("tighter", "shorter"), [(100, 1), (10, 1), (1, 2), (100, 2)])
def test_a_tighter_integration_lands_at_the_same_place(
    serve_task: ServeTask, tighter: float, shorter: float
) -> None:
    """Ten times finer it must hold as well as a hundred times, or it would hold by luck."""
    config = copy.copy(ServeScenario().simulator)
    config.accuracy /= tighter
    config.max_step_size /= shorter
    fine = with_simulator(serve_task, config)
    for via_points in variants(serve_task):
        landing = executed(serve_task, via_points).happened.landing
        other = fine.execute(serve_task.retargeting(via_points)).happened.landing
        assert landing is not None
        assert other is not None
        assert np.linalg.norm(landing - other) < 1e-4  # [m]; measured 3e-5


# the same bits


def test_a_trial_is_the_same_whatever_came_before(serve_task: ServeTask) -> None:
    for via_points in variants(serve_task):
        before = json.dumps(executed(serve_task, via_points).record())
        executed(serve_task, serve_task.via_points.moved(["x3", "z4"], [0.02, -0.03]))
        executed(serve_task, shrunk(serve_task.via_points, 0.1))
        assert json.dumps(executed(serve_task, via_points).record()) == before


def test_a_trial_is_the_same_in_a_new_process(serve_task: ServeTask) -> None:
    program = (
        "import json\n"
        "from drake_viapoint.tasks.serve import ServeTask\n"
        "from drake_viapoint.tasks.serve_scenario import ServeScenario\n"
        "task = ServeTask(ServeScenario())\n"
        "moved = task.via_points.moved(['x3', 'phi6'], [0.01, 0.05])\n"
        "print(json.dumps([task.execute(v, 0).record() for v in (moved, task.via_points)]))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        check=True,
        capture_output=True,
        text=True,
        cwd=Path(__file__).parent.parent,
    )
    moved = serve_task.via_points.moved(["x3", "phi6"], [0.01, 0.05])
    here = [
        executed(serve_task, via_points).record() for via_points in (serve_task.via_points, moved)
    ]
    assert json.loads(done.stdout) == here[::-1]


# the ball


def test_release_hit_and_landing_in_order(trial: ServeTrial) -> None:
    assert [event.name for event in trial.events] == ["release", "hit", "landing"]
    assert all(before.time < after.time for before, after in pairwise(trial.events))
    assert trial.ending is ServeOutcome.LANDED


def test_the_ball_leaves_the_cup_where_its_push_vanishes(
    serve_task: ServeTask, trial: ServeTrial
) -> None:
    """As the racket's motion alone tells it; the integrator's root and the path's own agree."""
    release = event(trial, "release")
    racket = HeldRacket(serve_task.scene.arm, trial.motion)
    carrying = trial.motion.segments[0]
    until = replace_end(racket, float(carrying.times[-1]))
    times = np.linspace(0.0, release.time - 1e-3, 200)
    assert np.all(serve_task.scene.cup.support(until, times) > 0)
    just_before = serve_task.scene.cup.support(until, [release.time - 1e-4])
    assert 0 < just_before[0] < 0.05
    carried = serve_task.scene.cup.ball(racket, [release.time])
    np.testing.assert_array_equal(release.ball_position, carried.position[0])
    np.testing.assert_array_equal(release.ball_velocity, carried.velocity[0])


def replace_end(racket: HeldRacket, end: float) -> HeldRacket:
    """The racket while it carries the ball: its acceleration jumps when the weight is gone."""

    class Carrying(HeldRacket):
        @property
        def end(self) -> float:
            return end

    return Carrying(racket.arm, racket.motion)


def test_the_ball_is_nowhere_torn_from_its_path(trial: ServeTrial) -> None:
    for name in ("release", "hit"):
        time = event(trial, name).time
        before, at, after = trial.ball_path([time - 1e-9, time, time + 1e-9])
        assert np.linalg.norm(after - before) < 2e-8  # [m] at 5 m/s
        np.testing.assert_allclose(at, event(trial, name).ball_position, atol=1e-12)
    thrown, struck = trial.flights
    np.testing.assert_allclose(thrown.position(struck.start), struck.position(struck.start))


def test_between_its_events_the_ball_only_falls(trial: ServeTrial) -> None:
    for flight, end in zip(trial.flights, [trial.flights[1].start, trial.end], strict=True):
        times = np.linspace(flight.start, end, 50)
        dt = (times - flight.start)[:, None]
        v = flight.velocity(flight.start)
        path = flight.position(flight.start) + v * dt - [0, 0, GRAVITY / 2] * dt**2
        np.testing.assert_allclose(trial.ball_path(times)[:-1], path[:-1], atol=1e-9)


def test_the_face_strikes_along_its_normal(serve_task: ServeTask, trial: ServeTrial) -> None:
    time = event(trial, "hit").time
    state = HeldRacket(serve_task.scene.arm, trial.motion)([time])
    normal = state.normal[0]
    centre = trial.flights[0].position(time)
    ball = serve_task.scenario.ball
    # one radius in front of the face, within the oval
    local = state.rotation[0].T @ (centre - state.position[0])
    assert local[1] == pytest.approx(ball.radius, abs=1e-11)
    assert (local[0] / 0.115) ** 2 + (local[2] / 0.155) ** 2 < 1
    before, after = trial.flights[0].velocity(time), trial.flights[1].velocity(time)
    np.testing.assert_allclose(np.cross(normal, after - before), 0, atol=1e-12)
    surface = state.point_velocity((centre - ball.radius * normal)[None])[0]
    approach = normal @ (before - surface)
    assert approach < -1
    assert normal @ (after - surface) == pytest.approx(-ball.restitution * approach, abs=1e-12)


def test_it_lands_at_the_height_of_the_ring(serve_task: ServeTask, trial: ServeTrial) -> None:
    landing = event(trial, "landing")
    assert landing.ball_position[2] == pytest.approx(serve_task.scene.ring[2], abs=1e-12)
    assert landing.ball_velocity[2] < 0
    np.testing.assert_array_equal(trial.happened.landing, landing.ball_position[:2])
    np.testing.assert_array_equal(trial.happened.goal, serve_task.scene.ring[:2])


def test_the_meeting_is_where_ball_and_face_are_at_the_time_of_the_hit(
    serve_task: ServeTask, trial: ServeTrial
) -> None:
    state = HeldRacket(serve_task.scene.arm, trial.motion)([trial.hit_time])
    np.testing.assert_array_equal(trial.happened.meeting, trial.flights[0].position(trial.hit_time))
    np.testing.assert_allclose(
        trial.happened.desired_meeting,
        state.position[0] + 0.033 * state.rotation[0][:, 1],
        atol=1e-12,
    )
    assert trial.happened.d == pytest.approx(
        np.linalg.norm(trial.happened.meeting - trial.happened.desired_meeting)
    )


def test_drag_shortens_the_shot_by_centimetres(
    serve_task: ServeTask, movement: JointMovement, trial: ServeTrial
) -> None:
    scenario = ServeScenario()
    scenario.ball.drag_coefficient = 0.507
    execution = EventExecution(scenario, serve_task.scene, serve_task.watched.hit_time)
    slowed = execution.execute(movement)
    assert trial.happened.landing is not None
    assert slowed.happened.landing is not None
    assert 0.02 < trial.happened.landing[1] - slowed.happened.landing[1] < 0.10
    assert slowed.events[0].record() == trial.events[0].record()


def test_the_tracking_error_is_the_largest_at_a_step(
    movement: JointMovement, trial: ServeTrial
) -> None:
    off = [np.abs(s.q - movement.trajectory(s.times)).max() for s in trial.motion.segments]
    assert trial.tracking_error == pytest.approx(max(off), abs=1e-12)
    assert 0 < trial.tracking_error < 0.03
    assert trial.record()["tracking_error"] == trial.tracking_error


def weak_arm(folder: Path, effort: float) -> str:
    """Directives of an arm whose elbow has another effort limit."""
    urdf = (models_path() / "arm/arm.urdf").read_text()
    limit = '<limit lower="0.05" upper="2.5" effort="60" velocity="12"/>'
    assert limit in urdf
    (folder / "arm.urdf").write_text(urdf.replace(limit, limit.replace("60", f"{effort:g}")))
    directives = (models_path() / "arm_with_racket.dmd.yaml").read_text()
    file = folder / "weak_arm.dmd.yaml"
    file.write_text(
        directives.replace("package://drake_viapoint/arm/arm.urdf", f"file://{folder}/arm.urdf")
    )
    return str(file)


def test_a_saturated_trial_says_so(
    serve_task: ServeTask, movement: JointMovement, trial: ServeTrial, tmp_path: Path
) -> None:
    scenario = ServeScenario()
    scenario.robot.directives = weak_arm(tmp_path, effort=12.0)
    execution = EventExecution(scenario, ServeScene(scenario), serve_task.watched.hit_time)
    weak = execution.execute(movement)
    assert weak.saturated == ("EB",)
    assert weak.record()["saturated"] == ["EB"]
    assert "torque clamped: EB" in weak.summary()
    assert weak.tracking_error > 2 * trial.tracking_error
    assert trial.record()["saturated"] == []
    assert "clamped" not in trial.summary()
    # and again the same
    assert execution.execute(movement).record() == weak.record()


# how it can end


def test_not_released(serve_task: ServeTask) -> None:
    """Too small a movement never falls away under the ball."""
    trial = executed(serve_task, shrunk(serve_task.via_points, 0.1))
    assert trial.ending is ServeOutcome.NOT_RELEASED
    assert (trial.events, trial.flights, trial.happened.landing) == ((), (), None)
    assert not trial.happened.success
    assert trial.end == trial.motion.end
    carried = serve_task.scene.cup.ball(
        HeldRacket(serve_task.scene.arm, trial.motion), [trial.hit_time]
    )
    np.testing.assert_array_equal(trial.happened.meeting, carried.position[0])
    assert serve_task.outcome(trial.record()).realized == {"T_H": None, "T_G": None}


def test_released_too_late_counts_as_not_released(
    serve_task: ServeTask, movement: JointMovement, trial: ServeTrial
) -> None:
    """Had it been due while the ball was still in the cup, nothing is learned of the throw."""
    early = event(trial, "release").time - 0.05
    late = EventExecution(ServeScenario(), serve_task.scene, early).execute(movement)
    assert late.ending is ServeOutcome.NOT_RELEASED
    assert not late.happened.success
    assert [event.name for event in late.events] == ["release", "hit", "landing"]
    assert serve_task.outcome(late.record()).realized["T_H"] is None


def test_missed(serve_task: ServeTask) -> None:
    """Thrown too high, the ball is not yet down when the racket comes by."""
    trial = executed(serve_task, serve_task.via_points.moved(["z3", "z4"], [0.1, 0.1]))
    assert trial.ending is ServeOutcome.MISSED
    assert [event.name for event in trial.events] == ["release"]
    assert trial.happened.landing is None
    assert trial.happened.d > 0.15
    realized = serve_task.outcome(trial.record()).realized
    np.testing.assert_array_equal(realized["T_H"], trial.happened.meeting)
    assert realized["T_G"] is None


def test_caught_behind(serve_task: ServeTask) -> None:
    """The face turned down, and the ball falls on its back."""
    turned = serve_task.via_points.moved(["psi5", "psi6", "psi7", "psi8"], [-1.0] * 4)
    trial = executed(serve_task, turned.moved(["y5", "y6", "z6"], [0.1] * 3))
    assert trial.ending is ServeOutcome.CAUGHT_BEHIND
    assert [event.name for event in trial.events] == ["release", "caught_behind"]
    assert trial.happened.landing is None
    caught = event(trial, "caught_behind")
    state = HeldRacket(serve_task.scene.arm, trial.motion)([caught.time])
    height = state.normal[0] @ (caught.ball_position - state.position[0])
    assert height == pytest.approx(-0.033, abs=1e-10)


def test_landed_and_never_a_success_beyond_the_tolerances(
    serve_task: ServeTask, movement: JointMovement, trial: ServeTrial
) -> None:
    assert trial.ending is ServeOutcome.LANDED
    assert trial.happened.landing_error is not None
    tolerances = serve_task.scenario.learning
    inside = trial.happened.landing_error < tolerances.landing_tolerance
    assert trial.happened.success == (inside and trial.happened.d < tolerances.meeting_tolerance)
    lenient = ServeScenario()
    lenient.learning.landing_tolerance = trial.happened.landing_error + 1e-6
    lenient.learning.meeting_tolerance = trial.happened.d + 1e-6

    def success(scenario: ServeScenario) -> bool:
        execution = EventExecution(scenario, serve_task.scene, trial.hit_time)
        return execution.execute(movement).happened.success

    assert success(lenient)
    lenient.learning.landing_tolerance -= 2e-6
    assert not success(lenient)
    lenient.learning.landing_tolerance += 2e-6
    lenient.learning.meeting_tolerance -= 2e-6
    assert not success(lenient)


def test_fell_short(tmp_path: Path) -> None:
    """A ring hung higher than the struck ball ever comes."""
    high = tmp_path / "high.dmd.yaml"
    text = (models_path() / "serve.dmd.yaml").read_text()
    high.write_text(text.replace("[0.4, 2.35, 0.5]", "[0.4, 2.35, 4.0]"))
    scenario = ServeScenario()
    scenario.scene = str(high)
    task = ServeTask(scenario)
    assert task.scene.ring[2] == 4.0
    trial = executed(task)
    assert trial.ending is ServeOutcome.FELL_SHORT
    assert [event.name for event in trial.events] == ["release", "hit"]
    assert trial.happened.landing is None
    assert trial.happened.landing_error is None
    assert not trial.happened.success
    assert "fell short" in trial.summary()


def test_released_at_the_first_instant(
    serve_task: ServeTask, movement: JointMovement, tmp_path: Path
) -> None:
    """A cup upside down: the ball falls at once, and nothing breaks."""
    file = tmp_path / "upside_down.dmd.yaml"
    file.write_text(
        "directives:\n"
        "- add_directives: {file: package://drake_viapoint/serve.dmd.yaml}\n"
        "- add_frame:\n"
        "    name: upside_down\n"
        "    X_PF: {base_frame: racket::cup, rotation: !Rpy {deg: [180.0, 0.0, 0.0]}}\n"
    )
    scenario = ServeScenario()
    scenario.scene, scenario.robot.cup_frame = str(file), "upside_down"
    execution = EventExecution(scenario, ServeScene(scenario), serve_task.watched.hit_time)
    trial = execution.execute(movement)
    assert trial.ending is ServeOutcome.MISSED
    assert event(trial, "release").time == 0.0
    np.testing.assert_allclose(event(trial, "release").ball_velocity, 0, atol=1e-12)
    assert trial.happened.meeting[2] == pytest.approx(
        trial.flights[0].position(0.0)[2] - GRAVITY / 2 * trial.hit_time**2
    )


def test_a_joint_driven_out_of_its_range_is_named(serve_task: ServeTask) -> None:
    via_points = serve_task.via_points.moved(["z3", "z4"], [0.3, 0.3])
    trial = executed(serve_task, via_points)
    limits = serve_task.scene.arm.limits
    q = np.concatenate([segment.q for segment in trial.motion.segments])
    v = np.concatenate([segment.v for segment in trial.motion.segments])
    out = np.any((q < limits.lower) | (q > limits.upper) | (np.abs(v) > limits.speed), axis=0)
    names = serve_task.scene.arm.joint_names
    assert out.any()
    assert trial.beyond_limits == tuple(name for name, o in zip(names, out, strict=True) if o)
