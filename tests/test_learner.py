"""The learner on maps whose answer is known: it converges, counts, waits at gates and backs off."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from drake_viapoint.errors import (
    LearningError,
    OutcomeError,
    OutcomeNotFiniteError,
    ViaPointsError,
)
from drake_viapoint.learning.ask_tell import Outcome, Proposal, Purpose
from drake_viapoint.learning.gain import ConstantGain, TaperedGain
from drake_viapoint.learning.learner import Learner
from drake_viapoint.learning.subtask import Subtask
from drake_viapoint.motion.via_points import ViaPoints

THROW = Subtask(
    "throw",
    ("x2", "y2", "x3"),
    "T_H",
    (0.01,) * 3,
    ConstantGain(0.5),
    regularization=1e-12,
    reached=0.02,
)
STRIKE = Subtask(
    "strike",
    ("y3", "x4"),
    "T_G",
    (0.02,) * 2,
    TaperedGain(0.4, 0.05, 0.1),
    regularization=1e-12,
    reached=0.0,
    gate=0.1,
)
CONTROL = (*THROW.control, *STRIKE.control)
Result = NDArray | None


def via_points() -> ViaPoints:
    return ViaPoints(np.arange(4.0), np.zeros((4, 2)), ("x", "y"))


@dataclass
class World:
    """What comes of S: T_H depends on throw and, a little, on strike; T_G on both."""

    throw: NDArray  # (2, 5)
    strike: NDArray  # (2, 5)
    goal_h: NDArray
    goal_g: NDArray
    bars: tuple[float, float] = (0.05, 0.02)
    lost: Callable[[NDArray], tuple[bool, bool]] = lambda _: (False, False)
    executed: list[NDArray] = field(default_factory=list)

    def __call__(self, proposal: Proposal) -> Outcome:
        s = proposal.via_points.select(CONTROL)
        self.executed.append(s)
        no_throw, no_strike = self.lost(s)
        t_h: Result = None if no_throw else self.throw @ s
        t_g: Result = None if no_throw or no_strike else self.strike @ s
        good = (
            t_h is not None
            and t_g is not None
            and np.linalg.norm(self.goal_h - t_h) < self.bars[0]
            and np.linalg.norm(self.goal_g - t_g) < self.bars[1]
        )
        return Outcome(
            {"T_H": t_h, "T_G": t_g}, {"T_H": self.goal_h, "T_G": self.goal_g}, bool(good)
        )


def random_world(seed: int, coupling: float = 0.0) -> World:
    """Well-conditioned slopes; the strike moves T_H by ``coupling`` of what it moves T_G."""
    rng = np.random.default_rng(seed)

    def slopes(columns: int) -> NDArray:
        u, _, vt = np.linalg.svd(rng.normal(size=(2, columns)), full_matrices=False)
        return u @ np.diag(rng.uniform(0.8, 2.0, 2)) @ vt

    own_h, own_g = slopes(3), slopes(2)
    across = coupling * rng.uniform(-1, 1, (2, 2))
    return World(
        np.hstack([own_h, across]),
        np.hstack([rng.uniform(-0.5, 0.5, (2, 3)), own_g]),
        rng.uniform(-0.2, 0.2, 2),
        rng.uniform(-0.5, 0.5, 2),
    )


def learn(
    learner: Learner, world: Callable[[Proposal], Outcome], most: int = 200
) -> list[Proposal]:
    proposals = []
    while not learner.finished and len(proposals) < most:
        proposals.append(learner.ask())
        learner.tell(world(proposals[-1]))
    return proposals


def purposes(proposals: list[Proposal]) -> list[tuple[str, str]]:
    return [(str(proposal.purpose), proposal.subtask) for proposal in proposals]


# it learns


@settings(max_examples=60)
@given(st.integers(0, 10**6), st.floats(0, 0.03))
def test_it_converges_on_linear_tasks(seed: int, coupling: float) -> None:
    world = random_world(seed, coupling)
    learner = Learner(via_points(), (THROW, STRIKE))
    proposals = learn(learner, world)
    assert learner.learned_at is not None
    assert learner.learned_at < 60
    assert learner.trials == len(proposals) == len(world.executed)
    s = learner.via_points.select(CONTROL)
    assert np.linalg.norm(world.throw @ s - world.goal_h) < world.bars[0]
    assert np.linalg.norm(world.strike @ s - world.goal_g) < world.bars[1]
    # a Jacobian is that of the error's fall, exact for linear worlds
    np.testing.assert_allclose(learner.jacobians["throw"], world.throw[:, :3], atol=1e-8)
    if "strike" in learner.jacobians:  # unless the goal happened to be hit before it was aimed at
        np.testing.assert_allclose(learner.jacobians["strike"], world.strike[:, 3:], atol=1e-8)


def test_the_error_falls_by_the_gain_a_trial() -> None:
    """With B = 0.5 I and an exact Jacobian: halved by every trial of learning."""
    world = random_world(1)
    only = replace(THROW, reached=0.0)
    learner = Learner(via_points(), (only,))
    proposals = learn(learner, world, most=20)
    errors = [
        np.linalg.norm(world.goal_h - world.throw @ proposal.via_points.select(CONTROL))
        for proposal in proposals
        if proposal.purpose is Purpose.LEARNING
    ]
    np.testing.assert_allclose(np.divide(errors[1:], errors[:-1]), 0.5, atol=1e-6)


def test_a_gain_for_each_task_variable() -> None:
    """B = diag(0.2, 1): each component of the error falls by its own gain."""
    world = random_world(2)
    learner = Learner(via_points(), (replace(THROW, gain=ConstantGain((0.2, 1.0))),))
    learn(learner, world, most=7)
    start = world.goal_h
    after = world.goal_h - world.throw @ learner.ask().via_points.select(CONTROL)
    np.testing.assert_allclose(after, start * [0.8, 0.0], atol=1e-8)


def test_a_desired_value_may_move_with_the_movement() -> None:
    """As the racket does that shall meet the ball: the slope learned is that of T - Td."""
    world = random_world(3)
    follows = np.array([[0.3, 0.0, 0.0, 0, 0], [0.0, -0.2, 0.1, 0, 0]])

    def moving(proposal: Proposal) -> Outcome:
        outcome = world(proposal)
        desired = world.goal_h + follows @ proposal.via_points.select(CONTROL)
        return Outcome(outcome.realized, {**outcome.desired, "T_H": desired}, False)

    learner = Learner(via_points(), (replace(THROW, reached=0.0),))
    learn(learner, moving, most=40)
    np.testing.assert_allclose(
        learner.jacobians["throw"], (world.throw - follows)[:, :3], atol=1e-9
    )
    s = learner.via_points.select(CONTROL)
    np.testing.assert_allclose(world.throw @ s, world.goal_h + follows @ s, atol=1e-6)


def test_regularization_is_in_units_of_a_perturbation() -> None:
    """Components of other units, perturbed in proportion: the same movement of T."""
    world = random_world(4)
    fine = replace(THROW, regularization=1e-5, reached=0.0)
    unit = np.array([1.0, 100.0, 0.01])
    coarse = replace(fine, perturbation=tuple(0.01 * unit))
    scaled = replace(world, throw=world.throw / np.r_[unit, 1, 1], executed=[])
    one, other = Learner(via_points(), (fine,)), Learner(via_points(), (coarse,))
    learn(one, world, most=12)
    learn(other, scaled, most=12)
    np.testing.assert_allclose(
        one.via_points.select(THROW.control) * unit,
        other.via_points.select(THROW.control),
        rtol=1e-9,
    )


# what it asks for


def test_the_course_of_a_run() -> None:
    world = random_world(5)
    proposals = learn(Learner(via_points(), (THROW, STRIKE), repeats=2), world)
    said = purposes(proposals)
    assert said[:8] == [("learning", "throw")] + [("exploration", "throw")] * 6 + [said[7]]
    first_strike = next(i for i, (_, subtask) in enumerate(said) if subtask == "strike")
    assert set(said[7:first_strike]) == {("learning", "throw")}
    assert said[first_strike : first_strike + 4] == [("exploration", "strike")] * 4
    assert set(said[first_strike + 4 : -2]) == {("learning", "strike")}
    assert [purpose for purpose, _ in said[-2:]] == ["repeat", "repeat"]


def test_the_first_trial_executes_what_was_given() -> None:
    proposal = Learner(via_points(), (THROW, STRIKE)).ask()
    np.testing.assert_array_equal(proposal.via_points.values, via_points().values)
    assert proposal.purpose is Purpose.LEARNING


def test_only_the_control_variables_ever_change() -> None:
    world = random_world(6)
    proposals = learn(Learner(via_points(), (THROW, STRIKE)), world)
    others = [name for name in via_points().components if name not in CONTROL]
    for proposal in proposals:
        np.testing.assert_array_equal(proposal.via_points.select(others), 0)
        np.testing.assert_array_equal(proposal.via_points.times, via_points().times)
        if proposal.purpose is Purpose.EXPLORATION and proposal.subtask == "throw":
            np.testing.assert_array_equal(proposal.via_points.select(STRIKE.control), 0)


def test_asking_again_gives_the_same_trial() -> None:
    learner = Learner(via_points(), (THROW, STRIKE))
    world = random_world(7)
    for _ in range(12):
        assert learner.ask() is learner.ask()
        learner.tell(world(learner.ask()))


def test_every_trial_is_counted() -> None:
    learner = Learner(via_points(), (THROW, STRIKE), repeats=3)
    world = random_world(8)
    for told in range(20):
        assert learner.trials == told
        learner.tell(world(learner.ask()))
    learn(learner, world)
    assert learner.trials == len(world.executed)
    assert learner.learned_at == learner.trials - 3


# successes and repeats


def outcome(error: float = 1.0, success: bool = False) -> Outcome:
    return Outcome(
        {"T_H": np.array([error, 0.0]), "T_G": np.array([error, 0.0])},
        {"T_H": np.zeros(2), "T_G": np.zeros(2)},
        success,
    )


def test_so_many_successes_in_a_row_are_needed() -> None:
    learner = Learner(via_points(), (THROW,), successes_to_learn=3)
    world = random_world(9)
    for success in (True, True, False, True, True):
        learner.tell(replace(world(learner.ask()), success=success))
        assert learner.learned_at is None
    last = learner.ask()
    learner.tell(replace(world(last), success=True))
    assert learner.learned_at == 6
    assert learner.finished
    # what succeeded last is kept, a perturbed movement as it was
    assert last.purpose is Purpose.EXPLORATION
    np.testing.assert_array_equal(learner.via_points.values, last.via_points.values)
    with pytest.raises(LearningError, match="learned at trial 6"):
        learner.ask()


def test_repeats_execute_what_was_learned_unchanged_whatever_comes() -> None:
    learner = Learner(via_points(), (THROW,), successes_to_learn=1, repeats=3)
    proposal = learner.ask()
    learner.tell(outcome(success=True))
    for _ in range(3):
        assert not learner.finished
        repeat = learner.ask()
        assert repeat.purpose is Purpose.REPEAT
        np.testing.assert_array_equal(repeat.via_points.values, proposal.via_points.values)
        learner.tell(outcome(error=9.0))
    assert learner.finished
    assert (learner.learned_at, learner.trials) == (1, 4)


# the gate


def at_the_strike(world: World) -> Learner:
    """A learner that has just begun to explore the strike."""
    learner = Learner(via_points(), (THROW, STRIKE))
    while learner.ask().subtask != "strike":
        learner.tell(world(learner.ask()))
    assert learner.ask().purpose is Purpose.EXPLORATION
    return learner


def beyond_the_gate(told: Outcome, d: float = 0.2) -> Outcome:
    desired = told.desired["T_H"]
    return replace(told, realized={**told.realized, "T_H": desired - [d, 0.0]})


def test_a_trial_beyond_the_gate_serves_the_throw_and_the_pair_starts_again() -> None:
    world = random_world(10)
    learner = at_the_strike(world)
    before = learner.via_points
    up = learner.ask().via_points.select(STRIKE.control) - before.select(STRIKE.control)
    learner.tell(world(learner.ask()))
    down = learner.ask()
    learner.tell(beyond_the_gate(world(down)))
    after = learner.via_points
    # a step of the throw: S += J# B (Td - T)
    jacobian = learner.jacobians["throw"]
    step = np.linalg.pinv(jacobian) @ [0.1, 0.0]
    np.testing.assert_allclose(after.select(THROW.control) - before.select(THROW.control), step)
    np.testing.assert_array_equal(after.select(STRIKE.control), before.select(STRIKE.control))
    again = learner.ask()
    assert (again.purpose, again.subtask) == (Purpose.EXPLORATION, "strike")
    np.testing.assert_allclose(
        again.via_points.select(STRIKE.control) - after.select(STRIKE.control), up
    )


def test_wasted_trials_are_those_no_jacobian_was_made_of() -> None:
    world = random_world(10)
    learner = at_the_strike(world)
    assert learner.wasted == 0
    begun = learner.trials
    for d in (0.0, 0.2, 0.2):  # up; down and up again beyond the gate
        learner.tell(beyond_the_gate(world(learner.ask()), d))
    assert learner.wasted == 3
    while learner.ask().purpose is Purpose.EXPLORATION:
        learner.tell(beyond_the_gate(world(learner.ask()), 0.0))
    assert learner.trials - begun == 2 * len(STRIKE.control) + learner.wasted


def test_at_the_gate_itself_a_trial_is_beyond_it() -> None:
    for d, counts in ((0.1, False), (0.0999, True)):
        world = random_world(11)
        learner = at_the_strike(world)
        up = learner.ask().via_points.select(STRIKE.control)
        told = world(learner.ask())
        exact = Outcome(
            {**told.realized, "T_H": np.zeros(2)},
            {**told.desired, "T_H": np.array([d, 0.0])},
            False,
        )
        learner.tell(exact)
        moved = learner.ask().via_points.select(STRIKE.control)
        assert np.allclose(moved, up) is not counts


def test_after_a_step_of_the_throw_no_old_result_is_used_for_the_strike() -> None:
    """The strike's error was measured before the throw moved: it has to be measured anew."""
    world = random_world(12)
    learner = at_the_strike(world)
    learner.tell(beyond_the_gate(world(learner.ask())))
    while learner.ask().purpose is Purpose.EXPLORATION:
        kept = learner.via_points
        told = world(learner.ask())
        learner.tell(replace(told, realized={**told.realized, "T_H": told.desired["T_H"]}))
    assert "strike" in learner.jacobians
    np.testing.assert_array_equal(learner.ask().via_points.values, kept.values)
    np.testing.assert_array_equal(learner.via_points.values, kept.values)
    told = world(learner.ask())
    learner.tell(replace(told, realized={**told.realized, "T_H": told.desired["T_H"]}))
    error = told.error("T_G")
    assert error is not None
    step = learner.via_points.select(STRIKE.control) - kept.select(STRIKE.control)
    np.testing.assert_allclose(world.strike[:, 3:] @ step, 0.4 * error, atol=1e-8)


