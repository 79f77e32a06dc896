"""What a person sees: figures, recordings, the study of persons, and the one command for them."""

from __future__ import annotations

import csv
import io
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from progress_bars import Bars

from drake_viapoint.errors import RunFolderError, UnreachableError, ViapointError
from drake_viapoint.motion.extraction import extract_via_points
from drake_viapoint.reproduction import (
    figure2,
    figure3,
    figure4,
    figure5,
    figure6,
    figure7,
    figure8,
    persons,
)
from drake_viapoint.reproduction.findings import Verdict
from drake_viapoint.reproduction.persons import PersonResult
from drake_viapoint.reproduction.serve_reproduction import reproduce_serve
from drake_viapoint.reproduction.shown_trials import shown_trials
from drake_viapoint.reproduction.style import POSE_LABELS, save
from drake_viapoint.reproduction.table import write_table
from drake_viapoint.runs.run_folder import TRIALS, read_trials
from drake_viapoint.tasks.serve import ServeTask
from drake_viapoint.tasks.serve_trial import ServeTrial


def lines(*kinds: str) -> list[dict[str, Any]]:
    """Records of ``"learning throw"`` and the like, numbered."""
    return [
        {"trial": number, "purpose": kind.split()[0], "subtask": kind.split()[1]}
        for number, kind in enumerate(kinds, start=1)
    ]


