"""The command line: one clear line and exit code 2 for every bad input, and nothing lost by it."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import yaml
from small_studies import rows_in, study_file

from drake_viapoint import cli
from drake_viapoint.demonstration.c3d import write_c3d
from drake_viapoint.demonstration.impact import find_impact
from drake_viapoint.demonstration.marker_recording import MarkerRecording
from drake_viapoint.demonstration.markers import read_markers
from drake_viapoint.packages import resolve
from drake_viapoint.reproduction.experiments import BY_NAME
from drake_viapoint.reproduction.findings import Comparison, Findings, Verdict
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.runs import task_run
from drake_viapoint.runs.run_folder import SCENARIO, TRIALS, read_trials
from drake_viapoint.runs.study_table import read_table
from drake_viapoint.tasks.catalogue import ROBOT_SERVE
from drake_viapoint.tasks.pendulum import PendulumMotion, Recurrence

SERVE = resolve("package://drake_viapoint/demonstrations/serve.c3d")
SHARED = Path(__file__).parents[1].parent / "shared" / "data"
REAL_SERVE = SHARED / "tennis-serve-ktk" / "kinematics_tennis_serve.c3d"
COMMAND = Path(sys.executable).parent / "drake-viapoint"


class Answer(NamedTuple):
    code: int
    out: str
    err: str

    def refuses(self, *words: str) -> None:
        """Exit code 2, and one line on stderr that has all the words."""
        assert self.code == 2, self
        assert self.err.startswith("drake-viapoint: "), self
        assert self.err.count("\n") == 1, self
        assert self.err.endswith("\n"), self
        for word in words:
            assert word in self.err, self


@pytest.fixture
def command(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> Callable[..., Answer]:
    """The command, run in this process, from a folder of its own."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str | Path) -> Answer:
        monkeypatch.setattr(sys, "argv", ["drake-viapoint", *map(str, arguments)])
        capfd.readouterr()
        with pytest.raises(SystemExit) as left:
            cli.main()
        out, err = capfd.readouterr()
        assert isinstance(left.value.code, int)
        return Answer(left.value.code, out, err)

    return run


def process(*arguments: str | Path, cwd: Path | None = None) -> Answer:
    """The installed command, in a process of its own."""
    done = subprocess.run(
        [COMMAND, *map(str, arguments)], check=False, capture_output=True, text=True, cwd=cwd
    )
    return Answer(done.returncode, done.stdout, done.stderr)


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Answer]:
    """A run of the shipped serve, made by the installed command; tests leave it as it is."""
    folder = tmp_path_factory.mktemp("cli") / "learned"
    return folder, process("learn", "serve", "--out", folder, cwd=folder.parent)


@pytest.fixture
def run(learned: tuple[Path, Answer], tmp_path: Path) -> Iterator[Path]:
    """A copy of that run; a test that is refused must leave its trials as they are."""
    folder = tmp_path / "run"
    shutil.copytree(learned[0], folder)
    yield folder
    assert not list(folder.glob(".*"))


def recording() -> MarkerRecording:
    return read_markers(SERVE)


def changed(change: Callable[[MarkerRecording, np.ndarray], None], path: Path) -> Path:
    """The shipped serve with its positions (n, markers, 3) changed."""
    shipped = recording()
    positions = shipped.positions.copy()
    change(shipped, positions)
    write_c3d(path, MarkerRecording(shipped.names, shipped.times, positions))
    return path


def csv_of(markers: MarkerRecording, times: np.ndarray, path: Path) -> Path:
    head = ",".join(["time", *(f"{name}_{axis}" for name in markers.names for axis in "xyz")])
    rows = np.column_stack([times, markers.positions.reshape(len(times), -1)])
    np.savetxt(path, rows, fmt="%.6f", delimiter=",", header=f"units: m\n{head}", comments="")
    path.write_text("# " + path.read_text())
    return path


def trc_of(markers: MarkerRecording, path: Path) -> Path:
    names = "\t\t\t".join(markers.names)
    axes = "\t".join(f"{a}{i}" for i in range(1, len(markers.names) + 1) for a in "XYZ")
    count, number = len(markers.times), len(markers.names)
    lines = [
        f"PathFileType\t4\t(X/Y/Z)\t{path.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
        "OrigNumFrames",
        f"250\t250\t{count}\t{number}\tmm\t250\t1\t{count}",
        f"Frame#\tTime\t{names}\t\t",
        f"\t\t{axes}",
        "",
    ]
    for frame, (t, row) in enumerate(zip(markers.times, markers.positions, strict=True), start=1):
        cells = "\t".join(f"{1000 * value:.5f}" for value in row.ravel())
        lines.append(f"{frame}\t{t:.6f}\t{cells}")
    path.write_text("\n".join(lines) + "\n")
    return path


# ---------------------------------------------------------------------------------- learning


def test_learning_says_so_and_exits_with_0(learned: tuple[Path, Answer]) -> None:
    folder, answer = learned
    assert (answer.code, answer.err) == (0, "")
    *trials, last = answer.out.splitlines()
    records = [json.loads(line) for line in (folder / TRIALS).read_text().splitlines()]
    assert len(trials) == len(records)
    assert [line.split()[:2] for line in trials] == [
        ["trial", str(number)] for number in range(1, len(records) + 1)
    ]
    assert last.startswith("learned at trial ")
    assert {path.name for path in folder.iterdir()} == {SCENARIO, TRIALS}


