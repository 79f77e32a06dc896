"""Completion in a shell: the script names this program, and the shell gets words from it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = Path(sys.executable).parent / "drake-viapoint"


def output(*words: str, **environment: str) -> str:
    return subprocess.run(
        [COMMAND, *words], capture_output=True, text=True, env={**os.environ, **environment},
        check=True,
    ).stdout  # fmt: skip


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_script_for_every_shell(shell: str) -> None:
    script = output("completion", shell)
    assert "drake-viapoint" in script
    assert f"_DRAKE_VIAPOINT_COMPLETE={shell}_complete" in script


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_the_script_is_bash() -> None:
    subprocess.run(["bash", "-n"], input=output("completion", "bash"), text=True, check=True)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("drake-viapoint re", {"replay", "reproduce"}),
        ("drake-viapoint learn ", {"serve", "upswing"}),
        ("drake-viapoint learn serve --jac", {"--jacobian"}),
        ("drake-viapoint reproduce --only upswing", {"upswing", "upswing-persons"}),
    ],
)
def test_words_are_completed(line: str, expected: set[str]) -> None:
    last = len(line.split()) - (not line.endswith(" "))
    said = output(_DRAKE_VIAPOINT_COMPLETE="bash_complete", COMP_WORDS=line, COMP_CWORD=str(last))
    assert {word.split(",")[1] for word in said.split()} == expected
