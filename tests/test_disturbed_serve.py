"""The statistics of section 3.2, on tables whose answers are known beforehand."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from drake_viapoint.errors import ViapointError
from drake_viapoint.reproduction import figure10
from drake_viapoint.reproduction.disturbed_serve import (
    condition_results,
    paired,
    paired_summary,
    summary,
)
from drake_viapoint.reproduction.run_curves import LEARNED, REFUSED, STAGES, curves, stages

GOAL = np.array([0.2, 2.4])


def row(
    condition: str,
    seed: int,
    learned_at: int | None,
    *,
    offset: float = 0.0,
    scatter: float = 0.03,
    repeats: int = 200,
    error: str | None = None,
) -> dict[str, Any]:
    """A run whose repeats land round about a point ``offset`` off the goal."""
    rng = np.random.default_rng(seed)
    made = learned_at or 60
    landings = GOAL + [offset, 0.0] + scatter * rng.normal(size=(repeats, 2))
    errors = np.linalg.norm(landings - GOAL, axis=1)
    return {
        "condition": condition,
        "seed": seed,
        "learned_at": learned_at,
        "wasted": 2,
        "error": error,
        "d": [0.1] * made,
        "landing_error": [None] + [0.5] * (made - 1),
        "T_G": [None] + [[0.1, 2.0]] * (made - 1),
        "success": [False] * made,
        "purpose": ["learning"] + ["exploration"] * 12 + ["learning"] * (made - 13),
        "subtask": ["throw"] * 20 + ["strike"] * (made - 20),
        "repeated_d": [0.01] * repeats,
        "repeated_landing_error": errors.tolist(),
        "repeated_T_G": landings.tolist(),
        "repeated_success": (errors < 0.125).tolist(),
        "repeated_purpose": ["repeat"] * repeats,
        "repeated_subtask": [None] * repeats,
    }


def table(rows: list[dict[str, Any]]) -> pd.DataFrame:
    frame = pd.DataFrame(rows)
    return frame.assign(learned_at=frame["learned_at"].astype("Int64"))


def test_counts_are_of_all_runs_learned_or_not() -> None:
    learned = [26, 28, 30, 32, 34, 36, 38, None, None, None]
    (result,) = condition_results(table([row("kept", i, n) for i, n in enumerate(learned)]))
    assert (result.runs, result.learned, result.errors) == (10, 0.7, 0)
    assert (result.median, result.percentile_90) == (36, None)
    # Wilson's interval of 7 of 10, as tabulated
    assert (result.learned_low, result.learned_high) == pytest.approx((0.3968, 0.8922), abs=1e-4)
    assert result.wasted == 2
    assert "70% of 10 runs learned (40% to 89%), median trial 36, 90th percentile -" in summary(
        result
    )


def test_a_run_that_raised_is_not_learned() -> None:
    broken = row("kept", 0, None, error="LearningError: nothing", repeats=0)
    (result,) = condition_results(table([broken, row("kept", 1, 30)]))
    assert (result.errors, result.learned, result.lost) == (1, 0.5, 1)
    assert np.isfinite(result.residual)
    assert result.held < 0.51


@given(st.floats(0, 0.2), st.floats(0.005, 0.05), st.integers(0, 1000))
def test_the_floor_is_what_scatter_alone_would_leave(
    offset: float, scatter: float, seed: int
) -> None:
    """Of normal landings the mean distance is Rayleigh's; an offset adds to it, never takes off."""
    aimed = row("a", seed, 30, offset=offset, scatter=scatter)
    (result,) = condition_results(table([aimed]))
    rayleigh = scatter * np.sqrt(np.pi / 2)
    assert result.floor == pytest.approx(rayleigh, rel=5 * 0.523 / np.sqrt(200))
    assert result.residual >= 0.95 * max(result.floor, offset - 4 * scatter / np.sqrt(200))
    if offset == 0:
        assert result.residual == pytest.approx(result.floor, rel=0.1)


