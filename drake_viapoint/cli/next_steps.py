"""``drake-viapoint`` alone: what can be done next, from what there is."""

from __future__ import annotations

import itertools
import shlex
from pathlib import Path

_MOST = 200  # folders that are looked at

_FIRST = (
    ("learn a tennis serve, a line a trial (seconds)", "learn serve --out runs/first"),
    ("everything the paper has, on one page (minutes)", "reproduce --out results"),
    ("is this installation sound?", "doctor"),
)
_ALWAYS = (
    ("your own marker file: its via-points", "extract my_serve.c3d"),
    ("everything that can be set, to be edited", "scenario serve > my_serve.yaml"),
    ("all commands", "--help"),
)


def next_steps(here: Path) -> list[str]:
    """Lines that say what can be done next.

    Args:
        here: Folder in which the command is called.
    """
    runs, pages = _found(here, "trials.jsonl"), _found(here, "index.html")
    tables = _found(here, "table.parquet")
    steps: list[tuple[str, str]] = []
    if not runs:
        steps += _FIRST[:1]
    else:
        run = max(runs, key=lambda path: path.stat().st_mtime)
        name = shlex.quote(str(run.parent.relative_to(here)))
        steps += [
            (f"watch the last trial of {name}", f"replay {name} --html last.html"),
            ("go on with it, if it was interrupted", f"learn {_task(run)} --out {name} --resume"),
        ]
        if _task(run) == "serve":
            steps.append(("which components move its ball", f"components {name} --out components"))
    if tables:
        name = shlex.quote(str(tables[0].parent.relative_to(here)))
        steps.append((f"compare the conditions of {name}", f"conditions {name} --out results"))
    steps += _FIRST[1:] if not pages else _FIRST[2:]
    steps += _ALWAYS
    lines = [f"open {page.relative_to(here)} in a browser" for page in pages[:1]]
    width = max(len(command) for _, command in steps)
    return [
        "What can be done next:",
        *(f"  {line}" for line in lines),
        *(f"  drake-viapoint {command:<{width}}  {what}" for what, command in steps),
    ]


def _found(here: Path, name: str) -> list[Path]:
    """Files of that name in this folder's folders, and in theirs."""
    found = itertools.chain(here.glob(f"*/{name}"), here.glob(f"*/*/{name}"))
    return sorted(itertools.islice(found, _MOST))


def _task(trials: Path) -> str:
    """Of a run's scenario, read without a parser: its first key says it."""
    try:
        lines = (trials.parent / "scenario.yaml").read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return "serve"
    tasks = [line.split(":", 1)[1].strip() for line in lines if line.startswith("task:")]
    return tasks[0] if tasks else "serve"
