"""Choosing components: by norm, by ratio, never by what was not seen."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.component_effects import ComponentEffects
from drake_viapoint.learning.selection import select_components

NAMES = tuple(f"x{i}" for i in range(1, 7))


def effects(norms: list[float], gaps: tuple[str, ...] = ()) -> ComponentEffects:
    columns = np.array([norms, np.zeros(len(norms))])
    for name in gaps:
        columns[:, NAMES.index(name)] = np.nan
    reasons = {name: f"{name} moved by +0.05 does not reach T" for name in gaps}
    return ComponentEffects("T", NAMES, columns, reasons)


def test_the_largest_norms_in_the_order_of_their_columns() -> None:
    selection = select_components(effects([1.0, 5.0, 3.0, 0.0, 4.0, 2.0]), 3)
    assert selection.control == ("x2", "x3", "x5")
    assert [line.rank for line in selection.table] == [5, 1, 3, 6, 2, 4]
    assert [line.column for line in selection.table] == [1, 2, 3, 4, 5, 6]
    assert selection.table[1].why == "norm ranks 1 of 6"


def test_the_largest_ratios() -> None:
    g, h = effects([1.0, 5.0, 3.0, 0.5, 4.0, 2.0]), effects([0.1, 5.0, 0.1, 0.01, 4.0, 1.0])
    selection = select_components(g, 2, preceding=h)
    assert selection.control == ("x3", "x4")  # 30 and 50
    assert selection.table[1].score == 1.0
    assert selection.table[3].why == "ratio ranks 1 of 6"


def test_a_ratio_of_two_nothings_is_not_chosen_if_told_so() -> None:
    g, h = effects([1.0, 5.0, 3.0, 0.01, 4.0, 2.0]), effects([0.1, 5.0, 0.1, 1e-5, 4.0, 1.0])
    assert "x4" in select_components(g, 2, preceding=h).control
    selection = select_components(g, 2, preceding=h, least_effect=0.1)
    assert selection.control == ("x1", "x3")
    assert selection.table[3].why == "effect below 0.1 of the largest"


def test_what_does_not_disturb_at_all_comes_first() -> None:
    g, h = effects([1.0, 5.0, 3.0, 0.0, 4.0, 2.0]), effects([0.1, 5.0, 0.0, 0.0, 4.0, 1.0])
    selection = select_components(g, 1, preceding=h)
    assert selection.control == ("x3",)
    assert selection.table[3].rank == 0  # 0 / 0 says nothing


@given(st.permutations(list(range(6))), st.integers(1, 4))
def test_a_gap_is_never_chosen(order: list[int], number: int) -> None:
    g = effects([float(value + 1) for value in order], gaps=("x2", "x5"))
    selection = select_components(g, number)
    assert not {"x2", "x5"} & set(selection.control)
    assert len(selection.control) == number
    assert selection.table[1].why == "no norm: x2 moved by +0.05 does not reach T"
    left = select_components(effects([1.0] * 6), 1, preceding=g).table
    assert left[4].rank == 0  # nor what disturbs in a way that was not seen


@pytest.mark.parametrize("number", [0, 5])
def test_more_than_there_are(number: int) -> None:
    with pytest.raises(LearningError, match=rf"4 of 6 components .* T .* {number} are asked for"):
        select_components(effects([1.0] * 6, gaps=("x1", "x2")), number)


def test_effects_of_other_components_do_not_go_together() -> None:
    other = ComponentEffects("T_H", NAMES[::-1], np.ones((2, 6)), {})
    with pytest.raises(LearningError, match="the same components"):
        select_components(effects([1.0] * 6), 1, preceding=other)