def test_without_such_a_step_the_last_exploration_leads_straight_to_a_step() -> None:
    world = random_world(12)
    learner = at_the_strike(world)
    before = learner.via_points
    for _ in range(4):
        learner.tell(world(learner.ask()))
    assert learner.ask().purpose is Purpose.LEARNING
    change = learner.via_points.select(STRIKE.control) - before.select(STRIKE.control)
    assert np.linalg.norm(change) > 0


def test_the_gate_holds_while_learning_too() -> None:
    world = random_world(13)
    learner = at_the_strike(world)
    while learner.ask().purpose is Purpose.EXPLORATION:
        learner.tell(world(learner.ask()))
    before = learner.via_points
    learner.tell(beyond_the_gate(world(learner.ask())))
    np.testing.assert_array_equal(
        learner.via_points.select(STRIKE.control), before.select(STRIKE.control)
    )
    assert np.any(learner.via_points.select(THROW.control) != before.select(THROW.control))


def test_with_three_subtasks_the_latest_whose_gate_is_passed_is_served() -> None:
    chain = tuple(
        Subtask(f"s{i}", (f"x{i}",), f"T{i}", (0.1,), ConstantGain(1.0), 0.0, 0.5, gate=1.0)
        for i in (1, 2, 3)
    )
    learner = Learner(via_points(), chain)

    def told(*errors: float) -> Outcome:
        """Unit slopes: T_i = x_i, and Td as far off as said."""
        x = learner.ask().via_points.select(("x1", "x2", "x3"))
        return Outcome(
            {f"T{i + 1}": np.array([x[i]]) for i in range(3)},
            {f"T{i + 1}": np.array([x[i] + errors[i]]) for i in range(3)},
            False,
        )

    def linear() -> Outcome:
        x = learner.ask().via_points.select(("x1", "x2", "x3"))
        return Outcome(
            {f"T{i + 1}": np.array([x[i]]) for i in range(3)},
            {f"T{i + 1}": np.array([0.01]) for i in range(3)},
            False,
        )

    while learner.ask().subtask != "s3":
        learner.tell(linear())
    assert set(learner.jacobians) == {"s1", "s2"}
    for errors, moves in (
        ((2.0, 2.0, 0.1), "x1"),
        ((0.1, 2.0, 0.1), "x2"),
    ):
        before = learner.via_points
        learner.tell(told(*errors))
        change = learner.via_points.values - before.values
        assert np.count_nonzero(change) == 1
        assert learner.via_points.select((moves,))[0] != before.select((moves,))[0]


