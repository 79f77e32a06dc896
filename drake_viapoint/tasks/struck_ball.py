"""What becomes of a thrown ball: struck by the face, missed, or caught behind it.

Event times are roots of continuous functions, never rounded to a step. The racket is taken as much
heavier than the ball: the bounce reverses the normal velocity relative to the face and leaves the
racket's own motion alone. A ball that passes outside the oval flies on; that the rim could touch
it is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from drake_viapoint.tasks.flight import Flight, fly
from drake_viapoint.tasks.racket import Face, RacketMotion

_SEARCH_STEP = 0.01  # [s] finer than any crossing back and forth: at 5 m/s the ball moves 5 cm


@dataclass(frozen=True)
class Encounter:
    """The ball's centre comes within its radius of the face's plane, inside the oval."""

    time: float  # [s]
    from_behind: bool


def bounce(
    velocity: NDArray[np.float64],
    surface_velocity: NDArray[np.float64],
    normal: NDArray[np.float64],
    restitution: float,
) -> NDArray[np.float64]:
    """Velocity of a ball after it bounced off a moving surface without friction.

    Args:
        velocity: Of the ball before (3,) [m/s].
        surface_velocity: Of the surface's point of contact (3,) [m/s].
        normal: Unit normal of the surface (3,).
        restitution: Ratio of the normal relative speeds after and before.
    """
    approach = normal @ (velocity - surface_velocity)
    after: NDArray[np.float64] = velocity - (1 + restitution) * approach * normal
    return after


def first_encounter(
    flight: Flight, racket: RacketMotion, face: Face, radius: float
) -> Encounter | None:
    """Where the flying ball first meets the face; None if it never does.

    Args:
        flight: Of the ball, from its release.
        racket: The motion of the racket; the search ends with it.
        face: The oval.
        radius: Of the ball [m].
    """

    def height(t: float) -> float:
        """Of the ball's centre over the face's plane [m]."""
        state = racket([t])
        return float(state.normal[0] @ (flight.position(t) - state.position[0]))

    count = max(2, int(np.ceil((racket.end - flight.start) / _SEARCH_STEP)) + 1)
    times = np.linspace(flight.start, racket.end, count)
    states = racket(times)
    offsets = flight.position(times) - states.position
    heights = np.einsum("ni,ni->n", states.normal, offsets)
    front = (heights[:-1] > radius) & (heights[1:] <= radius)
    back = (heights[:-1] < -radius) & (heights[1:] >= -radius)
    for i in np.nonzero(front | back)[0]:
        surface = radius if front[i] else -radius
        time = float(brentq(lambda t, s=surface: height(t) - s, times[i], times[i + 1], xtol=1e-14))
        state = racket([time])
        local = state.rotation[0].T @ (flight.position(time) - state.position[0])
        if face.contains(local):
            return Encounter(time, from_behind=bool(back[i]))
    return None


def strike(
    flight: Flight,
    racket: RacketMotion,
    time: float,
    radius: float,
    restitution: float,
    drag: float,
    disturbed: NDArray[np.float64] | float = 1.0,
) -> Flight:
    """The flight after the face struck the ball.

    Args:
        flight: Of the ball before.
        racket: The motion of the racket.
        time: Of the encounter [s].
        radius: Of the ball [m].
        restitution: Ratio of the normal relative speeds after and before.
        drag: Deceleration over speed squared [1/m].
        disturbed: Factors on the components of the velocity after (3,).
    """
    state = racket([time])
    centre = flight.position(time)
    contact = centre - radius * state.normal[0]
    surface_velocity = state.point_velocity(contact[None])[0]
    after = bounce(flight.velocity(time), surface_velocity, state.normal[0], restitution)
    return fly(time, centre, after * disturbed, drag)
