"""Recordings: which trial is shown, that a page needs nothing else, and where its bodies are."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray
from pydrake.geometry import Meshcat, MeshcatParams
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, Diagram

from drake_viapoint.cli.commands import cli
from drake_viapoint.errors import RunFolderError
from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction import upswing_page
from drake_viapoint.reproduction.page import FRAME, frame_times, play
from drake_viapoint.reproduction.recording import PAGES, record_trial
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.run_folder import TRIALS, read_trials
from drake_viapoint.runs.task_run import begin
from drake_viapoint.tasks.catalogue import TASKS, build_task, task_scenario
from drake_viapoint.tasks.upswing import UpswingTask
from drake_viapoint.tasks.upswing_trial import UpswingTrial

CHANGES: dict[str, dict[str, object]] = {
    "serve": {},
    "recurrence": {"execution": "recurrence"},
    "kinematic": {"execution": "plant", "hand": "kinematic"},
    "tracked": {"execution": "plant", "hand": "tracked"},
}
"""Of the shipped scenarios: the serve's, and the upswing's executions."""
DRAWN = {
    "serve": (b"paths/ball", b"paths/racket", b"via_points/8"),
    "upswing": (b"paths/tip", b"paths/hand", b"via_points/8", b"goal/rod"),
}
PENDULUM_MOVED = b"\xba/drake/visualizer/pendulum"
"""Moves the pendulum away from the arm: a name of 26 letters, as Meshcat packs it."""


@pytest.fixture(scope="module")
def tasks() -> dict[str, Any]:
    """A task of each kind."""
    return {
        kind: build_task(task_scenario("serve" if kind == "serve" else "upswing", changes=changes))
        for kind, changes in CHANGES.items()
    }


@pytest.fixture(scope="module")
def runs(tasks: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A run of two trials of each kind; tests leave them as they are."""
    paths = {kind: tmp_path_factory.mktemp(kind) / "run" for kind in CHANGES}
    for kind, path in paths.items():
        task = tasks[kind]
        with begin(path, task.scenario) as folder:
            learn(task, folder, seed=0, max_trials=2)
    return paths


def spoiled(run: Path, copy: Path, spoil: Callable[[dict[str, Any]], None]) -> Path:
    """A run whose second trial is another one."""
    shutil.copytree(run, copy)
    first, second = read_trials(run)
    spoil(second)
    (copy / TRIALS).write_text("".join(json.dumps(line) + "\n" for line in (first, second)))
    return copy


# ------------------------------------------------------------------------------------ one file


