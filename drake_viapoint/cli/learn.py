"""``drake-viapoint learn``: a task, trial by trial, into a run folder."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from drake_viapoint.cli.ending import LEARNED, NOT_LEARNED, importing, interruptible
from drake_viapoint.cli.output import Output, speaking
from drake_viapoint.errors import LearningError, OutcomeNotFiniteError

if TYPE_CHECKING:
    from drake_viapoint.runs.run_folder import RunFolder
    from drake_viapoint.tasks.trial import Task, Trial

F = TypeVar("F", bound=Callable[..., None])

_PATH = click.Path(path_type=Path)
_OF_EVERY_TASK = (
    click.option("--out", required=True, type=_PATH, help="Folder of the run."),
    click.option("--scenario", type=_PATH, help="Scenario file; the shipped one by default."),
    click.option("--demonstration", type=_PATH, help="Marker file to watch (C3D, TRC, CSV)."),
    click.option("--person", type=click.IntRange(0), help="Watch this virtual person instead."),
    click.option(
        "--jacobian",
        type=click.Choice(["fixed", "manual", "recorded"]),
        help="Keep the Jacobian, explore it again, or estimate it from the last trials.",
    ),
    click.option("--seed", type=click.IntRange(0), help="Seed of the run."),
    click.option("--max-trials", type=click.IntRange(1), default=60, show_default=True),
    click.option(
        "--resume", is_flag=True, help="Go on with the run in the folder, if there is one."
    ),
)


def _options_of_every_task(command: F) -> F:
    for option in reversed(_OF_EVERY_TASK):
        command = option(command)
    return command


def robot_serve() -> Path:
    """The scenario that stands for the robot experiment."""
    with importing():
        from drake_viapoint.packages import resolve
        from drake_viapoint.tasks.catalogue import ROBOT_SERVE

    return resolve(ROBOT_SERVE)


@click.group()
def learn() -> None:
    """Learn a task, trial by trial, into a run folder.

    Exits with 0 if it was learned, 1 if not within the trials, 2 on bad input.

    For example:

    \b
        drake-viapoint learn serve --out runs/first
        drake-viapoint learn upswing --out runs/swing
    """


@learn.command("serve")
@_options_of_every_task
@click.option("--t-hit", type=float, help="Time of the hit in the demonstration [s].")
@click.option(
    "--robot",
    is_flag=True,
    help="As on a robot: real contact, camera samples, a controller that does not know the truth.",
)
@speaking
@click.pass_context
def learn_serve(ctx: click.Context, /, t_hit: float | None, robot: bool, **options: Any) -> None:
    """Learn the tennis serve.

    Exits with 0 if it was learned, 1 if not within the trials, 2 on bad input.

    For example:

    \b
        drake-viapoint learn serve --out runs/first
        drake-viapoint learn serve --out runs/robot --robot --max-trials 80
        drake-viapoint learn serve --out runs/person7 --person 7 --max-trials 80
        drake-viapoint learn serve --out runs/first --resume
        drake-viapoint learn serve --out runs/mine --demonstration my_serve.c3d --t-hit 0.93
    """
    if robot:
        if options["scenario"] is not None:
            raise click.UsageError("give either --robot or --scenario")
        options["scenario"] = robot_serve()
    ctx.exit(_learn("serve", {"demonstration.hit_time": t_hit}, **options))


@learn.command("upswing")
@_options_of_every_task
@click.option(
    "--execution",
    type=click.Choice(["recurrence", "plant"]),
    help="The paper's difference equation, or Drake's plant.",
)
@click.option(
    "--hand",
    type=click.Choice(["kinematic", "tracked"]),
    help="In the plant: moved exactly as commanded, or carried by the arm.",
)
@click.option(
    "--end-state",
    type=(float, float),
    metavar="ANGLE SPEED",
    help="Of the demonstrated pendulum [rad, rad/s]; measured by default.",
)
@speaking
@click.pass_context
def learn_upswing(
    ctx: click.Context,
    /,
    execution: str | None,
    hand: str | None,
    end_state: tuple[float, float] | None,
    **options: Any,
) -> None:
    """Learn to swing a pendulum up.

    Exits with 0 if it was learned, 1 if not within the trials, 2 on bad input.

    For example:

    \b
        drake-viapoint learn upswing --out runs/swing
        drake-viapoint learn upswing --out runs/fixed --jacobian fixed
        drake-viapoint learn upswing --out runs/plant --execution plant --hand tracked
        drake-viapoint learn upswing --out runs/person7 --person 7 --max-trials 30
        drake-viapoint learn upswing --out runs/mine --demonstration my_swing.csv --end-state 0 0
    """
    angle, speed = end_state or (None, None)
    changes = {
        "execution": execution,
        "hand": hand,
        "demonstration.end_angle": angle,
        "demonstration.end_speed": speed,
    }
    ctx.exit(_learn("upswing", changes, **options))


def _learn(
    task_name: str,
    own_changes: Mapping[str, object],
    *,
    out: Path,
    scenario: Path | None,
    demonstration: Path | None,
    person: int | None,
    jacobian: str | None,
    seed: int | None,
    max_trials: int,
    resume: bool,
    output: Output,
) -> int:
    """Learn with the changes that are not None; returns the exit code."""
    output.begin(f"learning the {task_name}; trials go to {out}")
    with importing():
        from drake_viapoint.runs import task_run
        from drake_viapoint.tasks.catalogue import build_task, task_scenario

    if demonstration is not None:
        if person is not None:
            raise click.UsageError("give either --person or --demonstration")
        person = 0
    asked = {
        **own_changes,
        "demonstration.file": demonstration and str(demonstration.absolute()),
        "demonstration.person": person,
        "learning.jacobian.way": jacobian,
        "seed": seed,
    }
    changes = {key: value for key, value in asked.items() if value is not None}
    with interruptible(lambda: f"interrupted before a run was begun in {out}"):
        if resume and task_run.has_run(out):
            folder, run_scenario = task_run.resume(out, task_name, scenario, changes)
            output.say(f"going on after trial {len(folder.trials)} of {out}")
            task = build_task(run_scenario)
        else:
            if resume:
                output.say(f"no run in {out} yet: this begins one")
            run_scenario = task_scenario(task_name, scenario, changes)
            task = build_task(run_scenario)  # bad input is said before a folder is made
            folder = task_run.begin(out, run_scenario)
    go_on = f"drake-viapoint learn {task_name} --out {shlex.quote(str(out))} --resume"
    with (
        folder,
        interruptible(lambda: f"interrupted after trial {len(folder.trials)}; go on with: {go_on}"),
    ):
        return _trials(out, folder, task, run_scenario.seed, max_trials, go_on, output)


def _trials(
    out: Path,
    folder: RunFolder,
    task: Task,
    seed: int,
    max_trials: int,
    go_on: str,
    output: Output,
) -> int:
    with importing():
        from drake_viapoint.runs.learning_run import learn as learn_task

    def report(record: dict[str, Any], trial: Trial) -> None:
        mark = "*" if record["success"] else " "
        purpose = f"{record['purpose']} {record['subtask']}"
        output.say(f"trial {record['trial']:3d} {mark} {purpose:<20} {trial.summary()}")

    def ended(learned_at: int | None, why: str) -> int:
        trials = len(folder.trials)
        data = {"run": out, "task": task.name, "learned_at": learned_at, "trials": trials}
        output.result(data if learned_at else {**data, "reason": why}, [why])
        return LEARNED if learned_at else NOT_LEARNED

    try:
        result = learn_task(task, folder, seed=seed, max_trials=max_trials, on_trial=report)
    except OutcomeNotFiniteError as error:
        return ended(None, f"not learned: {error}; try it once more with: {go_on}")
    except LearningError as error:
        return ended(None, f"not learned: {error}; {len(folder.trials)} trials are in {out}")
    if result.learned_at is None:
        return ended(None, f"not learned within {result.trials} trials; they are in {out}")
    repeats = result.trials - result.learned_at
    then = f", then {repeats} repeats" if repeats else ""
    return ended(
        result.learned_at,
        f"learned at trial {result.learned_at}{then}; {result.trials} trials are in {out}",
    )