# what is lost


def test_a_step_too_far_is_taken_back_by_half_until_something_is_reached() -> None:
    """The ball is lost where x2 is beyond 0.3; the full step goes far beyond."""
    world = World(
        np.array([[1.0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0]]),
        np.zeros((2, 5)),
        np.array([1.0, 0.0]),
        np.zeros(2),
        lost=lambda s: (bool(s[0] > 0.3), False),
    )
    learner = Learner(via_points(), (replace(THROW, gain=ConstantGain(1.0), reached=0.0),))
    learn(learner, world, most=11)
    tried = [s[0] for s in world.executed[7:]]
    np.testing.assert_allclose(tried[:3], [1.0, 0.5, 0.25], atol=1e-6)
    assert tried[3] > 0.3  # and from there it tries again


def test_a_perturbation_that_loses_the_ball_is_halved() -> None:
    world = random_world(14)
    world.lost = lambda s: (bool(abs(s[1]) > 0.006), False)
    learner = Learner(via_points(), (THROW, STRIKE))
    learn(learner, world, most=9)
    np.testing.assert_allclose([s[1] for s in world.executed[3:6]], [0.01, 0.005, -0.005])
    assert learner.trials == 9
    np.testing.assert_allclose(learner.jacobians["throw"], world.throw[:, :3], atol=1e-9)


