"""What runs of the robot experiment came to, as judged by what truly happened (section 2.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drake_viapoint.reproduction.trials_needed import trials_in_words, trials_percentile

IN_A_ROW = 3
"""So many balls in the ring, one after the other, and the serve is learned."""


@dataclass(frozen=True)
class RobotRun:
    """One run.

    Attributes:
        seed: Of the run: which robot, and all its draws.
        centre_at: First trial after exploring J_H in which the ball met the face within the meeting
            tolerance of its centre; None if none did.
        learned_at: Trial with the third ball in a row in the ring; None if there was none.
        told_at: Trial after which the learner, who has only the cameras, was done; None if never.
        trials: Trials executed, repeats included.
        wasted: Exploration trials of J_G rejected because d was too large.
        failed: Trials that broke off.
        in_ring: Of the final movement's executions, those that landed in the ring.
        executions: How often the final movement was executed: a success and its repeats.
        spread: Largest distance between two landings of the final movement [m]; None if not two.
    """

    seed: int
    centre_at: int | None
    learned_at: int | None
    told_at: int | None
    trials: int
    wasted: int
    failed: int
    in_ring: int
    executions: int
    spread: float | None


def what_happened(record: Mapping[str, Any]) -> Mapping[str, Any]:
    """The part of a trial's record that says what happened, whatever was seen of it."""
    happened: Mapping[str, Any] = record.get("happened") or record
    return happened


def robot_run(
    records: Sequence[Mapping[str, Any]],
    *,
    seed: int,
    told_at: int | None,
    wasted: int,
    most: int,
    meeting_tolerance: float,
    ring: float,
) -> RobotRun:
    """Read one run off its records.

    Args:
        records: Lines of the run.
        seed: Of the run.
        told_at: Trial at which the learner was done.
        wasted: Exploration trials wasted.
        most: Trials within which it has to be learned.
        meeting_tolerance: Within which the face's centre counts as met [m].
        ring: Radius of the goal's ring [m].
    """
    inside = [_within(what_happened(record).get("landing_error"), ring) for record in records]
    thrice = [
        number
        for number in range(IN_A_ROW, len(inside) + 1)
        if all(inside[number - IN_A_ROW : number])
    ]
    explored = [r["trial"] for r in records if (r["purpose"], r["subtask"]) == _EXPLORING]
    met = [
        record["trial"]
        for record in records
        if record["trial"] > max(explored, default=0)
        and _within(what_happened(record).get("d"), meeting_tolerance)
    ]
    final = [r for r in records if r["purpose"] == "repeat" or r["trial"] == told_at]
    landings = [what_happened(record).get("T_G") for record in final]
    points = np.array([point for point in landings if point is not None])
    distances = np.linalg.norm(points[:, None] - points, axis=-1) if len(points) > 1 else None
    return RobotRun(
        seed=seed,
        centre_at=met[0] if met else None,
        learned_at=thrice[0] if thrice and thrice[0] <= most else None,
        told_at=told_at,
        trials=len(records),
        wasted=wasted,
        failed=sum(record["outcome"] == "failed" for record in records),
        in_ring=sum(_within(what_happened(r).get("landing_error"), ring) for r in final),
        executions=len(final),
        spread=None if distances is None else float(distances.max()),
    )


def summary(runs: Sequence[RobotRun], most: int) -> list[str]:
    """All runs in words."""
    needed = [np.inf if run.learned_at is None else run.learned_at for run in runs]
    centre = [np.inf if run.centre_at is None else run.centre_at for run in runs]
    learned = int(np.sum(np.isfinite(needed)))
    spreads = [run.spread for run in runs if run.spread is not None]
    repeats = sum(run.executions for run in runs)
    lines = [
        f"robot: {learned} of {len(runs)} runs put three balls in a row into the ring within "
        f"{most} trials: median {trials_in_words(trials_percentile(needed, 50))}, worst "
        f"{trials_in_words(trials_percentile(needed, 100))}",
        f"centre of the face met by trial {trials_in_words(trials_percentile(centre, 50))} "
        f"(median); {np.mean([run.wasted for run in runs]):.1f} exploration trials of J_G wasted, "
        f"at most {max(run.wasted for run in runs)}",
    ]
    if spreads:
        lines.append(
            f"the final movement again: {sum(run.in_ring for run in runs)} of {repeats} balls in "
            f"the ring, spread {100 * np.median(spreads):.0f} cm (median), at most "
            f"{100 * max(spreads):.0f} cm"
        )
    return lines


_EXPLORING = ("exploration", "throw")


def _within(distance: float | None, bound: float) -> bool:
    return distance is not None and distance < bound
