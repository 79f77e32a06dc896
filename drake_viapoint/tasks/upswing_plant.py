"""The upswing in continuous time, with a hand that moves exactly as commanded.

The plant is the pendulum alone, as seen from the hand: there the hinge is at rest, and the hand's
acceleration x'' is a force -m x'' on the bob, that is m l x'' cos theta about the hinge.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.math import BsplineBasis
from pydrake.multibody.plant import ApplyMultibodyPlantConfig, MultibodyPlant, MultibodyPlantConfig
from pydrake.symbolic import Variable, cos
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Multiplexer, SymbolicVectorSystem, TrajectorySource
from pydrake.trajectories import BsplineTrajectory

from drake_viapoint.errors import ScenarioError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.robot.arm_motion import ArmMotion, MotionSegment
from drake_viapoint.robot.step_log import StepLog
from drake_viapoint.robot.stepping import Stepping
from drake_viapoint.tasks.pendulum import PendulumMotion
from drake_viapoint.tasks.upswing_line import HandLine, LineCheck
from drake_viapoint.tasks.upswing_pendulum import hang_pendulum
from drake_viapoint.tasks.upswing_scenario import UpswingPendulum, UpswingScenario


class PushedPendulum:
    """The diagram of a pendulum in the frame of its hand.

    Args:
        pendulum: What swings.
        config: Of the plant.

    Attributes:
        diagram: Pendulum, the hand's acceleration and the force it makes.
        plant: The pendulum alone.
        joint: Its angle is theta.
    """

    def __init__(self, pendulum: UpswingPendulum, config: MultibodyPlantConfig) -> None:
        builder = DiagramBuilder()
        self.plant = MultibodyPlant(config.time_step)
        ApplyMultibodyPlantConfig(config, self.plant)
        self.joint = hang_pendulum(self.plant, self.plant.world_frame(), pendulum)
        self.plant.Finalize()
        builder.AddNamedSystem("plant", self.plant)
        still = BsplineTrajectory(BsplineBasis(1, [0.0, 1.0]), [np.zeros((1, 1))])
        self._hand = builder.AddNamedSystem("hand_acceleration", TrajectorySource(still))
        together = builder.AddNamedSystem("state_and_acceleration", Multiplexer([2, 1]))
        angle, speed, acceleration = Variable("theta"), Variable("omega"), Variable("x''")
        torque = pendulum.mass * pendulum.length * acceleration * cos(angle)
        # Drake (1.51) wants this kind of system to have a state; the work done is one worth having
        push = builder.AddNamedSystem(
            "push",
            SymbolicVectorSystem(
                input=[angle, speed, acceleration],
                state=[Variable("work")],
                dynamics=[torque * speed],
                output=[torque],
            ),
        )
        builder.Connect(self.plant.get_state_output_port(), together.get_input_port(0))
        builder.Connect(self._hand.get_output_port(), together.get_input_port(1))
        builder.Connect(together.get_output_port(), push.get_input_port())
        builder.Connect(
            push.get_output_port(), self.plant.get_applied_generalized_force_input_port()
        )
        self.diagram = builder.Build()
        self.diagram.set_name("pushed_pendulum")

    def push(self, acceleration: BsplineTrajectory) -> None:
        """Accelerate the hand so [m/s2] from now on; set the context's time afterwards."""
        self._hand.UpdateTrajectory(acceleration)


class KinematicExecution:
    """Executes upswings of a hand that obeys, in one diagram; each trial as if it were the first.

    Args:
        scenario: What swings and how accurately it is integrated.
        line: Where the hand moves; a movement out of its reach is refused.
        times: (n,) of the via-points [s].

    Attributes:
        times: Times of the motions it gives, a ``time_step`` apart or a little less [s].
    """

    def __init__(self, scenario: UpswingScenario, line: HandLine, times: ArrayLike) -> None:
        t = np.asarray(times, dtype=np.float64)
        self.times = sampling_times(t, scenario.time_step)
        self.pendulum = PushedPendulum(scenario.pendulum, scenario.plant)
        self._stepping = Stepping(self.pendulum.diagram, scenario.simulator)
        self._check = LineCheck(line, t)
        basis = minimum_jerk(t, np.eye(t.size))  # the path is linear in its via-points
        acceleration = basis.derivative(2)
        self._hand = basis(self.times)
        self._knots = BsplineBasis(acceleration.k + 1, list(acceleration.t))
        self._points = acceleration.c[: self._knots.num_basis_functions()]
        self._start, self._end = float(t[0]), float(t[-1])

    def __call__(self, x: ArrayLike) -> PendulumMotion:
        """Move the hand through via-points (n,) [m] and see what the pendulum does.

        Raises:
            ScenarioError: Not as many via-points as times.
            LineReachError: A via-point is out of the arm's reach, or the path between two.
        """
        via_points = check_places(x, self._points.shape[1])
        self._check(via_points)
        points = self._points @ via_points
        self.pendulum.push(BsplineTrajectory(self._knots, list(points.reshape(-1, 1, 1))))
        swung = self._stepping.until_accepted(self._swing)
        angle, speed = at_times(swung, self.times)
        return PendulumMotion(self.times, self._hand @ via_points, angle, speed)

    def _swing(self) -> MotionSegment:
        stepping, plant = self._stepping, self.pendulum.plant
        stepping.reset(self._start)
        log = StepLog(plant, self.pendulum.joint.model_instance(), stepping.context)

        def record() -> bool:
            log.add()
            return False

        stepping.advance(self._end, record)
        return log.segment()


def check_places(x: ArrayLike, number: int) -> NDArray[np.float64]:
    """Places of the hand as an array (n,).

    Raises:
        ScenarioError: Not as many as via-points, or not finite.
    """
    places = np.asarray(x, dtype=np.float64)
    if places.shape != (number,):
        raise ScenarioError(
            f"the movement has {number} via-points, got an array of shape {places.shape}"
        )
    if not np.all(np.isfinite(places)):
        raise ScenarioError(f"places of the hand must be finite, got {places.tolist()}")
    return places


def sampling_times(times: NDArray[np.float64], longest: float) -> NDArray[np.float64]:
    """Regular times from the first to the last, no more than so long apart [s]."""
    duration = float(times[-1] - times[0])
    steps = int(np.ceil(duration / longest - 1e-6))
    return np.linspace(times[0], times[-1], steps + 1)


def at_times(
    swung: MotionSegment, times: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angle and speed (n,) of a pendulum between the integrator's steps; its own at the end."""
    motion = ArmMotion([swung])
    angle, speed = motion.q(times)[:, 0], motion.v(times)[:, 0]
    angle[-1], speed[-1] = swung.q[-1, 0], swung.v[-1, 0]
    return angle, speed
