"""Via-points of any marker file, printed and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_viapoint.demonstration.gaps import fill_gaps
from drake_viapoint.demonstration.impact import find_impact
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.demonstration.markers import read_markers
from drake_viapoint.demonstration.racket_pose import RACKET_MARKERS, BodyMarkers, racket_pose
from drake_viapoint.errors import ExtractionError, ImpactNotFoundError
from drake_viapoint.motion.extraction import Extraction, extract_via_points
from drake_viapoint.motion.minimum_jerk import EndMotion, minimum_jerk
from drake_viapoint.reproduction import figure4
from drake_viapoint.reproduction.style import POSE_LABELS, save
from drake_viapoint.robot.retargeting import POSE_NAMES

_LEVER = 0.3  # [m/rad] makes angles comparable with positions
_DEFAULT_NUMBER = 8
_MOVING = 0.05  # [m/s] an end slower than this counts as rest


class Extracted(NamedTuple):
    """What was extracted, and said of it."""

    extraction: Extraction
    hit_time: float | None  # [s]
    lines: list[str]


def extract_from_file(
    file: Path,
    picture: Path,
    *,
    marker: str | None = None,
    body: tuple[str, str, str] | None = None,
    number: int | None = None,
    threshold: float | None = None,
    start: float | None = None,
    end: float | None = None,
    hit_time: float | None = None,
) -> Extracted:
    """Extract via-points, draw them, and say them in lines.

    Args:
        file: C3D, TRC or CSV.
        picture: Where the drawing goes.
        marker: Path of this marker, in three dimensions.
        body: Or the pose of these three markers; the racket's by default.
        number: Number of via-points, ends included; 8 if no threshold is given.
        threshold: Or the largest error left [m], angles at 0.3 m/rad.
        start: Part of the recording to look at [s].
        end: Part of the recording to look at [s].
        hit_time: t_HIT; looked for in a whole recording of a body if None [s].

    Raises:
        ViapointError: Whatever is wrong with the file or the request.
    """
    recording = read_markers(file)
    names: tuple[str, ...]
    labels: tuple[str, ...]
    if marker is not None:
        filled = fill_gaps(_part(recording, start, end), (marker,))
        times, values = filled.times, filled.marker(marker)
        names, labels, what = POSE_NAMES[:3], POSE_LABELS[:3], f"marker {marker}"
    else:
        markers = BodyMarkers(*body) if body else RACKET_MARKERS
        part = _part(recording, start, end)
        pose = racket_pose(part, markers=markers)
        times, values = pose.times, pose.values
        names, labels, what = POSE_NAMES, POSE_LABELS, f"pose of {', '.join(markers.names)}"
    if number is None and threshold is None:
        number = _DEFAULT_NUMBER
    ends = _end_motion(times, values)
    extraction = extract_via_points(
        times,
        values,
        names,
        number=number,
        threshold=threshold,
        weights=[1.0, 1.0, 1.0] + [_LEVER] * (len(names) - 3),
        end_motion=ends,
    )
    lines = [
        f"{file}: {len(recording.names)} markers, {len(recording.times)} samples at "
        f"{recording.rate:g} Hz; {what} from {times[0]:g} to {times[-1]:g} s"
    ]
    if marker is None and hit_time is None:
        try:
            hit_time = find_impact(part, markers)
            lines.append(f"t_HIT = {hit_time:.3f} s")
        except ImpactNotFoundError as error:
            lines.append(str(error))
    points = extraction.via_points
    lines.append("  ".join(["via-point", "   time [s]", *(f"{label:>9}" for label in labels)]))
    for row, (time, value) in enumerate(zip(points.times, points.values, strict=True), start=1):
        lines.append("  ".join([f"{row:9d}", f"{time:11.4f}", *(f"{v:9.4f}" for v in value)]))
    lines.append(
        f"error left: {1e3 * extraction.worst_errors[-1]:.1f} mm at worst, "
        f"{1e3 * extraction.rms_errors[-1]:.1f} mm root mean square"
    )
    if hit_time is not None and not times[0] <= hit_time <= times[-1]:
        raise ExtractionError(
            f"t_HIT must lie between {times[0]:g} and {times[-1]:g} s, got {hit_time:g}"
        )
    figure = figure4.draw(
        times,
        values,
        extraction,
        labels,
        title=f"{file.name}: {what}",
        hit_time=hit_time,
        path=minimum_jerk(points.times, points.values, ends),
    )
    save(figure, picture)
    return Extracted(extraction, hit_time, lines)


def _part(recording: MarkerRecording, start: float | None, end: float | None) -> MarkerRecording:
    first = recording.times[0] if start is None else start
    last = recording.times[-1] if end is None else end
    inside = (recording.times >= first) & (recording.times <= last)
    if inside.sum() < 2:
        raise ExtractionError(
            f"fewer than 2 samples between {first:g} and {last:g} s; the recording goes from "
            f"{recording.times[0]:g} to {recording.times[-1]:g} s"
        )
    return MarkerRecording(
        recording.names, recording.times[inside], recording.positions[inside], recording.source
    )


def _end_motion(times: NDArray[np.float64], values: NDArray[np.float64]) -> EndMotion | None:
    """Velocity at the ends of a movement cut out of a longer one; None if both are at rest.

    The acceleration there is left out: twice differentiated noise would bend the path's ends.
    """
    velocity = np.gradient(values, times, axis=0)[[0, -1]]
    if np.all(np.linalg.norm(velocity[:, :3], axis=1) < _MOVING):
        return None
    rest = np.zeros(values.shape[1])
    return EndMotion(velocity[0], rest, velocity[1], rest)
