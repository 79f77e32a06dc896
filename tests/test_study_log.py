"""Results of a study: kept line by line, whatever stops the work, and never mixed with others."""

import errno
import os
from pathlib import Path

import pytest

from drake_viapoint.errors import FolderHeldError, RunFolderError
from drake_viapoint.runs.study_log import StudyLog

STUDY = {"versions": {"drake": "1"}, "persons": [1, 2]}


def test_rows_are_there_when_the_file_is_opened_again(tmp_path: Path) -> None:
    path = tmp_path / "new" / "study.jsonl"
    with StudyLog(path, STUDY) as log:
        assert log.rows == []
        log.append({"person": 1, "error": [0.1, None]})
    with StudyLog(path, STUDY) as log:
        log.append({"person": 2})
        assert log.rows == [{"person": 1, "error": [0.1, None]}, {"person": 2}]
    assert len(path.read_bytes().splitlines()) == 3


def test_killed_at_any_byte_it_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "study.jsonl"
    rows = [{"person": 1}, {"person": 2}]
    with StudyLog(path, STUDY) as log:
        for row in rows:
            log.append(row)
    whole = path.read_bytes()
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        with StudyLog(path, STUDY) as log:
            assert log.rows == rows[: len(log.rows)]
            for row in rows[len(log.rows) :]:
                log.append(row)
        assert path.read_bytes() == whole


def test_another_studys_results_are_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "study.jsonl"
    StudyLog(path, STUDY).__exit__(None, None, None)
    before = path.read_bytes()
    with pytest.raises(RunFolderError, match=r"study.jsonl: holds results of another study"):
        StudyLog(path, {**STUDY, "persons": [1]})
    path.write_bytes(before + b"{broken\n" + b'{"person": 1}\n')
    with pytest.raises(RunFolderError, match="line 2 is damaged"):
        StudyLog(path, STUDY)


def test_a_disk_that_fills_or_a_place_that_cannot_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RunFolderError, match="cannot be written"):
        StudyLog(tmp_path / "file" / "study.jsonl", STUDY)

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with StudyLog(tmp_path / "study.jsonl", STUDY) as log:
        monkeypatch.setattr(os, "fsync", full)
        with pytest.raises(RunFolderError, match="No space left on device"):
            log.append({"person": 1})
        assert log.rows == []


def test_one_process_at_a_time(tmp_path: Path) -> None:
    path = tmp_path / "study.jsonl"
    with StudyLog(path, STUDY) as log:
        with pytest.raises(FolderHeldError, match=r"study.jsonl: another process is writing"):
            StudyLog(path, STUDY)
        log.append({"person": 1})
    with StudyLog(path, STUDY) as log:
        assert log.rows == [{"person": 1}]
