"""A trial of the upswing: how it ended, what is recorded of it, what the learner hears."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.errors import OutcomeNotFiniteError
from drake_viapoint.tasks.pendulum import PendulumMotion
from drake_viapoint.tasks.trial import RefusedTrial
from drake_viapoint.tasks.upswing_trial import UpswingOutcome, UpswingTrial, upswing_outcome

TOLERANCE = np.array([0.1, 0.5])


def trial(angle: float, speed: float, desired: tuple[float, float] = (0.0, 0.0)) -> UpswingTrial:
    ends = np.array([-np.pi, angle]), np.array([0.0, speed])
    motion = PendulumMotion(np.array([0.0, 2.0]), np.zeros(2), *ends)
    return UpswingTrial(motion, np.array(desired), TOLERANCE)


@pytest.mark.parametrize(
    ("angle", "speed", "ending"),
    [
        (0.0, 0.0, "inverted"),
        (0.099, -0.499, "inverted"),
        (0.0, 0.5, "too_fast"),
        (-0.05, -3.0, "too_fast"),
        (0.1, 0.0, "went_over"),
        (2 * np.pi, 0.0, "went_over"),  # over the top and round again is not a success
        (-0.1, 0.0, "fell_short"),
        (-np.pi, 0.0, "fell_short"),
        (-2 * np.pi, 0.0, "fell_short"),
    ],
)
def test_endings(angle: float, speed: float, ending: str) -> None:
    swung = trial(angle, speed)
    assert swung.ending == ending
    assert swung.success == (ending == "inverted")


def test_seen_from_where_it_hung_whichever_way_it_swings() -> None:
    """A pendulum that is to come up clockwise, to -2 pi, has gone over below that."""
    clockwise = (-2 * np.pi, 0.0)
    assert trial(-2 * np.pi - 1, 0.0, clockwise).ending is UpswingOutcome.WENT_OVER
    assert trial(-2 * np.pi + 1, 0.0, clockwise).ending is UpswingOutcome.FELL_SHORT


@given(st.floats(-9, 9), st.floats(-20, 20), st.floats(-1, 1), st.floats(-2, 2))
def test_the_learner_hears_what_is_recorded(
    angle: float, speed: float, desired_angle: float, desired_speed: float
) -> None:
    swung = trial(angle, speed, (desired_angle, desired_speed))
    read_back = json.loads(json.dumps(swung.record()))
    told = upswing_outcome(read_back)
    np.testing.assert_array_equal(told.error("T"), swung.error)
    assert told.success == swung.success == bool(np.all(np.abs(swung.error) < TOLERANCE))


def test_what_did_not_happen_or_gave_no_numbers() -> None:
    refused = RefusedTrial("via-point 3 is out of reach", ("T",)).record()
    assert upswing_outcome(refused).error("T") is None
    failed = {**trial(0.0, 0.0).record(), "outcome": "failed", "T": [None, 0.0]}
    with pytest.raises(OutcomeNotFiniteError, match="T is not finite"):
        upswing_outcome(failed).error("T")


def test_a_summary_says_how_far_off() -> None:
    assert trial(1.25, -3.0).summary() == "went over, off by +1.25 rad, -3.00 rad/s"
