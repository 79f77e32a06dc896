"""Integrating a serve with contact: short steps while the ball may touch something, long ones else.

A ball in the air is followed as cheaply as contact allows: nothing it could touch is nearer than it
can come within a long step (conservative advancement), and a flight without drag is a parabola,
which an integrator of third order follows exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from drake_viapoint.errors import BallFallsOutError, BrokenOffError
from drake_viapoint.robot.arm_motion import MotionSegment
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.robot.step_log import ArmLog
from drake_viapoint.robot.stepping import Stepping
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.serve_contact_scene import ContactScene
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_unknown import TrialDraw, Unknown

_NO_TIME = 1e-6  # [s]
_LOOK = 1e-3  # [s] between two looks at a ball that may touch something
_MARGIN = 1e-3  # [m] nearer than this, the ball may touch
_LONGEST_GLIDE = 0.01  # [s] between two looks, however far away everything is
_SURPRISE = 2.0  # [m/s] that ball and racket may gain on each other between two looks
_REACH = 0.6  # [m] from the racket's origin to its farthest point
_RESTING = 1e-3  # [m/s] a slower ball rests
_LONG_ENOUGH = 10  # looks
_PATIENCE = 2.0  # [s] by when the ball should rest in the cup
_AFTERWARDS = 2.0  # [s] after the movement, by when the ball should have landed


class BallStates(NamedTuple):
    """The ball at n times."""

    times: NDArray[np.float64]  # (n,) [s]
    position: NDArray[np.float64]  # (n, 3) [m]
    velocity: NDArray[np.float64]  # (n, 3) [m/s]


@dataclass(frozen=True)
class ContactSteps:
    """What arm and ball did, look by look."""

    arm: MotionSegment
    ball: BallStates
    clamped: NDArray[np.bool_]  # (k,) whether a joint's torque was clamped at a look


class ContactIntegration:
    """Integrates arm and ball through serves in one diagram, each as if it were the first.

    Args:
        scenario: Steps and surfaces.
        scene: The diagram.
        unknown: What the robot really is.
    """

    def __init__(self, scenario: ServeScenario, scene: ContactScene, unknown: Unknown) -> None:
        self._scene = scene
        self._unknown = unknown
        self._radius = scenario.ball.radius
        self._step = scenario.contact.step
        self._longest = scenario.simulator.max_step_size
        self._stepping = Stepping(scene.diagram, scenario.simulator)

    def __call__(self, movement: JointMovement, trial: TrialDraw) -> ContactSteps:
        """Integrate a movement until it is over and the ball has fallen through the ring's height.

        Raises:
            BallFallsOutError: The ball does not rest in the cup before the movement begins.
            BrokenOffError: The integration fails.
        """
        self.settle(movement, trial)
        scene, stepping = self._scene, self._stepping
        scene.tracking.follow(movement.trajectory)
        stepping.set_clock(float(movement.times[0]))
        log = ArmLog(scene.plant, scene.instance, scene.tracking, stepping.context)
        times: list[float] = []
        ball: list[NDArray[np.float64]] = []
        end = float(movement.times[-1])
        last = end + _AFTERWARDS
        while True:
            log.add()
            state = self._ball()
            times.append(stepping.context.get_time())
            ball.append(state)
            landed = state[2] < scene.ring[2] and state[5] < 0
            if times[-1] >= (end if landed else last):
                break
            until = end if times[-1] < end else last
            self._advance(state, until)
        states = np.array(ball)
        return ContactSteps(
            log.segment(), BallStates(np.array(times), states[:, :3], states[:, 3:]), log.clamped()
        )

    def settle(self, movement: JointMovement, trial: TrialDraw) -> None:
        """Hold the arm where a movement begins until the ball rests in the cup.

        Raises:
            BallFallsOutError: It does not.
            BrokenOffError: The integration fails.
        """
        scene, stepping = self._scene, self._stepping
        start = movement.angles[0]
        hold = BSpline(np.r_[np.zeros(6), np.ones(6)], np.tile(start, (6, 1)), 5)
        scene.tracking.follow(hold)
        stepping.reset(0.0)
        scene.differ(stepping.context, self._unknown, trial)
        own = scene.plant.GetMyMutableContextFromRoot(stepping.context)
        scene.plant.SetPositions(own, scene.instance, start)
        scene.seat_ball(own)
        slow = 0  # looks in a row at which it did not move
        while slow < _LONG_ENOUGH:
            self._march(_LOOK, self._step)
            state = self._ball()
            away = np.linalg.norm(state[:3] - scene.cup_frame.CalcPoseInWorld(own).translation())
            speed = np.linalg.norm(state[3:])
            if away > self._radius or stepping.context.get_time() > _PATIENCE:
                raise BallFallsOutError(float(away), float(speed))
            slow = slow + 1 if speed < _RESTING else 0

    def _advance(self, ball: NDArray[np.float64], until: float) -> None:
        """Go on to the next look."""
        glide = self._glide(ball)
        if glide > _LOOK:
            self._march(glide, self._longest, until)
        else:
            self._march(_LOOK, self._step, until)

    def _march(self, span: float, longest: float, until: float = np.inf) -> None:
        """Integrate over a span [s], in equal steps no longer than this [s], to a time at most."""
        stepping = self._stepping
        before = stepping.context.get_time()
        end = before + span
        if end > until - _NO_TIME:  # to the very time, and without a last step of no length
            end = until
        count = np.ceil((end - before) / longest - 1e-9)
        try:
            stepping.march(end, (end - before) / count)
        except RuntimeError as error:
            raise BrokenOffError(before, " ".join(str(error).split())) from error
        state = self._ball()
        if not np.all(np.abs(state) < 1e3):
            raise BrokenOffError(before, f"the ball is at {state[:3]} m")

    def _glide(self, ball: NDArray[np.float64]) -> float:
        """For how long the ball surely touches nothing [s]; 0 if it may already."""
        scene, place = self._scene, ball[:3]
        own = scene.plant.GetMyContextFromRoot(self._stepping.context)
        racket = scene.racket_frame.CalcPoseInWorld(own)
        moving = scene.racket_frame.CalcSpatialVelocityInWorld(own)
        in_racket = racket.inverse().multiply(place)
        in_cup = scene.cup_pose.inverse().multiply(in_racket)
        on_racket = min(
            scene.strings.least_gap(in_racket, self._radius),
            *(ring.least_gap(in_cup, self._radius) for ring in scene.cup_rings),
        )
        closing = (
            np.linalg.norm(ball[3:] - moving.translational())
            + _REACH * np.linalg.norm(moving.rotational())
            + _SURPRISE
        )
        on_ring = scene.goal_ring.least_gap(place - scene.ring, self._radius)
        falling = np.linalg.norm(ball[3:]) + GRAVITY * _LONGEST_GLIDE
        return min(
            max(0.0, on_racket - _MARGIN) / float(closing),
            max(0.0, on_ring - _MARGIN) / float(falling),
            _LONGEST_GLIDE,
        )

    def _ball(self) -> NDArray[np.float64]:
        """Position [m] and velocity [m/s] of the ball (6,)."""
        scene = self._scene
        own = scene.plant.GetMyContextFromRoot(self._stepping.context)
        velocity = scene.plant.EvalBodySpatialVelocityInWorld(own, scene.ball)
        place = scene.plant.EvalBodyPoseInWorld(own, scene.ball)
        return np.concatenate([place.translation(), velocity.translational()])