@pytest.mark.parametrize("loses", [(True, False), (False, True)])
def test_a_strike_whose_perturbation_loses_the_ball_does_not_try_the_same_for_ever(
    loses: tuple[bool, bool],
) -> None:
    """Whether the throw's result is lost with it or not."""
    world = random_world(15)
    world.lost = lambda s: loses if abs(s[3]) > 0.015 and abs(s[4]) < 1e-12 else (False, False)
    learner = Learner(via_points(), (THROW, STRIKE))
    learn(learner, world)
    assert learner.learned_at is not None
    assert 0.01 in np.round([s[3] for s in world.executed], 12)


def test_where_no_perturbation_keeps_the_ball_it_gives_up_and_says_where() -> None:
    world = random_world(16)
    world.lost = lambda s: (bool(s[2] != 0), False)
    with pytest.raises(LearningError, match=r"no slope of T_H along x3: even .* 0\.000625"):
        learn(Learner(via_points(), (THROW, STRIKE)), world)
    assert len(world.executed) == 1 + 4 + 5


def test_nothing_can_be_learned_from_a_first_trial_that_reached_nothing() -> None:
    learner = Learner(via_points(), (THROW, STRIKE))
    learner.ask()
    with pytest.raises(LearningError, match="the first trial did not reach T_H"):
        learner.tell(
            Outcome({"T_H": None, "T_G": None}, {"T_H": np.zeros(2), "T_G": np.zeros(2)}, False)
        )
    assert learner.trials == 1


