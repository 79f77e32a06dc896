"""What is done again and what is not: experiments, their ledger, and the page, without a trial."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from progress_bars import Bars

from drake_viapoint.cli.reproduce import EXPERIMENTS as TYPED
from drake_viapoint.errors import RunFolderError, ViapointError
from drake_viapoint.packages import resolve
from drake_viapoint.reproduction import conditions, ledger, reproduce, robot
from drake_viapoint.reproduction.captions import PICTURES
from drake_viapoint.reproduction.experiments import BY_NAME, EXPERIMENTS, Experiment
from drake_viapoint.reproduction.findings import Comparison, Findings, Verdict, findings_of
from drake_viapoint.reproduction.ledger import Entry, Ledger, differences, source_digest
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.runs.study_file import read_study

ROW = Comparison("first trial", "3.3.2", "fails", "<fails> & swings", Verdict.MATCHES, "why not")


class Counted:
    """An experiment that only counts how often it is made."""

    def __init__(self) -> None:
        self.made: list[int] = []
        self.depends: dict[str, Any] = {"scenario": {"seed": 0}, "versions": {"drake": "1.51.1"}}

    def make(self, out: Path, size: int, progress: Progress) -> Findings:
        with progress("counting", size) as bar:
            bar.update(size)
        (out / "runs").mkdir(parents=True, exist_ok=True)
        with (out / "runs" / "trials.jsonl").open("a") as file:
            file.write(f"{size}\n")
        (out / "table.csv").write_text("size\n")
        self.made.append(size)
        return Findings(
            (f"{size} made",), ("it is there",), comparisons=(ROW,), tables=("table.csv",)
        )

    def experiment(self) -> Experiment:
        return Experiment(
            "upswing", "Counting", "3.3", "It counts.", self.make, lambda: self.depends, ("runs",),
            "things", 2, 5,
        )  # fmt: skip


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Counted:
    counted = Counted()
    monkeypatch.setattr(reproduce, "BY_NAME", {"upswing": counted.experiment()})
    return counted


def made(out: Path, size: int = 2) -> tuple[list[str], reproduce.Reproduced]:
    """What is said by a call, and what came of it."""
    said: list[str] = []
    (done,) = reproduce.reproduce(out, {"upswing": size}, Bars(), said.append)
    return said, done


def test_a_second_call_does_nothing_and_says_so(tmp_path: Path, counted: Counted) -> None:
    said, first = made(tmp_path)
    assert not first.unchanged
    assert said[0] == "upswing (1 of 1, about a minute left): 2 things"
    assert said[1:] == ["  2 made", "  it is there"]
    said, second = made(tmp_path)
    assert second.unchanged
    assert second.findings == first.findings
    assert counted.made == [2]
    assert "nothing has changed, so it is not done again" in said[0]


def test_another_scenario_is_done_again_and_nothing_is_lost(
    tmp_path: Path, counted: Counted
) -> None:
    made(tmp_path)
    for number, (key, value) in enumerate([("seed", 1), ("seed", 2)], start=1):
        counted.depends = {**counted.depends, "scenario": {key: value}}
        said, done = made(tmp_path)
        assert not done.unchanged
        assert f"done again, as scenario.seed was {value - 1}, is {value}" in said[0]
        assert (tmp_path / "earlier" / str(number) / "runs" / "trials.jsonl").read_text() == "2\n"
    assert (tmp_path / "runs" / "trials.jsonl").read_text() == "2\n", "begun anew"


def test_another_version_is_done_again(tmp_path: Path, counted: Counted) -> None:
    made(tmp_path)
    counted.depends = {**counted.depends, "versions": {"drake": "1.58.0"}}
    said, _ = made(tmp_path)
    assert "as versions.drake was 1.51.1, is 1.58.0" in said[0]
    assert counted.made == [2, 2]


def test_other_models_are_done_again(
    tmp_path: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch
) -> None:
    models = tmp_path / "models"
    models.mkdir()
    (models / "arm.urdf").write_text("heavy")
    monkeypatch.setattr(ledger, "models_path", lambda: models)
    made(tmp_path / "out")
    (models / "make_arm.py").write_text("what makes a model is none")
    assert made(tmp_path / "out")[1].unchanged
    (models / "arm.urdf").write_text("light")
    said, done = made(tmp_path / "out")
    assert not done.unchanged
    assert "done again, as models was" in said[0]
    assert counted.made == [2, 2]
    assert (tmp_path / "out" / "earlier" / "1" / "runs").is_dir()


def test_a_larger_study_goes_on_and_stays(tmp_path: Path, counted: Counted) -> None:
    made(tmp_path)
    said, _ = made(tmp_path, 5)
    assert "5 things, of which 2 are there" in said[0]
    said, done = made(tmp_path, 2)
    assert done.unchanged
    assert "(5 things, more than asked for)" in said[0]
    assert counted.made == [2, 5]
    assert (tmp_path / "runs" / "trials.jsonl").read_text() == "2\n5\n", "runs are kept"


def test_time_left_is_of_what_is_left(tmp_path: Path, counted: Counted) -> None:
    slow = replace(counted.experiment(), seconds=(0.0, 600.0))
    plan = reproduce._plan(Ledger(tmp_path), slow, 5, "")
    assert plan.duration == 3000.0
    made(tmp_path)
    digest = source_digest()
    assert reproduce._plan(Ledger(tmp_path), slow, 5, digest).duration == 1800.0, "two are there"
    assert reproduce._plan(Ledger(tmp_path), slow, 2, digest).duration == 0.0
    assert reproduce._plan(Ledger(tmp_path), slow, 2, "other").duration == 0.0, "drawn anew"
    assert reproduce._Clock(3000.0).left() == ", about 50 min left"


def test_a_picture_that_is_gone_or_other_code_draws_anew(
    tmp_path: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch
) -> None:
    made(tmp_path)
    (tmp_path / "table.csv").unlink()
    said, _ = made(tmp_path)
    assert "drawn anew, as table.csv is gone; its runs are kept" in said[0]
    monkeypatch.setattr(reproduce, "source_digest", lambda: "other")
    said, _ = made(tmp_path)
    assert "drawn anew, as the package's code has changed" in said[0]
    assert counted.made == [2, 2, 2]
    assert not (tmp_path / "earlier").exists()


def test_an_interrupted_experiment_goes_on(
    tmp_path: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(out: Path, size: int, progress: Progress) -> Findings:
        counted.make(out, size, progress)
        raise KeyboardInterrupt

    stopped = replace(counted.experiment(), make=interrupted)
    with monkeypatch.context() as patch:
        patch.setattr(reproduce, "BY_NAME", {"upswing": stopped})
        with pytest.raises(KeyboardInterrupt):
            made(tmp_path)
    said, done = made(tmp_path)
    assert "going on" in said[0]
    assert not done.unchanged
    counted.depends = {**counted.depends, "scenario": {"seed": 1}}
    assert "earlier" in made(tmp_path)[0][1], "what was only begun is set aside, too"


def test_the_page_is_there_before_all_is_made(
    tmp_path: Path, counted: Counted, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> Findings:
        raise KeyboardInterrupt

    later = replace(counted.experiment(), name="robot", make=interrupted, runs=("robot",))
    both = {"upswing": counted.experiment(), "robot": later}
    monkeypatch.setattr(reproduce, "BY_NAME", both)
    with pytest.raises(KeyboardInterrupt):
        reproduce.reproduce(tmp_path, {"upswing": 2, "robot": 2}, Bars())
    assert "2 made" in (tmp_path / "index.html").read_text(encoding="utf-8")


@pytest.mark.usefixtures("counted")
def test_a_damaged_ledger_is_made_anew(tmp_path: Path) -> None:
    made(tmp_path)
    path = tmp_path / "reproduced" / "upswing.json"
    for damage in ("", "{", "[]", '{"depends": {}}', '{"depends": 3, "findings": null}'):
        path.write_text(damage)
        assert Ledger(tmp_path).read("upswing") is None
        assert not made(tmp_path)[1].unchanged
        assert made(tmp_path)[1].unchanged


def test_a_folder_that_cannot_be_written(tmp_path: Path, counted: Counted) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ViapointError, match="cannot be written"):
        made(tmp_path / "file")
    assert counted.made == []


def test_nothing_to_set_aside(tmp_path: Path) -> None:
    assert Ledger(tmp_path).set_aside(["runs"]) is None
    assert list(tmp_path.iterdir()) == []


def test_runs_that_cannot_be_set_aside(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    (tmp_path / "earlier").write_text("")
    with pytest.raises(RunFolderError, match="earlier"):
        Ledger(tmp_path).set_aside(["runs"])
    assert (tmp_path / "runs").is_dir()


@pytest.mark.parametrize(
    ("before", "now", "words"),
    [
        ({"a": 1}, {"a": 1}, []),
        ({"a": 1}, {"a": 2}, ["a was 1, is 2"]),
        ({"a": {"b": 1, "c": 2}}, {"a": {"b": 1, "c": 3}}, ["a.c was 2, is 3"]),
        ({}, {"a": 1}, ["a was None, is 1"]),
        ({"a": "x" * 50}, {"a": "y"}, ["a changed"]),
    ],
)
def test_what_differs_is_named(
    before: Mapping[str, Any], now: Mapping[str, Any], words: list[str]
) -> None:
    assert differences(before, now) == words


def test_findings_survive_json(tmp_path: Path) -> None:
    findings = Findings(
        ("a line",), ("there",), tuple(PICTURES.values())[:2], (), (ROW,), ("t.csv",), "0"
    )
    assert findings_of(json.loads(json.dumps(findings.plain()))) == findings
    entry = Entry({"a": 1}, 3, "digest", "now", 1.5, findings)
    Ledger(tmp_path).write("serve", entry)
    assert Ledger(tmp_path).read("serve") == entry


# --------------------------------------------------------------------------- the experiments


def test_the_command_line_knows_every_experiment() -> None:
    assert TYPED == tuple(experiment.name for experiment in EXPERIMENTS) == tuple(BY_NAME)


def test_sizes_are_those_of_the_shipped_studies() -> None:
    for name, study in (
        ("robot", robot.STUDY),
        ("conditions", conditions.STUDY),
        ("conditions-small", conditions.SMALL_STUDY),
    ):
        whole = read_study(resolve(study))
        assert BY_NAME[name].full * len(whole.conditions) == len(whole)
    for experiment in EXPERIMENTS:
        assert 1 <= experiment.reduced <= experiment.full
        assert bool(experiment.unit) == (experiment.full > 1)


def test_the_manual_knows_their_sizes() -> None:
    page = (Path(__file__).parents[1] / "docs" / "results.md").read_text(encoding="utf-8")
    for experiment in EXPERIMENTS:
        (row,) = [line for line in page.splitlines() if line.startswith(f"| `{experiment.name}` |")]
        _, _, section, _, sizes, _ = row.split("|")
        assert section.strip() == experiment.section
        if experiment.unit:
            assert sizes.split()[:2] == [f"{experiment.reduced},", str(experiment.full)]


def test_what_experiments_depend_on_is_plain_and_names_the_versions() -> None:
    for experiment in EXPERIMENTS:
        depends = json.loads(json.dumps(experiment.depends()))
        assert depends["versions"]["drake"], experiment.name
        assert depends == json.loads(json.dumps(experiment.depends())), experiment.name


def test_no_two_experiments_share_runs() -> None:
    names = [name for experiment in EXPERIMENTS for name in experiment.runs]
    assert len(names) == len(set(names))


def test_every_caption_names_its_file_and_says_what_is_seen() -> None:
    for file, picture in PICTURES.items():
        assert picture.file == file
        assert len(picture.alt) > 40
        assert picture.caption
        assert picture.alt != picture.caption


def test_the_source_has_one_digest() -> None:
    assert source_digest() == source_digest()
