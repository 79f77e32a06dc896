"""The stage of a notebook: live where a person looks on, a recording where nobody does."""

from __future__ import annotations

import base64
import html
import re
import subprocess
import sys
import time
import urllib.request
from typing import Any

import numpy as np
import pytest
from pydrake.geometry import Meshcat, Sphere
from touching import touch

from drake_viapoint.motion.via_points import ViaPoints
from drake_viapoint.reproduction import stage as staged
from drake_viapoint.reproduction.arm_page import draw_arm_task
from drake_viapoint.reproduction.serve_page import draw_serve
from drake_viapoint.reproduction.stage import Stage, somebody_looks_on
from drake_viapoint.tasks.trial import RefusedTrial

POINTS = ViaPoints(np.array([0.0, 1.0]), np.zeros((2, 1)), ("x",))
REFUSED = RefusedTrial("via-point 1 is out of reach", ("T",))


def draw(meshcat: Meshcat, of: str, trial: str, via_points: ViaPoints) -> float:
    """Something small under a name of its own."""
    assert via_points is POINTS
    meshcat.SetObject(f"marks/{of}{trial}", Sphere(0.1))
    return 0.25


@pytest.mark.parametrize(
    ("environment", "looks_on"),
    [
        ({}, False),
        ({"JPY_PARENT_PID": "1"}, False),  # every kernel has it
        ({"JPY_SESSION_NAME": "notebooks/01_serve.ipynb"}, True),
        ({"VSCODE_PID": "1"}, True),
        ({"JPY_SESSION_NAME": "x.ipynb", "CI": "true"}, False),
        ({"JPY_SESSION_NAME": "x.ipynb", "JUPYTERHUB_API_URL": "http://hub"}, False),
        ({"VSCODE_PID": "1", "SSH_CONNECTION": "1 2 3 4"}, False),
    ],
)
def test_who_looks_on(environment: dict[str, str], looks_on: bool) -> None:
    assert somebody_looks_on(environment) is looks_on


def test_it_finds_out_by_itself_unless_told(monkeypatch: pytest.MonkeyPatch) -> None:
    for looks_on in (False, True):
        monkeypatch.setattr(staged, "somebody_looks_on", lambda looks_on=looks_on: looks_on)
        assert Stage(draw, "x").live is looks_on
        assert Stage(draw, "x", live=not looks_on).live is not looks_on


def contents(displayed: str) -> bytes:
    """What an embedded page shows, as Meshcat packs it."""
    (page,) = re.findall('<iframe srcdoc="([^"]*)"', displayed)
    packed = re.findall(r"base64,([A-Za-z0-9+/=]+)", html.unescape(page))
    return b"".join(map(base64.b64decode, packed))


# ------------------------------------------------------------------------------- nobody looks on


def test_without_anybody_the_last_trial_is_embedded() -> None:
    stage = Stage(draw, "trial", live=False)
    assert "No trial" in stage._repr_html_()
    assert stage.show("1", POINTS) is stage
    stage.show("2", POINTS).show(REFUSED, POINTS, wait=True)
    shown = contents(stage._repr_html_())
    assert b"marks/trial2" in shown
    assert b"marks/trial1" not in shown
    assert "localhost" not in stage._repr_html_().split("srcdoc")[0]


def test_nothing_is_drawn_until_it_is_displayed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(staged, "page_of", lambda _: pytest.fail("drawn"))
    stage = Stage(lambda *_: pytest.fail("drawn"), "x", live=False)
    for _ in range(1000):
        stage.show("1", POINTS, wait=True)


def test_a_trial_of_an_arm_is_drawn_with_paths_and_marks() -> None:
    task = touch()
    task.marks = {"target": task.place}
    trial = task.execute(task.via_points, 0)
    shown = contents(
        Stage(draw_arm_task, task, live=False).show(trial, task.via_points)._repr_html_()
    )
    for part in (b"paths/asked", b"paths/done", b"via_points/5", b"marks/target", b"set_animation"):
        assert part in shown
    assert b"pointer" in shown


