"""The command line: arguments, progress, printing; no science.

Imports of the science stand inside the commands, so that ``--help`` answers at once.
"""

from __future__ import annotations

import logging
import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from drake_viapoint import __version__
from drake_viapoint.errors import LearningError, ViapointError

if TYPE_CHECKING:
    from drake_viapoint.runs.run_folder import RunFolder
    from drake_viapoint.tasks.serve import ServeTask
    from drake_viapoint.tasks.trial import Trial

LEARNED, NOT_LEARNED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130

_EXISTING = click.Path(path_type=Path)


def main() -> None:
    """Entry point: what goes wrong becomes one line on stderr, and an exit code."""
    # Meshcat would name its port; a level would not outlive the import of Drake
    logging.getLogger("drake").addFilter(lambda record: record.levelno >= logging.WARNING)
    try:
        code = cli.main(standalone_mode=False)
    except click.exceptions.Abort:  # what click makes of Ctrl-C
        click.echo("drake-viapoint: interrupted", err=True)
        code = INTERRUPTED
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        code = BAD_INPUT
    except _Interrupted as error:
        click.echo(f"drake-viapoint: {error.message}", err=True)
        code = INTERRUPTED
    except click.ClickException as error:
        click.echo(f"drake-viapoint: {_one_line(error.format_message())}", err=True)
        code = BAD_INPUT
    except ViapointError as error:
        click.echo(f"drake-viapoint: {_one_line(str(error))}", err=True)
        code = BAD_INPUT
    except RuntimeError as error:  # what Drake thinks of a scenario's wilder values
        if type(error) is not RuntimeError:
            raise
        click.echo(f"drake-viapoint: Drake refuses: {_one_line(str(error))}", err=True)
        code = BAD_INPUT
    except OSError as error:  # a disk that fills, a folder that goes away
        click.echo(f"drake-viapoint: {error.filename or 'writing'}: {error.strerror}", err=True)
        code = BAD_INPUT
    sys.exit(code if isinstance(code, int) else 0)


def _one_line(text: str) -> str:
    return " ".join(text.split())


class _Interrupted(click.ClickException):
    """Ctrl-C, with what a person can do next."""


@contextmanager
def _interruptible(how_to_go_on: Callable[[], str]) -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt as error:
        raise _Interrupted(how_to_go_on()) from error


@click.group(epilog="Start with: drake-viapoint learn serve --out runs/first")
@click.version_option(__version__)
def cli() -> None:
    """Teach a robot a dynamic skill from one demonstration and a few tens of trials."""


@cli.group()
def learn() -> None:
    """Learn a task, trial by trial, into a run folder."""


@learn.command("serve")
@click.option("--out", required=True, type=_EXISTING, help="Folder of the run.")
@click.option("--scenario", type=_EXISTING, help="Scenario file; the shipped one by default.")
@click.option("--demonstration", type=_EXISTING, help="Marker file to watch (C3D, TRC, CSV).")
@click.option("--person", type=click.IntRange(0), help="Watch this virtual person instead.")
@click.option("--t-hit", type=float, help="Time of the hit in the demonstration [s].")
@click.option("--seed", type=click.IntRange(0), help="Seed of the run.")
@click.option("--max-trials", type=click.IntRange(1), default=60, show_default=True)
@click.option("--resume", is_flag=True, help="Go on with the run in the folder, if there is one.")
@click.pass_context
def learn_serve(
    ctx: click.Context,
    out: Path,
    scenario: Path | None,
    demonstration: Path | None,
    person: int | None,
    t_hit: float | None,
    seed: int | None,
    max_trials: int,
    resume: bool,
) -> None:
    r"""Learn the tennis serve.

    Exits with 0 if it was learned, 1 if not within the trials, 2 on bad input.

    \b
    Examples:
      drake-viapoint learn serve --out runs/first
      drake-viapoint learn serve --out runs/person7 --person 7 --max-trials 80
      drake-viapoint learn serve --out runs/first --resume
      drake-viapoint learn serve --out runs/mine --demonstration my_serve.c3d --t-hit 0.93
    """
    from drake_viapoint.runs import serve_run
    from drake_viapoint.tasks.serve import ServeTask

    changes = serve_run.ServeChanges(person, seed, demonstration, t_hit)
    with _interruptible(lambda: f"interrupted before a run was begun in {out}"):
        if resume and serve_run.has_run(out):
            folder, run_scenario = serve_run.resume(out, scenario, changes)
            click.echo(f"going on after trial {len(folder.trials)} of {out}")
            task = ServeTask(run_scenario)
        else:
            if resume:
                click.echo(f"no run in {out} yet: this begins one")
            run_scenario = serve_run.serve_scenario(scenario, changes)
            task = ServeTask(run_scenario)  # bad input is said before a folder is made
            folder = serve_run.begin(out, run_scenario)
    go_on = f"drake-viapoint learn serve --out {shlex.quote(str(out))} --resume"
    with (
        folder,
        _interruptible(
            lambda: f"interrupted after trial {len(folder.trials)}; go on with: {go_on}"
        ),
    ):
        ctx.exit(_learn(out, folder, task, max_trials))


