"""What many trials or many runs say: which components, which choice, which condition."""

from __future__ import annotations

import math
from pathlib import Path

import click

from drake_viapoint.cli.ending import importing, interruptible

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
def components(run: Path, out: Path, position: float, angle: float) -> None:
    """Find which via-point components move the ball in a run of the serve (our Fig. 9).

    \b
    Examples:
      drake-viapoint components runs/first --out components
      drake-viapoint components runs/first --out components --position 0.01 --angle 1
    """
    if not (position > 0 and angle > 0):
        raise click.UsageError("--position and --angle must be positive")
    with importing():
        from drake_viapoint.reproduction.components import study_components

    with interruptible(lambda: "interrupted; nothing was written"):
        lines = study_components(run, out, position=position, angle=math.radians(angle))
    for line in lines:
        click.echo(line)


@click.command()
@click.option("--out", required=True, type=_PATH, help="Folder of the table.")
@click.option("--persons", type=click.IntRange(1), default=20, show_default=True)
def choices(out: Path, persons: int) -> None:
    """Learn many persons' serves with components chosen by norm and by ratio (section 2.2.2).

    \b
    Example:
      drake-viapoint choices --out results/choices --persons 20
    """
    with importing():
        from drake_viapoint.reproduction.choices import choices_summary, study_choices
        from drake_viapoint.reproduction.table import write_table

    label = f"{'learning with each choice':<32}"
    with (
        interruptible(lambda: "interrupted; the same command goes on from here"),
        click.progressbar(length=persons, label=label, show_eta=True) as bar,
    ):
        results = study_choices(out / "choices.jsonl", persons, on_person=bar.update)
    for line in choices_summary(results):
        click.echo(line)
    if results:
        click.echo(f"table in {write_table(results, out / 'choices.csv')}")


@click.command()
@click.argument("sweep", type=_PATH)
@click.option("--out", required=True, type=_PATH, help="Folder of the picture and tables.")
def conditions(sweep: Path, out: Path) -> None:
    """Draw the learning curves of a sweep of the serve, and compare its conditions (our Fig. 10).

    The sweep needs repeats, and to tabulate d, landing_error, T_G, success, purpose and subtask.

    \b
    Example:
      drake-viapoint sweep models/studies/three_conditions.yaml --out results/three_conditions
      drake-viapoint conditions results/three_conditions --out results
    """
    with importing():
        from drake_viapoint.reproduction.conditions import study_conditions

    for line in study_conditions(sweep, out):
        click.echo(line)
