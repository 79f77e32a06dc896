"""``drake-viapoint completion``: completing commands and options in a shell."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

PROGRAM = "drake-viapoint"
_VARIABLE = "_DRAKE_VIAPOINT_COMPLETE"


@click.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@click.pass_context
def completion(ctx: click.Context, shell: str) -> None:
    """Print what makes a shell complete commands, options and files.

    For example:

    \b
        drake-viapoint completion bash >> ~/.bashrc
        drake-viapoint completion zsh >> ~/.zshrc
        drake-viapoint completion fish > ~/.config/fish/completions/drake-viapoint.fish
    """
    kind = get_completion_class(shell)
    if kind is None:
        raise click.UsageError(f"no completion for {shell}")
    click.echo(kind(ctx.find_root().command, {}, PROGRAM, _VARIABLE).source())