def test_every_line_has_what_a_reader_expects(learned: tuple[Path, Answer]) -> None:
    for number, line in enumerate((learned[0] / TRIALS).read_text().splitlines(), start=1):
        record = json.loads(line)
        assert record["trial"] == number
        assert record["purpose"] in ("exploration", "learning", "repeat")
        assert record["subtask"] in ("throw", "strike")
        assert record["outcome"] in (
            "landed", "missed", "not_released", "fell_short", "caught_behind", "unreachable",
        )  # fmt: skip
        assert isinstance(record["success"], bool)
        assert isinstance(record["seed"], int)
        assert record["d"] >= 0
        assert np.shape(record["T_H"]) == (3,)
        assert record["T_G"] is None or np.shape(record["T_G"]) == (2,)
        assert np.shape(record["via_points"]["times"]) == (8,)
        assert np.shape(record["via_points"]["values"]) == (8, 6)


def test_a_learned_run_is_resumed_without_a_trial(
    command: Callable[..., Answer], run: Path, learned: tuple[Path, Answer]
) -> None:
    answer = command("learn", "serve", "--out", run, "--resume")
    assert answer.code == 0
    assert "going on after trial" in answer.out
    assert "\ntrial " not in answer.out
    assert (run / TRIALS).read_bytes() == (learned[0] / TRIALS).read_bytes()


def test_not_learned_exits_with_1_and_goes_on_later(
    command: Callable[..., Answer], tmp_path: Path, learned: tuple[Path, Answer]
) -> None:
    """``--resume`` begins a run that is not there: the same line works at any moment."""
    out = tmp_path / "with a space"
    line = ("learn", "serve", "--out", out, "--resume", "--max-trials")
    first = command(*line, "3")
    assert first.code == 1
    assert "this begins one" in first.out
    assert "not learned within 3 trials" in first.out
    assert command(*line, "3").code == 1
    assert command(*line, "60").code == 0
    assert (out / TRIALS).read_bytes() == (learned[0] / TRIALS).read_bytes()


