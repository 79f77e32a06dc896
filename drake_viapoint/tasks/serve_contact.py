"""A serve executed with contact: what happened is read off the steps, event by event.

Nothing tells the simulation when the ball leaves, is struck or lands; that is found out here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from drake_viapoint.robot.arm_motion import ArmMotion
from drake_viapoint.robot.retargeting import JointMovement
from drake_viapoint.tasks.flight import Flight, Parabola
from drake_viapoint.tasks.held_racket import LooseRacket
from drake_viapoint.tasks.racket import RacketMotion
from drake_viapoint.tasks.serve_contact_scene import ContactScene
from drake_viapoint.tasks.serve_contact_steps import BallStates, ContactIntegration
from drake_viapoint.tasks.serve_results import judged
from drake_viapoint.tasks.serve_scenario import ServeScenario
from drake_viapoint.tasks.serve_trial import BallEvent, ServeOutcome, ServeTrial, ball_event
from drake_viapoint.tasks.serve_unknown import AVERAGE


class ContactExecution:
    """Executes serves in one diagram, reused; each trial as if it were the first.

    Args:
        scenario: What is simulated and how accurately.
        scene: The diagram.
        hit_time: t_HIT, when the ball should be hit [s].
    """

    def __init__(self, scenario: ServeScenario, scene: ContactScene, hit_time: float) -> None:
        self._scene = scene
        self._hit_time = hit_time
        self._learning = scenario.learning
        self._radius = scenario.ball.radius
        self._unknown = scene.unknown(scenario.seed)
        self._integration = ContactIntegration(scenario, scene, self._unknown)

    def execute(self, movement: JointMovement, seed: int = 0) -> ServeTrial:
        """Simulate a serve; the seed is that of what differs from trial to trial.

        Raises:
            BallFallsOutError: The ball does not rest in the cup before the movement begins.
            BrokenOffError: The simulation fails.
        """
        scene = self._scene
        drawn = self._unknown.draw(seed)
        steps = self._integration(movement, drawn)
        motion = ArmMotion([steps.arm])
        racket = LooseRacket(scene.arm, motion, scene.loosened(drawn))
        path = FollowedPath(CubicHermiteSpline(*steps.ball))
        contact = _Contact(scene, racket, steps.ball, path, self._radius)
        events, flights, from_behind = contact.history()
        names = [event.name for event in events]
        hit_time = self._hit_time
        thrown = bool(flights) and events[0].time <= hit_time
        meeting = flights[0].position(hit_time) if thrown else path([hit_time])[0]
        state = racket([hit_time])
        wanted = state.position[0] + self._radius * state.normal[0]
        landing = events[-1].ball_position[:2] if "landing" in names else None
        return ServeTrial(
            ending=_ending(thrown, names, from_behind),
            events=events,
            hit_time=hit_time,
            happened=judged(self._learning, meeting, wanted, landing, np.array(scene.ring[:2])),
            saturated=scene.arm.named(steps.clamped),
            beyond_limits=scene.arm.named(motion.beyond(scene.arm.limits)),
            tracking_error=motion.strayed(movement.trajectory),
            disturbed=drawn,
            motion=motion,
            racket=racket,
            path=path,
            flights=flights,
        )

    def check_start(self, movement: JointMovement) -> None:
        """Make sure that a movement can begin, in an average trial.

        Raises:
            BallFallsOutError: The ball does not rest in the cup.
            BrokenOffError: The simulation fails.
        """
        self._integration.settle(movement, AVERAGE)


@dataclass(frozen=True)
class FollowedPath:
    """Where the ball is, as far as it was followed: exact in flight, which a cubic can be."""

    spline: CubicHermiteSpline

    def __call__(self, times: ArrayLike) -> NDArray[np.float64]:
        """Centre of the ball (n, 3) [m] at times (n,) [s]."""
        return np.asarray(self.spline(np.minimum(times, self.spline.x[-1])))


@dataclass(frozen=True)
class _Contact:
    """What a ball touched on its way."""

    scene: ContactScene
    racket: RacketMotion
    ball: BallStates
    path: FollowedPath
    radius: float

    def history(self) -> tuple[tuple[BallEvent, ...], tuple[Flight, ...], bool]:
        """Events, flights, and whether the strings met the ball with their back."""
        looks = self.ball.times
        on_strings = self._on_strings(looks) <= 0
        struck = np.flatnonzero(on_strings)
        first_struck = int(struck[0]) if struck.size else looks.size
        in_cup = np.flatnonzero(self._in_cup(looks[:first_struck]) <= 0)
        left = int(in_cup[-1]) if in_cup.size else 0  # the last look at which it was in the cup
        if left + 1 >= looks.size:
            return (), (), False
        release = self._root(self._in_cup, left)
        events = [self._event("release", release)]
        flights: list[Flight] = [self._flight(left + 1)]
        if not struck.size:
            return tuple(events), tuple(flights), False
        hit = self._root(self._on_strings, first_struck - 1)
        state = self.racket([hit])
        from_behind = bool(state.normal[0] @ (self.path([hit]) - state.position)[0] < 0)
        falls = self._falls(first_struck)
        until = falls if falls is not None else looks.size
        gone = int(struck[struck <= until][-1]) + 1  # the first look at which it has left them
        name = "caught_behind" if from_behind else "hit"
        if gone < looks.size:
            flights.append(self._flight(gone))
            events.append(self._event(name, hit, flights[-1].velocity(hit)))
        if falls is not None:
            ring = float(self.scene.ring[2])
            events.append(
                self._event("landing", self._root(lambda t: self.path(t)[:, 2] - ring, falls))
            )
        return tuple(events), tuple(flights), from_behind

    def _falls(self, start: int) -> int | None:
        """The last look before the ball falls through the ring's height, from a look on."""
        height = self.ball.position[start:, 2] - self.scene.ring[2]
        falls = np.flatnonzero((height[:-1] >= 0) & (height[1:] < 0))
        return start + int(falls[0]) if falls.size else None

    def _flight(self, look: int) -> Parabola:
        ball = self.ball
        return Parabola(float(ball.times[look]), ball.position[look], ball.velocity[look])

    def _in_cup(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance (n,) of the ball from the cup [m]; at most 0 where it touches it."""
        place = self.scene.cup_pose
        local = (self._in_racket(times) - place.translation()) @ place.rotation().matrix()
        gaps = [ring.gap(local, self.radius) for ring in self.scene.cup_rings]
        return np.minimum(*gaps)

    def _on_strings(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance (n,) of the ball from the strings [m]; at most 0 where it touches them."""
        return self.scene.strings.gap(self._in_racket(times), self.radius)

    def _in_racket(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        state = self.racket(np.minimum(times, self.racket.end))
        offset = self.path(times) - state.position
        return np.einsum("nij,ni->nj", state.rotation, offset)

    def _root(self, gap: Callable[[NDArray[np.float64]], NDArray[np.float64]], look: int) -> float:
        """When a distance changes its sign after a look [s]; at the look itself if it does not."""
        start, end = self.ball.times[look], self.ball.times[look + 1]
        before, after = gap(np.array([start, end]))
        if before * after > 0:  # as where the strings take the ball out of the cup
            return float(start)
        return float(brentq(lambda t: float(gap(np.array([t]))[0]), start, end, xtol=1e-12))

    def _event(
        self, name: str, time: float, velocity: NDArray[np.float64] | None = None
    ) -> BallEvent:
        spline = self.path.spline
        moving = spline(time, 1) if velocity is None else velocity
        return ball_event(name, time, spline(time), moving, self.racket)


def _ending(thrown: bool, events: list[str], from_behind: bool) -> ServeOutcome:
    if not thrown:
        return ServeOutcome.NOT_RELEASED
    if from_behind:
        return ServeOutcome.CAUGHT_BEHIND
    if "hit" not in events:
        return ServeOutcome.MISSED
    return ServeOutcome.LANDED if "landing" in events else ServeOutcome.FELL_SHORT
