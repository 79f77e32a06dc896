"""The pose of the racket from markers, by rigid fit (paper 2.1.1).

A template of the body, the markers' places in its own frame, is estimated from the recording
itself; then each sample's markers are fitted by the template, moved rigidly.

The markers are low-passed before the fit, not the pose after it. Filtering positions is linear and
treats all directions alike, so the pose turns with the laboratory's axes, whatever they are; ZYZ
angles are neither linear nor even near sin(theta) = 0, where noise in them grows without bound.
What the filter does to the distances between markers, the rigid fit takes out again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt
from scipy.spatial.transform import Rotation

from drake_viapoint.demonstration.even_times import unrounded
from drake_viapoint.demonstration.gaps import LONGEST_GAP, fill_gaps
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.errors import RacketPoseError
from drake_viapoint.motion.orientation import unwrap_zyz, zyz_from_rotation

CUTOFF = 12.0
"""Frequency at which the low-pass halves the power, both its passes together [Hz]."""
PASS_ORDER = 2
"""Order of the Butterworth filter in each of its two passes, so 4 together [-]."""
SMALLEST_AREA = 1e-4
"""Three markers spanning less do not tell an orientation (a triangle of 15 mm sides) [m2]."""


class BodyMarkers(NamedTuple):
    """Three markers of a rigid body, by the role they have in its frame.

    The origin is midway between `upper` and `lower`. x runs from `upper` to `lower`, z from `wrist`
    to the origin (made exact; x is made orthogonal to it), y = z cross x.

    Attributes:
        upper: Name of the marker at the -x side.
        lower: Name of the marker at the +x side.
        wrist: Name of the marker on the z axis.
        wrist_ahead: Whether that marker is at +z of the origin; z then runs towards it.
    """

    upper: str
    lower: str
    wrist: str
    wrist_ahead: bool = False

    @property
    def names(self) -> tuple[str, str, str]:
        """The three names, in the order upper, lower, wrist."""
        return self.upper, self.lower, self.wrist


RACKET_MARKERS = BodyMarkers("racket_upper", "racket_lower", "wrist")
"""Edges of the racket's head at -x_racket and +x_racket, and the wrist near the handle's end."""
HAND_MARKERS = BodyMarkers("RWRA", "RWRB", "RFIN", wrist_ahead=True)
"""Thumb side and little-finger side of the right wrist, and the hand: z points along the hand."""


@dataclass(frozen=True)
class RacketPose:
    """Path of the racket, or another rigid body, along even times.

    Attributes:
        times: (n,) [s].
        position: (n, 3) origin of the body in the world [m].
        zyz: (n, 3) angles phi, theta, psi, unwrapped along time [rad].
    """

    times: NDArray[np.float64]
    position: NDArray[np.float64]
    zyz: NDArray[np.float64]

    @property
    def values(self) -> NDArray[np.float64]:
        """(n, 6) x, y, z [m], phi, theta, psi [rad], the order of the paper's components."""
        return np.hstack([self.position, self.zyz])


def racket_pose(
    recording: MarkerRecording, cutoff: float = CUTOFF, markers: BodyMarkers = RACKET_MARKERS
) -> RacketPose:
    """Pose of the racket along time, smoothed without delay.

    Short gaps are filled first (`fill_gaps`); uneven times are resampled to the median rate by a
    cubic spline. The low-pass is a Butterworth filter run forwards and backwards.

    Args:
        recording: The markers.
        cutoff: Frequency at which the low-pass halves the power [Hz].
        markers: Which markers, in which roles; a plain tuple (upper, lower, wrist) does as well.

    Returns:
        The pose, at even times.

    Raises:
        MarkerMissingError: A marker is not in the recording.
        GapError: A marker is missing for too long.
        RacketPoseError: The markers lie on a line, the cutoff is not below half the sampling rate,
            or there are too few samples to filter.
    """
    body = BodyMarkers(*markers)
    times, points = even_marker_paths(recording, body.names)
    points = low_passed(points, (len(times) - 1) / float(times[-1] - times[0]), cutoff)
    rotation, origin = fit_rigid_body(points, body)
    return RacketPose(times, origin, unwrap_zyz(zyz_from_rotation(rotation)))


def hand_pose(
    recording: MarkerRecording, cutoff: float = CUTOFF, markers: BodyMarkers = HAND_MARKERS
) -> RacketPose:
    """Pose of the hand along time: `racket_pose` with the markers of a hand.

    The wrist bends between these markers, so unlike a racket's they are only nearly a rigid body.
    """
    return racket_pose(recording, cutoff, markers)


