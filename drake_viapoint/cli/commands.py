"""The commands: what each is called, what it takes, what it says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from drake_viapoint import __version__
from drake_viapoint.cli.ending import importing, interruptible, run
from drake_viapoint.cli.learn import learn, robot_serve
from drake_viapoint.cli.studies import choices, components, conditions
from drake_viapoint.cli.sweep import sweep

_EXISTING = click.Path(path_type=Path)
_TASK = click.argument("task", type=click.Choice(["serve", "upswing"]))


def main() -> None:
    """Entry point: what goes wrong becomes one line on stderr, and an exit code."""
    run(cli)


@click.group(epilog="Start with: drake-viapoint learn serve --out runs/first")
@click.version_option(__version__)
def cli() -> None:
    """Teach a robot a dynamic skill from one demonstration and a few tens of trials."""


for _command in (learn, components, choices, sweep, conditions):
    cli.add_command(_command)


@cli.command()
@click.argument("run", type=_EXISTING)
@click.option("--trial", type=click.IntRange(1), help="Trial to show; the last one by default.")
@click.option("--html", required=True, type=_EXISTING, help="File of the recording.")
def replay(run: Path, trial: int | None, html: Path) -> None:
    """Write a Meshcat recording of a run's trial, to be opened in a browser.

    \b
    Examples:
      drake-viapoint replay runs/first --trial 1 --html first.html
      drake-viapoint replay runs/first --html last.html
    """
    with importing():
        from drake_viapoint.reproduction.recording import record_trial

    number = record_trial(run, trial, html)
    click.echo(f"trial {number} of {run} is in {html}")


@cli.command()
@click.argument("file", type=_EXISTING)
@click.option("--marker", help="Extract the path of this marker instead of the racket's pose.")
@click.option(
    "--body", nargs=3, metavar="UPPER LOWER WRIST", help="Names of the three markers of the body."
)
@click.option("--number", type=click.IntRange(2), help="Number of via-points, ends included.")
@click.option("--threshold", type=float, help="Or the largest error left [m].")
@click.option("--start", type=float, help="Begin here [s].")
@click.option("--end", type=float, help="End here [s].")
@click.option("--t-hit", type=float, help="Time of the hit [s]; looked for by default.")
@click.option("--plot", type=_EXISTING, help="Picture; FILE-via-points.png here by default.")
def extract(
    file: Path,
    marker: str | None,
    body: tuple[str, str, str] | None,
    number: int | None,
    threshold: float | None,
    start: float | None,
    end: float | None,
    t_hit: float | None,
    plot: Path | None,
) -> None:
    """Print and plot the via-points of a marker file (C3D, TRC or CSV).

    \b
    Examples:
      drake-viapoint extract my_serve.c3d
      drake-viapoint extract reach.trc --marker fingertip --threshold 0.005
      drake-viapoint extract serve.c3d --body RWRA RWRB RFIN --start 1.2 --end 2.4 --number 8
    """
    with importing():
        from drake_viapoint.reproduction.marker_file import extract_from_file

    if marker is not None and body is not None:
        raise click.UsageError("give either --marker or --body")
    picture = plot or Path(f"{file.stem}-via-points.png")
    lines = extract_from_file(
        file,
        picture,
        marker=marker,
        body=body,
        number=number,
        threshold=threshold,
        start=start,
        end=end,
        hit_time=t_hit,
    )
    for line in lines:
        click.echo(line)
    click.echo(f"picture in {picture}")


@cli.command()
@_TASK
@click.option("--person", type=click.IntRange(0), default=0, show_default=True)
@click.option("--out", required=True, type=_EXISTING, help="C3D file to write.")
def demonstrate(task: str, person: int, out: Path) -> None:
    """Write the synthetic demonstration of a virtual person as a C3D file.

    \b
    Examples:
      drake-viapoint demonstrate serve --person 3 --out person3.c3d
      drake-viapoint demonstrate upswing --person 3 --out person3.c3d
    """
    with importing():
        from drake_viapoint.demonstration.c3d import write_c3d
        from drake_viapoint.tasks import catalogue

    write_c3d(out, catalogue.TASKS[task].recorded_person(person))
    click.echo(f"synthetic {task} of virtual person {person} in {out}")


@cli.command()
@_TASK
@click.option("--robot", is_flag=True, help="The serve's that stands for the robot experiment.")
def scenario(task: str, robot: bool) -> None:
    """Print a task's scenario with every value, to be edited and given with --scenario.

    \b
    Examples:
      drake-viapoint scenario serve > my_serve.yaml
      drake-viapoint scenario serve --robot > my_robot.yaml
      drake-viapoint scenario upswing > my_upswing.yaml
    """
    if robot and task != "serve":
        raise click.UsageError(f"--robot is of the serve, not of the {task}")
    with importing():
        from drake_viapoint.tasks.catalogue import task_scenario
        from drake_viapoint.tasks.scenario import dump_scenario

    file = robot_serve() if robot else None
    click.echo(dump_scenario(task_scenario(task, file)), nl=False)


@cli.command()
@click.option("--out", required=True, type=_EXISTING, help="Folder of figures and runs.")
@click.option("--only", type=click.Choice(["serve", "robot", "upswing"]), help="Not everything.")
@click.option(
    "--persons",
    type=click.IntRange(0),
    default=20,
    show_default=True,
    help="Virtual persons from whom the serve is learned.",
)
@click.option(
    "--upswing-persons",
    type=click.IntRange(0),
    default=200,
    show_default=True,
    help="Virtual persons from whom the upswing is learned.",
)
@click.option(
    "--disturbed-runs",
    type=click.IntRange(0, 100),
    default=100,
    show_default=True,
    help="Runs of the serve under each condition of section 3.2.",
)
@click.option(
    "--robot-runs",
    type=click.IntRange(0, 20),
    default=20,
    show_default=True,
    help="Runs of the robot experiment of section 2.1.",
)
def reproduce(
    out: Path,
    only: str | None,
    persons: int,
    upswing_persons: int,
    disturbed_runs: int,
    robot_runs: int,
) -> None:
    """Run the serve, the robot and the upswing, draw our figures, learn from many persons.

    \b
    Examples:
      drake-viapoint reproduce --out results
      drake-viapoint reproduce --out results --only upswing --upswing-persons 20
      drake-viapoint reproduce --out results --only robot --robot-runs 4
    """
    with importing():
        from drake_viapoint.reproduction.reproduce import reproduce as reproduce_all

    def progress(label: str, total: int) -> Any:
        return click.progressbar(length=total, label=f"{label:<32}", show_eta=True)

    with interruptible(lambda: "interrupted; the same command goes on from here"):
        lines = reproduce_all(
            out,
            persons,
            upswing_persons,
            progress,
            only,
            disturbed_runs=disturbed_runs,
            robot_runs=robot_runs,
        )
    for line in lines:
        click.echo(line)


if __name__ == "__main__":
    main()
