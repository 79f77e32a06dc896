"""What can go wrong, as data: every error a user's input can cause, and what it names."""

from __future__ import annotations

from pathlib import Path
from typing import Any


class ViapointError(Exception):
    """Root of every error this package raises on purpose; its message is one line."""

    def __reduce__(self) -> tuple[Any, ...]:
        """It comes back from other processes with message and data, whatever it is made of."""
        return _as_it_was, (type(self), self.args, self.__dict__)


def _as_it_was(kind: type[ViapointError], args: tuple[Any, ...], data: dict[str, Any]) -> Any:
    error = kind.__new__(kind, *args)
    error.__dict__.update(data)
    return error


class MarkerFileError(ViapointError):
    """A marker file that cannot be read.

    Attributes:
        path: The file.
        row: Line of the file, from 1, where a line is to blame.
    """

    def __init__(self, path: Path, reason: str, row: int | None = None) -> None:
        where = f"{path}" if row is None else f"{path}, line {row}"
        super().__init__(f"{where}: {reason}")
        self.path = path
        self.row = row


class ViaPointsError(ViapointError):
    """Via-points that make no movement, or a component that does not exist."""


class ExtractionError(ViapointError):
    """A movement from which the via-points asked for cannot be extracted."""


class LearningError(ViapointError):
    """A learner that was given what it cannot learn from."""


class ModelFileError(ViapointError):
    """A model or scene that is not where its address says.

    Attributes:
        uri: The address, ``package://drake_viapoint/...``.
    """

    def __init__(self, uri: str, reason: str) -> None:
        super().__init__(f"{uri}: {reason}")
        self.uri = uri


class UnreachableError(ViapointError):
    """A pose the arm cannot bring its tool to.

    Attributes:
        label: The pose, such as ``"via-point 3"``.
        distance: How far the nearest posture misses it [m].
        angle: By how much its orientation differs [rad].
        at_limit: Joints that the nearest posture has at a limit, with that limit [rad].
    """

    def __init__(
        self, label: str, distance: float, angle: float, at_limit: tuple[tuple[str, float], ...]
    ) -> None:
        stops = ", ".join(f"{name} at its limit {bound:g} rad" for name, bound in at_limit)
        super().__init__(
            f"{label} is out of reach: missed by {1e3 * distance:.1f} mm and {angle:.3f} rad, "
            f"stopped by {stops or 'the length of the arm'}"
        )
        self.label = label
        self.distance = distance
        self.angle = angle
        self.at_limit = at_limit


class BallFallsOutError(ViapointError):
    """A movement that cannot begin, as the ball does not come to rest in the cup.

    Attributes:
        distance: How far the ball was from its seat when it was given up [m].
        speed: How fast it was then [m/s].
    """

    def __init__(self, distance: float, speed: float) -> None:
        super().__init__(
            "the ball does not rest in the cup: before the movement begins it is "
            f"{1e3 * distance:.1f} mm from its seat and moves at {speed:.3g} m/s"
        )
        self.distance = distance
        self.speed = speed


class BrokenOffError(ViapointError):
    """A simulation that fails under way.

    Attributes:
        time: Up to when it went [s].
        cause: Why it went no further.
    """

    def __init__(self, time: float, cause: str) -> None:
        super().__init__(f"the simulation failed after {time:.4f} s: {cause}")
        self.time = time
        self.cause = cause


class RetargetingError(ViapointError):
    """A tool path that cannot be turned into a movement of the joints as asked."""


class RecordingError(ViapointError):
    """A marker recording whose arrays contradict each other or themselves.

    Attributes:
        sample: Index of the sample to blame, from 0, where there is one.
    """

    def __init__(self, reason: str, sample: int | None = None) -> None:
        super().__init__(reason if sample is None else f"sample {sample}: {reason}")
        self.reason = reason
        self.sample = sample


class MarkerMissingError(ViapointError):
    """A marker that the recording does not hold, or holds for several subjects.

    Attributes:
        marker: The name asked for.
        present: The names the recording holds.
    """

    def __init__(self, marker: str, present: tuple[str, ...], source: Path | None = None) -> None:
        where = "the recording" if source is None else str(source)
        several = tuple(name for name in present if name.endswith(f":{marker}"))
        fault = f"is ambiguous ({', '.join(several)})" if len(several) > 1 else "is absent"
        super().__init__(f"{where}: marker {marker!r} {fault}; present: {', '.join(present)}")
        self.marker = marker
        self.present = present


