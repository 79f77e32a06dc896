"""Verdicts on the serve under a disturbance: a difference is one if so many pairs would show it."""

from __future__ import annotations

import pytest

from drake_viapoint.reproduction.disturbed_serve import ConditionResult, PairedResult
from drake_viapoint.reproduction.findings import Comparison, Verdict
from drake_viapoint.reproduction.serve_comparison import conditions_comparison
from drake_viapoint.reproduction.split_test import split_p_value


def result(name: str, learned: float, wasted: float = 0.0) -> ConditionResult:
    return ConditionResult(
        name, 20, 0, learned, learned, learned, 26.0, None, wasted, 1.5, 0, 0.05, 0.03, learned
    )


def pair(one: str, other: str, sooner: int, later: int) -> PairedResult:
    return PairedResult(one, other, 20, 0, 0, 1.0, sooner, later, split_p_value(sooner, later))


def rows(
    kept: tuple[int, int], recorded: tuple[int, int], wasted: float = 0.0, learned: float = 0.9
) -> list[Comparison]:
    """Comparisons if kept was so often sooner and later than undisturbed, recorded than kept."""
    results = [result("undisturbed", learned), result("kept", 0.7, wasted), result("recorded", 0.8)]
    pairs = [pair("kept", "undisturbed", *kept), pair("recorded", "kept", *recorded)]
    return list(conditions_comparison(results, pairs, "5 cm, 5°"))


@pytest.mark.parametrize(
    ("split", "slower", "quicker"),
    [
        ((2, 12), Verdict.MATCHES, Verdict.DIFFERS),
        ((12, 2), Verdict.DIFFERS, Verdict.MATCHES),
        ((4, 7), Verdict.NOT_COMPARABLE, Verdict.NOT_COMPARABLE),
        ((0, 0), Verdict.NOT_COMPARABLE, Verdict.NOT_COMPARABLE),
    ],
)
def test_a_difference_has_to_show(
    split: tuple[int, int], slower: Verdict, quicker: Verdict
) -> None:
    assert rows(split, (0, 0))[1].verdict is slower
    row = rows((0, 0), split)[2]
    assert row.verdict is quicker
    assert f"sooner than kept in {split[0]}, later in {split[1]}" in row.why


def test_wasted_trials_are_as_many_as_the_papers_or_not() -> None:
    assert rows((0, 0), (0, 0), wasted=0.3)[3].verdict is Verdict.DIFFERS
    assert rows((0, 0), (0, 0), wasted=12.0)[3].verdict is Verdict.MATCHES


def test_all_learned_needs_no_excuse() -> None:
    assert rows((0, 0), (0, 0), learned=1.0)[0].why == ""
    assert "1.5 trials a run" in rows((0, 0), (0, 0), learned=0.9)[0].why
    assert rows((0, 0), (0, 0), learned=0.4)[0].verdict is Verdict.DIFFERS
