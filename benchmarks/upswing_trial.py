"""What a trial of the upswing costs, in each of its executions, beside what it must at the least.

All in one process, so that ratios hold on a busy machine; medians over repeats taken in turn.

    python benchmarks/upswing_trial.py [--batch 1000]

- recurrence, in plain Python: the paper's equation one trial at a time, in a loop over floats, the
  hand's accelerations taken from the trial's own spline, or from a matrix given beforehand;
- recurrence, in a batch: the package's, all trials in one call;
- plant, kinematic: Drake's pendulum on a hand that obeys;
- plant, tracked: carried by the arm, with and without its retargeting;
- bare integration: Drake integrating the same diagram, same integrator and accuracy, with nothing
  watched, logged or checked.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import Context, Diagram

from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.pendulum import HANGING, Pendulum, Recurrence
from drake_viapoint.tasks.upswing_plant import KinematicExecution
from drake_viapoint.tasks.upswing_scenario import UpswingScenario
from drake_viapoint.tasks.upswing_scene import UpswingScene
from drake_viapoint.tasks.upswing_tracked import TrackedExecution

TIMES = np.linspace(0.0, 2.0, 8)
SWING = np.array([0.0, -0.136, -0.301, -0.167, 0.137, 0.052, -0.067, 0.089])  # [m] at TIMES

PLAIN = "recurrence, plain Python, own spline"
MATRIX = "recurrence, plain Python, matrix given"
ONE = "recurrence, one at a time"
BATCH = "recurrence, batch"
KINEMATIC = "plant, kinematic"
BARE = "bare integration of the pendulum"
TRACKED = "plant, tracked"
BARE_ARM = "bare integration of arm and pendulum"
RETARGETING = "retargeting"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--batch", type=int, default=1000, help="trials in a call")
    parser.add_argument("--repeats", type=int, default=30, help="for the times")
    arguments = parser.parse_args()

    scenario = UpswingScenario()
    step, pendulum = scenario.time_step, Pendulum(scenario.pendulum.length)
    recurrence = Recurrence(TIMES, pendulum, step)
    at_steps = recurrence.times[:-1]
    matrix = minimum_jerk(TIMES, np.eye(TIMES.size)).derivative(2)(at_steps)
    scene = UpswingScene(scenario)
    kinematic = KinematicExecution(scenario, scene.line, TIMES)
    tracked = TrackedExecution(scenario, scene, TIMES, SWING)
    bare_kinematic = bare_integration(kinematic.pendulum.diagram, scenario.simulator)
    bare_tracked = bare_integration(scene.diagram, scenario.simulator)

    def by_its_own_spline(x: NDArray[np.float64]) -> list[float]:
        path = minimum_jerk(TIMES, x[:, None])
        return plain_recurrence(path.derivative(2)(at_steps)[:, 0].tolist(), pendulum, step)

    def by_a_matrix(x: NDArray[np.float64]) -> list[float]:
        return plain_recurrence((matrix @ x).tolist(), pendulum, step)

    rng = np.random.default_rng(0)
    changes = rng.normal(scale=0.01, size=(arguments.batch, 7))
    batch = SWING + np.c_[np.zeros(arguments.batch), changes]
    for reference in (by_its_own_spline, by_a_matrix):
        np.testing.assert_allclose(reference(batch[0]), recurrence(batch[0]).angle, atol=1e-9)

    times: dict[str, list[float]] = {}
    for x in batch[: arguments.repeats]:
        movement = tracked.movement(x)

        def hold(context: Context, angles: NDArray[np.float64] = movement.angles[0]) -> None:
            own = scene.plant.GetMyMutableContextFromRoot(context)
            scene.plant.SetPositions(own, scene.instance, angles)

        calls: dict[str, Callable[[], object]] = {
            PLAIN: lambda x=x: by_its_own_spline(x),
            MATRIX: lambda x=x: by_a_matrix(x),
            ONE: lambda x=x: recurrence(x),
            BATCH: lambda: recurrence(batch),
            KINEMATIC: lambda x=x: kinematic(x),
            BARE: lambda: bare_kinematic(lambda _: None),  # goes where the last trial went
            TRACKED: lambda m=movement, x=x: tracked.execute(m, x),
            BARE_ARM: lambda h=hold: bare_tracked(h),
            RETARGETING: lambda x=x: tracked.movement(x),
        }
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            trials = len(batch) if name == BATCH else 1
            times.setdefault(name, []).append(1e3 * (time.perf_counter() - start) / trials)

    medians = {name: statistics.median(values[3:]) for name, values in times.items()}
    for name, value in medians.items():
        print(f"{name:42} {value:9.4f} ms a trial")
    for dividend, divisor in ((PLAIN, BATCH), (MATRIX, BATCH), (ONE, BATCH)):
        print(f"{dividend} / {divisor}  {medians[dividend] / medians[divisor]:.0f}")
    for dividend, divisor in ((KINEMATIC, BARE), (TRACKED, BARE_ARM), (RETARGETING, TRACKED)):
        print(f"{dividend} / {divisor}  {medians[dividend] / medians[divisor]:.2f}")


def plain_recurrence(acceleration: list[float], pendulum: Pendulum, step: float) -> list[float]:
    """The paper's Eq. 13 in plain Python: angles [rad] under accelerations [m/s2]."""
    kept, gain = 1.0 - pendulum.damping * step, step * GRAVITY / pendulum.length
    angle, speed = HANGING, 0.0
    angles = [angle]
    for push in acceleration:
        speed = kept * speed + gain * (math.sin(angle) + push * math.cos(angle) / GRAVITY)
        angle += step * speed
        angles.append(angle)
    return angles


def bare_integration(
    diagram: Diagram, config: SimulatorConfig
) -> Callable[[Callable[[Context], None]], None]:
    """Drake's own integration of a movement, in C++, with nobody looking."""
    simulator = Simulator(diagram)

    def integrate(start: Callable[[Context], None]) -> None:
        context = simulator.get_mutable_context()
        diagram.SetDefaultContext(context)
        start(context)
        ApplySimulatorConfig(config, simulator)
        simulator.Initialize()
        simulator.AdvanceTo(float(TIMES[-1]))

    return integrate


if __name__ == "__main__":
    main()
