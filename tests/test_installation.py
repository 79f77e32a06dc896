"""The doctor: sound where it is, and says what is not."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from drake_viapoint import cli
from drake_viapoint.errors import ModelFileError
from drake_viapoint.packages import resolve
from drake_viapoint.reproduction import installation
from drake_viapoint.reproduction.installation import (
    REFERENCE,
    Check,
    check_browser,
    check_graphviz,
    check_meshcat,
    check_models,
    check_trial,
    check_versions,
    first_trial,
    this_kind,
)
from drake_viapoint.tasks.catalogue import TASKS


@pytest.fixture
def reference(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What is stored, to be changed."""
    data: dict[str, Any] = yaml.safe_load(resolve(REFERENCE).read_text())
    monkeypatch.setattr(installation, "_reference", lambda task: data[task])
    return data


def test_what_is_needed_is_there() -> None:
    for check in (check_versions(), check_models(), check_meshcat()):
        assert check.ok, check


@pytest.mark.parametrize("task", TASKS)
def test_the_first_trials_end_where_they_should(task: str) -> None:
    check = check_trial(task)
    assert check.ok or not check.needed, check
    assert first_trial(task) == first_trial(task), "bit for bit"


def test_other_bits_are_told_from_another_end(reference: dict[str, Any]) -> None:
    upswing = reference["upswing"]
    end, digest = first_trial("upswing")
    here = this_kind()

    upswing["bits"] = [{**here, "sha256": digest}]
    assert check_trial("upswing") == Check(
        "a trial of the upswing", True, "the bits stored for " + _words(here)
    )
    upswing["bits"] = [{**here, "sha256": "0" * 64}]
    check = check_trial("upswing")
    assert (check.ok, check.needed) == (False, False)
    assert "not with the bits stored" in check.detail
    upswing["bits"] = [{**here, "machine": "another", "sha256": "0" * 64}]
    check = check_trial("upswing")
    assert check.ok
    assert f"no bits are stored for {_words(here)}" in check.detail
    for wrong in ([end[0] + 0.01, end[1]], [float("nan"), end[1]]):
        upswing["end"] = wrong
        check = check_trial("upswing")
        assert (check.ok, check.needed) == (False, True)
        assert "ends at" in check.detail


def test_bits_are_stored_for_the_versions_that_are_pinned() -> None:
    data = yaml.safe_load(resolve(REFERENCE).read_text())
    pinned = (Path(__file__).parents[1] / "constraints.txt").read_text().splitlines()
    drakes = {line.split("==")[1].split(" ")[0] for line in pinned if line.startswith("drake==")}
    for task in TASKS:
        assert {str(row["drake"]) for row in data[task]["bits"]} == drakes


def test_an_old_drake(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installation, "versions", lambda: {"drake": "1.50.0"})
    check = check_versions()
    assert not check.ok
    assert "at least 1.51" in check.detail
    monkeypatch.setattr(installation, "versions", lambda: {"drake": "1.99.0"})
    check = check_versions()
    assert check.ok
    assert "tested with Drake 1.51.1" in check.detail


def test_models_that_are_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    def gone(uri: str) -> Path:
        raise ModelFileError(uri, "no such file")

    monkeypatch.setattr(installation, "resolve", gone)
    check = check_models()
    assert not check.ok
    assert "no such file" in check.detail


def test_what_is_not_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installation.shutil, "which", lambda _: None)
    for check in (check_browser(), check_graphviz()):
        assert (check.ok, check.needed) == (False, False)


def doctor(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], *words: str
) -> tuple[int, str]:
    monkeypatch.setattr(sys, "argv", ["drake-viapoint", "doctor", *words])
    with pytest.raises(SystemExit) as left:
        cli.main()
    return int(left.value.code or 0), capfd.readouterr().out


GOOD = Check("good", True, "as it should be")
BAD = Check("bad", False, "broken")
EXTRA = Check("extra", False, "not there", needed=False)


@pytest.mark.parametrize(
    ("checks", "code", "last"),
    [
        ([GOOD, EXTRA], 0, "this installation is sound"),
        ([GOOD, BAD, EXTRA], 1, "not sound: bad"),
    ],
)
def test_the_command(
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    checks: list[Check],
    code: int,
    last: str,
) -> None:
    monkeypatch.setattr(installation, "CHECKS", [lambda check=check: check for check in checks])
    left, said = doctor(monkeypatch, capfd)
    assert left == code
    lines = said.splitlines()
    assert lines[0] == "ok   good: as it should be"
    assert lines[-2] == "-    extra: not there"
    assert lines[-1] == last
    left, said = doctor(monkeypatch, capfd, "--json")
    assert left == code
    told = json.loads(said)
    assert told["sound"] == (code == 0)
    assert [check["name"] for check in told["checks"]] == [check.name for check in checks]


def _words(kind: dict[str, str]) -> str:
    return ", ".join(f"{what} {value}" for what, value in kind.items())