class Page(HTMLParser):
    """Addresses a browser would fetch, and the scripts a page brings itself."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.scripts = 0
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.scripts += tag == "script" and "src" not in given
        address = given.get("src") or (given.get("href") if tag == "link" else None)
        if address and not address.startswith("data:"):
            self.fetched.append(address)


def contents(page: str) -> bytes:
    """What a page shows, as Meshcat packs it."""
    return b"".join(map(base64.b64decode, re.findall(r"base64,([A-Za-z0-9+/=]+)", page)))


@pytest.mark.parametrize("kind", CHANGES)
def test_a_recording_is_one_file_that_needs_no_other(
    runs: dict[str, Path], kind: str, tmp_path: Path
) -> None:
    before = (runs[kind] / TRIALS).read_bytes()
    assert record_trial(runs[kind], 1, tmp_path / "x.html") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["x.html"]
    text = (tmp_path / "x.html").read_text()
    page = Page(text)
    assert page.scripts > 0
    assert page.fetched == []
    assert not re.search(r"@import|url\(\s*['\"]?https?:", text)
    assert (runs[kind] / TRIALS).read_bytes() == before
    for part in (*DRAWN["serve" if kind == "serve" else "upswing"], b"set_animation"):
        assert part in contents(text)
    assert PENDULUM_MOVED not in contents(text)


# ----------------------------------------------------------------------------- trials to show


def test_every_task_can_be_recorded() -> None:
    assert PAGES.keys() == TASKS.keys()


@pytest.mark.parametrize("number", [0, 3])
@pytest.mark.parametrize("kind", ["serve", "recurrence"])
def test_a_trial_that_was_not_made(
    runs: dict[str, Path], kind: str, tmp_path: Path, number: int
) -> None:
    with pytest.raises(RunFolderError, match=f"trials 1 to 2, not {number}"):
        record_trial(runs[kind], number, tmp_path / "x.html")


@pytest.mark.parametrize("task", TASKS)
def test_a_run_without_trials(task: str, tmp_path: Path) -> None:
    begin(tmp_path / "run", task_scenario(task)).close()
    with pytest.raises(RunFolderError, match="holds no trial yet"):
        record_trial(tmp_path / "run", None, tmp_path / "x.html")


def test_an_upswing_that_the_arm_refused(runs: dict[str, Path], tmp_path: Path) -> None:
    def too_far(record: dict[str, Any]) -> None:
        record["via_points"]["values"][3][0] = 0.8

    run = spoiled(runs["kinematic"], tmp_path / "run", too_far)
    with pytest.raises(RunFolderError, match=r"trial 2 was not executed: via-point 4 .* 0\.800"):
        record_trial(run, 2, tmp_path / "x.html")
    assert not (tmp_path / "x.html").exists()


def test_a_trial_that_gave_no_numbers(runs: dict[str, Path], tmp_path: Path) -> None:
    def failed(record: dict[str, Any]) -> None:
        record.update(outcome="failed", success=False, reason="T is not finite", T=None)

    run = spoiled(runs["recurrence"], tmp_path / "run", failed)
    with pytest.raises(RunFolderError, match="trial 2 failed: T is not finite"):
        record_trial(run, 2, tmp_path / "x.html")


def test_replay_shows_the_last_trial_by_default(runs: dict[str, Path], tmp_path: Path) -> None:
    run, page = runs["recurrence"], tmp_path / "x.html"
    said = CliRunner().invoke(cli, ["replay", str(run), "--html", str(page)])
    assert (said.exit_code, said.output) == (0, f"trial 2 of {run} is in {page}\n")
    assert page.read_text().lstrip().lower().startswith("<!doctype html")


# ------------------------------------------------------------------------- where the bodies are


@pytest.mark.parametrize("duration", [0.5, 1.3, 113 / 60])
def test_pictures_are_at_exact_times_and_show_the_end(duration: float) -> None:
    times = frame_times(duration)
    assert times[0] == 0.0
    np.testing.assert_array_equal(times / FRAME, np.arange(times.size))
    assert times[-2] < duration <= times[-1]


class Seen(NamedTuple):
    """Of an upswing's page, picture by picture."""

    page: str
    times: NDArray[np.float64]  # (n,) [s]
    axle: NDArray[np.float64]  # (n, 3) in the arm's hand [m]
    hinge: NDArray[np.float64]  # (n, 3) [m]
    tip: NDArray[np.float64]  # (n, 3) [m]


def seen(
    monkeypatch: pytest.MonkeyPatch, task: UpswingTask, trial: UpswingTrial, via_points: ViaPoints
) -> Seen:
    """What an upswing's page would show."""
    shifts: list[tuple[str, float | None, NDArray[np.float64]]] = []
    pictures: list[tuple[Any, ...]] = []

    class Watched(Meshcat):
        def SetTransform(
            self, path: str, pose: RigidTransform, time_in_recording: float | None = None
        ) -> None:
            shifts.append((path, time_in_recording, pose.translation()))
            super().SetTransform(path, pose, time_in_recording)

    def looked_at(
        meshcat: Meshcat,
        diagram: Diagram,
        times: NDArray[np.float64],
        pose: Callable[[Context, int], None],
    ) -> float:
        plant = diagram.GetSubsystemByName("plant")
        pendulum = plant.GetBodyByName("pendulum").body_frame()
        context = diagram.CreateDefaultContext()
        own = plant.GetMyMutableContextFromRoot(context)
        tip = np.array([0, 0, task.scenario.pendulum.length])
        for number, time in enumerate(times):
            shifts.clear()
            pose(context, number)
            shift = np.zeros(3)
            for path, at, by in shifts:
                assert (path, at) == ("visualizer/pendulum", time)
                shift = by
            place = pendulum.CalcPoseInWorld(own)
            axle = plant.GetFrameByName("axle").CalcPoseInWorld(own).translation()
            pictures.append((time, axle, place.translation() + shift, place @ tip + shift))
        return play(meshcat, diagram, times, pose)

    monkeypatch.setattr(upswing_page, "play", looked_at)
    meshcat = Watched(MeshcatParams(host="localhost"))
    duration = upswing_page.draw_upswing(meshcat, task.scenario, trial, via_points)
    assert duration == pictures[-1][0]
    return Seen(meshcat.StaticHtml(), *map(np.array, zip(*pictures, strict=True)))


