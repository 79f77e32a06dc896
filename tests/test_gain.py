"""Gains are continuous and are the paper's."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.learning.gain import ConstantGain, TaperedGain

ALPHA = TaperedGain(0.4, 0.05, 0.1)


@pytest.mark.parametrize(
    ("d", "alpha"), [(0.0, 0.4), (0.05, 0.4), (0.0625, 0.3), (0.075, 0.2), (0.1, 0.0), (1.0, 0.0)]
)
def test_alpha_of_the_paper(d: float, alpha: float) -> None:
    assert ALPHA(d) == pytest.approx(alpha, abs=1e-12)


@given(st.floats(0.05, 0.1))
def test_its_middle_branch(d: float) -> None:
    assert ALPHA(d) == pytest.approx(0.8 - 8 * d, abs=1e-12)


@given(st.floats(0, 0.2), st.floats(0, 0.01))
def test_it_is_continuous_and_never_rises(d: float, further: float) -> None:
    """No jump anywhere: its slope is never beyond 8 per metre."""
    fall = ALPHA(d) - ALPHA(d + further)
    assert -1e-15 <= fall <= 8 * further + 1e-12


@pytest.mark.parametrize("edge", [0.05, 0.1])
def test_both_sides_of_an_edge_agree(edge: float) -> None:
    assert ALPHA(edge - 1e-12) == pytest.approx(ALPHA(edge + 1e-12), abs=1e-10)


def test_a_trial_without_the_preceding_result_has_no_gain() -> None:
    assert ALPHA(float("inf")) == 0.0


@given(st.floats(0, 10))
def test_a_constant_gain_is_constant(d: float) -> None:
    assert ConstantGain((0.2, 0.02))(d) == (0.2, 0.02)
