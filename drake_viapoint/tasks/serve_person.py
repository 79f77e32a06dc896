"""A virtual person who serves: own limbs, own racket and ball, own style. Synthetic, and named so.

No recording of the paper's is public, so the demonstration is made. The person moves seven joints
of an arm that is not the robot's from posture to posture; the racket's path that follows is smooth
but is no minimum-jerk path of a few Cartesian via-points. Before being measured the person
practises: a few postures are corrected until the own serve lands in the goal, in the same physics
of release, flight and bounce in which the robot will be tried.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline, make_interp_spline
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from drake_viapoint.errors import DemonstrationError
from drake_viapoint.motion.minimum_jerk import minimum_jerk
from drake_viapoint.motion.orientation import rotation_from_zyz, unwrap_zyz, zyz_from_rotation
from drake_viapoint.tasks.carried_ball import Cup
from drake_viapoint.tasks.flight import Flight, fly
from drake_viapoint.tasks.racket import Face, PoseSpline
from drake_viapoint.tasks.struck_ball import first_encounter, strike

# A serve that works for a body of middle size: times [s], position of the hand relative to the
# shoulder [m], turn phi of the handle from pointing right and turn psi of the face about it [rad].
_PLAN = np.array(
    [
        # t      x      y       z      phi    psi
        [0.00, 0.120, 0.360, -0.270, 0.000, 0.000],
        [0.32, 0.104, 0.364, -0.331, 0.000, 0.000],
        [0.45, 0.196, 0.374, -0.069, 0.000, 0.000],
        [0.57, 0.239, 0.357, 0.094, 0.000, 0.020],
        [0.82, 0.120, 0.210, -0.123, 0.087, 0.470],
        [1.02, 0.056, 0.423, 0.011, 0.170, 0.554],
        [1.13, 0.025, 0.536, -0.032, 0.066, 0.630],
        [1.35, 0.040, 0.500, -0.020, 0.100, 0.600],
    ]
)
_POSTURES = np.linspace(0.0, 1.35, 14)  # [s] the body passes through so many postures
_THROW = 5  # posture just after the ball has left, at 0.52 s
_HIT = 9  # posture that meets the ball, at 0.935 s
_THROW_POINTS = [3]  # rows of the plan that practice of the throw shifts
_HIT_POINTS = [5, 6]  # and practice of the strike
_RELAXED = np.array([0.2, -0.3, 0.0, 1.3, 0.0, 0.0, 0.0])  # posture the body likes [rad]
_DOWN = np.array([0.0, 0.0, -1.0])  # along every limb when the arm hangs
# The racket in the hand: with the forearm forward, the handle points right and the face forward.
_GRIP = Rotation.from_euler("X", -np.pi / 2) * Rotation.from_euler("Y", np.pi / 2)
_CUP = np.array([-0.10, 0.0, -0.43])  # the robot's; a person has it 5 to 10 cm from there [m]
_SAMPLE = 0.0075  # [s] between the points that carry the racket's path from joints to a spline


class Body(NamedTuple):
    """Where the parts of a body are at n times, in the world."""

    elbow: NDArray[np.float64]  # (n, 3) [m]
    hand: NDArray[np.float64]  # (n, 3) [m]
    racket: Rotation  # n, world from racket
    centre: NDArray[np.float64]  # (n, 3) of the racket's face [m]


@dataclass(frozen=True)
class ServePerson:
    """Body, tools and skill of one virtual person; lengths in metres."""

    upper_arm: float
    forearm: float
    hand: float
    shoulder: NDArray[np.float64]  # (3,) in the world
    handle: float  # from the grip to the centre of the face
    cup: Cup
    face: Face
    ball_radius: float
    restitution: float
    pace: float  # time over the plan's time
    style: NDArray[np.float64]  # (14, 7) habit: difference from the plan's postures [rad]
    aim: NDArray[np.float64]  # (2,) where on the face the ball is met, x and z [m]
    miss: NDArray[np.float64]  # (2,) what practice leaves of the landing error [m]

    def body(self, joints: ArrayLike) -> Body:
        """Forward kinematics: shoulder (3), elbow (1), forearm (1) and wrist (2) [rad].

        Args:
            joints: (n, 7) angles.
        """
        q = np.atleast_2d(np.asarray(joints, dtype=np.float64))
        upper = Rotation.from_euler("XYZ", q[:, :3])
        lower = upper * Rotation.from_euler("X", q[:, 3:4])
        hand = lower * Rotation.from_euler("ZXY", q[:, 4:])
        elbow_at = self.shoulder + self.upper_arm * upper.apply(_DOWN)
        hand_at = elbow_at + self.forearm * lower.apply(_DOWN) + self.hand * hand.apply(_DOWN)
        racket = hand * _GRIP
        return Body(elbow_at, hand_at, racket, hand_at + racket.apply([0.0, 0.0, self.handle]))


@dataclass(frozen=True)
class PersonServe:
    """A person's serve as it happened: the movement, the ball's two flights, the events [s]."""

    joints: BSpline[np.float64]  # seven angles [rad]
    racket: PoseSpline
    release: float
    hit: float
    landing: float
    thrown: Flight
    struck: Flight


def draw_person(number: int, seed: int = 1998) -> ServePerson:
    """Person ``number`` of the population that ``seed`` draws; 0 serves in the shipped file."""
    rng = np.random.default_rng([seed, number])
    # slow waves, so that a habit bends the movement and does not make it tremble
    waves = np.sin(np.pi * np.outer(_POSTURES / _POSTURES[-1], [1.0, 2.0, 3.0]))
    style = waves @ rng.normal(scale=[[0.03], [0.01], [0.003]], size=(3, 7))
    return ServePerson(
        upper_arm=rng.uniform(0.28, 0.32),
        forearm=rng.uniform(0.25, 0.28),
        hand=rng.uniform(0.07, 0.09),
        shoulder=np.array([0.0, 0.0, 1.2]) + rng.uniform(-0.02, 0.02, 3),
        handle=rng.uniform(0.42, 0.44),
        cup=Cup(_CUP + rng.uniform(0.05, 0.1) * _direction(rng), np.array([-1.0, 0.0, 0.0])),
        face=Face(half_width=0.115, half_length=0.155),
        ball_radius=rng.uniform(0.0327, 0.0343),
        restitution=rng.uniform(0.75, 0.85),
        pace=rng.uniform(0.98, 1.02),
        style=style,
        aim=rng.normal(scale=0.01, size=2),
        miss=rng.normal(scale=0.03, size=2),
    )


def _direction(rng: np.random.Generator) -> NDArray[np.float64]:
    """A unit vector (3,), any direction as likely."""
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector))


def practise(person: ServePerson, goal: ArrayLike) -> PersonServe:
    """The person's serve, corrected until the ball is met as aimed and lands in the goal.

    Args:
        person: Who serves.
        goal: (3,) centre of the goal's ring [m].

    Raises:
        DemonstrationError: This person cannot serve into this goal.
    """
    ring = np.asarray(goal, dtype=np.float64)
    times = _POSTURES * person.pace
    postures = _postures(person)
    thrower = _directions(person, postures[_THROW])[:, :3]
    hitter = _directions(person, postures[_HIT])[:, 3:]
    throw_share, hit_share = _share(_THROW_POINTS), _share(_HIT_POINTS)

    def corrected(throw: NDArray[np.float64], hit: NDArray[np.float64]) -> NDArray[np.float64]:
        turn = hitter @ np.array([-hit[0], 0.0, hit[1]])
        shift = np.outer(throw_share, thrower @ throw) + np.outer(hit_share, turn)
        corrected: NDArray[np.float64] = postures + shift
        return corrected

    def miss(change: NDArray[np.float64]) -> NDArray[np.float64]:
        """By how much ball and face miss each other, and the struck ball its place (5,) [m].

        The strike is reckoned at the planned time wherever the ball is, so that this is smooth.
        """
        racket = _move(person, times, corrected(change[:3], change[3:]))[1]
        thrown = _throw(person, racket)
        state = racket([times[_HIT]])
        offset = state.rotation[0].T @ (thrown.position(times[_HIT]) - state.position[0])
        wanted = np.array([person.aim[0], person.ball_radius, person.aim[1]])
        struck = strike(thrown, racket, times[_HIT], person.ball_radius, person.restitution, 0.0)
        landing = struck.fall_through(ring[2])
        if landing is None:
            raise DemonstrationError("this person strikes the ball below the goal's height")
        strayed = struck.position(landing)[:2] - ring[:2] - person.miss
        return np.concatenate([offset - wanted, strayed])

    def ill_thrown(throw: NDArray[np.float64]) -> NDArray[np.float64]:
        return miss(np.r_[throw, 0.0, 0.0])[:3]

    throw = least_squares(ill_thrown, np.zeros(3), xtol=1e-10).x
    fit = least_squares(miss, np.r_[throw, 0.0, 0.0], xtol=1e-10)
    # rounding leaves the last bits of a fit to the machine; a file should not depend on them
    change = np.round(fit.x, 9)
    if np.max(np.abs(miss(change))) > 1e-3:
        raise DemonstrationError("practice does not bring this person's serve into the goal")
    return _serve(person, times, corrected(change[:3], change[3:]), ring[2])


def _share(rows: list[int]) -> NDArray[np.float64]:
    """How much each posture (14,) takes part when rows of the plan are shifted: smoothly."""
    shifted = np.zeros((len(_PLAN), 1))
    shifted[rows] = 1.0
    return minimum_jerk(_PLAN[:, 0], shifted)(_POSTURES)[:, 0]


def _postures(person: ServePerson) -> NDArray[np.float64]:
    """Joint angles (14, 7) of the plan for this body, with its habits."""
    postures = []
    q = _RELAXED
    for x, y, z, phi, psi in minimum_jerk(_PLAN[:, 0], _PLAN[:, 1:])(_POSTURES):
        turned = Rotation.from_matrix(rotation_from_zyz([phi, np.pi / 2, psi]))
        hand = person.shoulder + [x, y, z]

        def residual(
            q: NDArray[np.float64],
            hand: NDArray[np.float64] = hand,
            turned: Rotation = turned,
        ) -> NDArray[np.float64]:
            body = person.body(q)
            turn = (body.racket.inv() * turned).as_rotvec()[0]
            comfort = 0.02 * (q - _RELAXED)  # the plan is followed, comfort decides the rest
            return np.concatenate([10 * (body.hand[0] - hand), 3 * turn, comfort])

        q = least_squares(residual, q).x
        postures.append(q)
    return np.round(np.array(postures), 9) + person.style


def _directions(person: ServePerson, posture: NDArray[np.float64]) -> NDArray[np.float64]:
    """Changes of posture (7, 6) that move the face's centre along, and turn it about, the axes."""
    before = person.body(posture)
    columns = []
    for joint in range(7):
        after = person.body(posture + 1e-6 * np.eye(7)[joint])
        turn = (after.racket * before.racket.inv()).as_rotvec()[0]
        columns.append(np.concatenate([after.centre[0] - before.centre[0], turn]) / 1e-6)
    # regularised: far from any singular posture it changes nothing that practice would not mend
    jacobian = np.array(columns).T
    directions: NDArray[np.float64] = jacobian.T @ np.linalg.inv(
        jacobian @ jacobian.T + 1e-4 * np.eye(6)
    )
    return directions


