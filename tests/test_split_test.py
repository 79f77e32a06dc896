"""The exact test of a split, against the binomial distribution summed by hand."""

from __future__ import annotations

from math import comb

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.reproduction.split_test import split_p_value

counts = st.integers(0, 40)


@given(counts, counts)
def test_it_is_the_two_tails_of_a_fair_coin(one: int, other: int) -> None:
    number, fewer = one + other, min(one, other)
    tails = 2 * sum(comb(number, k) for k in range(fewer + 1)) / 2**number
    assert split_p_value(one, other) == pytest.approx(min(1.0, tails))


@given(counts, counts)
def test_it_knows_no_sides(one: int, other: int) -> None:
    assert split_p_value(one, other) == pytest.approx(split_p_value(other, one))


def test_no_pairs_tell_nothing() -> None:
    assert split_p_value(0, 0) == 1.0
