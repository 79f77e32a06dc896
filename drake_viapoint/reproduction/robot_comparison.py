"""The simulated robot's serve beside what the paper says of the real one (section 2.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drake_viapoint.reproduction.findings import Comparison, judged
from drake_viapoint.reproduction.robot_runs import RobotRun, what_happened
from drake_viapoint.reproduction.trials_needed import trials_in_words, trials_percentile
from drake_viapoint.tasks.serve_trial import ServeOutcome

_THROW = 12  # trials that explore J_H
_CENTRE, _LEARNED = 25, 60
_WASTED = 11
_GOAL = 0.25  # [m] across
_EASIER = "the simulated throw repeats to millimetres, the real one did not"


def robot_comparison(
    runs: Sequence[RobotRun], records: Sequence[Sequence[Mapping[str, Any]]]
) -> tuple[Comparison, ...]:
    """What the robots did, as it happened.

    Args:
        runs: What each came to.
        records: Lines of each.
    """
    number = len(runs)
    firsts = [lines[0] for lines in records]
    missed = sum(first["outcome"] == ServeOutcome.MISSED for first in firsts)
    d = [what_happened(first).get("d") for first in firsts]
    off = [100 * value for value in d if value is not None]
    explored = {
        sum((r["purpose"], r["subtask"]) == ("exploration", "throw") for r in lines)
        for lines in records
    }
    centre = _median([run.centre_at for run in runs])
    learned = [run.learned_at for run in runs]
    done = sum(at is not None for at in learned)
    wasted = float(np.mean([run.wasted for run in runs]))
    spreads = [run.spread for run in runs if run.spread is not None]
    spread = float(np.median(spreads)) if spreads else np.inf
    in_ring, again = (sum(getattr(run, key) for run in runs) for key in ("in_ring", "executions"))
    return (
        Comparison(
            "first trial",
            "2.1.1, Fig. 6",
            "misses the ball",
            f"{missed} of {number} miss"
            + (f"; the ball is {np.median(off):.1f} cm off the centre (median)" if off else ""),
            judged(2 * missed > number),
            "" if 2 * missed > number else "person and robot differ less here than they did there",
        ),
        Comparison(
            "trials that explore J_H, ±1 cm",
            "2.1.2",
            str(_THROW),
            " or ".join(map(str, sorted(explored))),
            judged(explored == {_THROW}),
        ),
        Comparison(
            "centre of the face met",
            "2.1.2, Figs. 6, 7",
            f"by trial {_CENTRE}",
            f"by trial {trials_in_words(centre)} (median of {number})",
            judged(centre is not None and abs(centre - _CENTRE) <= 0.2 * _CENTRE),
            _EASIER,
        ),
        Comparison(
            "trials wasted that should explore J_G, d ≥ 10 cm",
            "2.1.3",
            f"{_WASTED} of 17",
            f"{wasted:.1f} of {6 + wasted:.1f} (mean of {number})",
            judged(abs(wasted - _WASTED) <= 2),
            _EASIER,
        ),
        Comparison(
            "serve learned",
            "2.1.3, Fig. 7",
            f"by trial {_LEARNED}; one robot",
            f"{done} of {number} robots: by trial {trials_in_words(_median(learned))} (median), "
            f"{trials_in_words(_worst(learned))} (worst)",
            judged(_near(_median(learned), _LEARNED)),
            "learned all the same, and sooner: " + _EASIER if done else "",
        ),
        Comparison(
            "the last movement again, six times",
            "2.1.3, Fig. 6",
            "spread within the goal's 25 cm",
            f"within {100 * spread:.0f} cm (median); {in_ring} of {again} balls in the ring"
            if spreads
            else "never learned",
            judged(spread < _GOAL),
            "balls that touch the ring may jump off it, further than 25 cm"
            if any(value > _GOAL for value in spreads)
            else "",
        ),
    )


def _median(counts: Sequence[int | None]) -> float | None:
    return trials_percentile(_numbers(counts), 50)


def _worst(counts: Sequence[int | None]) -> float | None:
    return trials_percentile(_numbers(counts), 100)


def _numbers(counts: Sequence[int | None]) -> list[float]:
    return [np.inf if count is None else float(count) for count in counts]


def _near(ours: float | None, paper: float) -> bool:
    return ours is not None and abs(ours - paper) <= 0.2 * paper
