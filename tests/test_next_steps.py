"""What the bare command says can be done: commands that exist, about what is there."""

from __future__ import annotations

import shlex
from pathlib import Path

import click
import pytest

from drake_viapoint.cli import cli
from drake_viapoint.cli.next_steps import next_steps


def commands(lines: list[str]) -> list[list[str]]:
    """Words of each command that is named, without what stands two blanks after it."""
    named = [line.strip() for line in lines if line.strip().startswith("drake-viapoint ")]
    return [shlex.split(line.split("  ")[0])[1:] for line in named]


def folder_with(here: Path, name: str, file: str, text: str = "") -> Path:
    folder = here / name
    folder.mkdir(parents=True)
    (folder / file).write_text(text)
    return folder


def a_run(here: Path, name: str, task: str) -> Path:
    run = folder_with(here, name, "trials.jsonl")
    (run / "scenario.yaml").write_text(f"task: {task}\nseed: 0\n")
    return run


@pytest.mark.parametrize("there", [[], ["run"], ["run", "page", "table"]])
def test_every_command_that_is_named_exists(tmp_path: Path, there: list[str]) -> None:
    if "run" in there:
        a_run(tmp_path, "runs/a first", "serve")
    if "page" in there:
        folder_with(tmp_path, "results", "index.html")
    if "table" in there:
        folder_with(tmp_path, "results/study", "table.parquet")
    named = commands(next_steps(tmp_path))
    assert named
    for words in named:
        command: click.Command = cli
        for word in words:
            if isinstance(command, click.Group) and word in command.commands:
                command = command.commands[word]
            elif word.startswith("--") and word != "--help":
                assert word in {option for p in command.params for option in p.opts}, words


def test_the_last_run_is_the_one_to_watch(tmp_path: Path) -> None:
    import os

    for number, (name, task) in enumerate([("runs/one", "serve"), ("two", "upswing")]):
        os.utime(a_run(tmp_path, name, task) / "trials.jsonl", (number, number))
    named = commands(next_steps(tmp_path))
    assert ["replay", "two", "--html", "last.html"] in named
    assert ["learn", "upswing", "--out", "two", "--resume"] in named
    assert not any(words[0] == "components" for words in named), "that is of a serve"


def test_names_are_quoted(tmp_path: Path) -> None:
    a_run(tmp_path, "my runs/it's", "serve")
    assert ["replay", "my runs/it's", "--html", "last.html"] in commands(next_steps(tmp_path))


def test_a_page_is_to_be_opened(tmp_path: Path) -> None:
    folder_with(tmp_path, "results", "index.html")
    lines = next_steps(tmp_path)
    assert any("open results/index.html in a browser" in line for line in lines)
    assert not any(words[0] == "reproduce" for words in commands(lines))
