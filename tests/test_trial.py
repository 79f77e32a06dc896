"""A movement that is refused leaves a record like any other."""

import json

import numpy as np

from drake_viapoint.tasks.trial import RefusedTrial, recorded_vector


def test_a_refused_trial_reached_nothing_and_says_why() -> None:
    refused = RefusedTrial("via-point 3 is out of reach", ("d", "T_H", "T_G"))
    record = refused.record()
    assert json.loads(json.dumps(record)) == {
        "outcome": "unreachable",
        "success": False,
        "reason": "via-point 3 is out of reach",
        "d": None,
        "T_H": None,
        "T_G": None,
    }
    assert refused.summary() == "via-point 3 is out of reach"


def test_a_recorded_vector_is_reached_or_not_or_no_number() -> None:
    record = json.loads('{"outcome": "failed", "T": [null, 0.5], "T_H": null, "T_G": [1, 2]}')
    np.testing.assert_array_equal(recorded_vector(record, "T"), [np.nan, 0.5])
    assert recorded_vector(record, "T_H") is None
    np.testing.assert_array_equal(recorded_vector(record, "T_G"), [1.0, 2.0])
