"""A subtask that nothing could be learned of is refused."""

import numpy as np
import pytest

from drake_viapoint.errors import LearningError
from drake_viapoint.learning.gain import ConstantGain
from drake_viapoint.learning.subtask import Subtask


def subtask(control: tuple[str, ...], perturbation: tuple[float, ...]) -> Subtask:
    return Subtask("throw", control, "T", perturbation, ConstantGain(0.5), 0.0, 0.05)


def test_it_has_no_gate_unless_told() -> None:
    assert subtask(("x3", "y3"), (0.01, 0.02)).gate == np.inf


@pytest.mark.parametrize(
    ("control", "perturbation"), [((), ()), (("x3",), ()), (("x3", "y3"), (0.01,)), ((), (0.01,))]
)
def test_a_perturbation_for_each_component(
    control: tuple[str, ...], perturbation: tuple[float, ...]
) -> None:
    with pytest.raises(
        LearningError,
        match=f"'throw' has {len(control)} components and {len(perturbation)} perturbations",
    ):
        subtask(control, perturbation)


@pytest.mark.parametrize("size", [0.0, np.nan, np.inf])
def test_perturbations_that_tell_nothing_are_named(size: float) -> None:
    with pytest.raises(LearningError, match=f"perturbation of y3 .* got {size:g}"):
        subtask(("x3", "y3"), (0.01, size))
