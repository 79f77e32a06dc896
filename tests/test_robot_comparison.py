"""Verdicts on the robot's serve: by what happened, against the paper's counts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from drake_viapoint.reproduction.findings import Comparison, Verdict
from drake_viapoint.reproduction.robot_comparison import robot_comparison
from drake_viapoint.reproduction.robot_runs import RobotRun

PAPERS = RobotRun(0, 25, 60, 60, 65, 11, 0, 6, 6, 0.2)


def records(outcome: str = "missed", explored: int = 12) -> list[dict[str, Any]]:
    return [
        {"outcome": outcome, "d": 0.15, "purpose": "learning", "subtask": "throw"},
        *[{"purpose": "exploration", "subtask": "throw"}] * explored,
    ]


def compared(*runs: RobotRun, outcome: str = "missed", explored: int = 12) -> dict[str, Comparison]:
    rows = robot_comparison(runs, [records(outcome, explored)] * len(runs))
    return {row.quantity: row for row in rows}


def test_a_robot_like_the_papers_matches() -> None:
    rows = compared(PAPERS)
    assert {row.verdict for row in rows.values()} == {Verdict.MATCHES}
    assert rows["first trial"].ours == "1 of 1 miss; the ball is 15.0 cm off the centre (median)"


@pytest.mark.parametrize(
    ("change", "quantity"),
    [
        ({"centre_at": 14}, "centre of the face met"),
        ({"centre_at": None}, "centre of the face met"),
        ({"wasted": 0}, "trials wasted that should explore J_G, d ≥ 10 cm"),
        ({"learned_at": 26}, "serve learned"),
        ({"learned_at": None}, "serve learned"),
        ({"spread": 0.5}, "the last movement again, six times"),
        ({"spread": None}, "the last movement again, six times"),
    ],
)
def test_what_differs_is_said_to(change: dict[str, Any], quantity: str) -> None:
    rows = compared(replace(PAPERS, **change))
    assert {name for name, row in rows.items() if row.verdict is Verdict.DIFFERS} == {quantity}


def test_trials_are_read_off_the_records() -> None:
    assert compared(PAPERS, outcome="landed")["first trial"].verdict is Verdict.DIFFERS
    explored = compared(PAPERS, explored=10)["trials that explore J_H, ±1 cm"]
    assert (explored.ours, explored.verdict) == ("10", Verdict.DIFFERS)


def test_a_robot_that_learns_nothing_is_told_without_numbers() -> None:
    row = compared(replace(PAPERS, learned_at=None, spread=None))
    assert row["serve learned"].ours == "0 of 1 robots: by trial - (median), - (worst)"
    assert row["the last movement again, six times"].ours == "never learned"