def _learn(out: Path, folder: RunFolder, task: ServeTask, max_trials: int) -> int:
    from drake_viapoint.runs.learning_run import learn as learn_task

    def report(record: dict[str, Any], trial: Trial) -> None:
        mark = "*" if record["success"] else " "
        purpose = f"{record['purpose']} {record['subtask']}"
        click.echo(f"trial {record['trial']:3d} {mark} {purpose:<20} {trial.summary()}")

    try:
        seed = task.scenario.seed
        result = learn_task(task, folder, seed=seed, max_trials=max_trials, on_trial=report)
    except LearningError as error:
        click.echo(f"not learned: {error}; {len(folder.trials)} trials are in {out}")
        return NOT_LEARNED
    if result.learned_at is None:
        click.echo(f"not learned within {result.trials} trials; they are in {out}")
        return NOT_LEARNED
    repeats = result.trials - result.learned_at
    click.echo(
        f"learned at trial {result.learned_at}, then {repeats} repeats; "
        f"{result.trials} trials are in {out}"
    )
    return LEARNED


@cli.command()
@click.argument("run", type=_EXISTING)
@click.option("--trial", type=click.IntRange(1), help="Trial to show; the last one by default.")
@click.option("--html", required=True, type=_EXISTING, help="File of the recording.")
def replay(run: Path, trial: int | None, html: Path) -> None:
    r"""Write a Meshcat recording of a run's trial, to be opened in a browser.

    \b
    Examples:
      drake-viapoint replay runs/first --trial 1 --html first.html
      drake-viapoint replay runs/first --html last.html
    """
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
    r"""Print and plot the via-points of a marker file (C3D, TRC or CSV).

    \b
    Examples:
      drake-viapoint extract my_serve.c3d
      drake-viapoint extract reach.trc --marker fingertip --threshold 0.005
      drake-viapoint extract serve.c3d --body RWRA RWRB RFIN --start 1.2 --end 2.4 --number 8
    """
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
@click.argument("task", type=click.Choice(["serve"]))
@click.option("--person", type=click.IntRange(0), default=0, show_default=True)
@click.option("--out", required=True, type=_EXISTING, help="C3D file to write.")
def demonstrate(task: str, person: int, out: Path) -> None:
    r"""Write the synthetic demonstration of a virtual person as a C3D file.

    \b
    Example:
      drake-viapoint demonstrate serve --person 3 --out person3.c3d
    """
    from drake_viapoint.demonstration.c3d import write_c3d
    from drake_viapoint.runs.serve_run import serve_scenario
    from drake_viapoint.tasks.serve_recording import record_person
    from drake_viapoint.tasks.serve_scene import ServeScene

    write_c3d(out, record_person(person, ServeScene(serve_scenario()).ring))
    click.echo(f"synthetic {task} of virtual person {person} in {out}")


@cli.command()
@click.argument("task", type=click.Choice(["serve"]))
def scenario(task: str) -> None:
    r"""Print a task's scenario with every value, to be edited and given with --scenario.

    \b
    Example:
      drake-viapoint scenario serve > my_serve.yaml
    """
    from drake_viapoint.runs.serve_run import serve_scenario
    from drake_viapoint.tasks.scenario import dump_scenario

    del task
    click.echo(dump_scenario(serve_scenario()), nl=False)


@cli.command()
@click.option("--out", required=True, type=_EXISTING, help="Folder of figures and runs.")
@click.option(
    "--persons",
    type=click.IntRange(0),
    default=20,
    show_default=True,
    help="Virtual persons of the study.",
)
def reproduce(out: Path, persons: int) -> None:
    r"""Run the serve and draw our figures of the paper; then learn from many virtual persons.

    \b
    Example:
      drake-viapoint reproduce --out results
    """
    from drake_viapoint.reproduction.reproduce import reproduce as run

    def progress(label: str, total: int) -> Any:
        return click.progressbar(length=total, label=f"{label:<32}", show_eta=True)

    with _interruptible(lambda: "interrupted; the same command goes on from here"):
        lines = run(out, persons, progress)
    for line in lines:
        click.echo(line)


if __name__ == "__main__":
    main()
