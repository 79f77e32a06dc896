"""Serves executed with contact, whole: what is read off the steps, and where balls land."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from contact_scenes import NOTHING_UNKNOWN, robot_scenario

from drake_viapoint.errors import BallFallsOutError
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import BallEvent, ServeOutcome, ServeTrial
from drake_viapoint.tasks.trial import RefusedTrial

KNOWN = {**NOTHING_UNKNOWN, "cameras.see": "truth"}


def contact_task(changes: dict[str, object] | None = None) -> ServeTask:
    return ServeTask(robot_scenario({**KNOWN, **(changes or {})}))


@pytest.fixture(scope="module")
def task() -> ServeTask:
    return contact_task()


@pytest.fixture(scope="module")
def trial(task: ServeTask) -> ServeTrial:
    trial = task.execute(task.via_points, seed=0)
    assert isinstance(trial, ServeTrial)
    return trial


def event(trial: ServeTrial, name: str) -> BallEvent:
    return next(event for event in trial.events if event.name == name)


def test_the_ball_is_carried_thrown_struck_and_lands(trial: ServeTrial) -> None:
    assert trial.ending is ServeOutcome.LANDED
    assert [event.name for event in trial.events] == ["release", "hit", "landing"]
    times = [event.time for event in trial.events]
    assert times == sorted(times)


def test_it_leaves_the_cup_later_than_by_events(trial: ServeTrial, serve_task: ServeTask) -> None:
    """The cup would have to pull it from the event's release on; its walls let go later."""
    by_events = serve_task.execute(serve_task.via_points, seed=0)
    assert isinstance(by_events, ServeTrial)
    late = event(trial, "release").time - event(by_events, "release").time
    assert 0 < late < 0.06


def test_at_the_release_ball_and_cup_part(task: ServeTask, trial: ServeTrial) -> None:
    release = event(trial, "release").time
    times = release + np.array([-0.02, 0.0, 0.02])
    state = trial.racket(times)
    cup = state.position + state.rotation @ task.scene.cup.centre
    away = np.linalg.norm(trial.ball_path(times) - cup, axis=1)
    assert away[0] < away[1] < away[2]
    assert away[1] < 0.033


def test_at_the_hit_the_ball_touches_the_strings(task: ServeTask, trial: ServeTrial) -> None:
    hit = event(trial, "hit")
    state = trial.racket([hit.time])
    local = state.rotation[0].T @ (hit.ball_position - state.position[0])
    assert abs(local[1]) == pytest.approx(0.033 + 0.002, abs=1e-5)
    robot = task.scenario.robot
    assert (local[0] / robot.half_width) ** 2 + (local[2] / robot.half_length) ** 2 < 1


def test_flights_are_those_of_the_path(trial: ServeTrial) -> None:
    thrown, struck = trial.flights
    start, end = event(trial, "release").time + 0.01, event(trial, "hit").time - 0.001
    between = np.linspace(start, end, 20)
    np.testing.assert_allclose(trial.ball_path(between), thrown.position(between), atol=1e-6)
    after = np.linspace(struck.start, event(trial, "landing").time, 20)
    np.testing.assert_allclose(trial.ball_path(after), struck.position(after), atol=1e-6)


def test_results_are_the_papers(task: ServeTask, trial: ServeTrial) -> None:
    happened = trial.happened
    assert trial.seen is None
    assert trial.told is happened
    meeting = trial.flights[0].position(trial.hit_time)
    np.testing.assert_array_equal(happened.meeting, meeting)
    state = trial.racket([trial.hit_time])
    wanted = state.position[0] + 0.033 * state.normal[0]
    np.testing.assert_allclose(happened.desired_meeting, wanted, atol=1e-15)
    fallen = trial.flights[1].fall_through(float(task.scene.ring[2]))
    assert fallen is not None
    np.testing.assert_allclose(happened.landing, trial.flights[1].position(fallen)[:2], atol=1e-6)


def test_the_arm_feels_the_ball(trial: ServeTrial) -> None:
    """What the ball gains at the strings the racket loses: it gives way by a good part of 1 m/s."""
    hit = event(trial, "hit").time
    normal = trial.racket([hit]).normal[0]
    before, after = trial.racket([hit - 0.001, hit + 0.008]).velocity @ normal
    assert before - after > 0.3


