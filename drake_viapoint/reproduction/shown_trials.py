"""Which trials of a serve our Fig. 6 shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from drake_viapoint.runs.learning_run import recorded_via_points
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import ServeTrial


def shown_trials(records: Sequence[Mapping[str, Any]]) -> dict[str, list[int]]:
    """Which trials our Fig. 6 shows, by column title: first, first hit, last with its repeats.

    The first hit is the trial that ended subtask 1: ball and face met, the goal still missed.
    """
    before_strike = [r["trial"] for r in records if r["subtask"] == "throw"]
    first_hit = before_strike[-1] if before_strike else records[-1]["trial"]
    repeats = [r["trial"] for r in records if r["purpose"] == "repeat"]
    last = [repeats[0] - 1, *repeats] if repeats else [records[-1]["trial"]]
    span = f"trials {last[0]} to {last[-1]}" if len(last) > 1 else f"trial {last[0]}"
    return {
        "first trial": [1],
        f"trial {first_hit}: subtask 1 done": [first_hit],
        f"{span}: the end": last,
    }


def executed_trials(
    task: ServeTask, records: Sequence[Mapping[str, Any]], shown: Mapping[str, Sequence[int]]
) -> dict[str, list[ServeTrial]]:
    """Recorded trials executed once more, by column title; without those of which nothing came.

    Args:
        task: Of the run.
        records: Lines of the run.
        shown: Numbers of the trials, by column title.
    """
    executed = {}
    for title, numbers in shown.items():
        trials = [
            task.execute(
                recorded_via_points(dict(records[number - 1]), task.via_points.names),
                records[number - 1]["seed"],
            )
            for number in numbers
        ]
        executed[title] = [trial for trial in trials if isinstance(trial, ServeTrial)]
    return executed
