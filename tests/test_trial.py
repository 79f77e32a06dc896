"""A movement that is refused leaves a record like any other."""

import json

from drake_viapoint.tasks.trial import RefusedTrial


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
