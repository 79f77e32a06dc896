"""The disturbance of section 3.2: its range, its independence, and its way into a serve."""

from typing import NoReturn

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.errors import ScenarioError
from drake_viapoint.runs.learning_run import trial_seed
from drake_viapoint.tasks.catalogue import TaskBuilder, task_scenario
from drake_viapoint.tasks.disturbance import Disturbance
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import BallEvent, ServeTrial
from drake_viapoint.tasks.trial import UNREACHABLE

SEEDS = [trial_seed(7, number) for number in range(1, 4001)]


@given(st.integers(0, 2**32 - 1), st.floats(0, 0.5), st.floats(0, 0.5))
def test_factors_stay_in_range_and_the_same_seed_draws_the_same(
    seed: int, release: float, bounce: float
) -> None:
    drawn = Disturbance(release, bounce).draw(seed)
    rounding = np.finfo(np.float64).eps
    assert np.all(np.abs(drawn.release - 1) <= release + rounding)
    assert np.all(np.abs(drawn.bounce - 1) <= bounce + rounding)
    again = Disturbance(release, bounce).draw(seed)
    np.testing.assert_array_equal(np.concatenate(drawn), np.concatenate(again))


def test_nothing_disturbed_is_exactly_one() -> None:
    assert np.concatenate(Disturbance(0.0, 0.0).draw(3)).tolist() == [1.0] * 6


def test_the_bounce_does_not_depend_on_the_range_at_release() -> None:
    one, other = Disturbance(0.0, 0.03).draw(5), Disturbance(0.1, 0.03).draw(5)
    np.testing.assert_array_equal(one.bounce, other.bounce)


def test_draws_are_even_and_independent() -> None:
    """Over the trial seeds of one run: uniform on +-3 %, no component follows another."""
    factors = np.array([np.concatenate(Disturbance(0.03, 0.03).draw(seed)) for seed in SEEDS])
    deviations = (factors - 1) / 0.03
    # of n uniform draws the mean and the variance stray by 1/sqrt(3n) and sqrt(4/45/n)
    n = len(SEEDS)
    assert np.all(np.abs(deviations.mean(axis=0)) < 5 / np.sqrt(3 * n))
    assert np.all(np.abs(deviations.var(axis=0) - 1 / 3) < 5 * np.sqrt(4 / 45 / n))
    correlations = np.corrcoef(deviations.T) - np.eye(6)
    assert np.all(np.abs(correlations) < 5 / np.sqrt(n))
    after = np.corrcoef(deviations[:-1, 0], deviations[1:, 0])[0, 1]  # from trial to trial
    assert abs(after) < 5 / np.sqrt(n)


@pytest.fixture(scope="module")
def disturbed(serve_task: ServeTask) -> ServeTask:
    changes = {"disturbance.release": 0.03, "disturbance.bounce": 0.02}
    scenario = task_scenario("serve", None, changes)
    return ServeTask(scenario, serve_task.watched, serve_task.scene)


def ball(trial: ServeTrial, name: str) -> BallEvent:
    return next(event for event in trial.events if event.name == name)


def serve(task: ServeTask, seed: int) -> ServeTrial:
    trial = task.execute(task.via_points, seed)
    assert isinstance(trial, ServeTrial)
    return trial


def test_the_ball_leaves_the_cup_with_its_velocity_scaled(
    serve_task: ServeTask, disturbed: ServeTask
) -> None:
    calm, trial = serve(serve_task, 3), serve(disturbed, 3)
    before, after = ball(calm, "release"), ball(trial, "release")
    assert after.time == before.time  # the arm does not feel it
    np.testing.assert_array_equal(after.ball_position, before.ball_position)
    np.testing.assert_array_equal(
        after.ball_velocity, before.ball_velocity * trial.disturbed.release
    )
    # and so it is elsewhere when it should be hit: by the parabola's law
    flown = trial.hit_time - after.time
    np.testing.assert_allclose(
        trial.happened.meeting - calm.happened.meeting,
        (after.ball_velocity - before.ball_velocity) * flown,
        atol=1e-12,
    )


