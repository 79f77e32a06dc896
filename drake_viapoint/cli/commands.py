"""The commands: what each is called, what it takes, what it says."""

from __future__ import annotations

from pathlib import Path

import click

from drake_viapoint import __version__
from drake_viapoint.cli.completion import completion
from drake_viapoint.cli.doctor import doctor
from drake_viapoint.cli.ending import importing, run
from drake_viapoint.cli.learn import learn, robot_serve
from drake_viapoint.cli.next_steps import next_steps
from drake_viapoint.cli.output import Output, speaking
from drake_viapoint.cli.reproduce import reproduce
from drake_viapoint.cli.studies import choices, components, conditions
from drake_viapoint.cli.sweep import sweep

_EXISTING = click.Path(path_type=Path)
_TASK = click.argument("task", type=click.Choice(["serve", "upswing"]))


def main() -> None:
    """Entry point: what goes wrong becomes one line on stderr, and an exit code."""
    run(cli)


@click.group(
    invoke_without_command=True,
    epilog="Without a command it says what can be done next, from what is there.",
)
@click.version_option(__version__)
@click.pass_context
def cli(ctx: click.Context) -> None:
    """Teach a robot a dynamic skill from one demonstration and a few tens of trials.

    For example:

    \b
        drake-viapoint learn serve --out runs/first
        drake-viapoint reproduce --out results
        drake-viapoint doctor
    """
    if ctx.invoked_subcommand is None:
        for line in next_steps(Path.cwd()):
            click.echo(line)


for _command in (
    learn,
    reproduce,
    components,
    choices,
    sweep,
    conditions,
    doctor,
    completion,
):
    cli.add_command(_command)


@cli.command()
@click.argument("run", type=_EXISTING)
@click.option("--trial", type=click.IntRange(1), help="Trial to show; the last one by default.")
@click.option("--html", required=True, type=_EXISTING, help="File of the recording.")
@speaking
def replay(run: Path, trial: int | None, html: Path, output: Output) -> None:
    """Write a Meshcat recording of a run's trial, to be opened in a browser.

    For example:

    \b
        drake-viapoint replay runs/first --trial 1 --html first.html
        drake-viapoint replay runs/first --html last.html
    """
    output.begin(f"executing a trial of {run} once more")
    with importing():
        from drake_viapoint.reproduction.recording import record_trial

    number = record_trial(run, trial, html)
    data = {"run": run, "trial": number, "html": html}
    output.result(data, [f"trial {number} of {run} is in {html}"])


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
@speaking
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
    output: Output,
) -> None:
    """Print and plot the via-points of a marker file (C3D, TRC or CSV).

    For example:

    \b
        drake-viapoint extract my_serve.c3d
        drake-viapoint extract reach.trc --marker fingertip --threshold 0.005
        drake-viapoint extract serve.c3d --body RWRA RWRB RFIN --start 1.2 --end 2.4 --number 8
    """
    if marker is not None and body is not None:
        raise click.UsageError("give either --marker or --body")
    output.begin(f"reading {file}")
    with importing():
        from drake_viapoint.reproduction.marker_file import extract_from_file

    picture = plot or Path(f"{file.stem}-via-points.png")
    found = extract_from_file(
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
    points = found.extraction.via_points
    data = {
        "file": file,
        "t_HIT": found.hit_time,
        "names": points.names,
        "times": points.times,
        "values": points.values,
        "worst_error": float(found.extraction.worst_errors[-1]),
        "picture": picture,
    }
    output.result(data, [*found.lines, f"picture in {picture}"])


@cli.command()
@_TASK
@click.option("--person", type=click.IntRange(0), default=0, show_default=True)
@click.option("--out", required=True, type=_EXISTING, help="C3D file to write.")
@speaking
def demonstrate(task: str, person: int, out: Path, output: Output) -> None:
    """Write the synthetic demonstration of a virtual person as a C3D file.

    For example:

    \b
        drake-viapoint demonstrate serve --person 3 --out person3.c3d
        drake-viapoint demonstrate upswing --person 3 --out person3.c3d
    """
    output.begin(f"virtual person {person} shows the {task}")
    with importing():
        from drake_viapoint.demonstration.c3d import write_c3d
        from drake_viapoint.tasks import catalogue

    write_c3d(out, catalogue.TASKS[task].recorded_person(person))
    data = {"task": task, "person": person, "file": out}
    output.result(data, [f"synthetic {task} of virtual person {person} in {out}"])


@cli.command()
@_TASK
@click.option("--robot", is_flag=True, help="The serve's that stands for the robot experiment.")
def scenario(task: str, robot: bool) -> None:
    """Print a task's scenario with every value, to be edited and given with --scenario.

    For example:

    \b
        drake-viapoint scenario serve > my_serve.yaml
        drake-viapoint scenario serve --robot > my_robot.yaml
        drake-viapoint scenario upswing > my_upswing.yaml
    """
    if robot and task != "serve":
        raise click.UsageError(f"--robot is of the serve, not of the {task}")
    with importing():
        from drake_viapoint.tasks.catalogue import task_scenario
        from drake_viapoint.tasks.whole_scenario import whole_scenario

    file = robot_serve() if robot else None
    click.echo(whole_scenario(task_scenario(task, file)), nl=False)


if __name__ == "__main__":
    main()
