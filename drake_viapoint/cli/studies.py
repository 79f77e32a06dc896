"""What many trials or many runs say: which components, which choice, which condition."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path

import click

from drake_viapoint.cli.ending import importing, interruptible
from drake_viapoint.cli.output import Output, speaking

_PATH = click.Path(path_type=Path)


@click.command()
@click.argument("run", type=_PATH)
@click.option("--out", required=True, type=_PATH, help="Folder of the picture and tables.")
@click.option(
    "--position", type=float, default=0.05, show_default=True, help="Moved by so much [m]."
)
@click.option(
    "--angle", type=float, default=5.0, show_default=True, help="Turned by so much [deg]."
)
@speaking
def components(run: Path, out: Path, position: float, angle: float, output: Output) -> None:
    """Find which via-point components move the ball in a run of the serve (our Fig. 9).

    For example:

    \b
        drake-viapoint components runs/first --out components
        drake-viapoint components runs/first --out components --position 0.01 --angle 1
    """
    if not (position > 0 and angle > 0):
        raise click.UsageError("--position and --angle must be positive")
    output.begin(f"moving every component of {run}")
    with importing():
        from drake_viapoint.reproduction.components import study_components

    with interruptible(lambda: "interrupted; nothing was written"):
        studied = study_components(run, out, position=position, angle=math.radians(angle))
    found = studied.found
    data = {
        "S_H": {"by_norm": found.throw.control},
        "S_G": {"by_norm": found.by_norm.control, "by_ratio": found.by_ratio.control},
        "out": out,
    }
    output.result(data, [*studied.lines, studied.where])


@click.command()
@click.option("--out", required=True, type=_PATH, help="Folder of the table.")
@click.option("--persons", type=click.IntRange(1), default=20, show_default=True)
@speaking
def choices(out: Path, persons: int, output: Output) -> None:
    """Learn many persons' serves with components chosen by norm and by ratio (section 2.2.2).

    For example:

    \b
        drake-viapoint choices --out results/choices --persons 20
    """
    output.begin(f"learning {persons} persons' serves into {out}")
    with importing():
        from drake_viapoint.reproduction.choices import RESULTS, choices_summary, study_choices
        from drake_viapoint.reproduction.table import write_table

    with (
        interruptible(lambda: "interrupted; the same command goes on from here"),
        output.bar("learning with each choice", persons) as bar,
    ):
        results = study_choices(out / RESULTS, persons, on_person=bar.update)
    table = write_table(results, out / "choices.csv")
    data = {"table": table, "persons": [asdict(result) for result in results]}
    output.result(data, [*choices_summary(results), f"table in {table}"])


@click.command()
@click.argument("sweep", type=_PATH)
@click.option("--out", required=True, type=_PATH, help="Folder of the picture and tables.")
@speaking
def conditions(sweep: Path, out: Path, output: Output) -> None:
    """Draw the learning curves of a sweep of the serve, and compare its conditions (our Fig. 10).

    The sweep needs repeats, and to tabulate d, landing_error, T_G, success, purpose and subtask.

    For example:

    \b
        drake-viapoint sweep models/studies/three_conditions.yaml --out results/three_conditions
        drake-viapoint conditions results/three_conditions --out results
    """
    output.begin(f"comparing the conditions of {sweep}")
    with importing():
        from drake_viapoint.reproduction.conditions import study_conditions

    studied = study_conditions(sweep, out)
    data = {
        "conditions": [asdict(result) for result in studied.results],
        "pairs": [asdict(pair) for pair in studied.pairs],
        "out": out,
    }
    output.result(data, [*studied.lines, studied.where])