def even_marker_paths(
    recording: MarkerRecording, markers: tuple[str, ...], longest_gap: float = LONGEST_GAP
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Unfiltered paths of some markers at even times, gaps filled.

    Even times that a file has rounded count as what they were (``unrounded``).

    Args:
        recording: The markers; resampled to the median rate where its times are uneven by more than
            a thousandth of a period.
        markers: Their names.
        longest_gap: Longest gap to fill [s].

    Returns:
        Times (n,) [s] and positions (n, len(markers), 3) [m].
    """
    even = MarkerRecording(
        recording.names, unrounded(recording.times), recording.positions, recording.source
    )
    filled = fill_gaps(even, markers, longest_gap)
    points = np.stack([filled.marker(name) for name in markers], axis=1)
    times, rate = filled.times, filled.rate
    if np.max(np.abs(np.diff(times) * rate - 1.0)) < 1e-3:
        return times, points
    steps = int(np.floor((times[-1] - times[0]) * rate + 1e-9))
    resampled = times[0] + np.arange(steps + 1) / rate
    return resampled, CubicSpline(times, points)(np.minimum(resampled, times[-1]))


def fit_rigid_body(
    points: NDArray[np.float64], markers: BodyMarkers = RACKET_MARKERS
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Fit a rigid body to three markers at every sample.

    Args:
        points: (n, 3, 3) positions of the markers upper, lower and wrist, complete [m].
        markers: Their roles.

    Returns:
        Rotations (n, 3, 3), world from body, and origins (n, 3) in the world [m].

    Raises:
        RacketPoseError: The markers lie on a line.
    """
    rotation, origin = _frames(points, markers.wrist_ahead)
    # The median sheds the few samples where a marker was mistaken or struck.
    template = np.median((points - origin[:, None]) @ rotation, axis=0)  # (3, 3) marker, axis
    middle = template.mean(axis=0)
    centroid = points.mean(axis=1)
    fitted = np.empty_like(rotation)
    for k, sample in enumerate(points - centroid[:, None]):
        fitted[k] = Rotation.align_vectors(sample, template - middle)[0].as_matrix()
    return fitted, centroid - fitted @ middle


def _frames(
    points: NDArray[np.float64], wrist_ahead: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frames built on each sample alone: rotations (n, 3, 3) and origins (n, 3) [m]."""
    upper, lower, wrist = np.moveaxis(points, 1, 0)
    origin = (upper + lower) / 2.0
    along = wrist - origin if wrist_ahead else origin - wrist
    across = lower - upper
    area = 0.5 * np.linalg.norm(np.cross(along, across), axis=1)
    if np.median(area) < SMALLEST_AREA:
        raise RacketPoseError(
            f"the three markers lie on a line: their triangle measures {1e4 * np.median(area):.2f} "
            f"cm2, less than {1e4 * SMALLEST_AREA:.0f} cm2"
        )
    tiny = np.finfo(np.float64).tiny
    z = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), tiny)
    x = across - np.sum(across * z, axis=1, keepdims=True) * z
    x /= np.maximum(np.linalg.norm(x, axis=1, keepdims=True), tiny)
    return np.stack([x, np.cross(z, x), z], axis=-1), origin


def low_passed(
    points: NDArray[np.float64], rate: float, cutoff: float = CUTOFF
) -> NDArray[np.float64]:
    """Low-pass along the first axis without delay: a Butterworth filter, forwards and backwards.

    Args:
        points: (n, ...) samples.
        rate: Their rate [Hz].
        cutoff: Frequency at which both passes together halve the power [Hz].

    Returns:
        The samples, smoothed.

    Raises:
        RacketPoseError: The cutoff is not below half the rate, or there are too few samples.
    """
    if not 0.0 < cutoff < rate / 2.0:
        raise RacketPoseError(
            f"a cutoff of {cutoff:g} Hz is not between 0 and half the sampling rate, "
            f"{rate / 2.0:.4g} Hz"
        )
    # Each pass may take half of the 3 dB only, so its own cutoff lies higher (Winter, Biomechanics
    # and Motor Control of Human Movement, 2.2.4.4); the tangents are the bilinear transform's.
    share = (np.sqrt(2.0) - 1.0) ** (0.5 / PASS_ORDER)
    design = rate / np.pi * np.arctan(np.tan(np.pi * cutoff / rate) / share)
    padding = int(np.ceil(rate / cutoff))  # one period of the cutoff, reflected at both ends
    if len(points) <= padding:
        raise RacketPoseError(
            f"{len(points)} samples at {rate:.4g} Hz are too few for a low-pass at {cutoff:g} Hz, "
            f"which needs more than {padding}"
        )
    sections = butter(PASS_ORDER, design, fs=rate, output="sos")
    return np.asarray(sosfiltfilt(sections, points, axis=0, padlen=padding), dtype=np.float64)
