"""A run as a folder: its scenario, and a line for every trial that nothing can take back.

``scenario.yaml`` says everything the run depends on, and ends with a digest, so that trials of two
scenarios never end up in one run. ``trials.jsonl`` has one JSON object a trial, on the disk before
the next trial starts. A line cut short by a kill or a full disk is dropped when the folder is
opened again, and its trial done again.
"""

from __future__ import annotations

import fcntl
import hashlib
import io
import json
import os
import shutil
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Any, Literal

from drake_viapoint.errors import FolderHeldError, RunFolderError
from drake_viapoint.runs.trial_lines import TRIALS as TRIALS
from drake_viapoint.runs.trial_lines import trial_line, whole_lines

SCENARIO = "scenario.yaml"

_BEGINNING = ".scenario.yaml"  # becomes the scenario once it is whole
_SEAL = "# sha256 of the lines above: "


class RunFolder:
    """An open run folder, held by one process at a time; a context manager.

    Attributes:
        path: The folder.
        scenario_file: Its scenario.
    """

    def __init__(self, path: Path, file: io.FileIO) -> None:
        self.path = path
        self.scenario_file = path / SCENARIO
        self._file = file
        self._trials, length = whole_lines(path, file.readall())
        if file.tell() > length:
            file.truncate(length)
            file.seek(length)

    @classmethod
    def create(cls, path: Path, scenario: str) -> RunFolder:
        """Make the folder of a new run.

        The scenario comes last and whole: a folder that has one holds a run, and what a creation
        cut short leaves behind is no obstacle to the next.

        Args:
            path: A folder that does not exist or is empty.
            scenario: Text of its ``scenario.yaml``.

        Raises:
            RunFolderError: The folder holds something already or cannot be written.
        """
        try:
            path.mkdir(parents=True, exist_ok=True)
            _check_free(path)
            file = _locked(path, "a+b")
            try:
                _check_free(path)  # now that nobody else can begin a run here
                _write(path / _BEGINNING, _sealed(scenario))
                (path / _BEGINNING).replace(path / SCENARIO)
                _sync_folder(path)
            except BaseException:
                file.close()
                raise
        except OSError as error:
            raise RunFolderError(path, f"cannot be written: {error.strerror}") from error
        return cls(path, file)

    @classmethod
    def open(cls, path: Path) -> RunFolder:
        """Open the folder of a run to go on with it.

        Raises:
            RunFolderError: It holds no run, or a damaged one.
        """
        for name in (SCENARIO, TRIALS):
            if not (path / name).is_file():
                raise RunFolderError(path, f"holds no run: there is no {name}")
        try:
            _check_seal(path)
            file = _locked(path, "r+b")
        except OSError as error:
            raise RunFolderError(path, f"cannot be gone on with: {error.strerror}") from error
        try:
            return cls(path, file)
        except BaseException:
            file.close()
            raise

    @property
    def trials(self) -> tuple[dict[str, Any], ...]:
        """Records of the trials so far."""
        return tuple(self._trials)

    def append(self, record: dict[str, Any]) -> dict[str, Any]:
        """Put a trial's record on the disk.

        Returns:
            The record as it will be read back: a number that is not finite is None, as JSON has
            no such numbers.

        Raises:
            RunFolderError: It could not be written; the records before it are intact.
        """
        line = trial_line(record)
        end = self._file.tell()
        try:
            rest = memoryview(line)
            while rest:
                rest = rest[self._file.write(rest) :]
            os.fsync(self._file.fileno())
        except OSError as error:
            self._file.truncate(end)
            self._file.seek(end)
            raise RunFolderError(
                self.path,
                f"trial {record.get('trial')} could not be written: {error.strerror}; the "
                f"{len(self._trials)} trials before it are intact, --resume goes on from there",
            ) from error
        read_back: dict[str, Any] = json.loads(line)
        self._trials.append(read_back)
        return read_back

    def __enter__(self) -> RunFolder:
        """Nothing more to do: the folder is open."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Let go of the folder."""
        self.close()

    def close(self) -> None:
        """Let go of the folder; another process may go on with the run."""
        self._file.close()


def read_trials(path: Path) -> list[dict[str, Any]]:
    """Records of a run's trials, without changing or holding the folder.

    Raises:
        RunFolderError: It holds no run, or a damaged one.
    """
    if not (path / TRIALS).is_file():
        raise RunFolderError(path, f"holds no run: there is no {TRIALS}")
    try:
        content = (path / TRIALS).read_bytes()
    except OSError as error:
        raise RunFolderError(path, f"{TRIALS}: {error.strerror}") from error
    return whole_lines(path, content)[0]


def write_run(path: Path, scenario: str, trials: Iterable[dict[str, Any]]) -> None:
    """Write the folder of a run that was made elsewhere: whole, or not at all.

    Args:
        path: The folder; what it held of the same run gives way.
        scenario: Text of its ``scenario.yaml``.
        trials: Records of its trials.

    Raises:
        RunFolderError: It cannot be written.
    """
    begun = path.with_name(f".{path.name}")
    try:
        shutil.rmtree(begun, ignore_errors=True)
        begun.mkdir(parents=True)
        _write(begun / SCENARIO, _sealed(scenario))
        _write(begun / TRIALS, b"".join(map(trial_line, trials)))
        _sync_folder(begun)
        if path.exists():
            shutil.rmtree(path)
        begun.replace(path)
        _sync_folder(path.parent)
    except OSError as error:
        raise RunFolderError(path, f"cannot be written: {error.strerror}") from error


def _write(path: Path, content: bytes) -> None:
    with path.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _sealed(scenario: str) -> bytes:
    return (scenario + _SEAL + _digest(scenario.encode()) + "\n").encode()


def _check_seal(path: Path) -> None:
    scenario, _, digest = (path / SCENARIO).read_bytes().rpartition(_SEAL.encode())
    if digest.strip() != _digest(scenario).encode():
        raise RunFolderError(
            path,
            f"{SCENARIO} is not what this run began with; give the changed one a folder of its own",
        )


def _digest(scenario: bytes) -> str:
    return hashlib.sha256(scenario).hexdigest()


def _check_free(path: Path) -> None:
    if (path / SCENARIO).exists() and (path / TRIALS).exists():
        raise RunFolderError(path, "holds a run already; go on with --resume or name another")
    left = {entry.name for entry in path.iterdir()} - {_BEGINNING}
    if left - {TRIALS} or (left and (path / TRIALS).stat().st_size > 0):
        raise RunFolderError(path, "is not empty; name another folder")


def _locked(path: Path, mode: Literal["r+b", "a+b"]) -> io.FileIO:
    """The file of the trials, ours alone; unbuffered, so that nothing is written late."""
    file = (path / TRIALS).open(mode, buffering=0)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        file.close()
        raise FolderHeldError(path, "another process is writing to this run") from error
    except BaseException:
        file.close()
        raise
    return file


def _sync_folder(path: Path) -> None:
    """Put the names of the files on the disk, too."""
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
