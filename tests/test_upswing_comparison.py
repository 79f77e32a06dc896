"""Verdicts on the upswing: reckoned from the runs, so other runs get others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import pytest

from drake_viapoint.reproduction.findings import Verdict
from drake_viapoint.reproduction.upswing_comparison import (
    upswing_comparison,
    upswing_persons_comparison,
)
from drake_viapoint.reproduction.upswing_study import MAX_TRIALS, PersonRun
from drake_viapoint.tasks.catalogue import task_scenario

KEPT, MANUAL, RECORDED = (
    "Jacobian kept as first explored",
    "Jacobian explored again by hand",
    "Jacobian estimated from the last 12 trials",
)


def run(succeeds: Callable[[int], bool], trials: int = 60) -> list[dict[str, Any]]:
    """Records of seven exploring trials, then learning ones."""
    return [
        {
            "trial": number,
            "purpose": "exploration" if 2 <= number <= 7 else "learning",
            "success": succeeds(number),
            "T": [0.0, 0.0] if succeeds(number) else [1.5, 8.0],
            "Td": [0.0, 0.0],
        }
        for number in range(1, trials + 1)
    ]


def verdicts(*runs: list[dict[str, Any]], **changes: object) -> dict[str, Verdict]:
    scenario = task_scenario("upswing", None, {k.replace("__", "."): v for k, v in changes.items()})
    by_way = dict(zip(("fixed", "manual", "recorded"), runs, strict=True))
    return {row.quantity: row.verdict for row in upswing_comparison(scenario, by_way)}


def test_runs_like_the_papers_match() -> None:
    found = verdicts(run(lambda n: n == 55), run(lambda n: n > 40), run(lambda n: n > 20))
    assert set(found.values()) == {Verdict.MATCHES}


@pytest.mark.parametrize(
    ("quantity", "runs"),
    [
        (KEPT, (lambda n: n > 10, lambda n: n > 40, lambda n: n > 20)),
        (KEPT, (lambda n: n > 30, lambda n: n > 40, lambda n: n > 20)),
        (MANUAL, (lambda n: n == 55, lambda n: 40 < n < 60, lambda n: n > 20)),
        (RECORDED, (lambda n: n == 55, lambda n: n > 40, lambda n: n > 30)),
        ("first trial", (lambda n: n == 55, lambda n: n > 40, lambda n: n > 20 or n == 1)),
    ],
)
def test_runs_unlike_the_papers_differ(
    quantity: str, runs: Sequence[Callable[[int], bool]]
) -> None:
    found = verdicts(*map(run, runs))
    assert {name for name, verdict in found.items() if verdict is Verdict.DIFFERS} == {quantity}


def test_another_pendulum_is_another() -> None:
    runs = [run(lambda _: False)] * 3
    found = verdicts(*runs, pendulum__length=0.5)
    assert found["a2 = Δ g / l of the pendulum"] is Verdict.DIFFERS


def test_no_number_is_below_zero_that_is_not() -> None:
    records = run(lambda n: n > 20)
    records[29] = {**records[29], "T": [-0.001, -0.001]}
    rows = upswing_comparison(
        task_scenario("upswing"), {"fixed": records, "manual": records, "recorded": records}
    )
    assert "-0.00" not in " ".join(row.ours for row in rows)


# --------------------------------------------------------------------------------------- persons


def person_runs(way: str, held: Iterable[bool]) -> list[PersonRun]:
    return [
        PersonRun(
            person,
            "recurrence",
            way,
            np.zeros((MAX_TRIALS, 2)),
            np.full(MAX_TRIALS, success),
            np.zeros(MAX_TRIALS, dtype=bool),
        )
        for person, success in enumerate(held)
    ]


def order(kept: int, manual: int, recorded: int, persons: int) -> Verdict:
    """The verdict if so many persons' upswings are held in each way, the first ones."""
    runs = [
        run
        for way, number in (("fixed", kept), ("manual", manual), ("recorded", recorded))
        for run in person_runs(way, (person < number for person in range(persons)))
    ]
    (row,) = upswing_persons_comparison(runs)
    assert f"of {persons} persons" in row.ours
    return row.verdict


def test_an_order_that_is_clear_matches() -> None:
    assert order(100, 150, 190, 200) is Verdict.MATCHES


def test_an_order_that_few_persons_show_is_none() -> None:
    assert order(26, 28, 30, 30) is Verdict.NOT_COMPARABLE
    assert order(100, 100, 190, 200) is Verdict.NOT_COMPARABLE


def test_another_order_that_is_clear_differs() -> None:
    assert order(150, 100, 190, 200) is Verdict.DIFFERS