def test_a_strike_that_reaches_nothing_is_not_explored_but_the_throw_improved() -> None:
    world = random_world(17)
    learner = Learner(via_points(), (THROW, STRIKE))
    while len(learner.jacobians) < 1 or learner.ask().subtask == "throw":
        world.lost = lambda _: (False, True)
        learner.tell(world(learner.ask()))
        assert len(world.executed) < 50
    for _ in range(3):
        proposal = learner.ask()
        assert proposal.purpose is Purpose.LEARNING
        before = world.goal_h - world.throw @ proposal.via_points.select(CONTROL)
        learner.tell(world(proposal))
        after = world.goal_h - world.throw @ learner.via_points.select(CONTROL)
        assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before) / 2)
    world.lost = lambda _: (False, False)
    learn(learner, world)
    assert learner.learned_at is not None


# replay and refusals


@given(st.integers(0, 10**6))
def test_the_same_outcomes_lead_to_the_same_proposals_bit_for_bit(seed: int) -> None:
    world = random_world(seed, coupling=0.3)
    first = Learner(via_points(), (THROW, STRIKE), repeats=1)
    history = []
    while not first.finished and first.trials < 40:
        proposal = first.ask()
        told = world(proposal)
        history.append((proposal, told))
        first.tell(told)
    again = Learner(via_points(), (THROW, STRIKE), repeats=1)
    for proposal, told in history:
        asked = again.ask()
        assert asked.via_points.values.tobytes() == proposal.via_points.values.tobytes()
        assert (asked.purpose, asked.subtask) == (proposal.purpose, proposal.subtask)
        again.tell(told)
    assert again.via_points.values.tobytes() == first.via_points.values.tobytes()


