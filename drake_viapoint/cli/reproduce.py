"""``drake-viapoint reproduce``: everything the paper has, on one page."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from drake_viapoint.cli.ending import importing, interruptible
from drake_viapoint.cli.output import Output, speaking

EXPERIMENTS = (
    "serve",
    "persons",
    "choices",
    "robot",
    "conditions",
    "conditions-small",
    "upswing",
    "upswing-persons",
)
"""Names of the experiments: written down here, too, as ``--help`` imports no science."""

_NAME = click.Choice(EXPERIMENTS)


@click.command()
@click.option(
    "--out", required=True, type=click.Path(path_type=Path), help="Folder of the page and the runs."
)
@click.option("--only", type=_NAME, multiple=True, help="Not everything; may be given repeatedly.")
@click.option("--full", is_flag=True, help="Studies at full size instead of a reduced one.")
@click.option(
    "--size",
    type=(_NAME, click.IntRange(1)),
    multiple=True,
    metavar="EXPERIMENT N",
    help="So many persons, robots or runs in that study.",
)
@speaking
def reproduce(
    out: Path,
    only: tuple[str, ...],
    full: bool,
    size: tuple[tuple[str, int], ...],
    output: Output,
) -> None:
    """Reproduce the paper: runs, figures, recordings, and a page of it all, index.html.

    What the folder holds already is done again only if its scenario or a version has changed.

    For example:

    \b
        drake-viapoint reproduce --out results
        drake-viapoint reproduce --out results --full
        drake-viapoint reproduce --out results --only serve --only upswing
        drake-viapoint reproduce --out results --only robot --size robot 4

    Experiments:

    \b
        serve             Figs. 2 to 5, 8 and 9, recordings
        persons           the serve from many virtual persons
        choices           components chosen by norm and by ratio (section 2.2.2)
        robot             Figs. 6 and 7, on a simulated robot (section 2.1)
        conditions        Fig. 10, a disturbed ball (section 3.2)
        conditions-small  the same with smaller explorations
        upswing           Figs. 11 to 14, recordings
        upswing-persons   the upswing from many virtual persons
    """
    output.begin(f"reproducing into {out}")
    with importing():
        from drake_viapoint.reproduction.experiments import BY_NAME
        from drake_viapoint.reproduction.report import PAGE
        from drake_viapoint.reproduction.reproduce import reproduce as reproduce_all

    sizes = {name: BY_NAME[name].full if full else BY_NAME[name].reduced for name in BY_NAME}
    for name, number in size:
        if number > BY_NAME[name].full:
            raise click.UsageError(
                f"--size {name} must be at most {BY_NAME[name].full}, got {number}"
            )
        sizes[name] = number
    chosen = {name: sizes[name] for name in sizes if not only or name in only}
    if strangers := [name for name, _ in size if name not in chosen]:
        raise click.UsageError(f"--size {strangers[0]} is of an experiment that --only leaves out")
    with interruptible(lambda: "interrupted; the same command goes on from here"):
        done = reproduce_all(out, chosen, output.bar, output.say)
    data = {
        "page": out / PAGE,
        "experiments": [
            {
                "name": part.name,
                "unchanged": part.unchanged,
                "seconds": part.seconds,
                "files": [str(out / file) for file in part.findings.files],
                "comparisons": [asdict(row) for row in part.findings.comparisons],
            }
            for part in done
        ],
    }
    unchanged = sum(part.unchanged for part in done)
    kept = f" ({unchanged} of {len(done)} experiments were as before)" if unchanged else ""
    output.result(data, [f"everything is on {out / PAGE}{kept}"])
