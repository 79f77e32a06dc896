"""Results of a study, one JSON line a piece of work, so that what is done is never done again.

The first line says which study it is. A line cut short by a kill is dropped when the file is
opened again, and its piece of work done again.
"""

from __future__ import annotations

import fcntl
import json
import os
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from drake_viapoint.errors import FolderHeldError, RunFolderError


class StudyLog:
    """An open file of results, held by one process at a time; a context manager.

    Args:
        path: The file, made if it is not there.
        study: What the results depend on, as plain data.

    Attributes:
        path: The file.
        rows: Results so far.

    Raises:
        RunFolderError: The file holds another study's results, another process holds it, or it
            cannot be read or written.
    """

    def __init__(self, path: Path, study: dict[str, Any]) -> None:
        self.path = path
        self.rows: list[dict[str, Any]] = []
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: IO[bytes] = path.open("a+b")
        except OSError as error:
            raise RunFolderError(path, f"cannot be written: {error.strerror}") from error
        try:
            self._go_on(study)
        except OSError as error:
            self._file.close()
            raise RunFolderError(path, f"cannot be written: {error.strerror}") from error
        except BaseException:
            self._file.close()
            raise

    def append(self, row: dict[str, Any]) -> None:
        """Put a result on the disk.

        Raises:
            RunFolderError: It could not be written.
        """
        self.rows.append(row)  # first, as Ctrl-C may come once it is on the disk
        try:
            self._write(row)
        except OSError as error:
            self.rows.pop()
            raise RunFolderError(self.path, f"cannot be written: {error.strerror}") from error

    def __enter__(self) -> StudyLog:
        """Nothing more to do: the file is open."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Close the file."""
        self._file.close()

    def _go_on(self, study: dict[str, Any]) -> None:
        """Take in what the file holds, once nobody else writes to it."""
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise FolderHeldError(self.path, "another process is writing to this study") from error
        self._file.seek(0)
        content = self._file.read()
        whole = self._read(content.split(b"\n")[:-1], study)
        if len(content) > whole:
            self._file.truncate(whole)
        if not whole:
            self._write({"study": study})

    def _read(self, lines: list[bytes], study: dict[str, Any]) -> int:
        """Take in whole lines; returns how many bytes they take."""
        length = 0
        for number, line in enumerate(lines, start=1):
            try:
                row = json.loads(line)
            except ValueError as error:
                if number == len(lines):
                    break
                raise RunFolderError(self.path, f"line {number} is damaged") from error
            if number > 1:
                self.rows.append(row)
            elif row != {"study": json.loads(json.dumps(study))}:
                raise RunFolderError(
                    self.path, "holds results of another study or version; name another folder"
                )
            length += len(line) + 1
        return length

    def _write(self, row: dict[str, Any]) -> None:
        self._file.write(json.dumps(row, allow_nan=False).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())
