"""Counting what runs of the robot experiment came to."""

from __future__ import annotations

from typing import Any

import pytest

from drake_viapoint.reproduction.robot_runs import robot_run, summary, what_happened


def line(
    trial: int,
    purpose: str = "learning",
    subtask: str = "strike",
    *,
    error: float | None = 0.5,
    d: float | None = 0.02,
    outcome: str = "landed",
) -> dict[str, Any]:
    happened = {"landing_error": error, "d": d, "T_G": None if error is None else [error, 0.0]}
    seen = {"landing_error": 0.0, "d": 0.0, "T_G": [0.0, 0.0]}  # cameras that see only success
    return {
        "trial": trial,
        "purpose": purpose,
        "subtask": subtask,
        "outcome": outcome,
        **seen,
        "happened": happened,
    }


def counted(records: list[dict[str, Any]], told_at: int | None = None, most: int = 80) -> Any:
    return robot_run(
        records,
        seed=4,
        told_at=told_at,
        wasted=2,
        most=most,
        meeting_tolerance=0.05,
        ring=0.125,
    )


def test_three_in_a_row_as_they_happened() -> None:
    errors = [0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.1]
    records = [line(number, error=error) for number, error in enumerate(errors, start=1)]
    assert counted(records).learned_at == 6
    assert counted(records, most=5).learned_at is None
    assert counted(records[:5]).learned_at is None


def test_on_the_ring_is_not_in_it() -> None:
    assert counted([line(n, error=0.125) for n in (1, 2, 3)]).learned_at is None
    assert counted([line(n, error=0.1249) for n in (1, 2, 3)]).learned_at == 3


def test_the_centre_is_met_after_exploring() -> None:
    records = [
        line(1, "learning", "throw", d=0.2),
        line(2, "exploration", "throw", d=0.01),
        line(3, "exploration", "throw", d=0.01),
        line(4, "learning", "throw", d=0.06),
        line(5, "learning", "throw", d=0.04),
    ]
    assert counted(records).centre_at == 5
    assert counted(records[:4]).centre_at is None


def test_the_final_movement_is_the_last_success_and_its_repeats() -> None:
    records = [
        line(1, error=0.9),
        line(2, error=0.02),
        line(3, "repeat", error=0.06),
        line(4, "repeat", error=0.14),
    ]
    run = counted(records, told_at=2)
    assert (run.in_ring, run.executions) == (2, 3)
    assert run.spread == pytest.approx(0.12)
    assert (run.seed, run.told_at, run.trials, run.wasted) == (4, 2, 4, 2)


def test_trials_that_broke_off_or_land_nowhere() -> None:
    broken = {**line(2, error=None, d=None, outcome="failed")}
    del broken["happened"]
    broken.update({"landing_error": None, "d": None, "T_G": None})
    run = counted([line(1), broken, line(3, error=None)])
    assert (run.failed, run.learned_at, run.spread) == (1, None, None)


def test_without_cameras_what_is_told_is_what_happened() -> None:
    told = {"landing_error": 0.3, "d": 0.1}
    assert what_happened(told) is told
    assert what_happened({**told, "happened": {"d": 1.0}}) == {"d": 1.0}


def test_the_summary_counts_runs_that_never_get_there() -> None:
    good = counted([line(n, error=0.01) for n in (1, 2, 3)], told_at=3)
    bad = counted([line(n) for n in (1, 2, 3)])
    first, *rest = summary([good, good, bad], 80)
    assert "2 of 3 runs" in first
    assert "median 3, worst -" in first
    assert "2.0 exploration trials" in rest[0]
    assert len(summary([bad], 80)) == 2, "no final movement, no spread"
