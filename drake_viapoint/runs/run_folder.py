"""A run as a folder: its scenario, and a line for every trial that nothing can take back.

``scenario.yaml`` says everything the run depends on; ``trials.jsonl`` has one JSON object a trial,
on the disk before the next trial starts. A line cut short by a kill or a full disk is dropped when
the folder is opened again, and its trial done again.
"""

from __future__ import annotations

import fcntl
import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any

from drake_viapoint.errors import RunFolderError

SCENARIO = "scenario.yaml"
TRIALS = "trials.jsonl"


class RunFolder:
    """An open run folder, held by one process at a time; a context manager.

    Attributes:
        path: The folder.
        scenario_file: Its scenario.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.scenario_file = path / SCENARIO
        try:
            self._file = (path / TRIALS).open("r+b")
        except OSError as error:
            raise RunFolderError(path, f"{error.strerror}: {TRIALS}") from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self._file.close()
            raise RunFolderError(path, "another process is writing to this run") from error
        try:
            self._trials, length = _whole_lines(path, self._file.read())
            self._file.truncate(length)
            self._file.seek(length)
        except BaseException:
            self._file.close()
            raise

    @classmethod
    def create(cls, path: Path, scenario: str) -> RunFolder:
        """Make the folder of a new run.

        Args:
            path: A folder that does not exist or is empty.
            scenario: Text of its ``scenario.yaml``.

        Raises:
            RunFolderError: The folder holds something already or cannot be written.
        """
        if (path / TRIALS).exists():
            raise RunFolderError(path, "holds a run already; go on with --resume or name another")
        try:
            path.mkdir(parents=True, exist_ok=True)
            if any(path.iterdir()):
                raise RunFolderError(path, "is not empty; name another folder")
            # the trials come last: a folder that has them has its scenario whole
            _write(path / SCENARIO, scenario)
            _write(path / TRIALS, "")
        except OSError as error:
            raise RunFolderError(path, f"cannot be written: {error.strerror}") from error
        return cls(path)

    @classmethod
    def open(cls, path: Path) -> RunFolder:
        """Open the folder of a run to go on with it.

        Raises:
            RunFolderError: It holds no run, or a damaged one.
        """
        for name in (SCENARIO, TRIALS):
            if not (path / name).is_file():
                raise RunFolderError(path, f"holds no run: there is no {name}")
        return cls(path)

    @property
    def trials(self) -> tuple[dict[str, Any], ...]:
        """Records of the trials so far."""
        return tuple(self._trials)

    def append(self, record: dict[str, Any]) -> None:
        """Put a trial's record on the disk.

        Raises:
            RunFolderError: It could not be written; the records before it are intact.
        """
        line = json.dumps(record, allow_nan=False).encode() + b"\n"
        end = self._file.tell()
        try:
            self._file.write(line)
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            self._take_back(end)
            raise RunFolderError(
                self.path,
                f"trial {record.get('trial')} could not be written: {error.strerror}; "
                f"the {len(self._trials)} trials before it are intact",
            ) from error
        self._trials.append(record)

    def _take_back(self, end: int) -> None:
        """Cut off a line that is only partly written, past the buffer that still holds it."""
        os.ftruncate(self._file.fileno(), end)
        raw = self._file.detach()
        raw.close()

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
        try:
            self._file.close()
        except ValueError:  # detached after a failed write: closed already
            return


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
    return _whole_lines(path, content)[0]


def _whole_lines(path: Path, content: bytes) -> tuple[list[dict[str, Any]], int]:
    """Records of the undamaged lines, and the number of bytes they take."""
    lines = content.split(b"\n")
    records: list[dict[str, Any]] = []
    length = 0
    for number, line in enumerate(lines, start=1):
        rest_is_empty = number >= len(lines) - 1 and not any(lines[number:])
        try:
            record = json.loads(line)
            whole = isinstance(record, dict) and record.get("trial") == number
        except ValueError:
            whole = False
        if whole and number < len(lines):  # a line without its newline was cut short
            records.append(record)
            length += len(line) + 1
        elif rest_is_empty:
            break
        else:
            raise RunFolderError(
                path, f"{TRIALS}, line {number} is damaged, and lines after it are not"
            )
    return records, length


def _write(path: Path, text: str) -> None:
    with path.open("x", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
