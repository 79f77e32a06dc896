"""The page: every figure with its caption, our numbers beside the paper's, the recordings.

``index.html`` and what it shows are plain files of one folder: nothing is fetched from elsewhere,
and it opens from a disk as from a server.
"""

from __future__ import annotations

import platform
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from drake_viapoint.errors import ViapointError
from drake_viapoint.reproduction.experiments import EXPERIMENTS, Experiment
from drake_viapoint.reproduction.findings import Verdict
from drake_viapoint.reproduction.ledger import Entry

PAGE = "index.html"

_SUMMED = {
    Verdict.MATCHES: "of our numbers match the paper's",
    Verdict.DIFFERS: "differ",
    Verdict.NOT_COMPARABLE: "cannot be compared",
}
_TEMPLATE = "report.html.jinja"


def write_report(out: Path, entries: Mapping[str, Entry | None]) -> Path:
    """Write the page of what a folder holds.

    Args:
        out: The folder.
        entries: What its ledger says of each experiment, by name.

    Returns:
        The page.

    Raises:
        ViapointError: It cannot be written.
    """
    page = out / PAGE
    try:
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(report(out, entries), encoding="utf-8")
    except OSError as error:
        raise ViapointError(f"{page}: cannot be written: {error.strerror}") from error
    return page


def report(out: Path, entries: Mapping[str, Entry | None]) -> str:
    """The page as text. See ``write_report``."""
    environment = Environment(
        loader=PackageLoader("drake_viapoint.reproduction", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    parts = [_part(out, experiment, entries.get(experiment.name)) for experiment in EXPERIMENTS]
    rows = [row for part in parts for row in part["comparisons"]]
    return environment.get_template(_TEMPLATE).render(
        parts=parts,
        verdicts=[(words, _count(rows, verdict)) for verdict, words in _SUMMED.items()],
        machine=f"{platform.system()} {platform.machine()}",
    )


def command_of(out: Path, experiment: Experiment, size: int) -> str:
    """The command that makes an experiment, of some size, in a folder."""
    words = ["drake-viapoint", "reproduce", "--out", str(out), "--only", experiment.name]
    if experiment.unit:
        words += ["--size", experiment.name, str(size)]
    return shlex.join(words)


def _part(out: Path, experiment: Experiment, entry: Entry | None) -> dict[str, Any]:
    done = entry if entry is not None and entry.findings is not None else None
    size = done.size if done else experiment.reduced
    return {
        "experiment": experiment,
        "entry": done,
        "findings": done.findings if done else None,
        "comparisons": done.findings.comparisons if done and done.findings else (),
        "versions": done.depends.get("versions", {}) if done else {},
        "size": f"{size} {experiment.unit}" if experiment.unit else "one run",
        "reduced": bool(experiment.unit) and size < experiment.full,
        "command": command_of(out, experiment, size),
    }


def _count(rows: list[Any], verdict: Verdict) -> int:
    return sum(row.verdict == verdict for row in rows)
