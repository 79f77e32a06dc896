"""How a command ends: an exit code, and one line on stderr for what went wrong."""

from __future__ import annotations

import logging
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click

from drake_viapoint.errors import ViapointError

LEARNED, NOT_LEARNED, BAD_INPUT, INTERRUPTED, BROKEN_PIPE = 0, 1, 2, 130, 141


def run(command: click.Command) -> None:
    """Run a command and exit with its code; what goes wrong is said in one line."""
    # Meshcat would name its port; a level would not outlive the import of Drake
    logging.getLogger("drake").addFilter(lambda record: record.levelno >= logging.WARNING)
    try:
        code = command.main(standalone_mode=False)
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


@contextmanager
def interruptible(how_to_go_on: Callable[[], str]) -> Iterator[None]:
    """Let Ctrl-C end the command with a line that says what can be done next."""
    try:
        yield
    except KeyboardInterrupt as error:
        raise _Interrupted(how_to_go_on()) from error


@contextmanager
def importing() -> Iterator[None]:
    """Let Ctrl-C wait until modules are imported.

    Drake's turn an interruption of their import into an ImportError, or swallow it.
    """
    pressed: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: pressed.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if pressed:
        raise KeyboardInterrupt


class _Interrupted(click.ClickException):
    """Ctrl-C, with what a person can do next."""


def _one_line(text: str) -> str:
    return " ".join(text.split())