def test_ctrl_c_says_how_to_go_on(tmp_path: Path, learned: tuple[Path, Answer]) -> None:
    out = tmp_path / "my run"
    running = subprocess.Popen(
        [COMMAND, "learn", "serve", "--out", out],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    assert running.stdout is not None
    for _ in range(4):
        running.stdout.readline()
    running.send_signal(signal.SIGINT)
    _, err = running.communicate(timeout=30)
    assert running.returncode == 130
    assert err.count("\n") == 1
    assert f"drake-viapoint learn serve --out '{out}' --resume" in err
    recorded = (out / TRIALS).read_bytes().count(b"\n")
    assert 4 <= recorded < 30
    said = int(err.split("interrupted after trial ")[1].split(";")[0])
    assert said in (recorded, recorded - 1)  # one may be on the disk and not yet counted
    assert process("learn", "serve", "--out", out, "--resume").code == 0
    assert (out / TRIALS).read_bytes() == (learned[0] / TRIALS).read_bytes()


def test_ctrl_c_before_the_first_trial(tmp_path: Path) -> None:
    running = subprocess.Popen(
        [COMMAND, "learn", "serve", "--out", tmp_path / "run"], stderr=subprocess.PIPE, text=True
    )
    maps = Path(f"/proc/{running.pid}/maps")
    while running.poll() is None and "pydrake" not in maps.read_text():
        time.sleep(0.01)  # until Drake is being imported
    running.send_signal(signal.SIGINT)
    _, err = running.communicate(timeout=30)
    assert running.returncode == 130
    assert "interrupted" in err
    assert "Traceback" not in err
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (KeyboardInterrupt(), 130, "the same command goes on from here"),
        (OSError(errno.ENOSPC, "No space left on device", "x.png"), 2, "x.png: No space left"),
        (RuntimeError("minimum step\nreached"), 2, "Drake refuses: minimum step reached"),
    ],
)
def test_whatever_stops_a_command_is_one_line(
    command: Callable[..., Answer],
    monkeypatch: pytest.MonkeyPatch,
    error: BaseException,
    code: int,
    words: str,
) -> None:
    def stopped(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("drake_viapoint.reproduction.reproduce.reproduce", stopped)
    answer = command("reproduce", "--out", "results")
    assert answer.code == code
    assert words in answer.err
    assert answer.err.count("\n") == 1


def test_a_mistake_of_ours_keeps_its_traceback(
    command: Callable[..., Answer], monkeypatch: pytest.MonkeyPatch
) -> None:
    def unfinished(*_: object, **__: object) -> None:
        raise NotImplementedError

    monkeypatch.setattr("drake_viapoint.reproduction.reproduce.reproduce", unfinished)
    with pytest.raises(NotImplementedError):
        command("reproduce", "--out", "results")


# --------------------------------------------------------------------------------- run folders


def test_a_folder_with_another_run(command: Callable[..., Answer], run: Path) -> None:
    before = (run / TRIALS).read_bytes()
    command("learn", "serve", "--out", run).refuses(str(run), "--resume", "name another")
    for other, key in (
        (("--seed", "4"), "seed"),
        (("--person", "3"), "demonstration.person"),
        (("--t-hit", "0.9"), "demonstration.hit_time"),
        (("--jacobian", "recorded"), "learning.jacobian.way"),
    ):
        command("learn", "serve", "--out", run, "--resume", *other).refuses(f"another {key}")
    command("learn", "upswing", "--out", run, "--resume").refuses("run of the serve, not of")
    assert (run / TRIALS).read_bytes() == before


def test_resuming_with_a_scenario(command: Callable[..., Answer], run: Path) -> None:
    same, other = run.parent / "same.yaml", run.parent / "other.yaml"
    same.write_text("task: serve\n")
    other.write_text("task: serve\nball: {mass: 0.057}\n")
    line = ("learn", "serve", "--out", run, "--resume", "--scenario")
    assert command(*line, same).code == 0
    command(*line, other).refuses("another scenario")


def test_a_run_of_other_versions(
    command: Callable[..., Answer], run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    newer = {**task_run.versions(), "drake": "9.9.9"}
    monkeypatch.setattr(task_run, "versions", lambda: newer)
    command("learn", "serve", "--out", run, "--resume").refuses("drake", "this is 9.9.9")


def test_two_processes_on_one_folder(command: Callable[..., Answer], run: Path) -> None:
    with (run / TRIALS).open("rb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        command("learn", "serve", "--out", run, "--resume").refuses("another process")


def test_a_damaged_last_line_is_done_again(
    command: Callable[..., Answer], run: Path, learned: tuple[Path, Answer]
) -> None:
    whole = (learned[0] / TRIALS).read_bytes()
    (run / TRIALS).write_bytes(whole[:-100])
    answer = command("learn", "serve", "--out", run, "--resume")
    assert answer.code == 0
    assert answer.out.count("\ntrial ") == 1
    assert (run / TRIALS).read_bytes() == whole


@pytest.mark.parametrize("damage", [b'{"trial": 5, "purp', b"{}", b"\xff\x00"])
def test_a_damaged_earlier_line_is_named(
    command: Callable[..., Answer], run: Path, damage: bytes
) -> None:
    lines = (run / TRIALS).read_bytes().split(b"\n")
    lines[4] = damage
    (run / TRIALS).write_bytes(b"\n".join(lines))
    for line in (
        ("learn", "serve", "--out", run, "--resume"),
        ("replay", run, "--html", run.parent / "x.html"),
    ):
        command(*line).refuses(TRIALS, "line 5 is damaged")
    assert (run / TRIALS).read_bytes() == b"\n".join(lines)


def test_an_edited_scenario(command: Callable[..., Answer], run: Path) -> None:
    text = (run / SCENARIO).read_text()
    (run / SCENARIO).write_text(text.replace("restitution: 0.8", "restitution: 0.7"))
    command("learn", "serve", "--out", run, "--resume").refuses(SCENARIO, "not what this run began")
    (run / SCENARIO).write_text(text[: len(text) // 2] + "[")
    command("learn", "serve", "--out", run, "--resume").refuses(SCENARIO, "not what this run began")
    command("replay", run, "--html", run.parent / "x.html").refuses(SCENARIO)


def test_a_folder_that_cannot_be_written(command: Callable[..., Answer], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    below = tmp_path / "file" / "run"
    command("learn", "serve", "--out", below).refuses(str(below), "cannot be written")
    command("reproduce", "--out", below, "--only", "serve").refuses("cannot be written")
    command("extract", SERVE, "--plot", below / "x.png").refuses(str(below), "cannot be written")
    command("demonstrate", "serve", "--out", below / "x.c3d").refuses(str(below))
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("mine")
    command("learn", "serve", "--out", tmp_path / "mine").refuses("not empty")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["thesis.txt"]


def test_a_disk_that_fills(
    command: Callable[..., Answer],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    learned: tuple[Path, Answer],
) -> None:
    whole = (learned[0] / TRIALS).read_bytes()
    fsync, count = os.fsync, 0

    def full(descriptor: int) -> None:
        nonlocal count
        count += 1
        if count > 8:
            raise OSError(errno.ENOSPC, "No space left on device")
        fsync(descriptor)

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        answer = command("learn", "serve", "--out", tmp_path / "run")
        answer.refuses("No space left on device", "are intact", "--resume")
    kept = (tmp_path / "run" / TRIALS).read_bytes()
    assert 4 < kept.count(b"\n") < 9
    assert whole.startswith(kept)
    assert kept.endswith(b"\n")
    assert command("learn", "serve", "--out", tmp_path / "run", "--resume").code == 0
    assert (tmp_path / "run" / TRIALS).read_bytes() == whole


# -------------------------------------------------------------------------------- marker files


def test_files_that_are_none(command: Callable[..., Answer], tmp_path: Path) -> None:
    (tmp_path / "cut.c3d").write_bytes(SERVE.read_bytes()[:9000])
    (tmp_path / "text.c3d").write_text("not a recording\n" * 100)
    (tmp_path / "empty.trc").write_text("")
    (tmp_path / "notes.txt").write_text("")
    for name, words in {
        "missing.c3d": "No such file",
        "cut.c3d": "cut.c3d",
        "text.c3d": "text.c3d",
        "empty.trc": "empty.trc",
        "notes.txt": ".c3d, .trc, .csv",
    }.items():
        command("extract", tmp_path / name).refuses(name, words)
        command(
            "learn", "serve", "--out", tmp_path / "run", "--demonstration", tmp_path / name
        ).refuses(name, words)
    assert not (tmp_path / "run").exists()


def learn_from(command: Callable[..., Answer], file: Path) -> Answer:
    answer = command("learn", "serve", "--out", file.parent / "run", "--demonstration", file)
    assert not (file.parent / "run").exists(), "bad input is said before a folder is made"
    return answer


def test_a_marker_that_is_absent(command: Callable[..., Answer], tmp_path: Path) -> None:
    command("extract", SERVE, "--marker", "thumb").refuses("'thumb' is absent", "racket_upper")
    shipped = recording()
    path = tmp_path / "headless.c3d"
    write_c3d(path, MarkerRecording(shipped.names[:3], shipped.times, shipped.positions[:, :3]))
    for answer in (learn_from(command, path), command("extract", path)):
        answer.refuses("'racket_upper' is absent", "shoulder, elbow, wrist")


def test_a_gap_that_is_too_long(command: Callable[..., Answer], tmp_path: Path) -> None:
    def gap(markers: MarkerRecording, positions: np.ndarray) -> None:
        positions[100:150, markers.names.index("wrist")] = np.nan

    path = changed(gap, tmp_path / "gap.c3d")
    for answer in (learn_from(command, path), command("extract", path)):
        answer.refuses("'wrist'", "0.400 s", "0.600 s")


def test_times_that_do_not_increase(command: Callable[..., Answer], tmp_path: Path) -> None:
    shipped = recording()
    times = shipped.times.copy()
    times[20] = times[18]
    path = csv_of(shipped, times, tmp_path / "late.csv")
    for answer in (learn_from(command, path), command("extract", path)):
        answer.refuses("late.csv, line 23", "do not increase")


def test_fewer_samples_than_via_points(command: Callable[..., Answer], tmp_path: Path) -> None:
    command("extract", SERVE, "--marker", "wrist", "--end", "0.02", "--number", "8").refuses(
        "8 via-points", "6 samples"
    )
    (tmp_path / "many.yaml").write_text("demonstration: {via_points: 999}")
    command(
        "learn", "serve", "--out", tmp_path / "run", "--scenario", tmp_path / "many.yaml"
    ).refuses("999 via-points", "343 samples")


def test_no_impact(command: Callable[..., Answer], tmp_path: Path) -> None:
    """Only the beginning, where nothing is hit; with a time given it is not looked for."""
    shipped = recording()
    path = tmp_path / "short.c3d"
    write_c3d(path, MarkerRecording(shipped.names, shipped.times[:200], shipped.positions[:200]))
    learn_from(command, path).refuses("no impact found", "--t-hit")
    assert "no impact found" in command("extract", path).out
    answer = command(
        "learn", "serve", "--out", "run", "--demonstration", path, "--t-hit", "0.7",
        "--max-trials", "1",
    )  # fmt: skip
    assert answer.code == 1, answer
    assert command("extract", path, "--t-hit", "0.7").code == 0
    command("extract", path, "--t-hit", "nan").refuses("t_HIT must lie between")
    for wrong in ("nan", "9", "-1"):
        command(
            "learn", "serve", "--out", "other", "--demonstration", path, "--t-hit", wrong
        ).refuses("hit_time")


def test_a_demonstration_out_of_reach(command: Callable[..., Answer], tmp_path: Path) -> None:
    def away(_: MarkerRecording, positions: np.ndarray) -> None:
        positions += [0.0, 1.0, 0.0]

    path = changed(away, tmp_path / "away.c3d")
    learn_from(command, path).refuses("via-point", "out of reach", "mm", "stopped by")


@pytest.mark.parametrize(
    "arguments",
    [
        ("--number", "5", "--threshold", "0.01"),
        ("--number", "1"),
        ("--threshold", "0"),
        ("--threshold", "nan"),
        ("--start", "3"),
        ("--start", "nan"),
        ("--marker", "wrist", "--body", "a", "b", "c"),
        ("--body", "wrist", "wrist", "wrist"),
        ("--plot", "picture.docx"),
    ],
)
def test_extractions_that_make_no_sense(
    command: Callable[..., Answer], arguments: tuple[str, ...]
) -> None:
    command("extract", SERVE, *arguments).refuses()


# ----------------------------------------------------------------------------------- scenarios


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("bal: {mass: 0.1}", ("bal",)),
        ("ball: {mas: 0.1}", ("mas",)),
        ("ball: {mass: heavy}", ("ball.mass", "heavy")),
        ("ball: {mass: [1]}", ("ball.mass",)),
        ("ball: 3", ("ball",)),
        ("ball: {mass: -0.058}", ("ball.mass must be positive", "-0.058")),
        ("ball: {mass: .nan}", ("ball.mass",)),
        ("ball: {restitution: 1.5}", ("ball.restitution", "1.5")),
        ("plant: {time_step: 0.001}", ("plant.time_step",)),
        ("plant: {stiction_tolerance: 0}", ("plant.stiction_tolerance",)),
        ("plant: {contact_model: soft}", ("soft",)),
        ("simulator: {max_step_size: 0}", ("simulator.max_step_size", "got 0")),
        ("simulator: {accuracy: 0}", ("simulator.accuracy", "got 0")),
        ("simulator: {integration_scheme: euler}", ("euler",)),
        ("simulator: {start_time: .nan}", ("simulator.start_time",)),
        ("learning: {throw: {control: [x9]}}", ("x9", "1 to 8")),
        ("learning: {throw: {control: []}}", ("learning.throw.control",)),
        ("robot: {tool_frame: hammer}", ("hammer",)),
        ("scene: nowhere.dmd.yaml", ("nowhere.dmd.yaml",)),
        ("task: upswing", ("upswing",)),
        ("[1, 2]", ("mapping",)),
        ("ball: [", ("not YAML",)),
        ("seed: -1", ("seed",)),
        ("seed: 1.5", ("seed",)),
    ],
)
def test_scenarios_with_mistakes(
    command: Callable[..., Answer], tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    (tmp_path / "mine.yaml").write_text(text)
    answer = command("learn", "serve", "--out", "run", "--scenario", tmp_path / "mine.yaml")
    answer.refuses(*words)
    assert not (tmp_path / "run").exists()


def test_scenarios_that_cannot_be_read(command: Callable[..., Answer], tmp_path: Path) -> None:
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    for path in (tmp_path / "missing.yaml", tmp_path, tmp_path / "bytes.yaml"):
        command("learn", "serve", "--out", "run", "--scenario", path).refuses(str(path))


def test_the_printed_scenario_is_one(command: Callable[..., Answer], tmp_path: Path) -> None:
    printed = command("scenario", "serve")
    assert printed.code == 0
    assert "\n  # hit_time:\n" in printed.out
    (tmp_path / "mine.yaml").write_text(printed.out)
    assert command(
        "learn", "serve", "--out", "run", "--scenario", tmp_path / "mine.yaml", "--max-trials", "1"
    ).code == 1  # fmt: skip


# ---------------------------------------------------------------------------- replay and extract


def test_the_robots_scenario_is_one(command: Callable[..., Answer], tmp_path: Path) -> None:
    answer = command("scenario", "serve", "--robot")
    assert (answer.code, answer.err) == (0, "")
    assert "execution: contact\n" in answer.out
    command("scenario", "upswing", "--robot").refuses("--robot is of the serve")
    file = tmp_path / "robot.yaml"
    file.write_text(answer.out)
    command("learn", "serve", "--out", "x", "--robot", "--scenario", file).refuses(
        "either --robot or --scenario"
    )


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("contact.strings_stiffness", 0, ["contact.strings_stiffness must be positive, got 0"]),
        ("contact.cup_stiffness", -1, ["contact.cup_stiffness must be positive, got -1"]),
        ("ball.restitution", 1.5, ["ball.restitution must be in (0, 1], got 1.5"]),
        ("cameras.rate", 0, ["cameras.rate must be positive, got 0"]),
        ("contact.cup_radius", 0.02, ["the cup is smaller than the ball, got 0.02"]),
        ("robot.cup_frame", "handle", ["the ball does not rest in the cup"]),
        ("robot.mount_frame", "nowhere", ["no frame 'nowhere'"]),
    ],
)
def test_robots_that_cannot_serve_are_one_line_and_leave_no_folder(
    command: Callable[..., Answer], tmp_path: Path, key: str, value: object, words: list[str]
) -> None:
    part, name = key.split(".")
    file = tmp_path / "robot.yaml"
    scenario = yaml.safe_load(resolve(ROBOT_SERVE).read_text())
    scenario.setdefault(part, {})[name] = value
    file.write_text(yaml.safe_dump(scenario))
    command("learn", "serve", "--out", "run", "--scenario", file).refuses(*words)
    assert not (tmp_path / "run").exists()


def test_replay(command: Callable[..., Answer], run: Path, tmp_path: Path) -> None:
    page = tmp_path / "x.html"
    answer = command("replay", run, "--trial", "2", "--html", page)
    assert (answer.code, answer.err) == (0, "")
    assert page.read_text().lstrip().lower().startswith("<!doctype html")
    command("replay", run, "--trial", "99", "--html", page).refuses("not 99")
    command("replay", tmp_path / "nothing", "--html", page).refuses("holds no run")
    command("replay", run, "--html", tmp_path / "no" / "x.html").refuses("cannot be written")


@pytest.mark.parametrize("kind", ["c3d", "csv", "trc"])
def test_extract_from_every_kind_of_file(
    command: Callable[..., Answer], tmp_path: Path, kind: str
) -> None:
    shipped = recording()
    file = {
        "c3d": lambda: SERVE,
        "csv": lambda: csv_of(shipped, shipped.times, tmp_path / "serve.csv"),
        "trc": lambda: trc_of(shipped, tmp_path / "serve.trc"),
    }[kind]()
    answer = command("extract", file, "--plot", tmp_path / "x.png")
    assert (answer.code, answer.err) == (0, "")
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")
    head, hit, labels, *points, error, picture = answer.out.splitlines()
    assert "5 markers, 343 samples at 250 Hz" in head
    assert float(hit.split()[2]) == pytest.approx(find_impact(shipped), abs=1e-3)
    assert labels.split()[0] == "via-point"
    assert [line.split()[0] for line in points] == [str(n) for n in range(1, 9)]
    assert all(len(line.split()) == 8 for line in points)
    assert "error left" in error
    assert str(tmp_path / "x.png") in picture


def test_extract_a_marker_to_a_threshold(command: Callable[..., Answer], tmp_path: Path) -> None:
    answer = command("extract", SERVE, "--marker", "elbow", "--threshold", "0.01")
    assert answer.code == 0
    assert (tmp_path / "serve-via-points.png").is_file(), "beside the caller, not the file"
    left = next(line for line in answer.out.splitlines() if "error left" in line)
    assert float(left.split()[2]) <= 10.0


@pytest.mark.skipif(not REAL_SERVE.exists(), reason="the recording of real serves is not there")
@pytest.mark.parametrize("prefix", ["", "Derrick:"])
def test_extract_from_a_real_serve(
    command: Callable[..., Answer], tmp_path: Path, prefix: str
) -> None:
    body = [f"{prefix}{name}" for name in ("RWRA", "RWRB", "RFIN")]
    part = ("--start", "2.44", "--end", "4.20", "--plot", tmp_path / "x.png")
    answer = command("extract", REAL_SERVE, "--body", *body, *part, "--number", "10")
    assert (answer.code, answer.err) == (0, "")
    assert "from 2.44 to 4.2 s" in answer.out
    marker = command("extract", REAL_SERVE, "--marker", body[2], *part, "--threshold", "0.02")
    assert (marker.code, marker.err) == (0, "")
    command("extract", REAL_SERVE, *part).refuses("racket_upper", "Derrick:RFIN")


# ---------------------------------------------------------------------------------------- help

COMMANDS = [["learn", "serve"], ["learn", "upswing"], ["replay"], ["extract"], ["demonstrate"]]
COMMANDS += [["components"], ["choices"], ["scenario"], ["reproduce"], ["sweep"]]
COMMANDS += [["conditions"], ["doctor"], ["completion"]]


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_help_shows_examples(command: Callable[..., Answer], words: list[str]) -> None:
    answer = command(*words, "--help")
    assert answer.code == 0
    assert "For example:" in answer.out
    examples = answer.out.split("For example:")[1].splitlines()
    assert any(line.startswith(f"      drake-viapoint {' '.join(words)} ") for line in examples)


def test_every_command_is_tested_for_its_help() -> None:
    assert {words[0] for words in COMMANDS} == set(cli.cli.commands)
    assert {words[1] for words in COMMANDS if words[0] == "learn"} == set(
        cli.cli.commands["learn"].commands
    )


def test_help_does_not_import_what_it_does_not_need() -> None:
    program = (
        "import sys; from drake_viapoint import cli\n"
        f"for words in {[[], ['learn'], *COMMANDS]!r}:\n"
        "    cli.cli.main([*words, '--help'], standalone_mode=False)\n"
        "heavy = {'pydrake', 'numpy', 'scipy', 'matplotlib', 'ezc3d', 'pandas', 'distributed'}\n"
        "heavy &= set(sys.modules)\n"
        "sys.exit(', '.join(sorted(heavy)) or 0)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "arguments", [["--frobnicate"], ["juggle"], ["learn", "juggling"], ["learn", "serve"],
                  ["learn", "serve", "--out", "x", "--person", "-1"],
                  ["learn", "serve", "--out", "x", "--max-trials", "0"]],
)  # fmt: skip
def test_mistyped_commands(command: Callable[..., Answer], arguments: list[str]) -> None:
    command(*arguments).refuses()


def test_learn_without_a_task_says_which_there_are(command: Callable[..., Answer]) -> None:
    answer = command("learn")
    assert answer.code == 2
    assert "Commands:" in answer.err


def test_without_a_command_it_says_what_can_be_done_next(command: Callable[..., Answer]) -> None:
    answer = command()
    assert (answer.code, answer.err) == (0, "")
    assert "drake-viapoint learn serve --out runs/first" in answer.out
    assert "drake-viapoint reproduce --out results" in answer.out


# ------------------------------------------------------------------------------ quiet, and JSON


def test_a_script_gets_json_and_nothing_else(
    command: Callable[..., Answer], run: Path, tmp_path: Path
) -> None:
    answer = command("learn", "serve", "--out", run, "--resume", "--json")
    trials = len(read_trials(run))
    told = json.loads(answer.out)
    assert (answer.code, answer.err) == (0, "")
    assert told == {
        "run": str(run),
        "task": "serve",
        "learned_at": next(r["trial"] for r in read_trials(run) if r["purpose"] == "repeat") - 1,
        "trials": trials,
    }
    told = json.loads(command("replay", run, "--html", "last.html", "--json").out)
    assert told == {"run": str(run), "trial": trials, "html": "last.html"}
    assert (tmp_path / "last.html").is_file()
    told = json.loads(command("extract", SERVE, "--json").out)
    assert len(told["times"]) == len(told["values"]) == 8
    assert told["names"] == ["x", "y", "z", "phi", "theta", "psi"]
    assert 0 < told["worst_error"] < 0.1
    assert told["t_HIT"] == pytest.approx(find_impact(read_markers(SERVE)), abs=1e-3)
    assert (tmp_path / told["picture"]).is_file()


def test_not_learned_in_json_says_why(command: Callable[..., Answer], tmp_path: Path) -> None:
    answer = command("learn", "upswing", "--out", "run", "--max-trials", "1", "--json")
    told = json.loads(answer.out)
    assert (answer.code, told["learned_at"], told["trials"]) == (1, None, 1)
    assert told["reason"].startswith("not learned within 1 trials")
    assert len(read_trials(tmp_path / "run")) == 1


def test_quiet_is_quiet_but_errors_are_said(command: Callable[..., Answer]) -> None:
    answer = command("learn", "upswing", "--out", "run", "--max-trials", "1", "--quiet")
    assert answer == Answer(1, "", "")
    for flag in ("--quiet", "--json"):
        again = command("learn", "upswing", "--out", "run", "--max-trials", "1", flag)
        again.refuses("run")
        assert again.out == ""


def test_a_reader_that_leaves_is_not_a_task_that_was_not_learned(tmp_path: Path) -> None:
    learning = subprocess.Popen(
        [COMMAND, "learn", "serve", "--out", "run"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert learning.stdout is not None
    assert learning.stderr is not None
    assert learning.stdout.readline().startswith(b"trial   1")
    learning.stdout.close()
    assert learning.wait() == 141
    assert learning.stderr.read() == b""
    learning.stderr.close()
    assert [r["trial"] for r in read_trials(tmp_path / "run")], "what is on record stays"


# ---------------------------------------------------------------------------------- reproducing


def test_reproduce_says_where_everything_is_and_does_it_once(
    command: Callable[..., Answer], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    row = Comparison("it", "3.3", "so", "so", Verdict.MATCHES)

    def make(out: Path, size: int, progress: Progress) -> Findings:
        with progress("making it", size) as bar:
            bar.update(size)
        (out / "it.csv").write_text("it\n")
        return Findings(("it is made",), comparisons=(row,), tables=("it.csv",))

    quick = replace(BY_NAME["upswing"], make=make)
    monkeypatch.setitem(BY_NAME, "upswing", quick)
    words = ("reproduce", "--out", "results", "--only", "upswing")
    answer = command(*words)
    assert (answer.code, answer.err) == (0, "")
    assert "  it is made\n" in answer.out
    assert answer.out.endswith(f"everything is on {Path('results', 'index.html')}\n")
    told = json.loads(command(*words, "--json").out)
    assert told["page"] == str(Path("results", "index.html"))
    (experiment,) = told["experiments"]
    assert experiment["unchanged"]
    assert experiment["files"] == [str(Path("results", "it.csv"))]
    assert experiment["comparisons"][0]["verdict"] == "matches"
    assert (tmp_path / told["page"]).read_text().count("it is made") == 1
    assert "(1 of 1 experiments were as before)" in command(*words).out


@pytest.mark.parametrize(
    ("more", "word"),
    [
        (("--only", "juggling"), "juggling"),
        (("--size", "robot", "0"), "0"),
        (("--size", "robot", "21"), "at most 20, got 21"),
        (("--size", "serve", "2"), "at most 1, got 2"),
        (("--only", "serve", "--size", "robot", "2"), "robot"),
    ],
)
def test_sizes_that_make_no_sense(
    command: Callable[..., Answer], tmp_path: Path, more: tuple[str, ...], word: str
) -> None:
    command("reproduce", "--out", "results", *more).refuses(word)
    assert list(tmp_path.iterdir()) == []


# --------------------------------------------------------------------------------- the upswing


@pytest.fixture(scope="module")
def swung(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Answer]:
    """A run of the shipped upswing; tests leave it as it is."""
    folder = tmp_path_factory.mktemp("cli") / "swung"
    return folder, process("learn", "upswing", "--out", folder, cwd=folder.parent)


def test_learn_upswing_as_the_readme_says(swung: tuple[Path, Answer]) -> None:
    folder, answer = swung
    assert answer.code == 0, answer
    assert answer.err == ""
    lines = answer.out.splitlines()
    records = read_trials(folder)
    assert len(lines) == len(records) + 1
    assert lines[0].startswith("trial   1   learning swing")
    assert lines[-1] == f"learned at trial {len(records)}; {len(records)} trials are in {folder}"
    assert [record["success"] for record in records[-4:]] == [False, True, True, True]


@pytest.mark.parametrize(
    "options",
    [
        ("--jacobian", "fixed"),
        ("--jacobian", "manual"),
        ("--execution", "plant"),
        ("--execution", "plant", "--hand", "tracked"),
        ("--person", "3", "--seed", "7"),
    ],
    ids=" ".join,
)
def test_options_of_the_upswing(
    command: Callable[..., Answer], tmp_path: Path, options: tuple[str, ...]
) -> None:
    answer = command("learn", "upswing", "--out", "run", "--max-trials", "2", *options)
    assert answer.code == 1, answer
    said = (tmp_path / "run" / SCENARIO).read_text()
    for value in options[1::2]:
        assert f": {value}\n" in said
    again = command("learn", "upswing", "--out", "run", "--max-trials", "3", "--resume")
    assert again.out.startswith("going on after trial 2")
    assert len(read_trials(tmp_path / "run")) == 3


def test_a_scenario_of_the_upswing(command: Callable[..., Answer], tmp_path: Path) -> None:
    printed = command("scenario", "upswing").out
    (tmp_path / "mine.yaml").write_text(printed.replace("length: 0.35", "length: 0.3"))
    answer = command(
        "learn", "upswing", "--scenario", "mine.yaml", "--out", "run", "--max-trials", "1"
    )
    assert answer.code == 1, answer
    assert "length: 0.3\n" in (tmp_path / "run" / SCENARIO).read_text()
    command("learn", "serve", "--scenario", "mine.yaml", "--out", "other").refuses(
        "mine.yaml", "task must be serve, got upswing"
    )


def test_ones_own_upswing(command: Callable[..., Answer], tmp_path: Path) -> None:
    assert command("demonstrate", "upswing", "--person", "5", "--out", "five.c3d").code == 0
    seen = read_markers(tmp_path / "five.c3d")
    mine = csv_of(seen, seen.times, tmp_path / "mine.csv")
    answer = command(
        "learn", "upswing", "--demonstration", mine, "--out", "run", "--max-trials", "1"
    )
    assert answer.code == 1, answer
    alone = MarkerRecording(("hand",), seen.times, seen.positions[:, :1])
    hand = csv_of(alone, seen.times, tmp_path / "hand.csv")
    line = ("learn", "upswing", "--demonstration", hand, "--out", "blind")
    command(*line).refuses("end state", "hand.csv")
    assert not (tmp_path / "blind").exists()
    answer = command(*line, "--end-state", "0", "-0.5", "--max-trials", "1")
    assert answer.code == 1, answer
    assert read_trials(tmp_path / "blind")[0]["Td"] == [0.0, -0.5]


def test_bad_upswings_are_one_line_and_leave_no_folder(
    command: Callable[..., Answer], tmp_path: Path
) -> None:
    def refused(scenario: str, *words: str, options: tuple[str, ...] = ()) -> None:
        (tmp_path / "bad.yaml").write_text(scenario)
        line = ("learn", "upswing", "--out", "run", "--scenario", "bad.yaml", *options)
        command(*line).refuses(*words)
        assert not (tmp_path / "run").exists()

    refused("demonstration: {via_points: 10}", "bad.yaml", "learning.control", "8 interior ones")
    refused("time_step: 0.03", "time_step 0.03 s does not divide", "would")
    plant = ("--execution", "plant")
    refused("robot: {line: [0.35, 0.44, 1.215]}", "via-point", "mm beyond", options=plant)
    refused("robot: {line: [2.0, 0.44, 1.215]}", "robot.line", "out of reach", options=plant)
    refused("robot: {orientation: [1.0, 1.57, 0.0]}", "robot.orientation", "y", options=plant)
    refused("robot: {tool_frame: nothing}", "nothing", options=plant)
    refused("task: serve", "task must be upswing, got serve")
    both = ("--person", "1", "--demonstration", str(SERVE))
    refused("", "either --person or --demonstration", options=both)
    command("learn", "upswing", "--out", "run", "--demonstration", SERVE).refuses("'hand'")
    command("learn", "upswing", "--out", "run", "--jacobian", "guessed").refuses("guessed")


def test_a_trial_without_numbers(
    command: Callable[..., Answer], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sound = Recurrence.__call__

    def broken(self: Recurrence, x: np.ndarray) -> PendulumMotion:
        motion = sound(self, x)
        return motion._replace(angle=motion.angle * np.nan)

    line = ("learn", "upswing", "--out", "run")
    command(*line, "--max-trials", "4")
    with monkeypatch.context() as patched:
        patched.setattr(Recurrence, "__call__", broken)
        answer = command(*line, "--resume")
    assert answer.code == 1
    said = answer.out.splitlines()[-1]
    assert said.startswith("not learned: trial 5: T is not finite: [nan, ")
    assert said.endswith("drake-viapoint learn upswing --out run --resume")
    assert command(*line, "--resume").code == 0
    records = read_trials(tmp_path / "run")
    assert records[4]["outcome"] == "failed"
    assert records[5]["via_points"] == records[4]["via_points"]


def test_components_of_a_run(command: Callable[..., Answer], run: Path, tmp_path: Path) -> None:
    line = ("components", run, "--out", tmp_path / "found")
    for bad in (("--position", "0"), ("--angle", "-1")):
        command(*line, *bad).refuses("must be positive")
    command("components", tmp_path, "--out", tmp_path / "found").refuses("holds no run")
    assert not (tmp_path / "found").exists()


# ---------------------------------------------------------------------------------------- sweeps


def test_sweep_as_its_help_says(command: Callable[..., Answer], tmp_path: Path) -> None:
    study = study_file(tmp_path / "study.yaml")
    line = ("sweep", study, "--out", "out", "--workers", "1")
    answer = command(*line, "--csv")
    assert (answer.code, answer.err) == (0, "")
    *_, fixed, recorded, last = answer.out.splitlines()
    assert fixed.startswith("fixed     learned 0 of 6 within 12 trials")
    assert recorded.startswith("recorded  learned ")
    assert last == "table in out/table.parquet, runs in out/runs"
    before = (tmp_path / "out" / "results.jsonl").read_bytes()
    assert command(*line).out.splitlines()[-3:] == [fixed, recorded, last]
    assert (tmp_path / "out" / "results.jsonl").read_bytes() == before
    told = json.loads(command(*line, "--json").out)
    table = read_table(tmp_path / "out")
    assert told["runs"] == len(table) == 12
    assert told["learned"] == int(table["learned_at"].notna().sum())
    assert (told["errors"], told["never_given"]) == (0, [])
    bare = command("sweep", study, "--out", "bare", "--workers", "1", "--no-folders")
    assert bare.out.splitlines()[-1] == "table in bare/table.parquet"
    assert {path.name for path in (tmp_path / "bare").iterdir()} == {
        "results.jsonl",
        "table.parquet",
    }


def test_a_sweep_with_errors_says_how_many(command: Callable[..., Answer], tmp_path: Path) -> None:
    study = study_file(tmp_path / "study.yaml", vary={"time_step": [0.03]})
    answer = command("sweep", study, "--out", "out", "--workers", "1")
    assert answer.code == 0
    assert "fixed     learned 0 of 1 within 12 trials, 1 ended with an error" in answer.out


def test_bad_sweeps_are_one_line_and_leave_no_folder(
    command: Callable[..., Answer], tmp_path: Path
) -> None:
    def refused(*words: str, **changes: object) -> None:
        study = study_file(tmp_path / "study.yaml", **changes)
        command("sweep", study, "--out", "out").refuses("study.yaml", *words)
        assert not (tmp_path / "out").exists()

    refused("vary: sed", "unknown", vary={"sed": [1]})
    refused("vary: seed", "at least one", vary={"seed": []})
    refused("conditions", "at least one", conditions={})
    refused("max_trials", "0", max_trials=0)
    study = study_file(tmp_path / "study.yaml")
    line = ("sweep", study, "--out", "out")
    command(*line, "--workers", "0").refuses("0")
    command(*line, "--workers", "2", "--scheduler", "tcp://x:1").refuses("either")
    command(*line, "--scheduler", "nonsense").refuses("nonsense", "address")
    command("sweep", tmp_path / "nowhere.yaml", "--out", "out").refuses("nowhere.yaml")
    assert not (tmp_path / "out").exists()
    (tmp_path / "file").write_text("")
    command("sweep", study, "--out", tmp_path / "file" / "out").refuses("cannot be written")


def test_a_folder_with_another_study(command: Callable[..., Answer], tmp_path: Path) -> None:
    study = study_file(tmp_path / "study.yaml", vary={"seed": [0]})
    line = ("sweep", study, "--out", "out", "--workers", "1")
    assert command(*line).code == 0
    before = {path: path.read_bytes() for path in (tmp_path / "out").rglob("*.*") if path.is_file()}
    study_file(study, vary={"seed": [0]}, max_trials=13)
    command(*line).refuses("table.parquet", "holds another study")
    study_file(study, vary={"seed": [1]})
    command(*line).refuses("results.jsonl", "runs that are not in this study", "seed0")
    (tmp_path / "out" / "table.parquet").write_text("thesis")
    study_file(study, vary={"seed": [0]})
    command(*line).refuses("table.parquet", "not a sweep's table")
    (tmp_path / "out" / "table.parquet").write_bytes(before[tmp_path / "out" / "table.parquet"])
    assert before == {path: path.read_bytes() for path in before}


def test_ctrl_c_on_a_sweep_goes_on_later(tmp_path: Path) -> None:
    """As a terminal sends it: to the workers, too, which have nothing to say to it."""
    study = study_file(tmp_path / "study.yaml", vary={"seed": {"from": 0, "to": 30}})
    line = [COMMAND, "sweep", study, "--out", tmp_path / "out", "--workers", "2"]
    running = subprocess.Popen(
        line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    results = tmp_path / "out" / "results.jsonl"
    while not results.exists() or results.read_bytes().count(b"\n") < 4:
        assert running.poll() is None
        time.sleep(0.01)
    os.killpg(running.pid, signal.SIGINT)
    _, err = running.communicate(timeout=30)
    assert running.returncode == 130
    assert err == "drake-viapoint: interrupted; the same command goes on from here\n"
    done = results.read_bytes()
    assert len(read_table(tmp_path / "out")) == done.count(b"\n") - 1
    again = process(*line[1:])
    assert (again.code, again.err) == (0, "")
    assert results.read_bytes().startswith(done)
    assert len(rows_in(tmp_path / "out")) == len(read_table(tmp_path / "out")) == 62