def _move(
    person: ServePerson, times: NDArray[np.float64], postures: NDArray[np.float64]
) -> tuple[BSpline[np.float64], PoseSpline]:
    joints = minimum_jerk(times, postures)
    t = np.linspace(times[0], times[-1], int(np.ceil(times[-1] / _SAMPLE)) + 1)
    body = person.body(joints(t))
    zyz = unwrap_zyz(zyz_from_rotation(body.racket.as_matrix()))
    path = np.concatenate([body.centre, zyz], axis=1)
    return joints, PoseSpline(make_interp_spline(t, path, k=5))


def _throw(person: ServePerson, racket: PoseSpline) -> Flight:
    """The ball's flight out of the cup."""
    release = person.cup.release_time(racket)
    if release is None:
        raise DemonstrationError("the ball never leaves this person's cup")
    carried = person.cup.ball(racket, [release])
    return fly(release, carried.position[0], carried.velocity[0])


def _serve(
    person: ServePerson,
    times: NDArray[np.float64],
    postures: NDArray[np.float64],
    ring_height: float,
) -> PersonServe:
    joints, racket = _move(person, times, postures)
    thrown = _throw(person, racket)
    met = first_encounter(thrown, racket, person.face, person.ball_radius)
    if met is None or met.from_behind:
        raise DemonstrationError("this person misses the ball")
    struck = strike(thrown, racket, met.time, person.ball_radius, person.restitution, 0.0)
    landing = struck.fall_through(ring_height)
    if landing is None:
        raise DemonstrationError("this person's ball never falls through the goal's height")
    return PersonServe(joints, racket, thrown.start, met.time, landing, thrown, struck)
