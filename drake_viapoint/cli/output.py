"""What a command says, to a person or to a script."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Any

import click

from drake_viapoint.cli.ending import BROKEN_PIPE


@dataclass(frozen=True)
class Output:
    """Where the words of a command go.

    Attributes:
        quiet: Say nothing; errors go to stderr all the same.
        json: Say the result as one JSON document, and nothing else.
    """

    quiet: bool = False
    json: bool = False

    @property
    def silent(self) -> bool:
        """Whether only a script listens."""
        return self.quiet or self.json

    def begin(self, line: str) -> None:
        """What is about to be done, for a person who waits: imports and scenes take a second."""
        if sys.stdout.isatty():
            self.say(line)

    def say(self, line: str) -> None:
        """Something on the way."""
        if self.silent:
            return
        try:
            click.echo(line)
        except BrokenPipeError:  # whoever read has left, as `head` does; click would exit with 1
            # what is still to be flushed needs somewhere to go, or Python complains at its end
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(BROKEN_PIPE)

    def result(self, data: Mapping[str, Any], lines: Iterable[str]) -> None:
        """What came of it: data for a script, lines for a person."""
        if self.json:
            click.echo(json.dumps(data, indent=1, default=_plain, ensure_ascii=False))
        else:
            for line in lines:
                self.say(line)

    def bar(self, label: str, total: int) -> Any:
        """A progress bar with the time left."""
        return click.progressbar(
            length=total, label=f"{label:<32}", show_eta=True, hidden=self.silent
        )


def speaking(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command ``--quiet`` and ``--json``; it gets an ``Output`` as ``output``."""

    @click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors.")
    @click.option("--json", "as_json", is_flag=True, help="Say the result as JSON, for scripts.")
    @wraps(command)
    def told(*args: Any, quiet: bool, as_json: bool, **options: Any) -> Any:
        return command(*args, output=Output(quiet, as_json), **options)

    return told


def _plain(value: Any) -> Any:
    """Of what JSON does not know: arrays and paths."""
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is not plain")
