"""``drake-viapoint sweep``: all runs of a study, into one table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from drake_viapoint.cli.ending import importing, interruptible
from drake_viapoint.cli.output import Output, speaking

if TYPE_CHECKING:
    from drake_viapoint.runs.workers import Workers

_PATH = click.Path(path_type=Path)


@click.command()
@click.argument("study", type=_PATH)
@click.option("--out", required=True, type=_PATH, help="Folder of the table and the runs.")
@click.option("--workers", type=click.IntRange(1), help="Processes; one a core by default.")
@click.option("--scheduler", help="Address of a Dask cluster that does the runs instead.")
@click.option("--csv", is_flag=True, help="Write the table as CSV, too.")
@click.option("--no-folders", is_flag=True, help="Keep no trials, only the table.")
@speaking
def sweep(
    study: Path,
    out: Path,
    workers: int | None,
    scheduler: str | None,
    csv: bool,
    no_folders: bool,
    output: Output,
) -> None:
    """Do all runs of a study, and put them into one table.

    Runs that are in the folder already are not done again: the same command goes on after whatever
    interrupted it, or after the study has grown. A run that fails is a row with its error.

    For example:

    \b
        drake-viapoint sweep models/studies/three_conditions.yaml --out results/conditions
        drake-viapoint sweep my_study.yaml --out results/mine --workers 8 --csv
        drake-viapoint sweep my_study.yaml --out results/mine --scheduler tcp://10.0.0.1:8786
    \b
    A study is a YAML file:
      task: serve
      conditions:
        kept: {learning.jacobian.way: fixed}
        recorded: {learning.jacobian.way: recorded}
      vary:
        demonstration.person: {from: 0, to: 19}
        seed: [0, 1, 2]
      max_trials: 60
      tabulate: [d, landing_error, success]
    """
    if scheduler is not None and workers is not None:
        raise click.UsageError("give either --workers or --scheduler")
    output.begin(f"the runs of {study} go to {out}")
    with importing():
        from drake_viapoint.runs.study_file import read_study
        from drake_viapoint.runs.study_table import TABLE, condition_summaries, never_given
        from drake_viapoint.runs.sweep import sweep as sweep_study

    with (
        interruptible(lambda: "interrupted; the same command goes on from here"),
        ExitStack() as closing,
    ):
        asked = read_study(study)
        hands = _workers(workers, scheduler, closing)
        bar = closing.enter_context(output.bar("runs", len(asked)))
        began, there = False, 0

        def show(rows: Sequence[Mapping[str, Any]]) -> None:
            nonlocal began, there
            if not began:  # rows of an earlier sweep: time left is judged by what they took
                began, there = True, len(rows)
                bar.start -= sum(row["seconds"] or 0.0 for row in rows) / hands.number
            bar.update(len(rows))

        table = sweep_study(asked, out, hands, folders=not no_folders, csv=csv, on_rows=show)
    unknown = never_given(table, asked.tabulate)
    runs = "" if no_folders else f", runs in {out / 'runs'}"
    data = {
        "table": out / TABLE,
        "runs": len(table),
        "learned": int(table["learned_at"].notna().sum()),
        "errors": int(table["error"].notna().sum()),
        "never_given": unknown,
    }
    lines = [
        *([f"{there} of {len(table)} runs were there"] if there else []),
        *condition_summaries(table, asked.max_trials),
        *(f"no trial gave {name}: is that what it is called?" for name in unknown),
        f"table in {out / TABLE}{runs}",
    ]
    output.result(data, lines)


def _workers(number: int | None, scheduler: str | None, closing: ExitStack) -> Workers:
    if scheduler is not None:
        with importing():
            from drake_viapoint.runs.cluster import cluster_workers
        return closing.enter_context(cluster_workers(scheduler))
    with importing():
        from joblib import cpu_count

        from drake_viapoint.runs.workers import LocalWorkers
    return LocalWorkers(number or cpu_count())