def test_the_struck_ball_is_disturbed_as_well(serve_task: ServeTask) -> None:
    """Struck as without disturbance, as its release was left alone; it leaves otherwise."""
    scenario = task_scenario("serve", None, {"disturbance.bounce": 0.03})
    task = ServeTask(scenario, serve_task.watched, serve_task.scene)
    calm, trial = serve(serve_task, 11), serve(task, 11)
    before, after = ball(calm, "hit"), ball(trial, "hit")
    assert after.time == before.time
    np.testing.assert_array_equal(
        after.ball_velocity, before.ball_velocity * trial.disturbed.bounce
    )
    assert trial.happened.landing is not None
    assert calm.happened.landing is not None
    flown = ball(trial, "landing").time - after.time
    reached = after.ball_position[:2] + after.ball_velocity[:2] * flown
    np.testing.assert_allclose(trial.happened.landing, reached, atol=1e-10)
    assert not np.allclose(trial.happened.landing, calm.happened.landing, atol=1e-4)


def test_seeds_make_the_difference_and_nothing_else(disturbed: ServeTask) -> None:
    """Repeats reuse what the arm did; a task that has done nothing before gives the same bits."""
    records = [serve(disturbed, seed).record() for seed in (1, 2, 1)]
    assert records[0] == records[2] != records[1]
    fresh = ServeTask(disturbed.scenario)
    assert serve(fresh, 2).record() == records[1]


def test_another_movement_is_executed_anew(disturbed: ServeTask) -> None:
    moved = disturbed.via_points.moved(["z3"], [0.01])
    first = serve(disturbed, 1).record()
    between = disturbed.execute(moved, 1).record()
    assert between["T_H"] != first["T_H"]
    assert serve(disturbed, 1).record() == first


def test_a_refused_movement_is_refused_again_without_another_search(
    disturbed: ServeTask, monkeypatch: pytest.MonkeyPatch
) -> None:
    far = disturbed.via_points.moved(["y7"], [3.0])
    first = disturbed.execute(far, 1)
    assert first.record()["outcome"] == UNREACHABLE

    def search(_: object) -> NoReturn:
        raise AssertionError("searched again")

    with monkeypatch.context() as patched:
        patched.setattr(disturbed, "retargeting", search)
        assert disturbed.execute(far, 2).record() == first.record()
    serve(disturbed, 1)  # and what comes after is executed


def test_the_spread_it_sets(disturbed: ServeTask) -> None:
    """T_H strays as the law of uniform factors says: sd = v t range / sqrt(3) along each axis."""
    trials = [serve(disturbed, seed) for seed in SEEDS[:200]]
    release = ball(trials[0], "release")
    flown = trials[0].hit_time - release.time
    calm_velocity = release.ball_velocity / trials[0].disturbed.release
    expected = np.abs(calm_velocity) * flown * 0.03 / np.sqrt(3)
    spread = np.std([trial.happened.meeting for trial in trials], axis=0)
    np.testing.assert_allclose(spread, expected, rtol=0.2)


@pytest.mark.parametrize("name", ["release", "bounce"])
@pytest.mark.parametrize("value", [-0.01, 1.0, float("nan"), float("inf")])
def test_ranges_that_cannot_be(name: str, value: float) -> None:
    with pytest.raises(ScenarioError, match=rf"disturbance.{name} must be in \[0, 1\), got"):
        task_scenario("serve", None, {f"disturbance.{name}": value})


def test_it_changes_neither_scene_nor_demonstration() -> None:
    builder = TaskBuilder()
    calm = builder.build(task_scenario("serve"))
    rough = builder.build(task_scenario("serve", None, {"disturbance.release": 0.03}))
    assert isinstance(calm, ServeTask)
    assert isinstance(rough, ServeTask)
    assert rough.scene is calm.scene
    assert rough.watched is calm.watched