def test_the_face_gives_way_so_the_ball_is_slower_than_off_a_heavy_one(trial: ServeTrial) -> None:
    hit = event(trial, "hit")
    state = trial.racket([hit.time])
    normal, surface = state.normal[0], state.point_velocity(hit.ball_position[None])[0]
    approach = normal @ (trial.flights[0].velocity(hit.time) - surface)
    away = normal @ (trial.flights[1].velocity(hit.time) - surface)
    apparent = -away / approach
    assert 0.2 < apparent < 0.75  # hand-held about 0.4, held fast 0.85


def test_landings_are_a_smooth_function_of_a_component(task: ServeTask) -> None:
    changes = np.linspace(-0.02, 0.02, 9)
    landings = []
    for change in changes:
        trial = task.execute(task.via_points.moved(["z4"], [change]), seed=0)
        assert isinstance(trial, ServeTrial)
        landings.append(trial.happened.landing)
    found = np.array(landings)
    assert np.ptp(found, axis=0).min() > 0.03
    cubic = np.stack([np.polyval(np.polyfit(changes, c, 3), changes) for c in found.T], axis=1)
    assert np.max(np.linalg.norm(found - cubic, axis=1)) < 0.005


def test_a_pure_function_in_another_process(trial: ServeTrial, tmp_path: Path) -> None:
    program = (
        "import json, sys\n"
        f"sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
        "from test_serve_contact import contact_task\n"
        "task = contact_task()\n"
        "task.execute(task.via_points.moved(['x3'], [0.01]), seed=7)\n"
        "print(json.dumps(task.execute(task.via_points, seed=0).record()))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert json.loads(done.stdout) == json.loads(json.dumps(trial.record()))


def test_draws_of_a_trial_are_in_its_record(task: ServeTask, trial: ServeTrial) -> None:
    assert trial.record()["disturbed"] == {"mount": [0.0, 0.0, 0.0], "restitution": 1.0}
    loose = contact_task({"unknown.mount": 0.01, "unknown.restitution": 0.05})
    one, other = (loose.execute(task.via_points, seed=seed) for seed in (1, 2))
    assert one.record()["disturbed"] != other.record()["disturbed"]
    moved = np.subtract(one.record()["T_Hd"], trial.record()["T_Hd"])
    assert 1e-4 < np.linalg.norm(moved) < 0.03


def test_a_movement_without_a_throw_is_not_released(task: ServeTask) -> None:
    middle = task.via_points.values[0]
    still = task.via_points.values * 0.05 + middle * 0.95
    trial = task.execute(
        task.via_points.moved(task.via_points.components, (still - task.via_points.values).ravel()),
        seed=0,
    )
    assert isinstance(trial, ServeTrial)
    assert trial.ending is ServeOutcome.NOT_RELEASED
    assert trial.happened.landing is None
    assert task.outcome(trial.record()).error("T_H") is None


def test_a_ball_that_passes_by_is_missed(task: ServeTask) -> None:
    thrown_short = task.via_points.moved(["x5", "x6", "x7"], [0.3, 0.3, 0.2])
    trial = task.execute(thrown_short, seed=0)
    assert isinstance(trial, ServeTrial)
    assert trial.ending is ServeOutcome.MISSED
    assert trial.happened.d is not None
    assert trial.happened.d > 0.1
    assert trial.happened.landing is None
    assert [event.name for event in trial.events] == ["release"]
    assert len(trial.flights) == 1


def test_a_movement_that_begins_with_the_cup_on_its_side_spills_the_ball(task: ServeTask) -> None:
    trial = task.execute(task.via_points.moved(["psi1"], [-0.9]), seed=0)
    assert isinstance(trial, RefusedTrial)
    record = trial.record()
    assert (record["outcome"], record["success"], record["T_H"]) == ("spilt", False, None)
    assert record["reason"].startswith("the ball does not rest in the cup")
    outcome = task.outcome(record)
    assert outcome.error("T_H") is None
    assert not outcome.broken_off, "trying the same again would spill it again"


def test_a_failing_simulation_is_a_failed_trial_and_nothing_lingers() -> None:
    glass = contact_task({"contact.strings_stiffness": 1e14})
    trial = glass.execute(glass.via_points, seed=0)
    assert isinstance(trial, RefusedTrial)
    record = trial.record()
    assert (record["outcome"], record["success"], record["T_H"]) == ("failed", False, None)
    assert record["reason"].startswith("the simulation failed after 0.9")
    assert glass.outcome(record).broken_off


def test_a_first_pose_that_spills_the_ball_is_refused_at_once() -> None:
    with pytest.raises(BallFallsOutError, match="the ball does not rest in the cup"):
        contact_task({"robot.cup_frame": "handle"})  # opens towards the head, level
