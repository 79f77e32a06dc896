"""Learning curves of many runs of the serve, from a sweep's table."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from drake_viapoint.runs.study import REPEATED

LEARNED = "learned"
"""What a run's trials are for once there is nothing left to learn."""

REFUSED = "refused"
"""A trial that the arm could not make; it counts all the same."""

STAGES = {
    ("exploration", "throw"): "exploring J_H",
    ("learning", "throw"): "learning subtask 1",
    ("exploration", "strike"): "exploring J_G",
    ("learning", "strike"): "learning subtask 2",
    ("repeat", "strike"): LEARNED,
}
"""What a trial is for, by its purpose and subtask."""


def runs_of(table: pd.DataFrame, condition: str) -> pd.DataFrame:
    """The rows of one condition."""
    return table[table["condition"] == condition]


def curves(runs: pd.DataFrame, field: str, trials: int) -> NDArray[np.float64]:
    """A field of every trial of every run (n, trials); NaN where there is none.

    A run that was learned goes on with its repeats: the same movement, with fresh draws.

    Args:
        runs: Rows of a sweep's table.
        field: A number of every trial, such as "d".
        trials: How many to show.
    """
    rows = zip(runs[field], runs[REPEATED + field], strict=True)
    joined = [[*listed(made), *listed(repeated)][:trials] for made, repeated in rows]
    filled = [row + [np.nan] * (trials - len(row)) for row in joined]
    return np.array(filled, dtype=np.float64).reshape(len(filled), trials)


def stages(runs: pd.DataFrame, names: tuple[str, ...], trials: int) -> NDArray[np.float64]:
    """Share of runs that are at each stage of learning (len(names), trials).

    Args:
        runs: Rows of a sweep's table.
        names: The values of ``STAGES``, and ``REFUSED``.
        trials: How many to show.
    """
    counts = np.zeros((len(names), trials))
    for _, row in runs.iterrows():
        made = [
            REFUSED if d is None or np.isnan(d) else STAGES[str(purpose), str(subtask)]
            for purpose, subtask, d in zip(
                listed(row["purpose"]), listed(row["subtask"]), listed(row["d"]), strict=True
            )
        ]
        repeated = (
            [LEARNED] * len(listed(row[REPEATED + "d"])) if pd.notna(row["learned_at"]) else []
        )
        for trial, stage in enumerate([*made, *repeated][:trials]):
            counts[names.index(stage), trial] += 1
    return counts / max(1, len(runs))


def listed(cell: Any) -> list[Any]:
    """A list column's cell as a list: Parquet gives arrays, or nothing where a run has an error."""
    return list(cell) if isinstance(cell, list | tuple | np.ndarray) else []
