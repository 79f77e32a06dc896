"""Markdown texts of the project, taken apart for the tests that look at them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import mistune

ROOT = Path(__file__).resolve().parents[1]

_parse = mistune.create_markdown(renderer=None, plugins=["table"])


class Fence(NamedTuple):
    """A block of code: the words after its fence, and its lines."""

    info: str
    code: str


def texts() -> dict[str, str]:
    """Every page and every notebook's Markdown, by its path in the repository."""
    tops = [ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")]
    pages = {path: path.read_text() for path in [*tops, *(ROOT / "docs").rglob("*.md")]}
    for path in (ROOT / "notebooks").glob("*.ipynb"):
        cells = json.loads(path.read_text())["cells"]
        prose = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown"]
        pages[path] = "\n\n".join(prose)
    return {path.relative_to(ROOT).as_posix(): text for path, text in sorted(pages.items())}


def tokens(text: str) -> Iterator[dict[str, Any]]:
    """Every token of a text, those within others too."""
    waiting: list[Any] = list(_parse(text))
    while waiting:
        token = waiting.pop(0)
        yield token
        waiting = [*token.get("children", []), *waiting]


def fences(text: str) -> list[Fence]:
    """Blocks of code, in their order."""
    blocks = (token for token in tokens(text) if token["type"] == "block_code")
    return [Fence(token.get("attrs", {}).get("info", ""), token["raw"]) for token in blocks]


def links(text: str) -> list[str]:
    """Where links and images lead."""
    return [t["attrs"]["url"] for t in tokens(text) if t["type"] in {"link", "image"}]


def anchors(text: str) -> set[str]:
    """What a link may point at within a text: its headings, by GitHub's rule."""
    found: set[str] = set()
    for heading in (token for token in tokens(text) if token["type"] == "heading"):
        words = "".join(t.get("raw", "") for t in _within(heading))
        slug = re.sub(r"[^\w\- ]", "", words.strip().lower()).replace(" ", "-")
        number = sum(name == slug or name.startswith(f"{slug}-") for name in found)
        found.add(f"{slug}-{number}" if slug in found else slug)
    return found


def commands(text: str, program: str) -> list[str]:
    """Lines of code and stretches of it within a sentence that run a program."""
    code = []
    for token in tokens(text):
        if token["type"] == "codespan":
            code.append(" ".join(token["raw"].split()))
        elif token["type"] == "block_code":
            code += [line.strip() for line in token["raw"].splitlines()]
    return [line for line in code if re.match(rf"(\.venv/bin/)?{program}\s", line)]


def _within(token: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for child in token.get("children", []):
        yield child
        yield from _within(child)