@pytest.mark.parametrize(
    ("kind", "near"), [("recurrence", 1e-7), ("kinematic", 1e-7), ("tracked", 4e-3)]
)
def test_arm_and_pendulum_are_where_they_were(
    monkeypatch: pytest.MonkeyPatch, tasks: dict[str, Any], kind: str, near: float
) -> None:
    """At the times that pictures and motion share, and to the end of the page."""
    task = tasks[kind]
    start, length = np.array(task.scenario.robot.line), task.scenario.pendulum.length
    trial = task.execute(task.via_points, seed=0)
    motion = trial.motion
    pictures = seen(monkeypatch, task, trial, task.via_points)
    np.testing.assert_array_equal(pictures.axle, pictures.hinge)
    assert pictures.times[-1] >= motion.times[-1] + 0.5
    for sample in (*range(0, motion.times.size, 15), -1):
        same = np.abs(pictures.times - motion.times[sample]) < 1e-9
        if sample == -1:
            same = pictures.times >= motion.times[-1]
        assert same.any()
        hinge = start + [motion.hand[sample], 0, 0]
        x, height = motion.tip(length)[sample]
        tip = start + [x, 0, height]
        np.testing.assert_allclose(pictures.hinge[same] - hinge, 0, atol=near)
        np.testing.assert_allclose(pictures.tip[same] - tip, 0, atol=near)
    if trial.carried is not None:  # the arm strays from the line, and is seen to
        moving = pictures.times <= motion.times[-1]
        strayed = np.linalg.norm(pictures.axle[moving, 1:] - start[1:], axis=1)
        assert 1e-4 < strayed.max() < 1.1 * trial.carried.hand_error


def test_a_hand_out_of_reach_leaves_the_arm_behind(
    monkeypatch: pytest.MonkeyPatch, tasks: dict[str, Any]
) -> None:
    """The recurrence knows no arm: the pendulum goes where it went, the arm as far as it can."""
    task = tasks["recurrence"]
    far = task.via_points.moved(["x4"], [0.75])
    trial = task.execute(far, seed=0)
    hand = trial.motion.hand
    assert hand.max() > 0.6
    pictures = seen(monkeypatch, task, trial, far)
    assert PENDULUM_MOVED in contents(pictures.page)
    np.testing.assert_allclose(pictures.hinge[:, 0].max(), hand.max(), atol=0.01)
    assert pictures.axle[:, 0].max() == pytest.approx(0.5, abs=0.01)
    np.testing.assert_allclose(pictures.hinge[:, 1:], pictures.axle[:, 1:], atol=1e-7)
    within = pictures.hinge[:, 0] < 0.45
    assert 0 < within.sum() < within.size
    np.testing.assert_array_equal(pictures.hinge[within], pictures.axle[within])
    rod = np.linalg.norm(pictures.tip - pictures.hinge, axis=1)
    np.testing.assert_allclose(rod, task.scenario.pendulum.length, atol=1e-9)


def test_a_recording_leaves_nothing_that_another_thread_could_stumble_over(
    runs: dict[str, Path], tmp_path: Path
) -> None:
    """Drake stops the process when a Meshcat ends in another thread than it began in."""
    program = (
        "import gc, sys, threading\n"
        "from pathlib import Path\n"
        "gc.disable()\n"
        "from drake_viapoint.reproduction.recording import record_trial\n"
        "record_trial(Path(sys.argv[1]), 1, Path(sys.argv[2]))\n"
        "collector = threading.Thread(target=gc.collect)\n"
        "collector.start()\n"
        "collector.join()\n"
    )
    page = tmp_path / "page.html"
    done = subprocess.run(
        [sys.executable, "-c", program, runs["recurrence"], page],
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert page.stat().st_size > 1e6
