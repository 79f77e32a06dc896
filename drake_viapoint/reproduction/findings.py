"""What an experiment brought: pictures, recordings, and its numbers beside the paper's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any


class Verdict(StrEnum):
    """How a number of ours stands to the paper's."""

    MATCHES = "matches"
    DIFFERS = "differs"
    NOT_COMPARABLE = "cannot be compared"


def judged(same: bool) -> Verdict:
    """The verdict on two numbers that can be compared."""
    return Verdict.MATCHES if same else Verdict.DIFFERS


@dataclass(frozen=True)
class Picture:
    """A picture of an experiment.

    Attributes:
        file: Its name in the folder of results.
        title: "Our Fig. 3", or what it shows where the paper has no such figure.
        caption: What the paper's caption says, in our words.
        alt: What is to be seen, for whoever cannot see it.
    """

    file: str
    title: str
    caption: str
    alt: str


@dataclass(frozen=True)
class Recording:
    """A trial that plays in a browser.

    Attributes:
        file: Its name in the folder of results.
        caption: Which trial it is, and what comes of it.
    """

    file: str
    caption: str


@dataclass(frozen=True)
class Comparison:
    """A quantity that the paper states, beside ours.

    Attributes:
        quantity: What is counted or measured.
        where: Section, figure or equation of the paper.
        paper: What the paper says.
        ours: What came of the runs.
        verdict: How the two stand to each other.
        why: Why they differ or cannot be compared; what the match rests on.
    """

    quantity: str
    where: str
    paper: str
    ours: str
    verdict: Verdict
    why: str = ""


@dataclass(frozen=True)
class Findings:
    """All that an experiment brought.

    Attributes:
        lines: What was found, in words.
        where: Where it is, in words; of the command line, not of the page that lies beside it.
        pictures: In the order of the page.
        recordings: In the order of the page.
        comparisons: In the order of the paper.
        tables: Names of the tables written.
        seeds: Of the runs, in words.
    """

    lines: tuple[str, ...]
    where: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = ()
    recordings: tuple[Recording, ...] = ()
    comparisons: tuple[Comparison, ...] = ()
    tables: tuple[str, ...] = ()
    seeds: str = ""

    @property
    def files(self) -> tuple[str, ...]:
        """Names of all files that belong to it."""
        pictures = [picture.file for picture in self.pictures]
        return (*pictures, *(recording.file for recording in self.recordings), *self.tables)

    def missing(self, out: Path) -> tuple[str, ...]:
        """Names of those of its files that a folder lacks."""
        return tuple(name for name in self.files if not (out / name).is_file())

    def plain(self) -> dict[str, Any]:
        """As plain data, ready for JSON."""
        return asdict(self)


def findings_of(data: Mapping[str, Any]) -> Findings:
    """Findings of plain data.

    Raises:
        KeyError, TypeError, ValueError: They are of another form.
    """
    return Findings(
        lines=tuple(map(str, data["lines"])),
        where=tuple(map(str, data["where"])),
        pictures=tuple(Picture(**part) for part in data["pictures"]),
        recordings=tuple(Recording(**part) for part in data["recordings"]),
        comparisons=tuple(
            Comparison(**{**part, "verdict": Verdict(part["verdict"])})
            for part in data["comparisons"]
        ),
        tables=tuple(map(str, data["tables"])),
        seeds=str(data["seeds"]),
    )
