"""Watching an upswing: from a marker file to via-points of the hand and the end state wanted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.signal import savgol_filter

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.demonstration.markers import read_markers
from drake_viapoint.demonstration.racket_pose import even_marker_paths, low_passed
from drake_viapoint.errors import EndStateError, GapError, HangingError, MarkerMissingError
from drake_viapoint.motion.extraction import Extraction, extract_via_points
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.pendulum import HANGING
from drake_viapoint.tasks.scene import scene_path
from drake_viapoint.tasks.upswing_recording import record_person
from drake_viapoint.tasks.upswing_scenario import UpswingDemonstration

FARTHEST_FROM_HANGING = 0.5
"""A pendulum further from hanging at first was not recorded from the start [rad]."""

_LINE = 0.24  # [s] of the lines that smooth what is not known of the pendulum's movement


class SeenPendulum(NamedTuple):
    """A pendulum as the camera saw it."""

    angle: NDArray[np.float64]  # (n,) theta, smoothed [rad]
    speed: NDArray[np.float64]  # (n,) omega [rad/s]
    length: float  # from hand to tip [m]


@dataclass(frozen=True)
class WatchedUpswing:
    """An upswing as it was seen.

    Attributes:
        recording: The markers.
        times: (n,) from 0 [s].
        hand: (n,) x of the hand, smoothed, from where it is first [m].
        pendulum: What was seen of the pendulum; None without a marker at its tip.
        extraction: Via-points of the hand, named x.
        end_state: (2,) theta_d [rad] and omega_d [rad/s].
        synthetic: Whether a virtual person made it.
    """

    recording: MarkerRecording
    times: NDArray[np.float64]
    hand: NDArray[np.float64]
    pendulum: SeenPendulum | None
    extraction: Extraction
    end_state: NDArray[np.float64]
    synthetic: bool

    @property
    def angle(self) -> NDArray[np.float64] | None:
        """(n,) theta, smoothed [rad]."""
        return None if self.pendulum is None else self.pendulum.angle

    @property
    def speed(self) -> NDArray[np.float64] | None:
        """(n,) omega [rad/s]."""
        return None if self.pendulum is None else self.pendulum.speed

    @property
    def length(self) -> float | None:
        """Of the pendulum that was seen [m]."""
        return None if self.pendulum is None else self.pendulum.length


def recorded_upswing(config: UpswingDemonstration) -> MarkerRecording:
    """The recording a scenario names: its file, or another virtual person's upswing."""
    if config.person > 0:
        return record_person(config.person)
    return read_markers(scene_path(config.file))


def watch_upswing(config: UpswingDemonstration, recording: MarkerRecording) -> WatchedUpswing:
    """Find the hand's via-points and the pendulum's end state in a recording (section 3.3.1).

    Raises:
        MarkerMissingError, GapError, RacketPoseError: The markers give no path of the hand.
        EndStateError: The end state is neither seen nor given.
        HangingError: The pendulum does not hang at first.
        ExtractionError: Too few samples.
    """
    given = np.array([config.end_angle, config.end_speed], dtype=np.float64)  # NaN for None
    try:
        times, points = even_marker_paths(recording, (config.hand, config.tip))
    except (MarkerMissingError, GapError) as error:
        if error.marker != config.tip:
            raise
        if np.isnan(given).any():
            raise EndStateError(str(error), config.tip) from error
        times, points = even_marker_paths(recording, (config.hand,))
    rate = _whole((times.size - 1) / float(times[-1] - times[0]))
    times = np.arange(times.size) / rate
    hand = low_passed(points[:, 0, 0], rate, config.cutoff)
    hand = hand - hand[0]
    pendulum, end_state = None, given
    if points.shape[1] == 2:
        pendulum = see_pendulum(times, hand, points[:, 1] - points[:, 0])
        seen = np.array([pendulum.angle[-1], pendulum.speed[-1]])
        end_state = np.where(np.isnan(given), seen, given)
    extraction = extract_via_points(times, hand, ("x",), number=config.via_points)
    synthetic = config.person > 0 or config.file == UpswingDemonstration().file
    return WatchedUpswing(recording, times, hand, pendulum, extraction, end_state, synthetic)


def see_pendulum(
    times: NDArray[np.float64], hand: NDArray[np.float64], rod: NDArray[np.float64]
) -> SeenPendulum:
    """Angle and speed of a pendulum, smoothed, to the very end of its movement.

    What gravity and the hand do to a pendulum is known, and what they add up to in two integrals is
    taken off the angle. Friction and mistakes about the pendulum leave little and slow change, so
    straight lines through a quarter second smooth the rest. Speeds at the end are off by 0.14 rad/s
    (root mean square of 100 virtual persons); cubics through the angle itself give 0.8 rad/s.

    Args:
        times: (n,) even [s].
        hand: (n,) x, smooth [m].
        rod: (n, 3) from hand to tip [m].

    Raises:
        HangingError: The pendulum does not hang at first.
    """
    angle = angle_of_rod(rod)
    if abs(angle[0] - HANGING) > FARTHEST_FROM_HANGING:
        raise HangingError(float(angle[0] - HANGING), FARTHEST_FROM_HANGING)
    length = float(np.mean(np.linalg.norm(rod, axis=1)))
    push = np.gradient(np.gradient(hand, times), times)
    driven = (GRAVITY * np.sin(angle) + push * np.cos(angle)) / length
    driven_speed = cumulative_trapezoid(driven, times, initial=0)
    driven_angle = cumulative_trapezoid(driven_speed, times, initial=0)
    period = float(times[1] - times[0])
    samples = min(2 * round(_LINE / period / 2) + 1, times.size - 1 + times.size % 2)
    rest = angle - driven_angle
    return SeenPendulum(
        driven_angle + savgol_filter(rest, samples, 1),
        driven_speed + savgol_filter(rest, samples, 1, deriv=1, delta=period),
        length,
    )


def angle_of_rod(rod: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles theta (n,), unwrapped from near hanging on, of rods (n, 3) from hinge to tip."""
    angle = np.unwrap(np.arctan2(-rod[:, 0], rod[:, 2]))
    return np.asarray(angle - 2 * np.pi * np.round((angle[0] - HANGING) / (2 * np.pi)))


def _whole(rate: float) -> float:
    """The rate, a whole number if it is one but for the file's rounding [Hz]."""
    whole = round(rate)
    return float(whole) if abs(rate - whole) < 1e-4 * rate else rate
