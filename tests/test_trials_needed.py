"""Percentiles of trials needed: of runs there are, counting those that never get there."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.reproduction.trials_needed import trials_in_words, trials_percentile


@given(st.lists(st.integers(1, 60) | st.just(np.inf), min_size=1, max_size=50), st.floats(0, 100))
def test_it_is_one_of_the_runs_and_enough_of_them_are_no_later(
    trials: list[float], percent: float
) -> None:
    value = trials_percentile(trials, percent)
    limit = np.inf if value is None else value
    assert limit in trials
    # of n runs, ranked from 0, it is the first at or beyond percent of n - 1
    enough = np.ceil(round(percent / 100 * (len(trials) - 1), 9)) + 1
    assert np.sum(np.asarray(trials) <= limit) >= enough


@pytest.mark.parametrize(
    ("trials", "percent", "expected"),
    [([10, 20, 30], 50, 20), ([10, 20, 30, 40], 50, 30), ([10, np.inf], 50, None), ([7], 90, 7)],
)
def test_known_ones(trials: list[float], percent: float, expected: float | None) -> None:
    assert trials_percentile(trials, percent) == expected


def test_in_words() -> None:
    assert [trials_in_words(value) for value in (None, 12.0, 12.5)] == ["-", "12", "12.5"]
