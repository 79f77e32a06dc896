"""The upswing beside what the paper says of it (section 3.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from drake_viapoint.reproduction.findings import Comparison, Verdict, judged
from drake_viapoint.reproduction.split_test import SURE, split_p_value
from drake_viapoint.reproduction.upswing_study import MAX_TRIALS, PersonRun
from drake_viapoint.tasks.flight import GRAVITY
from drake_viapoint.tasks.upswing_scenario import UpswingScenario

_LAST = 30  # trial of Fig. 14
_HELD = 3
_WAYS = {"fixed": "kept", "manual": "by hand", "recorded": "estimated"}  # in the paper's order


def upswing_comparison(
    scenario: UpswingScenario, records: Mapping[str, Sequence[Mapping[str, Any]]]
) -> tuple[Comparison, ...]:
    """The shipped upswing, learned in three ways.

    Args:
        scenario: Of the runs.
        records: Lines of each run, by its way to the Jacobian.
    """
    kept, manual, recorded = (records[way] for way in ("fixed", "manual", "recorded"))
    a2 = scenario.time_step * GRAVITY / scenario.pendulum.length
    first = recorded[0]
    after = [r["trial"] for r in recorded[1:] if r["purpose"] != "exploration"]
    exploring = after[0] - 1 if after else len(recorded)
    last = recorded[_LAST - 1] if len(recorded) >= _LAST else recorded[-1]
    return (
        Comparison(
            "a2 = Δ g / l of the pendulum",
            "3.3.1, Eq. 13",
            "0.47",
            f"{a2:.3f}",
            judged(round(a2, 2) == 0.47),
        ),
        Comparison(
            "first trial",
            "3.3.2, Fig. 12",
            "fails",
            "succeeds" if first["success"] else f"fails: {_error(first)}",
            judged(not first["success"]),
        ),
        Comparison(
            "first trials, before anything is learned",
            "3.3.2, Fig. 13",
            "7",
            str(exploring),
            judged(exploring == 7),
        ),
        Comparison(
            "Jacobian kept as first explored",
            "3.3.2, Fig. 13",
            "very late or unstable",
            _course(kept),
            judged(_later(kept, recorded) and _later(kept, manual)),
            "how sharply the ways differ hangs on constants that the paper does not give, and on "
            "the person",
        ),
        Comparison(
            "Jacobian explored again by hand",
            "3.3.2, Fig. 13",
            "stabilized",
            _course(manual),
            judged(_holds(manual)),
            "trials that explore are moved away on purpose and do not succeed",
        ),
        Comparison(
            "Jacobian estimated from the last 12 trials",
            "3.3.2, Figs. 13, 14",
            f"converges; inverted at trial {_LAST}",
            f"{_course(recorded)}; trial {last['trial']}: {_error(last)}",
            judged(bool(last["success"])),
        ),
    )


def upswing_persons_comparison(runs: Sequence[PersonRun]) -> tuple[Comparison, ...]:
    """The order of the three ways, in each execution, judged by pairs of runs of one person."""
    return tuple(
        _order(execution, [run for run in runs if run.execution == execution])
        for execution in dict.fromkeys(run.execution for run in runs)
    )


def _order(execution: str, runs: Sequence[PersonRun]) -> Comparison:
    held = {
        way: {run.person: run.held(MAX_TRIALS) for run in runs if run.way == way} for way in _WAYS
    }
    shares = [sum(held[way].values()) / len(held[way]) for way in _WAYS]
    tests = []
    for worse, better in pairwise(_WAYS):
        gained = sum(held[better][person] and not held[worse][person] for person in held[worse])
        lost = sum(held[worse][person] and not held[better][person] for person in held[worse])
        tests.append((worse, better, split_p_value(gained, lost)))
    told = all(p_value < SURE for _, _, p_value in tests)
    said = ", ".join(
        f"{words} {share:.1%}" for words, share in zip(_WAYS.values(), shares, strict=True)
    )
    pairs = "; ".join(f"{_WAYS[a]} against {_WAYS[b]}: p = {p:.2g}" for a, b, p in tests)
    return Comparison(
        f"order of the three ways ({execution})",
        "3.3.2, Fig. 13",
        "kept, by hand, estimated; one person",
        f"held at trial {MAX_TRIALS}, of {len(held['fixed'])} persons: {said}",
        judged(shares == sorted(shares)) if told else Verdict.NOT_COMPARABLE,
        pairs if told else f"so many persons do not tell every two of them apart; {pairs}",
    )


def _course(records: Sequence[Mapping[str, Any]]) -> str:
    good = [record["trial"] for record in records if record["success"]]
    first = f"first succeeds at trial {good[0]}" if good else "never succeeds"
    return f"{first}, {'holds' if _holds(records) else 'does not hold'} at trial {len(records)}"


def _error(record: Mapping[str, Any]) -> str:
    if record["T"] is None:
        return "no end"
    angle, speed = (is_ - should for is_, should in zip(record["T"], record["Td"], strict=True))
    # adding zero takes the sign from what is rounded to it
    return f"{round(angle, 2) + 0.0:+.2f} rad, {round(speed, 2) + 0.0:+.2f} rad/s off"


def _holds(records: Sequence[Mapping[str, Any]]) -> bool:
    learning = [record["success"] for record in records if record["purpose"] != "exploration"]
    return all(learning[-_HELD:])


def _later(records: Sequence[Mapping[str, Any]], others: Sequence[Mapping[str, Any]]) -> bool:
    """Whether one run first succeeds after another does, or never."""
    one, two = (
        next((r["trial"] for r in run if r["success"]), len(run) + 1) for run in (records, others)
    )
    return one > two
