"""The run folder: whatever cuts a run short, the trials on record stay, and nobody else's do."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_viapoint.errors import RunFolderError
from drake_viapoint.runs.run_folder import SCENARIO, TRIALS, RunFolder, read_trials, write_run


class Killed(BaseException):
    """Stands for the end of the process."""


def trial(number: int, **values: Any) -> dict[str, Any]:
    return {
        "trial": number,
        "purpose": "learning",
        "subtask": "reach",
        "outcome": "landed",
        "success": False,
        "d": 0.1,
        "via_points": {"times": [0.0, 1.0], "values": [[0.0], [1.0]]},
        "seed": 7,
        **values,
    }


def a_run(path: Path, trials: int = 3) -> list[dict[str, Any]]:
    records = [trial(number) for number in range(1, trials + 1)]
    with RunFolder.create(path, "task: toy\n") as folder:
        for record in records:
            folder.append(record)
    return records


def test_what_is_appended_is_read_back(tmp_path: Path) -> None:
    records = a_run(tmp_path / "a" / "run")
    assert read_trials(tmp_path / "a" / "run") == records
    with RunFolder.open(tmp_path / "a" / "run") as folder:
        assert folder.trials == tuple(records)
        assert folder.scenario_file.read_text().startswith("task: toy\n#")
        folder.append(trial(4))
    assert [r["trial"] for r in read_trials(tmp_path / "a" / "run")] == [1, 2, 3, 4]
    assert {path.name for path in (tmp_path / "a" / "run").iterdir()} == {SCENARIO, TRIALS}


def test_every_trial_is_on_the_disk_when_append_returns(tmp_path: Path) -> None:
    with RunFolder.create(tmp_path / "run", "") as folder:
        for number in (1, 2):
            folder.append(trial(number))
            assert len(read_trials(tmp_path / "run")) == number


def test_lines_are_json_even_for_numbers_json_has_not(tmp_path: Path) -> None:
    with RunFolder.create(tmp_path / "run", "") as folder:
        read_back = folder.append(trial(1, d=float("nan"), T=[1.0, float("inf")]))
        assert read_back == folder.trials[0]
    (line,) = (tmp_path / "run" / TRIALS).read_text().splitlines()

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    assert json.loads(line, parse_constant=refuse) == read_back
    assert read_back["d"] is None
    assert read_back["T"] == [1.0, None]


@pytest.mark.parametrize("missing_newline", [False, True])
def test_cut_at_every_byte_of_the_last_line(tmp_path: Path, missing_newline: bool) -> None:
    records = a_run(tmp_path / "run")
    file = tmp_path / "run" / TRIALS
    whole = file.read_bytes()
    last = whole[:-1].rindex(b"\n") + 1
    for length in range(last, len(whole)):
        file.write_bytes(whole[:length] + (b"" if missing_newline or length == last else b"\n"))
        complete = length == len(whole) - 1 and not missing_newline
        assert read_trials(tmp_path / "run") == records[: 3 if complete else 2]
        with RunFolder.open(tmp_path / "run") as folder:
            assert len(folder.trials) == (3 if complete else 2)
            if not complete:
                folder.append(trial(3))
        assert file.read_bytes() == whole


@given(cut=st.integers(0, 3 * 170), junk=st.binary(max_size=8))
def test_any_cut_anywhere_leaves_the_lines_before_it(
    tmp_path_factory: pytest.TempPathFactory, cut: int, junk: bytes
) -> None:
    """A kill truncates, a bad sector leaves junk behind the cut; junk with a newline is damage."""
    path = tmp_path_factory.mktemp("cut") / "run"
    records = a_run(path)
    file = path / TRIALS
    whole = file.read_bytes()
    kept = whole[: min(cut, len(whole))]
    file.write_bytes(kept + junk.replace(b"\n", b""))
    intact = kept.count(b"\n")
    assert read_trials(path) == records[:intact]
    with RunFolder.open(path) as folder:
        for number in range(intact + 1, 4):
            folder.append(trial(number))
    assert file.read_bytes() == whole


@given(
    number=st.integers(1, 2),
    line=st.one_of(
        st.binary(max_size=30).filter(lambda b: b"\n" not in b),
        st.sampled_from([b"{}", b"[]", b"null", b'{"trial": 1}', json.dumps(trial(9)).encode()]),
    ),
)
def test_a_damaged_earlier_line_is_refused_and_named(
    tmp_path_factory: pytest.TempPathFactory, number: int, line: bytes
) -> None:
    path = tmp_path_factory.mktemp("damaged") / "run"
    a_run(path)
    lines = (path / TRIALS).read_bytes().split(b"\n")
    lines[number - 1] = line
    damaged = b"\n".join(lines)
    (path / TRIALS).write_bytes(damaged)
    for reading in (read_trials, RunFolder.open):
        with pytest.raises(RunFolderError, match=f"line {number} is damaged") as caught:
            reading(path)
        assert caught.value.path == path
    assert (path / TRIALS).read_bytes() == damaged, "nothing is lost by looking"


def test_a_folder_with_something_in_it_is_refused_and_left_alone(tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    before = (tmp_path / "run" / TRIALS).read_bytes()
    with pytest.raises(RunFolderError, match="--resume or name another"):
        RunFolder.create(tmp_path / "run", "task: other\n")
    assert (tmp_path / "run" / TRIALS).read_bytes() == before
    assert (tmp_path / "run" / SCENARIO).read_text().startswith("task: toy\n")

    (tmp_path / "mine").mkdir()
    for name in ("thesis.txt", SCENARIO, TRIALS):
        (tmp_path / "mine" / name).write_text("mine")
        with pytest.raises(RunFolderError, match="is not empty"):
            RunFolder.create(tmp_path / "mine", "")
        assert [p.read_text() for p in (tmp_path / "mine").iterdir()] == ["mine"]
        (tmp_path / "mine" / name).unlink()


@pytest.mark.parametrize("missing", [SCENARIO, TRIALS])
def test_a_folder_without_a_run_is_not_opened(tmp_path: Path, missing: str) -> None:
    a_run(tmp_path / "run")
    (tmp_path / "run" / missing).unlink()
    with pytest.raises(RunFolderError, match=f"no {missing}"):
        RunFolder.open(tmp_path / "run")


@given(at=st.integers(0, 90), byte=st.integers(0, 255))
def test_a_changed_scenario_is_refused(
    tmp_path_factory: pytest.TempPathFactory, at: int, byte: int
) -> None:
    path = tmp_path_factory.mktemp("changed") / "run"
    RunFolder.create(path, "task: toy\n").close()
    before = (path / SCENARIO).read_bytes()
    after = before[:at] + bytes([byte]) + before[at + 1 :]
    (path / SCENARIO).write_bytes(after)
    if after == before:
        RunFolder.open(path).close()
        return
    with pytest.raises(RunFolderError, match="not what this run began with"):
        RunFolder.open(path)


@pytest.mark.parametrize("below_a_file", ["run", "deeper/run"])
def test_a_place_that_cannot_be_written(tmp_path: Path, below_a_file: str) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RunFolderError, match="cannot be written: Not a directory"):
        RunFolder.create(tmp_path / "file" / below_a_file, "")


def test_one_process_at_a_time(tmp_path: Path) -> None:
    program = (
        "import sys; from pathlib import Path; from drake_viapoint.errors import ViapointError\n"
        "from drake_viapoint.runs.run_folder import RunFolder\n"
        "try: RunFolder.open(Path(sys.argv[1]))\n"
        "except ViapointError as error: sys.exit(str(error))"
    )

    def other_process() -> str:
        return subprocess.run(
            [sys.executable, "-c", program, str(tmp_path / "run")],
            check=False,
            capture_output=True,
            text=True,
        ).stderr

    with RunFolder.create(tmp_path / "run", "") as folder:
        assert "another process is writing to this run" in other_process()
        with pytest.raises(RunFolderError, match="another process"):
            RunFolder.open(tmp_path / "run")
        folder.append(trial(1))
    assert other_process() == ""


def failing(call: Callable[..., Any], at: int, error: BaseException) -> Callable[..., Any]:
    """The call, but its ``at``-th time (from 1) raises."""
    count = 0

    def called(*args: Any, **kwargs: Any) -> Any:
        nonlocal count
        count += 1
        if count == at:
            raise error
        return call(*args, **kwargs)

    return called


@pytest.mark.parametrize("at", [1, 2])
def test_a_beginning_cut_short_is_begun_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, at: int
) -> None:
    """At 1 the scenario is written under its first name, at 2 it has its own."""
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", failing(os.fsync, at, Killed()))
        with pytest.raises(Killed):
            RunFolder.create(tmp_path / "run", "task: first\n")
    if at == 2:
        assert RunFolder.open(tmp_path / "run").trials == ()
        return
    with pytest.raises(RunFolderError, match="holds no run"):
        RunFolder.open(tmp_path / "run")
    with RunFolder.create(tmp_path / "run", "task: second\n") as folder:
        folder.append(trial(1))
    assert (tmp_path / "run" / SCENARIO).read_text().startswith("task: second\n")


def test_a_disk_that_fills_up_takes_nothing_with_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    full = OSError(errno.ENOSPC, "No space left on device")
    with RunFolder.create(tmp_path / "run", "") as folder:
        folder.append(trial(1))
        before = (tmp_path / "run" / TRIALS).read_bytes()
        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", failing(os.fsync, 1, full))
            with pytest.raises(RunFolderError, match="No space left on device; the 1 trials"):
                folder.append(trial(2))
        assert (tmp_path / "run" / TRIALS).read_bytes() == before
        assert len(folder.trials) == 1
        folder.append(trial(2))  # space was made
    assert [r["trial"] for r in read_trials(tmp_path / "run")] == [1, 2]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_disk_that_is_full_from_the_start(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / ".scenario.yaml").symlink_to("/dev/full")
    with pytest.raises(RunFolderError, match="No space left on device"):
        RunFolder.create(tmp_path / "run", "task: toy\n")


def test_a_run_written_in_one_go_is_the_same_run(tmp_path: Path) -> None:
    records = a_run(tmp_path / "appended")
    write_run(tmp_path / "new" / "whole", "task: toy\n", records)
    a_run(tmp_path / "part", trials=1)
    (tmp_path / ".part").mkdir()  # cut short before
    write_run(tmp_path / "part", "task: toy\n", records)
    for path in (tmp_path / "new" / "whole", tmp_path / "part"):
        assert {entry.name for entry in path.parent.iterdir()} <= {
            "whole",
            "part",
            "appended",
            "new",
        }
        for name in (SCENARIO, TRIALS):
            assert (path / name).read_bytes() == (tmp_path / "appended" / name).read_bytes()
        with RunFolder.open(path) as folder:
            folder.append(trial(4))
    (tmp_path / "file").write_text("")
    with pytest.raises(RunFolderError, match="cannot be written"):
        write_run(tmp_path / "file" / "run", "", records)