def test_an_outcome_before_a_question_is_refused() -> None:
    learner = Learner(via_points(), (THROW,))
    with pytest.raises(LearningError, match="ask for a trial before telling"):
        learner.tell(outcome())
    learner.ask()
    learner.tell(outcome())
    with pytest.raises(LearningError, match="ask for a trial before telling"):
        learner.tell(outcome())


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("where", ["realized", "desired"])
def test_what_is_not_finite_is_refused_by_name_and_number_and_tried_again(
    value: float, where: str
) -> None:
    learner = Learner(via_points(), (THROW, STRIKE))
    learner.ask()
    good = outcome()
    bad = {"T_H": np.zeros(2), "T_G": np.array([0.0, value])}
    asked = learner.ask()
    with pytest.raises(
        OutcomeNotFiniteError, match=r"trial 1: (desired )?T_G is not finite"
    ) as refused:
        learner.tell(replace(good, **{where: bad}))
    assert refused.value.trial == 1
    assert learner.trials == 1  # it was executed
    assert learner.ask() is asked  # and is to be executed once more
    learner.tell(good)
    assert learner.trials == 2
    assert learner.ask() is not asked


@pytest.mark.parametrize("broken", [{1}, {4}, {9, 10}, {1, 2, 8}])
def test_trials_that_break_off_count_and_are_done_again(broken: set[int]) -> None:
    """What is learned is the same; only the trials that said nothing come on top."""
    nothing = Outcome({"T_H": None, "T_G": None}, {}, False, broken_off=True)

    def executed(broken: set[int]) -> tuple[list[NDArray], Learner]:
        world, learner = random_world(0), Learner(via_points(), (THROW, STRIKE))
        told: list[NDArray] = []
        while not learner.finished and learner.trials < 60:
            proposal = learner.ask()
            number = learner.trials + 1
            told.append(proposal.via_points.values)
            learner.tell(nothing if number in broken else world(proposal))
        return told, learner

    smooth, whole = executed(set())
    interrupted, learner = executed(broken)
    assert whole.learned_at is not None
    assert learner.learned_at == whole.learned_at + len(broken)
    kept = [told for n, told in enumerate(interrupted, start=1) if n not in broken]
    np.testing.assert_array_equal(kept, smooth)


def test_a_repeat_that_breaks_off_is_not_made_up_for() -> None:
    world, learner = random_world(0), Learner(via_points(), (THROW, STRIKE), repeats=3)
    nothing = Outcome({"T_H": None, "T_G": None}, {}, False, broken_off=True)
    while not learner.finished:
        proposal = learner.ask()
        learner.tell(nothing if proposal.purpose is Purpose.REPEAT else world(proposal))
    assert learner.learned_at is not None
    assert learner.trials == learner.learned_at + 3


def test_a_missing_task_variable_is_named() -> None:
    learner = Learner(via_points(), (THROW, STRIKE))
    learner.ask()
    good = outcome()
    with pytest.raises(OutcomeError, match="no task variable 'T_G'; it has T_H"):
        learner.tell(replace(good, realized={"T_H": np.zeros(2)}))
    with pytest.raises(OutcomeError, match="not say what T_G should have been"):
        learner.tell(replace(good, desired={"T_H": np.zeros(2)}))


@pytest.mark.parametrize(
    ("realized", "desired"), [(np.zeros(3), np.zeros(2)), (np.zeros(2), 0.0), (0.0, 0.0)]
)
def test_values_of_other_shapes_are_refused(realized: NDArray, desired: NDArray) -> None:
    told = Outcome({"T": realized}, {"T": desired}, False)
    with pytest.raises(OutcomeError, match="vectors of the same length"):
        told.error("T")


def test_a_task_needs_subtasks_and_their_components() -> None:
    with pytest.raises(LearningError, match="at least one subtask"):
        Learner(via_points(), ())
    with pytest.raises(ViaPointsError, match="no component 'z9'"):
        Learner(via_points(), (replace(THROW, control=("x2", "y2", "z9")),))


def test_what_was_given_is_not_changed() -> None:
    given_points = via_points()
    learn(Learner(given_points, (THROW, STRIKE)), random_world(18))
    np.testing.assert_array_equal(given_points.values, 0)
