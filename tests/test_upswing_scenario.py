"""What an upswing may depend on, and what is said of values that cannot be."""

from pathlib import Path

import pytest

from drake_viapoint.errors import ScenarioError
from drake_viapoint.tasks.catalogue import task_scenario


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("execution", "event", "must be recurrence or plant, got event"),
        ("hand", "held", "must be kinematic or tracked, got held"),
        ("time_step", 0.0, "must be positive"),
        ("time_step", float("inf"), "must be positive"),
        ("seed", -1, "must not be negative"),
        ("demonstration.person", -1, "must not be negative"),
        ("demonstration.via_points", 2, "must be at least 3"),
        ("demonstration.cutoff", 0.0, "must be positive"),
        ("demonstration.end_angle", float("nan"), "must be finite"),
        ("demonstration.end_speed", float("inf"), "must be finite"),
        ("pendulum.length", 0.0, "must be positive"),
        ("pendulum.mass", -0.1, "must be positive"),
        ("pendulum.damping", -0.1, "must be finite and not negative"),
        ("robot.line", [0.0, 0.4], "must be three numbers"),
        ("robot.orientation", [0.0, float("nan"), 0.0], "must be three numbers"),
        ("robot.natural_frequency", 0.0, "must be positive"),
        ("learning.perturbation", 0.0, "must be positive"),
        ("learning.gain", [0.2], "must be two"),
        ("learning.gain", [0.2, 0.0], "must be positive"),
        ("learning.regularization", -1.0, "must be finite and not negative"),
        ("learning.angle_tolerance", 0.0, "must be positive"),
        ("learning.speed_tolerance", -1.0, "must be positive"),
        ("learning.successes", -1, "must not be negative"),
        ("learning.repeats", -1, "must not be negative"),
        ("plant.time_step", 0.01, "must be 0"),
        ("simulator.accuracy", 0.0, "must be in"),
        ("simulator.integration_scheme", "guess", "plant or simulator"),
    ],
)
def test_bounds(key: str, value: object, words: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        task_scenario("upswing", None, {key: value})
    assert key.split(".")[-1] in str(refused.value) or words.startswith("plant")
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("via_points", "control"),
    [
        (8, ["x2", "x3", "x4", "x5", "x6"]),
        (8, ["x1", "x2", "x3", "x4", "x5", "x6"]),
        (7, ["x2", "x3", "x4", "x5", "x6", "x7"]),
        (10, ["x2", "x3", "x4", "x5", "x6", "x7"]),
        (8, ["x2", "x2", "x3", "x4", "x5", "x6"]),
        (8, []),
    ],
)
def test_s_are_the_interior_via_points(via_points: int, control: list[str]) -> None:
    changes = {"demonstration.via_points": via_points, "learning.control": control}
    with pytest.raises(ScenarioError) as refused:
        task_scenario("upswing", None, changes)
    said = str(refused.value)
    assert f"must be the {via_points - 2} interior ones of {via_points} via-points: x2" in said
    assert (", ".join(control) or "none") in said


def test_a_file_with_an_unknown_key(tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text("task: upswing\npendulum: {lenght: 0.3}\n")
    with pytest.raises(ScenarioError, match=r"s.yaml: pendulum.lenght"):
        task_scenario("upswing", tmp_path / "s.yaml")
