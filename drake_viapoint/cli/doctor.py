"""``drake-viapoint doctor``: is this installation sound?"""

from __future__ import annotations

from dataclasses import asdict

import click

from drake_viapoint.cli.ending import importing
from drake_viapoint.cli.output import Output, speaking


@click.command()
@speaking
@click.pass_context
def doctor(ctx: click.Context, /, output: Output) -> None:
    """Check the installation: versions, models, the bits of a trial, Meshcat, Chromium.

    Exits with 0 if everything that is needed is there, 1 if not. Chromium and Graphviz are only
    needed by tests and notebooks; without them it says so and exits with 0.

    For example:

    \b
        drake-viapoint doctor
        drake-viapoint doctor --json
    """
    output.begin("looking at this installation")
    with importing():
        from drake_viapoint.reproduction.installation import CHECKS

    found = []
    for check in CHECKS:
        found.append(check())
        mark = "ok  " if found[-1].ok else "FAIL" if found[-1].needed else "-   "
        output.say(f"{mark} {found[-1].name}: {found[-1].detail}")
    failed = [check.name for check in found if check.needed and not check.ok]
    last = f"not sound: {', '.join(failed)}" if failed else "this installation is sound"
    output.result({"sound": not failed, "checks": [asdict(check) for check in found]}, [last])
    ctx.exit(1 if failed else 0)
