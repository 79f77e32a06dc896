"""What cameras tell of a serve: ball, racket and goal as coloured blobs, 60 times a second.

T_H and T_G come from parabolas through the ball's samples, T_Gd from the goal's. What the arm was
told is known, so T_Hd is that, moved by as much as the racket is seen to stray from it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.robot.arm import Arm
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.cameras import Cameras, Samples
from drake_viapoint.tasks.seen_flight import find_flights
from drake_viapoint.tasks.serve_results import judged
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_trial import SeenServe, ServeTrial
from drake_viapoint.tasks.serve_unknown import spawned

_STRAYING = 0.15  # [s] before t_HIT in which the racket's straying is looked at


class ServeSight:
    """Watches serves.

    Args:
        scenario: How well cameras see.
        arm: That serves, with the racket for a tool.
        ring: (3,) centre of the goal's ring [m].
    """

    def __init__(self, scenario: ServeScenario, arm: Arm, ring: NDArray[np.float64]) -> None:
        self._arm = arm
        self._ring = ring
        self._cameras = Cameras(scenario.cameras.rate, scenario.cameras.noise)
        self._radius = scenario.ball.radius
        self._learning = scenario.learning

    def __call__(self, trial: ServeTrial, movement: JointMovement, seed: int) -> ServeTrial:
        """The trial, with what was seen of it.

        Args:
            trial: As it happened.
            movement: What the arm was told.
            seed: Of the trial.
        """
        rng = spawned(seed, 1)
        times = self._cameras.moments(trial.end, rng)
        ball = self._cameras.sample(trial.ball_path, times, rng)
        held = times[times <= trial.racket.end]
        racket = self._cameras.sample(lambda t: trial.racket(t).position, held, rng)
        goal = self._cameras.sample(lambda t: np.tile(self._ring, (t.size, 1)), times, rng)

        hit_time, rate, noise = trial.hit_time, self._cameras.rate, self._cameras.noise
        ring = goal.positions.mean(axis=0)
        flights = find_flights(ball, hit_time, noise, float(ring[2]), rate)
        landed = flights.struck and flights.struck.fall_through(float(ring[2]))
        results = judged(
            self._learning,
            flights.thrown.position(hit_time) if flights.thrown else None,
            self._desired_meeting(racket, movement, hit_time),
            flights.struck.position(landed)[:2] if flights.struck and landed else None,
            ring[:2],
        )
        return replace(trial, seen=SeenServe(results, ball, racket, goal, flights))

    def _desired_meeting(
        self, racket: Samples, movement: JointMovement, hit_time: float
    ) -> NDArray[np.float64] | None:
        """A ball's radius in front of the face's centre (3,) [m]; None if it is not seen."""
        before = (racket.times > hit_time - _STRAYING) & (racket.times <= hit_time)
        seen = racket.within(before)
        if seen.times.size < 3:
            return None
        told = [self._arm.tool_pose(q).position for q in movement.trajectory(seen.times)]
        ago = np.stack([np.ones_like(seen.times), seen.times - hit_time], axis=1)
        straying = np.linalg.lstsq(ago, seen.positions - told, rcond=None)[0][0]
        face = self._arm.tool_pose(movement.trajectory(hit_time))
        wanted: NDArray[np.float64] = face.position + straying + self._radius * face.rotation[:, 1]
        return wanted
