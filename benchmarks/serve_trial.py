"""What a trial of the serve costs, beside what it must cost at the least.

All in one process, so that ratios hold on a busy machine; medians over repeats taken in turn.

    python benchmarks/serve_trial.py [--trials 1000]

- retargeting: from Cartesian via-points to a joint trajectory;
- simulation: the trial itself, arm and ball, events and record;
- bare integration: Drake integrating the same arm motion, same integrator and accuracy, with
  nothing watched or logged;
- MuJoCo: the same arm, racket and ball stepped for the same time at 0.5 ms by mujoco.rollout;
- memory: growth and peak over many trials.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import time
from collections.abc import Callable

import mujoco
import mujoco.rollout
import numpy as np
import psutil
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator

from drake_viapoint.packages import models_path
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.catalogue import task_scenario
from drake_viapoint.tasks.serve import ServeTask

STEP = 0.0005  # [s] of MuJoCo: lands within about 5 mm


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=1000, help="for the memory figures")
    parser.add_argument("--repeats", type=int, default=30, help="for the times")
    arguments = parser.parse_args()

    scenario = task_scenario("serve")
    task = ServeTask(scenario)
    rng = np.random.default_rng(0)
    control = task.subtasks[0].control
    changes = rng.normal(scale=0.005, size=(arguments.repeats, len(control)))
    movements = [task.retargeting(task.via_points.moved(control, c)) for c in changes]
    bare = bare_integration(task)
    stepped = mujoco_rollout(task)

    times: dict[str, list[float]] = {}
    for change, movement in zip(changes, movements, strict=True):
        points = task.via_points.moved(control, change)
        for name, call in (
            ("retargeting", lambda p=points: task.retargeting(p)),
            ("simulation", lambda m=movement: task.execution.execute(m)),
            ("bare integration", lambda m=movement: bare(m)),
            ("MuJoCo", stepped),
        ):
            start = time.perf_counter()
            call()
            times.setdefault(name, []).append(1e3 * (time.perf_counter() - start))
    medians = {name: statistics.median(values[3:]) for name, values in times.items()}
    for name, value in medians.items():
        print(f"{name:18} {value:7.1f} ms")
    print(
        f"simulation / bare integration  {medians['simulation'] / medians['bare integration']:.2f}"
    )
    print(f"simulation / MuJoCo            {medians['simulation'] / medians['MuJoCo']:.2f}")
    print(f"retargeting / simulation       {medians['retargeting'] / medians['simulation']:.2f}")

    process = psutil.Process()
    before = process.memory_info().rss
    for number in range(arguments.trials):
        task.execute(task.via_points.moved(control, changes[number % len(changes)]), number)
    growth = (process.memory_info().rss - before) / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(f"memory: {growth:+.1f} MB over {arguments.trials} trials, peak {peak:.0f} MB")


def bare_integration(task: ServeTask) -> Callable[[JointMovement], None]:
    """Drake's own integration of the arm's motion, in C++, with nobody looking."""
    scene = task.scene
    simulator = Simulator(scene.diagram)

    def integrate(movement: JointMovement) -> None:
        scene.tracking.follow(movement.trajectory)
        context = simulator.get_mutable_context()
        scene.diagram.SetDefaultContext(context)
        context.SetTime(0.0)
        own = scene.plant.GetMyMutableContextFromRoot(context)
        scene.plant.SetPositions(own, scene.instance, movement.angles[0])
        scene.load_ball(own)
        ApplySimulatorConfig(task.scenario.simulator, simulator)
        simulator.Initialize()
        simulator.AdvanceTo(float(movement.times[-1]))

    return integrate


def mujoco_rollout(task: ServeTask) -> Callable[[], None]:
    """MuJoCo stepping arm, racket and ball, under the torques of the first movement."""
    model = mujoco_model(task)
    data = mujoco.MjData(model)
    plant = task.scene.arm.plant
    context = plant.CreateDefaultContext()
    movement = task.retargeting.first
    trajectory = movement.trajectory
    times = np.arange(0.0, float(movement.times[-1]), STEP)
    torques = np.empty((1, times.size, model.nu))
    for row, t in enumerate(times):
        plant.SetPositions(context, trajectory(t))
        plant.SetVelocities(context, trajectory(t, 1))
        bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
        torques[0, row] = plant.CalcMassMatrix(context) @ trajectory(t, 2) + bias
    data.qpos[: model.nu] = movement.angles[0]
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)

    def step() -> None:
        mujoco.rollout.rollout(model, data, state[None], torques)

    return step


def mujoco_model(task: ServeTask) -> mujoco.MjModel:
    """The arm's own model file, with the racket's inertia, a free ball and a motor a joint."""
    spec = mujoco.MjSpec.from_file(str(models_path() / "arm" / "arm.urdf"))
    spec.compiler.fusestatic = False
    spec.option.timestep = STEP
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    plant = task.scene.arm.plant
    context = plant.CreateDefaultContext()
    racket = plant.GetBodyByName("racket")
    place = plant.CalcRelativeTransform(context, plant.GetFrameByName("hand"), racket.body_frame())
    inertia = racket.default_spatial_inertia()
    moments = inertia.Shift(inertia.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    spec.body("hand").add_body(
        name="racket",
        pos=place.translation(),
        quat=place.rotation().ToQuaternion().wxyz(),
        mass=inertia.get_mass(),
        ipos=inertia.get_com(),
        fullinertia=[*np.diag(moments), moments[0, 1], moments[0, 2], moments[1, 2]],
        explicitinertial=True,
    )
    ball = task.scenario.ball
    moment = 2 / 3 * ball.mass * ball.radius**2
    body = spec.worldbody.add_body(
        name="ball",
        pos=[0.0, 0.0, 2.0],
        mass=ball.mass,
        inertia=[moment] * 3,
        explicitinertial=True,
    )
    body.add_freejoint()
    for name in task.scene.arm.joint_names:
        motor = spec.add_actuator(name=name, target=name)
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    return spec.compile()


if __name__ == "__main__":
    main()