def drawn(figure: Figure) -> bytes:
    """The figure as a picture; a warning of matplotlib's is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        picture = io.BytesIO()
        figure.savefig(picture, dpi=40)
    return picture.getvalue()


def words(figure: Figure) -> str:
    """Everything the figure says."""
    return " ".join(
        text.get_text() for text in figure.findobj(match=lambda a: hasattr(a, "get_text"))
    )


# ---------------------------------------------------------------------------- which trials to show


def test_the_first_the_first_hit_and_the_last_are_shown() -> None:
    records = lines(
        "learning throw", "exploration throw", "learning throw", "exploration strike",
        "learning strike", "learning strike", "repeat strike", "repeat strike",
    )  # fmt: skip
    assert list(shown_trials(records).values()) == [[1], [3], [6, 7, 8]]
    assert list(shown_trials(records)) == [
        "first trial", "trial 3: subtask 1 done", "trials 6 to 8: the end",
    ]  # fmt: skip


def test_a_run_without_repeats_shows_its_last_trial() -> None:
    assert list(shown_trials(lines("learning throw", "exploration throw")).values())[2] == [2]
    assert list(shown_trials(lines("learning throw")).values()) == [[1], [1], [1]]


# -------------------------------------------------------------------------------------- figures


@pytest.fixture(scope="module")
def two_trials(serve_task: ServeTask) -> list[dict[str, Any]]:
    """The first trial, and one that the arm cannot make: it has no distances."""
    points = serve_task.via_points
    away = points.moved(["x3", "y3"], [3.0, 3.0])
    records = []
    for number, via_points in enumerate((points, away), start=1):
        trial = serve_task.execute(via_points, seed=0)
        head = {"trial": number, "purpose": "learning", "subtask": "throw"}
        records.append({**head, **trial.record()})
    assert records[1]["d"] is None
    return records


@pytest.fixture(scope="module")
def figures(
    serve_task: ServeTask, two_trials: list[dict[str, Any]]
) -> dict[str, Callable[[], Figure]]:
    watched = serve_task.watched
    times, values = watched.pose.times, watched.pose.values
    trial = serve_task.execute(serve_task.via_points, seed=0)
    assert isinstance(trial, ServeTrial)
    return {
        "2": lambda: figure2.draw(watched),
        "3": lambda: figure3.draw(times, values, watched.extraction),
        "4": lambda: figure4.draw(
            times, values, watched.extraction, POSE_LABELS, title="title", hit_time=0.9
        ),
        "5": lambda: figure5.draw(serve_task),
        "6": lambda: figure6.draw(serve_task, {"first": [trial], "refused": []}),
        "7": lambda: figure7.draw(two_trials, 0.05, 0.125),
        "8": lambda: figure8.draw(serve_task, trial),
    }


@pytest.mark.parametrize("number", list("2345678"))
def test_figures_draw_without_a_warning(
    figures: dict[str, Callable[[], Figure]], number: str
) -> None:
    assert drawn(figures[number]()).startswith(b"\x89PNG")


def test_a_synthetic_demonstration_is_called_so(
    figures: dict[str, Callable[[], Figure]],
) -> None:
    assert "synthetic" in words(figures["2"]())


def test_figure_3_for_very_few_via_points() -> None:
    times = np.linspace(0.0, 1.0, 30)
    for number in (3, 4):
        found = extract_via_points(times, np.sin(5 * times)[:, None], ["x"], number=number)
        assert drawn(figure3.draw(times, np.sin(5 * times)[:, None], found))


def test_figure_5_shows_what_supplemental_via_points_are_for(serve_task: ServeTask) -> None:
    figure = figure5.draw(serve_task)
    alone, complete = (figure.axes[index].lines[0].get_ydata() for index in (4, 5))
    assert np.max(complete) < 2.0 < np.max(alone), "distance from the desired path [mm]"


def test_figure_7_shows_every_trial_once(two_trials: list[dict[str, Any]]) -> None:
    kinds = [(p, s) for p in ("exploration", "learning") for s in ("throw", "strike")]
    kinds.append(("repeat", "strike"))
    records = [
        {**two_trials[0], "trial": number, "purpose": purpose, "subtask": subtask}
        for number, (purpose, subtask) in enumerate(kinds, start=1)
    ]
    below = figure7.draw(records, 0.05, 0.125).axes[1]
    marked = sorted(float(x) for line in below.lines for x in np.atleast_1d(line.get_xdata()))
    assert marked == [1.0, 2.0, 3.0, 4.0, 5.0]


def test_figure_7_shows_what_happened_and_what_was_seen(two_trials: list[dict[str, Any]]) -> None:
    happened = {**two_trials[0], "d": 0.03, "landing_error": 0.4}
    records = [{**two_trials[0], "d": 0.02, "landing_error": 0.1, "happened": happened}]
    figure = figure7.draw(records, 0.05, 0.125, runs=[records, two_trials])
    curve, _, *below = figure.axes
    shown = {str(line.get_label()): list(line.get_ydata()) for line in curve.lines}
    assert shown["ball to racket centre, $d$"] == [0.03]
    assert shown["$d$, as seen by the cameras"] == [0.02]
    assert shown["$|T_{Gd} - T_G|$, as seen by the cameras"] == [0.1]
    assert [len(panel.lines) for panel in below] == [3, 3], "two runs and a bar"
    assert drawn(figure)


def test_a_picture_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file" / "x.png", tmp_path / "x.docx"):
        with pytest.raises(ViapointError, match="cannot be written"):
            save(Figure(), path)


# -------------------------------------------------------------------------------------- persons

LEARNED = PersonResult(0, "missed", 0.2, None, 27, 32, "")
SLOW = PersonResult(1, "landed", 0.03, 0.6, 41, 46, "")
FAILED = PersonResult(2, "landed", 0.04, 0.5, None, 60, "after 60 trials: missed, d = 0.12")


def test_the_summary_counts_the_learned_and_their_trials() -> None:
    text = persons.summary([LEARNED, SLOW, FAILED])
    assert "2 of 3" in text
    assert "those by trial 34 (median), 41 (worst)" in text
    assert persons.summary([FAILED]).startswith("none of 1")


def test_the_table_explains_failures(tmp_path: Path) -> None:
    table = write_table([LEARNED, SLOW, FAILED], tmp_path / "new" / "persons.csv")
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["learned_at"] for row in rows] == ["27", "41", ""]
    assert [row["reason"] for row in rows] == ["", "", FAILED.reason]
    assert rows[0]["first_landing_error"] == ""


@pytest.mark.parametrize("results", [[LEARNED, SLOW, FAILED], [LEARNED], [FAILED]])
def test_persons_are_drawn(results: list[PersonResult]) -> None:
    figure = persons.draw(results)
    assert drawn(figure)
    assert ("not learned" in words(figure)) == (FAILED in results)


def test_a_person_not_learned_from_in_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(persons, "MAX_TRIALS", 2)
    told = []
    (result,) = persons.study_persons(tmp_path, 1, lambda: told.append(1))
    assert told == [1]
    assert (result.person, result.learned_at, result.trials) == (0, None, 2)
    assert result.reason.startswith("after 2 trials: ")
    first = read_trials(tmp_path / "person00")[0]
    assert (result.first_outcome, result.first_d) == (first["outcome"], first["d"])


def test_a_person_the_robot_cannot_follow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def unreachable(_: Any) -> ServeTask:
        raise UnreachableError("via-point 3", 0.1, 0.0, (("EB", 2.5),))

    monkeypatch.setattr(persons, "ServeTask", unreachable)
    (result,) = persons.study_persons(tmp_path, 1)
    assert result.learned_at is None
    assert result.trials == 0
    assert "via-point 3 is out of reach" in result.reason


def test_a_disk_is_no_person(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RunFolderError, match="cannot be written"):
        persons.study_persons(tmp_path / "file", 1)


# ------------------------------------------------------------------------------ the whole of it


def test_everything_into_one_folder_and_a_second_call_resumes(tmp_path: Path) -> None:
    out, bars = tmp_path / "results", Bars()
    findings = reproduce_serve(out, 1, bars)
    names = {path.name for path in out.iterdir()}
    pages = {name for name in names if name.endswith(".html")}
    assert names - pages == {
        *(f"figure{number}.png" for number in (2, 3, 4, 5, 8, 9)),
        "serve_views.png", "serve_curve.png",
        *(f"components_{name}.csv" for name in ("throw", "strike_norm", "strike_ratio")),
        "serve",
    }  # fmt: skip
    assert set(findings.files) == names - {"serve"}
    assert len(pages) == 3
    assert "serve_trial01.html" in pages
    records = read_trials(out / "serve")
    assert f"serve_trial{len(records):02d}.html" in pages
    assert not records[0]["success"], "the first trial does not succeed"
    learned = next(r["trial"] for r in records if r["purpose"] == "repeat") - 1
    assert learned <= persons.MAX_TRIALS
    assert findings.lines[0] == f"serve: learned at trial {learned}"
    drawings = bars.seen["figures and recordings"]
    assert drawings[0] == len(drawings) - 1 == 10

    rows = {row.quantity: row for row in findings.comparisons}
    assert rows["via-points, ends included"].verdict is Verdict.MATCHES
    assert rows["markers of the demonstration"].verdict is Verdict.NOT_COMPARABLE
    with (out / "components_strike_ratio.csv").open(newline="") as file:
        chosen = [row["component"] for row in csv.DictReader(file) if row["chosen"] == "True"]
    aims = rows["components that aim, by ratio"]
    same = set(chosen) == {"phi6", "phi7", "psi7"}
    assert aims.verdict is (Verdict.MATCHES if same else Verdict.DIFFERS)

    stamp = (out / "serve" / TRIALS).stat().st_mtime_ns
    assert reproduce_serve(out, 1, bars) == findings
    assert (out / "serve" / TRIALS).stat().st_mtime_ns == stamp


def test_persons_into_one_folder_and_a_second_call_does_no_trial_again(tmp_path: Path) -> None:
    out, bars = tmp_path / "results", Bars()
    findings = persons.reproduce_persons(out, 1, bars)
    assert set(findings.files) == {"persons.csv", "persons.png"}
    assert {path.name for path in out.iterdir()} == {*findings.files, "persons"}
    assert "1 of 1 virtual persons" in findings.lines[0]
    assert bars.seen["learning from virtual persons"] == [1, 1]
    stamp = (out / "persons" / "person00" / TRIALS).stat().st_mtime_ns
    assert persons.reproduce_persons(out, 1, bars) == findings
    assert (out / "persons" / "person00" / TRIALS).stat().st_mtime_ns == stamp
