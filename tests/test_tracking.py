"""The controller: the same curve in Drake, errors that decay as designed, torques within limits."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from scipy.interpolate import BSpline

from drake_viapoint.errors import RetargetingError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.packages import resolve
from drake_viapoint.robot.arm import Arm, load_plant
from drake_viapoint.robot.tracking import Tracking, drake_trajectory
from drake_viapoint.tasks.serve import ServeTask

DIRECTIVES = resolve("package://drake_viapoint/arm_with_racket.dmd.yaml")
FREQUENCY = 20.0  # [rad/s]


class Rig:
    """An arm in a diagram of its own, followed by a controller with the same model or another."""

    def __init__(self, arm: Arm, directives: Path = DIRECTIVES) -> None:
        builder = DiagramBuilder()
        self.plant = builder.AddNamedSystem("plant", load_plant(directives))
        self.tracking = Tracking(
            builder, self.plant, self.plant.GetModelInstanceByName("arm"), arm, FREQUENCY
        )
        self.diagram: Diagram = builder.Build()

    def context(self, q: NDArray, v: NDArray | float = 0.0) -> Context:
        context = self.diagram.CreateDefaultContext()
        own = self.plant.GetMyMutableContextFromRoot(context)
        self.plant.SetPositions(own, q)
        self.plant.SetVelocities(own, np.broadcast_to(v, 7))
        return context

    def run(self, context: Context, times: NDArray) -> NDArray:
        """Joint angles (n, 7) at the times, from a context at time 0."""
        simulator = Simulator(self.diagram, context)
        simulator.get_mutable_integrator().set_target_accuracy(1e-9)
        angles = []
        for t in times:
            simulator.AdvanceTo(float(t))
            angles.append(self.plant.GetPositions(self.plant.GetMyContextFromRoot(context)))
        return np.array(angles)


@pytest.fixture
def rig(arm: Arm) -> Rig:
    return Rig(arm)


def wave(arm: Arm, seed: int, size: float = 0.3) -> BSpline:
    """A random movement about the rest posture, 1.2 s long."""
    rng = np.random.default_rng(seed)
    times = np.array([0.0, 0.35, 0.6, 0.9, 1.2])
    return minimum_jerk(times, arm.rest + rng.uniform(-size, size, (5, 7)))


@pytest.mark.parametrize("seed", range(5))
def test_drake_follows_the_same_curve(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(2, 15)), int(rng.integers(1, 9))
    spline = minimum_jerk(np.cumsum(rng.uniform(0.08, 0.3, n)), rng.uniform(-2, 2, (n, k)))
    curve = drake_trajectory(spline)
    assert (curve.rows(), curve.cols()) == (k, 1)
    assert (curve.start_time(), curve.end_time()) == (spline.t[0], spline.t[-1])
    times = np.linspace(spline.t[0], spline.t[-1], 200)
    for order in range(3):
        by_drake = [curve.EvalDerivative(t, order)[:, 0] for t in times]
        scale = np.max(np.abs(spline(times, order)))
        assert np.max(np.abs(by_drake - spline(times, order))) < 1e-12 * max(1.0, scale) * 10**order


def test_the_shipped_serve_in_drake(serve_task: ServeTask) -> None:
    spline = serve_task.retargeting.first.trajectory
    curve = drake_trajectory(spline)
    times = np.linspace(spline.t[0], spline.t[-1], 500)
    for order, tolerance in ((0, 1e-12), (1, 1e-11), (2, 1e-10)):
        by_drake = [curve.EvalDerivative(t, order)[:, 0] for t in times]
        np.testing.assert_allclose(by_drake, spline(times, order), rtol=0, atol=tolerance)


def test_an_exact_model_follows_exactly(arm: Arm, rig: Rig) -> None:
    movement = wave(arm, 0)
    rig.tracking.follow(movement)
    times = np.linspace(0.05, 1.2, 24)
    followed = rig.run(rig.context(movement(0.0)), times)
    assert np.max(np.abs(followed - movement(times))) < 1e-7
    assert np.ptp(movement(times)) > 0.2


def test_an_error_decays_as_a_critically_damped_spring(arm: Arm, rig: Rig) -> None:
    """With an exact model every joint's error obeys e'' + 2 w e' + w^2 e = 0, however it moves."""
    movement = wave(arm, 1)
    rig.tracking.follow(movement)
    e, w = np.linspace(-0.05, 0.05, 7), FREQUENCY
    times = np.linspace(0.02, 0.5, 20)
    followed = rig.run(rig.context(movement(0.0) + e), times)
    decay = ((1 + w * times) * np.exp(-w * times))[:, None] * e
    np.testing.assert_allclose(followed - movement(times), decay, atol=1e-7)


def test_at_rest_the_torque_holds_the_weight(arm: Arm, rig: Rig) -> None:
    """Before any movement is given, the arm is held at rest."""
    context = rig.context(arm.rest)
    own = arm.plant.CreateDefaultContext()
    weight = -arm.plant.CalcGravityGeneralizedForces(own)
    np.testing.assert_allclose(rig.tracking.torque_before_clamping(context)(), weight, atol=1e-10)
    assert np.max(np.abs(weight)) > 1


def test_a_new_movement_counts_once_time_is_set(arm: Arm, rig: Rig) -> None:
    context = rig.context(arm.rest)
    held = rig.tracking.torque_before_clamping(context)().copy()
    rig.tracking.follow(wave(arm, 2))
    context.SetTime(0.1)
    moved = rig.tracking.torque_before_clamping(context)().copy()
    assert np.max(np.abs(moved - held)) > 1
    fresh = Rig(arm)
    fresh.tracking.follow(wave(arm, 2))
    other = fresh.context(arm.rest)
    other.SetTime(0.1)
    np.testing.assert_array_equal(fresh.tracking.torque_before_clamping(other)(), moved)


def test_torques_are_clamped_at_the_efforts(arm: Arm, rig: Rig) -> None:
    """Far from where it should be, the arm wants more than its motors give, and gets their most."""
    rig.tracking.follow(wave(arm, 3))
    context = rig.context(arm.rest + 1.0)
    wanted = rig.tracking.torque_before_clamping(context)()
    port = rig.plant.get_actuation_input_port(rig.plant.GetModelInstanceByName("arm"))
    given = port.Eval(rig.plant.GetMyContextFromRoot(context))
    limit = arm.limits.effort
    assert np.any(np.abs(wanted) > limit)
    np.testing.assert_array_equal(given, np.clip(wanted, -limit, limit))


@pytest.mark.parametrize("columns", [1, 6, 8])
def test_a_movement_of_other_joints_is_refused(rig: Rig, columns: int) -> None:
    """Drake would end the process instead."""
    with pytest.raises(RetargetingError, match="the arm has 7 joints"):
        rig.tracking.follow(minimum_jerk([0.0, 1.0], np.zeros((2, columns))))
    with pytest.raises(RetargetingError, match="the arm has 7 joints"):
        rig.tracking.follow(BSpline(np.r_[np.zeros(6), np.ones(6)], np.zeros(6), 5))
