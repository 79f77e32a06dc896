"""A trial's record is plain data, and all that the learner is told."""

import json
from dataclasses import replace

import numpy as np
import pytest

from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import ServeOutcome, ServeTrial, serve_outcome


@pytest.fixture(scope="module")
def trial(serve_task: ServeTask) -> ServeTrial:
    trial = serve_task.execute(serve_task.via_points, seed=0)
    assert isinstance(trial, ServeTrial)
    return trial


def test_a_record_survives_json_to_the_bit(trial: ServeTrial) -> None:
    record = trial.record()
    assert json.loads(json.dumps(record, allow_nan=False)) == record


def test_a_record_says_what_a_line_of_the_run_needs(trial: ServeTrial) -> None:
    record = trial.record()
    assert record["outcome"] == "landed"
    assert record["d"] == pytest.approx(
        np.linalg.norm(np.subtract(record["T_H"], record["T_Hd"])), abs=1e-15
    )
    assert record["landing_error"] == pytest.approx(
        np.linalg.norm(np.subtract(record["T_G"], record["T_Gd"])), abs=1e-15
    )
    assert [event["name"] for event in record["events"]] == ["release", "hit", "landing"]
    for event in record["events"]:
        assert set(event) == {
            "name",
            "time",
            "ball_position",
            "ball_velocity",
            "racket_position",
            "racket_velocity",
        }


def test_the_learner_is_told_the_same_from_the_record_as_read_back(trial: ServeTrial) -> None:
    for record in (trial.record(), json.loads(json.dumps(trial.record()))):
        outcome = serve_outcome(record)
        np.testing.assert_array_equal(outcome.realized["T_H"], trial.happened.meeting)
        np.testing.assert_array_equal(outcome.realized["T_G"], trial.happened.landing)
        np.testing.assert_array_equal(outcome.desired["T_H"], trial.happened.desired_meeting)
        np.testing.assert_array_equal(outcome.desired["T_G"], trial.happened.goal)
        assert outcome.success is trial.happened.success
        error = outcome.error("T_H")
        assert error is not None
        assert np.linalg.norm(error) == pytest.approx(trial.happened.d)


def test_a_ball_still_in_the_cup_says_nothing_of_the_throw(trial: ServeTrial) -> None:
    nowhere = replace(trial.happened, landing=None)
    kept = replace(trial, ending=ServeOutcome.NOT_RELEASED, flights=(), events=(), happened=nowhere)
    outcome = serve_outcome(kept.record())
    assert outcome.error("T_H") is None
    assert outcome.error("T_G") is None


@pytest.mark.parametrize("ending", [ServeOutcome.MISSED, ServeOutcome.CAUGHT_BEHIND])
def test_a_miss_says_where_the_ball_was(trial: ServeTrial, ending: ServeOutcome) -> None:
    missed = replace(
        trial,
        ending=ending,
        flights=trial.flights[:1],
        events=trial.events[:1],
        happened=replace(trial.happened, landing=None),
    )
    outcome = serve_outcome(missed.record())
    np.testing.assert_array_equal(outcome.realized["T_H"], trial.happened.meeting)
    assert outcome.error("T_G") is None
    assert missed.happened.landing_error is None
    assert missed.record()["landing_error"] is None
    assert "goal" not in missed.summary()


def test_a_refused_movement_says_nothing(serve_task: ServeTask) -> None:
    refused = serve_task.execute(serve_task.via_points.moved(["z3"], [1.0]), seed=0)
    record = json.loads(json.dumps(refused.record()))
    assert (record["outcome"], record["success"]) == ("unreachable", False)
    assert record["reason"].startswith("via-point 3 is out of reach")
    assert refused.summary() == record["reason"]
    outcome = serve_outcome(record)
    assert outcome.error("T_H") is None
    assert outcome.error("T_G") is None
    assert not outcome.success


def test_the_balls_path_runs_through_cup_throw_and_shot(trial: ServeTrial) -> None:
    release, hit, landing = (event.time for event in trial.events)
    np.testing.assert_array_equal(trial.ball_path([0.1]), trial.path.carried(np.array([0.1])))
    middle = (release + hit) / 2
    np.testing.assert_array_equal(trial.ball_path(middle)[0], trial.flights[0].position(middle))
    middle = (hit + landing) / 2
    np.testing.assert_array_equal(trial.ball_path(middle)[0], trial.flights[1].position(middle))
    times = np.linspace(0, trial.end, 500)
    steps = np.linalg.norm(np.diff(trial.ball_path(times), axis=0), axis=1)
    assert steps.max() < 8.0 * times[1]  # [m]: never faster than 8 m/s


def test_it_ends_when_there_is_nothing_more_to_see(trial: ServeTrial) -> None:
    assert trial.end == max(trial.motion.end, trial.events[-1].time)
    empty = replace(trial, events=())
    assert empty.end == trial.motion.end


def test_the_summary_is_one_line_of_figures(trial: ServeTrial) -> None:
    summary = trial.summary()
    assert summary.startswith(f"landed, d = {100 * trial.happened.d:.1f} cm, ")
    assert f"{100 * trial.happened.landing_error:.1f} cm from the goal's centre" in summary
    assert "\n" not in summary
    clamped = replace(trial, saturated=("EB", "WR"), beyond_limits=("SFE",)).summary()
    assert "torque clamped: EB WR" in clamped
    assert "beyond limits: SFE" in clamped
