"""How contact is simulated: where the ball lands, when it leaves, and what that costs.

The first movement of the shipped serve, in the robot's scene without noise or ignorance, done by
each way of integrating it; against the finest runge_kutta3. Costs are ratios to the same trial in
event execution, medians in one process, so that they hold on a busy machine.

    python benchmarks/contact_accuracy.py [--repeats 3] [--trials 100]

Then how smooth the default is, landing against a component of via-point 4 in 41 trials, and what
memory does over many trials.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import psutil
from pydrake.systems.analysis import GetIntegrationSchemes

from drake_viapoint.errors import BrokenOffError
from drake_viapoint.packages import resolve
from drake_viapoint.tasks.catalogue import ROBOT_SERVE, task_scenario
from drake_viapoint.tasks.serve import ServeTask, serve_scene
from drake_viapoint.tasks.serve_contact import ContactExecution
from drake_viapoint.tasks.serve_trial import ServeTrial

KNOWN = {
    "unknown.inertia": 0.0,
    "unknown.viscous_friction": 0.0,
    "unknown.coulomb_friction": 0.0,
    "unknown.mount": 0.0,
    "unknown.restitution": 0.0,
    "cameras.see": "truth",
}
REFERENCE = "runge_kutta3, accuracy 1e-7, 0.1 ms"


class Way(NamedTuple):
    """A way to integrate a trial."""

    name: str
    changes: dict[str, object]


def ways() -> list[Way]:
    """The reference first, then all others."""
    fine = {"contact.step": 1e-4, "simulator.max_step_size": 1e-4}
    found = [Way(REFERENCE, {"simulator.accuracy": 1e-7, **fine})]
    found += [
        Way(f"runge_kutta3, accuracy {accuracy:.0e}", {"simulator.accuracy": accuracy})
        for accuracy in (1e-5, 1e-4, 1e-3, 1e-2)
    ]
    found += [
        Way(
            f"runge_kutta3, fixed {1e3 * step:g} ms",
            {"simulator.use_error_control": False, "contact.step": step},
        )
        for step in (1e-4, 2e-4, 4e-4)
    ]
    found += [
        Way(
            f"lagged, {1e3 * step:g} ms",
            {"plant.time_step": step, "plant.discrete_contact_approximation": "lagged"},
        )
        for step in (1e-3, 5e-4, 2.5e-4, 1e-4)
    ]
    if "cenic" in GetIntegrationSchemes():
        cenic = {"simulator.integration_scheme": "cenic"}
        found += [
            Way(f"cenic, accuracy {accuracy:.0e}", {**cenic, "simulator.accuracy": accuracy})
            for accuracy in (1e-3, 1e-4, 1e-5, 1e-6)
        ]
    return found


def execution(task: ServeTask, changes: dict[str, object]) -> ContactExecution:
    """What executes the serve in one way."""
    scenario: Any = task_scenario("serve", resolve(ROBOT_SERVE), {**KNOWN, **changes})
    scene: Any = serve_scene(scenario)
    return ContactExecution(scenario, scene, task.watched.hit_time)


def timed(call: Callable[[], ServeTrial], repeats: int) -> tuple[ServeTrial, float]:
    """A trial, and the median of what it takes [s]."""
    took = []
    for _ in range(repeats):
        start = time.perf_counter()
        trial = call()
        took.append(time.perf_counter() - start)
    return trial, statistics.median(took)


def release(trial: ServeTrial) -> float:
    """When the ball left the cup [s]."""
    return next(event.time for event in trial.events if event.name == "release")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=3, help="for the times")
    parser.add_argument("--trials", type=int, default=100, help="for the memory figures")
    arguments = parser.parse_args()

    task = ServeTask(task_scenario("serve"))
    movement = task.retargeting.first
    # a copy each time: event execution remembers the last movement's swing
    _, by_events = timed(lambda: task.execution.execute(replace(movement)), 20)
    print(f"event execution: {1e3 * by_events:.0f} ms a trial")
    print(
        f"{'':36} {'landing x, y [m]':>18} {'off [mm]':>9} {'release':>9} {'[ms]':>6} {'ratio':>6}"
    )
    reference: ServeTrial | None = None
    for way in ways():
        try:
            one = execution(task, way.changes)
            trial, took = timed(lambda one=one: one.execute(movement), arguments.repeats)
        except BrokenOffError as error:
            print(f"{way.name:36} {error}")
            continue
        reference = reference or trial
        there = trial.happened.landing
        if there is None:
            print(f"{way.name:36} {trial.ending}")
            continue
        off = 1e3 * float(np.linalg.norm(there - reference.happened.landing))
        late = 1e3 * (release(trial) - release(reference))
        print(
            f"{way.name:36} {there[0]:9.4f} {there[1]:8.4f} {off:9.2f} {late:+8.2f} "
            f"{1e3 * took:7.0f} {took / by_events:6.1f}",
            flush=True,
        )

    default = execution(task, {})
    for component in ("x4", "y4", "z4"):
        print(smoothness(task, default, component), flush=True)
    process = psutil.Process()
    before = process.memory_info().rss
    for number in range(arguments.trials):
        default.execute(movement, number)
    growth = (process.memory_info().rss - before) / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(f"memory: {growth:+.1f} MB over {arguments.trials} trials, peak {peak:.0f} MB")


def smoothness(task: ServeTask, default: ContactExecution, component: str) -> str:
    """How far landings are from a cubic, over 41 places of a component within 2 cm."""
    changes = np.linspace(-0.02, 0.02, 41)
    landings = []
    for change in changes:
        points = task.via_points.moved([component], [change])
        landings.append(default.execute(task.retargeting(points)).happened.landing)
    if any(landing is None for landing in landings):
        return f"{component}: some do not land"
    found = np.array(landings)
    cubic = np.stack([np.polyval(np.polyfit(changes, c, 3), changes) for c in found.T], axis=1)
    worst = 1e3 * np.max(np.linalg.norm(found - cubic, axis=1))
    return f"landing against {component}, 41 places over 4 cm: within {worst:.2f} mm of a cubic"


if __name__ == "__main__":
    main()