def test_what_is_shown_moves_as_the_arm_did(monkeypatch: pytest.MonkeyPatch) -> None:
    task = touch()
    trial = task.execute(task.via_points, 0)
    seen: list[Any] = []

    def looked_at(_meshcat: Meshcat, diagram: Any, times: Any, pose: Any) -> float:
        context = diagram.CreateDefaultContext()
        plant = diagram.GetSubsystemByName("plant")
        tip = plant.GetFrameByName("tip")
        for number, moment in enumerate(times):
            pose(context, number)
            own = plant.GetMyContextFromRoot(context)
            seen.append((moment, tip.CalcPoseInWorld(own).translation()))
        return float(times[-1])

    monkeypatch.setattr("drake_viapoint.reproduction.arm_page.play", looked_at)
    duration = draw_arm_task(staged.new_page(), task, trial, task.via_points)
    assert trial.motion.end < duration == seen[-1][0]
    for moment, place in seen:
        modelled = trial.motion.tool(task.scene.arm, [min(moment, trial.motion.end)])[0]
        np.testing.assert_allclose(place, modelled.position, atol=1e-12)


# ------------------------------------------------------------------------------- a person does


def test_live_it_is_meshcats_own_page() -> None:
    stage = Stage(draw, "trial", live=True, height=300)
    displayed = stage._repr_html_()
    (url,) = re.findall('<iframe src="([^"]*)"', displayed)
    assert "srcdoc" not in displayed
    assert 'height="300"' in displayed
    with urllib.request.urlopen(url, timeout=10) as page:
        assert b"meshcat" in page.read().lower()


def test_live_one_trial_takes_the_place_of_the_other() -> None:
    task = touch()
    stage = Stage(draw_arm_task, task, live=True)
    meshcat = stage._meshcat
    assert meshcat is not None
    shown = []
    for change in (0.0, 0.05):
        moved = task.via_points.moved(["z3"], [change])
        stage.show(task.execute(moved, 0), moved)
        shown.append(contents(f'<iframe srcdoc="{html.escape(meshcat.StaticHtml())}"'))
    stage.show(REFUSED, POINTS)
    assert stage._meshcat is meshcat, "the page that is open stays"
    for page in shown:
        assert page.count(b"set_animation") == 1
        assert page.count(b"paths/done") == shown[0].count(b"paths/done")
    assert shown[0] != shown[1]
    assert abs(len(shown[0]) - len(shown[1])) < 0.01 * len(shown[0]), "nothing piles up"


def test_live_it_waits_only_for_who_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    slept: list[float] = []
    monkeypatch.setattr(time, "sleep", slept.append)
    stage = Stage(draw, "trial", live=True)
    stage.show("1", POINTS, wait=True)
    assert slept == [], "nobody has the page open"

    class Watched:
        def SetObject(self, *_: object) -> None: ...
        def GetNumActiveConnections(self) -> int:
            return 1

    monkeypatch.setattr(stage, "_meshcat", Watched())
    stage.show("1", POINTS)
    assert slept == []
    stage.show("1", POINTS, wait=True)
    assert slept == [0.25]


def test_live_the_view_stays_as_somebody_has_turned_it(monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[Any] = []

    class Watched(Meshcat):
        def SetCameraPose(self, camera: Any, target: Any) -> None:
            looked.append((camera, target))

    monkeypatch.setattr(staged, "new_page", lambda: Watched())
    task = touch()
    trial = task.execute(task.via_points, 0)
    stage = Stage(draw_arm_task, task, live=True)
    for _ in range(3):
        stage.show(trial, task.via_points)
    assert len(looked) == 1


def test_live_a_serve_after_the_other(serve_task: Any) -> None:
    trial = serve_task.execute(serve_task.via_points, 0)
    stage = Stage(draw_serve, serve_task.scenario, live=True)
    for _ in range(2):
        stage.show(trial, serve_task.via_points)
    assert stage._meshcat is not None
    for path in ("paths/ball", "via_points/8", "visualizer/arm"):
        assert stage._meshcat.HasPath(path)


@pytest.mark.parametrize("live", [False, True])
def test_nothing_is_left_for_another_thread_to_end(live: bool) -> None:
    """Drake stops the process when a Meshcat ends in another thread than it began in."""
    program = (
        "import gc, sys, threading\n"
        "gc.disable()\n"
        "sys.path.insert(0, 'tests')\n"
        "from touching import touch\n"
        "from drake_viapoint.reproduction.arm_page import draw_arm_task\n"
        "from drake_viapoint.reproduction.stage import Stage\n"
        "task = touch()\n"
        f"stage = Stage(draw_arm_task, task, live={live})\n"
        "trial = task.execute(task.via_points, 0)\n"
        "stage.show(trial, task.via_points).show(trial, task.via_points)\n"
        "stage._repr_html_()\n"
        "del stage\n"
        "collector = threading.Thread(target=gc.collect)\n"
        "collector.start()\n"
        "collector.join()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        check=False,
        capture_output=True,
        text=True,
        cwd=staged.__file__.rsplit("/", 3)[0],
    )
    assert done.returncode == 0, done.stderr
