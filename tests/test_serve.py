"""The task that the learner sees: subtasks as the paper has them, trials as pure functions."""

import copy

import numpy as np
import pytest

from drake_viapoint.errors import ScenarioError
from drake_viapoint.learning.ask_tell import Purpose
from drake_viapoint.learning.gain import ConstantGain
from drake_viapoint.learning.learner import Learner
from drake_viapoint.tasks.serve import ServeTask, serve_subtasks
from drake_viapoint.tasks.serve_scenario import ServeLearning, ServeScenario
from drake_viapoint.tasks.serve_trial import STRIKE, THROW
from drake_viapoint.tasks.trial import RefusedTrial, Task, Trial


def test_a_serve_is_a_task(serve_task: ServeTask) -> None:
    task: Task = serve_task
    trial: Trial = task.execute(task.via_points, seed=0)
    assert task.name == "serve"
    assert (task.successes, task.repeats) == (3, 5)
    assert task.outcome(trial.record()).realized.keys() == {THROW, STRIKE}


def test_throw_then_strike(serve_task: ServeTask) -> None:
    throw, strike = serve_task.subtasks
    assert (throw.name, throw.task_variable) == ("throw", THROW)
    assert throw.control == ("x3", "y3", "z3", "x4", "y4", "z4")
    assert throw.perturbation == (0.01,) * 6
    assert throw.gain == ConstantGain(0.5)
    assert (strike.name, strike.task_variable) == ("strike", STRIKE)
    assert strike.control == ("phi6", "phi7", "psi7")
    assert strike.perturbation == pytest.approx((np.radians(1),) * 3)
    assert strike.gate == 0.1
    assert [strike.gain(d) for d in (0.0, 0.05, 0.075, 0.1, 0.2)] == pytest.approx(
        [0.4, 0.4, 0.2, 0.0, 0.0]
    )


def test_subtasks_follow_the_scenario() -> None:
    learning = ServeLearning()
    learning.strike.control = ["phi6", "theta6", "psi6"]
    learning.throw.gain, learning.throw.reached = 0.3, 0.02
    learning.throw.control = ["x3", "psi4", "z4"]
    learning.position_perturbation, learning.angle_perturbation = 0.02, 0.05
    throw, strike = serve_subtasks(learning)
    assert throw.perturbation == (0.02, 0.05, 0.02)
    assert strike.perturbation == (0.05,) * 3
    assert strike.control == ("phi6", "theta6", "psi6")
    assert throw.gain(0.0) == 0.3
    assert throw.reached == 0.02


def test_the_first_trial_lands_but_does_not_succeed(serve_task: ServeTask) -> None:
    """There is something to learn, and something to learn from."""
    record = serve_task.execute(serve_task.via_points, seed=0).record()
    assert record["outcome"] == "landed"
    assert not record["success"]
    assert record["d"] < 0.1


def test_the_seed_changes_nothing_where_nothing_is_drawn(serve_task: ServeTask) -> None:
    one, other = (serve_task.execute(serve_task.via_points, seed=seed) for seed in (0, 7))
    assert one.record() == other.record()


def test_a_movement_out_of_reach_is_refused_and_counted(serve_task: ServeTask) -> None:
    trial = serve_task.execute(serve_task.via_points.moved(["y7"], [0.5]), seed=0)
    assert isinstance(trial, RefusedTrial)
    learner = Learner(serve_task.via_points, serve_task.subtasks)
    learner.ask()
    record = serve_task.execute(serve_task.via_points, seed=0).record()
    learner.tell(serve_task.outcome(record))
    assert learner.ask().purpose is Purpose.EXPLORATION
    learner.tell(serve_task.outcome(trial.record()))
    assert learner.trials == 2


def test_a_trial_needs_all_its_components() -> None:
    scenario = ServeScenario()
    scenario.learning.throw.control = ["x3", "x9"]
    with pytest.raises(ScenarioError, match=r"^learning\.throw\.control: .* no component x9;"):
        ServeTask(scenario)


@pytest.mark.parametrize("hit_time", [-0.1, 0.0, 5.0, float("nan")])
def test_a_hit_beyond_the_movement_is_refused(hit_time: float) -> None:
    scenario = ServeScenario()
    scenario.demonstration.hit_time = hit_time
    with pytest.raises(ScenarioError, match=r"demonstration\.hit_time"):
        ServeTask(scenario)


def test_a_scenario_beyond_its_bounds_is_refused() -> None:
    scenario = copy.deepcopy(ServeScenario())
    scenario.ball.mass = -0.058
    with pytest.raises(ScenarioError, match=r"ball\.mass must be positive, got -0\.058"):
        ServeTask(scenario)


def test_the_serve_is_learned_within_sixty_trials(serve_task: ServeTask) -> None:
    learner = Learner(serve_task.via_points, serve_task.subtasks, repeats=2)
    successes = []
    while not learner.finished and learner.trials < 60:
        proposal = learner.ask()
        record = serve_task.execute(proposal.via_points, seed=0).record()
        learner.tell(serve_task.outcome(record))
        successes.append(record["success"])
    assert learner.learned_at is not None
    assert not successes[0]
    assert successes[learner.learned_at - 3 : learner.learned_at] == [True] * 3
    # what is learned stays: nothing is random here
    assert successes[learner.learned_at :] == [True] * 2
    throw, strike = (learner.jacobians[name] for name in ("throw", "strike"))
    assert (throw.shape, strike.shape) == ((3, 6), (2, 3))
    assert np.linalg.matrix_rank(throw, tol=0.05) == 3
