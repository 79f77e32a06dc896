"""Section 3.2 from a sweep's table: what a disturbed ball makes of learning the serve.

The disturbance itself sets a floor. After learning, the movement is repeated with fresh draws: how
far from the goal its balls land is the residual error, and how far from their own mean is the
floor under it, which no correction of the movement can reach below.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from drake_viapoint.errors import ViapointError
from drake_viapoint.reproduction.run_curves import listed
from drake_viapoint.reproduction.split_test import split_p_value
from drake_viapoint.reproduction.trials_needed import trials_in_words, trials_percentile
from drake_viapoint.runs.study import REPEATED

_FIELDS = ("d", "landing_error", "T_G", "success", "purpose", "subtask")
_COLUMNS = (
    "condition",
    "learned_at",
    "wasted",
    "error",
    *_FIELDS,
    *(REPEATED + f for f in _FIELDS),
)

_CONFIDENCE = 0.95


@dataclass(frozen=True)
class ConditionResult:
    """What all runs under one condition came to.

    Attributes:
        condition: Its name.
        runs: How many.
        errors: Of these, how many ended with an error; they count as not learned.
        learned: Share that was learned within the trials allowed.
        learned_low: Lower end of its 95 % confidence interval (Wilson).
        learned_high: Upper end.
        median: Trial that completed three successes in a row, of all runs; None if most did not.
        percentile_90: The same for nine runs of ten.
        wasted: Exploration trials a run wasted, on average.
        unreachable: Trials a run asked for that the arm could not make, on average.
        lost: Runs whose repeated movement never lands a ball; the next two leave them out.
        residual: Landing error of the repeated movement, its median over runs [m].
        floor: Part of it that the disturbance sets, its median over runs [m].
        held: Share of repeats that succeed, on average.
    """

    condition: str
    runs: int
    errors: int
    learned: float
    learned_low: float
    learned_high: float
    median: float | None
    percentile_90: float | None
    wasted: float
    unreachable: float
    lost: int
    residual: float
    floor: float
    held: float


@dataclass(frozen=True)
class PairedResult:
    """One condition against another, run by run: same person, same seed.

    Attributes:
        condition: The one.
        other: The other.
        pairs: How many.
        only_this: Pairs in which only the one's run was learned.
        only_other: Pairs in which only the other's was.
        p_value: Of so uneven a split, or more so, if neither were better (exact McNemar test).
        sooner: Pairs in which the one was learned at an earlier trial, or at all.
        later: Pairs in which the other was.
        p_sooner: Of so uneven a split of these two, or more so, if neither were sooner (sign test).
    """

    condition: str
    other: str
    pairs: int
    only_this: int
    only_other: int
    p_value: float
    sooner: int
    later: int
    p_sooner: float


def check_columns(table: pd.DataFrame) -> None:
    """Check that a table has what the figures of section 3.2 need.

    Raises:
        ViapointError: Names what is missing.
    """
    missing = [name for name in _COLUMNS if name not in table.columns]
    if missing:
        raise ViapointError(
            f"the table has no {', '.join(missing)}: section 3.2 needs a sweep of conditions, with "
            f"repeats, that tabulates {', '.join(_FIELDS)}"
        )


def condition_results(table: pd.DataFrame) -> list[ConditionResult]:
    """Shares and counts, one line a condition, in the order of the table.

    Args:
        table: Of a sweep of the serve, with repeats.

    Raises:
        ViapointError: The table lacks a column.
    """
    check_columns(table)
    return [_result(str(name), runs) for name, runs in table.groupby("condition", sort=False)]


def paired(table: pd.DataFrame, condition: str, other: str, keys: Iterable[str]) -> PairedResult:
    """Whether one condition beats another, by the runs that differ in nothing else.

    Args:
        table: Of a sweep.
        condition: The one.
        other: The other.
        keys: Columns that make a pair: what varies beside the condition.
    """
    by_run = table.set_index([*keys])
    one = _trials_to_learn(by_run[by_run["condition"] == condition])
    two = _trials_to_learn(by_run[by_run["condition"] == other])
    both = pd.concat({"one": one, "two": two}, axis=1, join="inner")
    first, second = both["one"].to_numpy(), both["two"].to_numpy()
    only_this = int(np.sum(np.isfinite(first) & ~np.isfinite(second)))
    only_other = int(np.sum(~np.isfinite(first) & np.isfinite(second)))
    sooner, later = int(np.sum(first < second)), int(np.sum(first > second))
    return PairedResult(
        condition,
        other,
        len(both),
        only_this,
        only_other,
        split_p_value(only_this, only_other),
        sooner,
        later,
        split_p_value(sooner, later),
    )


def summary(result: ConditionResult) -> str:
    """One line of the table in words."""
    return (
        f"{result.condition}: {result.learned:.0%} of {result.runs} runs learned "
        f"({result.learned_low:.0%} to {result.learned_high:.0%}), median trial "
        f"{trials_in_words(result.median)}, 90th percentile "
        f"{trials_in_words(result.percentile_90)}; {result.wasted:.1f} exploration trials wasted; "
        "afterwards "
        f"{100 * result.residual:.1f} cm from the goal, of which the disturbance alone makes "
        f"{100 * result.floor:.1f} cm (no ball lands in the end in {result.lost} runs); "
        f"{result.held:.0%} of repeats succeed"
    )


def paired_summary(result: PairedResult) -> str:
    """The comparison in words."""
    return (
        f"{result.condition} against {result.other}, {result.pairs} pairs of runs: only the first "
        f"learned in {result.only_this}, only the second in {result.only_other} "
        f"(p = {result.p_value:.2g}); the first was sooner in {result.sooner}, later in "
        f"{result.later} (p = {result.p_sooner:.2g})"
    )


def _result(name: str, runs: pd.DataFrame) -> ConditionResult:
    learned_at = _trials_to_learn(runs).to_numpy()
    learned = np.isfinite(learned_at)
    interval = binomtest(int(learned.sum()), len(runs)).proportion_ci(_CONFIDENCE, "wilson")
    spreads = np.array([_spread(row) for _, row in runs.iterrows()])  # (n, 3)
    landed = ~np.isnan(spreads[:, 1])
    residual, floor = np.median(spreads[landed, :2], axis=0) if landed.any() else (np.nan,) * 2
    return ConditionResult(
        condition=name,
        runs=len(runs),
        errors=int(runs["error"].notna().sum()),
        learned=float(learned.mean()),
        learned_low=float(interval.low),
        learned_high=float(interval.high),
        median=trials_percentile(learned_at, 50),
        percentile_90=trials_percentile(learned_at, 90),
        wasted=float(runs["wasted"].mean()),
        unreachable=float(np.mean([_unreachable(row) for _, row in runs.iterrows()])),
        lost=int(np.sum(np.isnan(spreads[:, 1]))),
        residual=float(residual),
        floor=float(floor),
        held=float(np.mean(spreads[:, 2])),
    )


def _trials_to_learn(runs: pd.DataFrame) -> pd.Series:
    """Trials until it was learned; infinity where it was not."""
    return runs["learned_at"].astype(float).fillna(np.inf)


def _spread(row: pd.Series) -> tuple[float, float, float]:
    """Residual error and floor [m], NaN if nothing landed, and share of successes of repeats."""
    landings = [point for point in listed(row["repeated_T_G"]) if point is not None]
    successes = listed(row["repeated_success"])
    held = float(np.mean(successes)) if successes else 0.0  # a run that raised holds nothing
    if not landings:
        return np.nan, np.nan, held
    points = np.array([list(point) for point in landings], dtype=np.float64)  # (n, 2)
    errors = [error for error in listed(row["repeated_landing_error"]) if error is not None]
    floor = np.linalg.norm(points - points.mean(axis=0), axis=1).mean()
    return float(np.nanmean(np.array(errors, dtype=np.float64))), float(floor), held


def _unreachable(row: pd.Series) -> int:
    """Trials that gave no d: movements the arm could not make."""
    return sum(value is None or np.isnan(value) for value in listed(row["d"]))