def test_a_lost_ball_is_no_landing() -> None:
    rows = row("a", 1, 30)
    rows["repeated_T_G"][3] = rows["repeated_landing_error"][3] = None
    (result,) = condition_results(table([rows]))
    assert np.isfinite(result.residual)
    assert np.isfinite(result.floor)


def test_pairs_are_runs_that_differ_in_the_condition_alone() -> None:
    """8 pairs that only the one learned, none the other: p = 2 / 2^8 by the binomial law."""
    ones = [row("recorded", i, 30) for i in range(10)]
    others = [row("kept", i, 30 if i >= 8 else None) for i in range(10)]
    rows = [*ones, *reversed(others)]  # the order does not matter
    result = paired(table(rows), "recorded", "kept", ["seed"])
    assert (result.pairs, result.only_this, result.only_other) == (10, 8, 0)
    assert result.p_value == pytest.approx(2 / 2**8)
    assert (result.sooner, result.later) == (8, 0)
    swapped = paired(table(rows), "kept", "recorded", ["seed"])
    assert (swapped.only_this, swapped.only_other, swapped.p_value) == (0, 8, result.p_value)
    assert "only the first learned in 8, only the second in 0 (p = 0.0078)" in paired_summary(
        result
    )


def test_no_difference_is_no_evidence() -> None:
    rows = [row(name, i, 30) for name in ("recorded", "kept") for i in range(4)]
    assert paired(table(rows), "recorded", "kept", ["seed"]).p_value == 1.0


def test_a_learned_run_goes_on_with_its_repeats() -> None:
    runs = table([row("a", 0, 30), row("a", 1, None)])
    d = curves(runs, "d", 60)
    assert d.shape == (2, 60)
    assert d[0].tolist() == [0.1] * 30 + [0.01] * 30
    assert d[1].tolist() == [0.1] * 60
    landing = curves(runs, "landing_error", 60)
    assert np.isnan(landing[:, 0]).all()
    np.testing.assert_array_equal(landing[0, 30:], runs["repeated_landing_error"][0][:30])


def test_stages_account_for_every_trial() -> None:
    names = (*dict.fromkeys(STAGES.values()), REFUSED)
    refused = row("a", 1, None)
    refused["d"][40] = None
    shares = stages(table([row("a", 0, 30), refused]), names, 60)
    assert shares[names.index(REFUSED)].tolist() == [0.0] * 40 + [0.5] + [0.0] * 19
    np.testing.assert_allclose(shares.sum(axis=0), 1.0)
    assert shares[names.index("exploring J_H"), 1:13].tolist() == [1.0] * 12
    assert shares[names.index(LEARNED)].tolist() == [0.0] * 30 + [0.5] * 30


def test_the_figure_has_a_panel_a_condition_with_its_own_runs() -> None:
    rows = [row("kept", i, 30 + i) for i in range(5)] + [row("recorded", i, None) for i in range(3)]
    figure = figure10.draw(table(rows), 60, 0.05, 0.125, {"kept": "Jacobians kept"})
    assert isinstance(figure, Figure)
    upper, _, lower, _ = figure.axes
    assert upper.get_title() == "Jacobians kept: 100% of 5 runs learned"
    assert lower.get_title() == "recorded: 0% of 3 runs learned"
    medians = [line for line in upper.lines if line.get_label().startswith("ball to")]
    np.testing.assert_allclose(medians[0].get_ydata()[:30], 0.1)
    np.testing.assert_allclose(medians[0].get_ydata()[34:], 0.01)


def test_the_median_counts_balls_that_never_landed_as_far_off() -> None:
    rows = [row("kept", i, None) for i in range(5)]
    for lost in rows[:3]:
        lost["landing_error"] = [None] * 60
    upper = figure10.draw(table(rows), 60, 0.05, 0.125).axes[0]
    landing = next(line for line in upper.lines if "goal" in line.get_label())
    assert np.isnan(landing.get_ydata()).all()


def test_a_table_without_what_is_needed() -> None:
    with pytest.raises(ViapointError, match=r"the table has no T_G, repeated_T_G: section 3\.2"):
        condition_results(table([row("a", 0, 30)]).drop(columns=["T_G", "repeated_T_G"]))
