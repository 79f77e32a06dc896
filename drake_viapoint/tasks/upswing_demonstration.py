"""Watching an upswing: from a marker file to via-points of the hand and the end state wanted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.demonstration.markers import read_markers
from drake_viapoint.demonstration.racket_pose import even_marker_paths, low_passed
from drake_viapoint.errors import EndStateError, GapError, HangingError, MarkerMissingError
from drake_viapoint.motion.extraction import Extraction, extract_via_points
from drake_viapoint.tasks.pendulum import HANGING
from drake_viapoint.tasks.serve_scene import scene_path
from drake_viapoint.tasks.upswing_recording import record_person
from drake_viapoint.tasks.upswing_scenario import UpswingDemonstration

FARTHEST_FROM_HANGING = 0.5
"""A pendulum further from hanging at first was not recorded from the start [rad]."""

_FIT_TIME = 0.25  # [s] of the polynomials that smooth the angle and give its rate
_FIT_ORDER = 3


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
    needs_tip = bool(np.isnan(given).any())
    pendulum = None
    try:
        recording.index(config.tip)
        times, points = even_marker_paths(recording, (config.hand, config.tip))
        pendulum = see_pendulum(times, points[:, 0], points[:, 1])
    except (MarkerMissingError, GapError) as error:
        if not needs_tip or getattr(error, "marker", config.tip) != config.tip:
            times, points = even_marker_paths(recording, (config.hand,))
        else:
            raise EndStateError(str(error), config.tip) from error
    rate = (times.size - 1) / float(times[-1] - times[0])
    times = np.arange(times.size) / _whole(rate)
    hand = low_passed(points[:, 0, 0], rate, config.cutoff)
    hand = hand - hand[0]
    extraction = extract_via_points(times, hand, ("x",), number=config.via_points)
    end_state = given
    if pendulum is not None:
        seen = np.array([pendulum.angle[-1], pendulum.speed[-1]])
        end_state = np.where(np.isnan(given), seen, given)
    synthetic = config.person > 0 or config.file == UpswingDemonstration().file
    return WatchedUpswing(recording, times, hand, pendulum, extraction, end_state, synthetic)


def see_pendulum(
    times: NDArray[np.float64], hand: NDArray[np.float64], tip: NDArray[np.float64]
) -> SeenPendulum:
    """Angle and speed of a pendulum from its markers (n, 3) at even times (n,).

    The angle is smoothed, and its rate found, by cubics through a quarter second; at the ends one
    cubic serves for all of the last eighth.

    Raises:
        HangingError: The pendulum does not hang at first.
    """
    rod = tip - hand
    angle = angle_of_rod(rod)
    if abs(angle[0] - HANGING) > FARTHEST_FROM_HANGING:
        raise HangingError(float(angle[0] - HANGING), FARTHEST_FROM_HANGING)
    period = float(times[-1] - times[0]) / (times.size - 1)
    window = min(2 * round(_FIT_TIME / period / 2) + 1, times.size - 1 + times.size % 2)
    fits = [
        savgol_filter(angle, window, _FIT_ORDER, deriv=order, delta=period, mode="interp")
        for order in (0, 1)
    ]
    return SeenPendulum(fits[0], fits[1], float(np.mean(np.linalg.norm(rod, axis=1))))


def angle_of_rod(rod: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles theta (n,), unwrapped from near hanging on, of rods (n, 3) from hinge to tip."""
    angle = np.unwrap(np.arctan2(-rod[:, 0], rod[:, 2]))
    return np.asarray(angle - 2 * np.pi * np.round((angle[0] - HANGING) / (2 * np.pi)))


def _whole(rate: float) -> float:
    """The rate, a whole number if it is one but for the file's rounding [Hz]."""
    whole = round(rate)
    return float(whole) if abs(rate - whole) < 1e-4 * rate else rate