class GapError(ViapointError):
    """A gap in a marker's samples that is too long, or open, to be filled.

    Attributes:
        marker: The marker.
        start: Time of the first missing sample [s].
        end: Time of the next valid sample, or of the end of the recording [s].
        longest: Longest gap that would be filled [s].
    """

    def __init__(
        self, marker: str, start: float, end: float, longest: float, reason: str | None = None
    ) -> None:
        reason = reason or f"longer than the {longest:g} s that are filled"
        super().__init__(
            f"marker {marker!r} is missing from {start:.3f} s to {end:.3f} s: {reason}"
        )
        self.marker = marker
        self.start = start
        self.end = end
        self.longest = longest


class RacketPoseError(ViapointError):
    """A pose that cannot be found: degenerate markers, too few samples, an impossible cutoff."""


class ImpactNotFoundError(ViapointError):
    """No impact stands out of the racket's acceleration.

    Attributes:
        reason: Why not.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(f"no impact found: {reason}; give its time with --t-hit SECONDS")
        self.reason = reason


class DemonstrationError(ViapointError):
    """A virtual person for whom the task cannot be made to succeed."""


class ScenarioError(ViapointError):
    """A scenario with an unknown key, a value of the wrong type, or one out of its bounds."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.splitlines()))  # keys and values may hold anything


class RunFolderError(ViapointError):
    """A run folder that cannot be made, read or written.

    Attributes:
        path: The folder.
    """

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"{path}: {reason}")
        self.path = path


class OutcomeError(LearningError, ValueError):
    """An outcome that lacks a task variable, or whose values do not fit each other."""


class OutcomeNotFiniteError(LearningError):
    """A trial from which nothing can be learned: a task variable is not a number.

    Attributes:
        task_variable: Its name.
        value: What it or its desired value was told to be.
        trial: Number of the trial, where known.
    """

    def __init__(self, task_variable: str, value: list[float], trial: int | None = None) -> None:
        which = "" if trial is None else f"trial {trial}: "
        super().__init__(f"{which}{task_variable} is not finite: {value}")
        self.task_variable = task_variable
        self.value = value
        self.trial = trial

    def of_trial(self, trial: int) -> OutcomeNotFiniteError:
        """The same, naming the trial."""
        return OutcomeNotFiniteError(self.task_variable, self.value, trial)


class EndStateError(ViapointError):
    """An upswing whose end state is neither given nor seen.

    Attributes:
        marker: The marker of the pendulum's tip that would show it.
    """

    def __init__(self, reason: str, marker: str) -> None:
        super().__init__(
            f"the end state of the upswing is not given: {reason}; give demonstration.end_angle "
            f"and demonstration.end_speed, or a marker {marker!r} seen to the end"
        )
        self.marker = marker


class HangingError(ViapointError):
    """An upswing whose recording begins with a pendulum that does not hang.

    Attributes:
        deviation: From hanging, at first [rad].
        bound: What it may be [rad].
    """

    def __init__(self, deviation: float, bound: float) -> None:
        super().__init__(
            f"the pendulum is {deviation:.3g} rad from hanging when the recording starts, more "
            f"than {bound:g}: record it from the start, at rest"
        )
        self.deviation = deviation
        self.bound = bound


class LineReachError(UnreachableError):
    """A place on the hand's line that the arm does not reach.

    Attributes:
        label: What should have been there, such as ``"via-point 3"``.
        place: x along the line [m].
        reach: Least and largest x within reach [m].
        distance: How far the place is beyond [m].
    """

    def __init__(self, label: str, place: float, reach: tuple[float, float]) -> None:
        low, high = reach
        distance = max(place - high, low - place)
        message = (
            f"{label} is out of reach: x = {place:.3f} m, {1e3 * distance:.1f} mm beyond the arm's "
            f"reach from {low:.3f} m to {high:.3f} m"
        )
        ViapointError.__init__(self, message)
        self.label = label
        self.distance = distance
        self.angle = 0.0
        self.at_limit = ()
        self.place = place
        self.reach = reach


class StudyError(ViapointError):
    """A study that makes no sense, or whose results are another study's.

    Attributes:
        path: The study's file, or what holds the results.
    """

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(" ".join(f"{path}: {reason}".split()))  # keys and values may hold anything
        self.path = path


class ClusterError(ViapointError):
    """A cluster that cannot be used: no scheduler, no workers, or workers of other versions."""


class VersionsError(ClusterError):
    """A worker whose trials would differ in their last bits from those of who asks.

    Attributes:
        worker: The worker.
        package: What differs.
        theirs: The worker's version; None if it has none.
        ours: The version of who asks.
    """

    def __init__(self, worker: str, package: str, theirs: str | None, ours: str) -> None:
        super().__init__(
            f"worker {worker} has {package} {theirs or 'not installed'}, this is {ours}: bits "
            "would differ"
        )
        self.worker = worker
        self.package = package
        self.theirs = theirs
        self.ours = ours


class FolderHeldError(RunFolderError):
    """A folder or file that another process is writing to."""
