"""No link of the project's texts leads nowhere, and every command line in them is one there is."""

from __future__ import annotations

import shlex
from pathlib import Path
from urllib.parse import unquote, urlsplit

import click
import pytest
from markdown_pages import ROOT, anchors, commands, links, texts

from drake_viapoint.cli import cli

PAGES = texts()


def broken_link(page: str, url: str) -> str | None:
    """What is wrong with a link of a page, or None."""
    parts = urlsplit(url)
    if parts.scheme:
        whole = parts.scheme == "https" and "." in parts.netloc and " " not in url
        return None if whole else "is not a whole https address"
    target = (ROOT / page).parent / unquote(parts.path) if parts.path else ROOT / page
    if parts.netloc or not target.resolve().is_relative_to(ROOT):
        return "leaves the repository"
    if not target.exists():
        return "leads to no file"
    if parts.fragment:
        there = PAGES.get(target.resolve().relative_to(ROOT).as_posix())
        if there is None or parts.fragment not in anchors(there):
            return "leads to no heading"
    return None


def broken_command(line: str) -> str | None:
    """What is wrong with a command line, or None."""
    reader = shlex.shlex(line, posix=True, punctuation_chars=True)
    reader.whitespace_split = True
    words = list(reader)[1:]
    ends = [number for number, word in enumerate(words) if set(word) <= set("();<>|&")]
    words = words[: ends[0]] if ends else words
    command: click.Command = cli
    while isinstance(command, click.Group) and words and not words[0].startswith("-"):
        found = command.get_command(click.Context(command), words[0])
        if found is None:
            return f"there is no command {words[0]}"
        command, words = found, words[1:]
    try:
        _, left, _ = command.make_parser(click.Context(command)).parse_args(words)
    except click.UsageError as error:
        return error.format_message()
    return f"does not take {' '.join(left)}" if left else None


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str) -> None:
    wrong = {url: broken_link(page, url) for url in links(PAGES[page])}
    assert {url: fault for url, fault in wrong.items() if fault} == {}


@pytest.mark.parametrize("page", PAGES)
def test_command_lines_are_those_there_are(page: str) -> None:
    wrong = {line: broken_command(line) for line in commands(PAGES[page], "drake-viapoint")}
    assert {line: fault for line, fault in wrong.items() if fault} == {}


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("[x](docs/nowhere.md)", "leads to no file"),
        ("![x](docs/nowhere.png)", "leads to no file"),
        ("[x][1]\n\n[1]: nowhere.md", "leads to no file"),
        ("[x](docs/contact.md#nowhere)", "leads to no heading"),
        ("[x](#nowhere)", "leads to no heading"),
        ("[x](../elsewhere.md)", "leaves the repository"),
        ("[x](http://drake.mit.edu)", "is not a whole https address"),
        ("| a |\n|---|\n| [x](https://drake) |", "is not a whole https address"),
    ],
)
def test_a_broken_link_is_seen(text: str, fault: str) -> None:
    (url,) = links(text)
    assert broken_link("README.md", url) == fault


def test_sound_links_are_passed() -> None:
    for url in ("docs/contact.md#what-touches", "#limits", "docs/serve.png", "https://a.org/b"):
        assert broken_link("README.md", url) is None


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("`drake-viapoint lern serve`", "no command lern"),
        ("```\ndrake-viapoint learn tennis --out a\n```", "no command tennis"),
        ("```\ndrake-viapoint learn serve --inn a\n```", "--inn"),
        ("run `drake-viapoint replay a b --html c`", "does not take b"),
        ("`drake-viapoint learn serve --out`", "--out"),
    ],
)
def test_a_broken_command_line_is_seen(text: str, fault: str) -> None:
    (line,) = commands(text, "drake-viapoint")
    assert fault in (broken_command(line) or "")


def test_headings_are_found_by_githubs_rule() -> None:
    text = "# What `x` is: λ_J\n\n## Twice\n\n## Twice\n\n## A - b\n\n```\n# no heading\n```"
    assert anchors(text) == {"what-x-is-λ_j", "twice", "twice-1", "a---b"}


def test_every_text_is_looked_at() -> None:
    found = {Path(page).name for page in PAGES}
    assert {"README.md", "contact.md", "learning.md", "01_serve.ipynb"} <= found
