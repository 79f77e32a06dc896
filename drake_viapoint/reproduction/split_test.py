"""Is a split of pairs more uneven than chance would make it?"""

from __future__ import annotations

from scipy.stats import binomtest

SURE = 0.05
"""A p-value below this counts as a difference."""


def split_p_value(one: int, other: int) -> float:
    """Probability of so uneven a split, or more so, if both were equally likely.

    Of pairs in which just one of two succeeds this is McNemar's exact test, of pairs in which one
    of two is sooner the sign test.

    Args:
        one: Pairs of the one sort.
        other: Pairs of the other.
    """
    return float(binomtest(one, one + other).pvalue) if one + other else 1.0
