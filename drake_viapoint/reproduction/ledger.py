"""What has been reproduced in a folder already, of which scenario, by which versions.

``reproduced/<experiment>.json`` says what an experiment's results depend on: it is written before
the first run and again with the findings. So the next call knows what is as it was, what has only
to be drawn anew, and what is of another scenario or version and has to be done again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import drake_viapoint
from drake_viapoint.errors import RunFolderError
from drake_viapoint.packages import models_path
from drake_viapoint.reproduction.findings import Findings, findings_of

FOLDER = "reproduced"
_MADE_BY = {".py", ".pyc"}  # what makes models is none
EARLIER = "earlier"
"""Folder of runs that were set aside."""


@dataclass(frozen=True)
class Entry:
    """What the ledger says of an experiment.

    Attributes:
        depends: What its runs depend on, as plain data: scenarios, numbers, versions.
        size: How many runs it was made with.
        source: Digest of the code that drew it.
        finished: When [UTC], in words; empty while it is only begun.
        seconds: What it took.
        findings: What it brought; None while it is only begun.
    """

    depends: Mapping[str, Any]
    size: int
    source: str
    finished: str = ""
    seconds: float = 0.0
    findings: Findings | None = None


class Ledger:
    """The entries of a folder of results.

    Args:
        out: The folder.
    """

    def __init__(self, out: Path) -> None:
        self._out = out

    def read(self, experiment: str) -> Entry | None:
        """What is said of an experiment; None if nothing that can be understood."""
        try:
            data = json.loads(self._path(experiment).read_text(encoding="utf-8"))
            findings = data["findings"]
            return Entry(
                dict(data["depends"]),
                int(data["size"]),
                str(data["source"]),
                str(data["finished"]),
                float(data["seconds"]),
                None if findings is None else findings_of(findings),
            )
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def write(self, experiment: str, entry: Entry) -> None:
        """Say it, whole or not at all.

        Raises:
            RunFolderError: It cannot be written.
        """
        path = self._path(experiment)
        data = {
            "depends": entry.depends,
            "size": entry.size,
            "source": entry.source,
            "finished": entry.finished,
            "seconds": entry.seconds,
            "findings": None if entry.findings is None else entry.findings.plain(),
        }
        begun = path.with_suffix(".begun")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            begun.write_text(json.dumps(data, indent=1), encoding="utf-8")
            begun.replace(path)
        except OSError as error:
            raise RunFolderError(path, f"cannot be written: {error.strerror}") from error

    def missing(self, findings: Findings) -> tuple[str, ...]:
        """Names of an experiment's files that the folder lacks."""
        return findings.missing(self._out)

    def set_aside(self, runs: Sequence[str]) -> Path | None:
        """Move runs out of the way of others; nothing is deleted.

        Args:
            runs: Names of their files and folders.

        Returns:
            Where they are now; None if there were none.

        Raises:
            RunFolderError: They cannot be moved.
        """
        there = [name for name in runs if (self._out / name).exists()]
        if not there:
            return None
        number = 1
        while (aside := self._out / EARLIER / str(number)).exists():
            number += 1
        try:
            aside.mkdir(parents=True)
            for name in there:
                (self._out / name).rename(aside / name)
        except OSError as error:
            raise RunFolderError(aside, f"cannot be written: {error.strerror}") from error
        return aside

    def _path(self, experiment: str) -> Path:
        return self._out / FOLDER / f"{experiment}.json"


def differences(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """What two entries do not depend on alike, in words: the deepest keys, with their values."""
    words = []
    for key in sorted({*before, *now}):
        old, new = before.get(key), now.get(key)
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            words += [f"{key}.{word}" for word in differences(old, new)]
        elif old != new:
            words.append(f"{key} was {old}, is {new}" if _short(old, new) else f"{key} changed")
    return words


def source_digest() -> str:
    """Of the package's own code."""
    package = Path(drake_viapoint.__file__).parent
    return _digest(package, package.rglob("*.py"))


def models_digest() -> str:
    """Of all that lies with the models: arms, scenes, demonstrations, scenarios, studies."""
    models = models_path()
    own = (path for path in models.rglob("*") if path.is_file() and path.suffix not in _MADE_BY)
    return _digest(models, own)


def now_in_words() -> str:
    """The time of day [UTC], to the minute."""
    return datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")


def _digest(folder: Path, files: Iterable[Path]) -> str:
    content = hashlib.sha256()
    for path in sorted(files):
        content.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return content.hexdigest()[:16]


def _short(*values: object) -> bool:
    return all(len(str(value)) < 40 for value in values)
