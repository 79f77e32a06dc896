"""The serve's scenario: its defaults are valid, and no value beyond its bounds gets in."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydrake.systems.analysis import GetIntegrationSchemes

from drake_viapoint.errors import ScenarioError
from drake_viapoint.packages import resolve
from drake_viapoint.tasks.catalogue import ROBOT_SERVE
from drake_viapoint.tasks.scenario import dump_scenario, load_scenario
from drake_viapoint.tasks.serve_scenario import ServeScenario

DEFAULTS = yaml.safe_load(dump_scenario(ServeScenario()))


def leaves(data: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in data.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


KEYS = dict(leaves(DEFAULTS))
NUMBERS = sorted(
    key
    for key, value in KEYS.items()
    if isinstance(value, int | float) and not isinstance(value, bool)
)
LISTS = sorted(key for key, value in KEYS.items() if isinstance(value, list))
ANY_NUMBER = {"plant.sap_near_rigid_threshold", "simulator.target_realtime_rate"}
"""Bounds of these are Drake's own affair: no serve in event execution depends on them."""


def nested(key: str, value: object) -> dict[str, Any]:
    for part in reversed(key.split(".")):
        value = {part: value}
    assert isinstance(value, dict)
    return value


def load(folder: Path, data: object) -> ServeScenario:
    file = folder / "serve.yaml"
    file.write_text(yaml.safe_dump(data))
    return load_scenario(file, ServeScenario)


def fault(folder: Path, key: str, value: object) -> str:
    with pytest.raises(ScenarioError) as caught:
        load(folder, nested(key, value))
    message = str(caught.value)
    assert message.startswith(f"{folder / 'serve.yaml'}: ")
    assert "\n" not in message
    return message.removeprefix(f"{folder / 'serve.yaml'}: ")


def get(scenario: object, key: str) -> Any:
    for part in key.split("."):
        scenario = getattr(scenario, part)
    return scenario


def test_the_defaults_are_valid_and_survive_a_file(tmp_path: Path) -> None:
    ServeScenario().validate()
    text = dump_scenario(ServeScenario())
    assert dump_scenario(load(tmp_path, {})) == text
    assert dump_scenario(load(tmp_path, DEFAULTS)) == text


def test_the_defaults_are_the_papers() -> None:
    """Sections 2.1.2, 2.1.3 and 2.2.2."""
    learning = ServeScenario().learning
    assert learning.throw.control == ["x3", "y3", "z3", "x4", "y4", "z4"]
    assert learning.throw.gain == 0.5
    assert learning.strike.control == ["phi6", "phi7", "psi7"]
    assert learning.position_perturbation == 0.01
    assert learning.angle_perturbation == pytest.approx(math.radians(1))
    assert (learning.strike.gain, learning.strike.taper_start, learning.strike.gate) == (
        0.4,
        0.05,
        0.1,
    )
    assert (learning.meeting_tolerance, learning.landing_tolerance) == (0.05, 0.125)
    assert (learning.successes, ServeScenario().ball.drag_coefficient) == (3, 0.0)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(
    mass=st.floats(1e-3, 1),
    restitution=st.floats(0.01, 1),
    person=st.integers(0, 1000),
    seed=st.integers(0, 2**31 - 1),
    control=st.lists(st.sampled_from(["x3", "phi6", "psi7"]), min_size=1),
    file=st.text(st.characters(codec="utf-8", categories=["L", "N", "P", "Zs"]), max_size=20),
    hit_time=st.none() | st.floats(0.01, 10),
)
def test_what_is_dumped_loads_again(tmp_path: Path, **said: Any) -> None:
    scenario = ServeScenario()
    scenario.ball.mass, scenario.ball.restitution = said["mass"], said["restitution"]
    scenario.demonstration.person, scenario.seed = said["person"], said["seed"]
    scenario.demonstration.file, scenario.demonstration.hit_time = said["file"], said["hit_time"]
    scenario.learning.strike.control = said["control"]
    scenario.made_with = {"drake": "1.51.1"}
    again = load(tmp_path, yaml.safe_load(dump_scenario(scenario)))
    assert dump_scenario(again) == dump_scenario(scenario)
    assert (again.ball, again.demonstration, again.learning) == (
        scenario.ball,
        scenario.demonstration,
        scenario.learning,
    )


@pytest.mark.parametrize("key", NUMBERS)
@pytest.mark.parametrize("value", ["much", [1, 2], {}, None, True], ids=str)
def test_what_is_no_number_is_refused(tmp_path: Path, key: str, value: object) -> None:
    message = fault(tmp_path, key, value)
    assert message.startswith(key)
    assert repr(value) in message


@pytest.mark.parametrize("key", sorted(set(NUMBERS) - ANY_NUMBER))
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -1, -1e-300])
def test_numbers_no_serve_can_have_are_refused(tmp_path: Path, key: str, value: float) -> None:
    message = fault(tmp_path, key, value)
    assert message.startswith((key, "plant"))
    assert str(value) in message


@pytest.mark.parametrize(
    "key",
    [
        "ball.mass",
        "ball.radius",
        "ball.restitution",
        "robot.natural_frequency",
        "robot.position_threshold",
        "robot.rotation_threshold",
        "robot.half_width",
        "robot.half_length",
        "demonstration.cutoff",
        "demonstration.angle_weight",
        "demonstration.via_points",
        "learning.throw.gain",
        "learning.throw.reached",
        "learning.position_perturbation",
        "learning.angle_perturbation",
        "learning.strike.gain",
        "learning.strike.gate",
        "learning.meeting_tolerance",
        "learning.landing_tolerance",
        "learning.successes",
        "simulator.max_step_size",
        "simulator.accuracy",
        "contact.strings_stiffness",
        "contact.cup_stiffness",
        "contact.ring_stiffness",
        "contact.ring_restitution",
        "contact.speed",
        "contact.step",
        "cameras.rate",
    ],
)
def test_zero_is_refused_where_it_means_nothing(tmp_path: Path, key: str) -> None:
    message = fault(tmp_path, key, 0)
    assert message.startswith(key)
    assert ", got 0" in message


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("task", "upswing"),
        ("execution", "both"),
        ("ball.restitution", 1.01),
        ("demonstration.via_points", 1),
        ("demonstration.markers", ["racket_upper", "racket_lower"]),
        ("learning.throw.control", []),
        ("learning.strike.control", []),
        ("learning.strike.taper_start", 0.1),
        ("plant.time_step", 0.001),
        ("simulator.start_time", 1.0),
        ("simulator.integration_scheme", "cenic"),
        ("contact.ring_restitution", 1.01),
        ("cameras.see", "everything"),
        ("unknown.inertia", 0.05),
        ("unknown.mount", 0.005),
    ],
)
def test_other_values_beyond_their_bounds(tmp_path: Path, key: str, value: object) -> None:
    message = fault(tmp_path, key, value)
    assert message.startswith(key)
    assert str(value) in message


@pytest.mark.parametrize("key", ["simulator.integration_scheme", "plant.contact_model"])
def test_what_drake_does_not_know_is_refused(tmp_path: Path, key: str) -> None:
    assert "'no_such'" in fault(tmp_path, key, "no_such").replace(": no_such", ": 'no_such'")


@pytest.mark.parametrize("scheme", sorted(set(GetIntegrationSchemes()) - {"cenic"}))
def test_every_integrator_for_a_plant_without_contact_may_be_named(
    tmp_path: Path, scheme: str
) -> None:
    data = nested("simulator.integration_scheme", scheme)
    assert load(tmp_path, data).simulator.integration_scheme == scheme


@pytest.mark.parametrize("key", LISTS)
@pytest.mark.parametrize("value", ["x3", 3, {"x3": 1}], ids=str)
def test_what_is_no_list_is_refused(tmp_path: Path, key: str, value: object) -> None:
    message = fault(tmp_path, key, value)
    assert message.startswith(key)
    assert "must be a list" in message


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
@given(
    st.sampled_from(["", *sorted({key.rpartition(".")[0] for key in KEYS} - {""})]),
    st.from_regex(r"[a-z][a-z_]{0,11}", fullmatch=True),
    st.integers() | st.text("abc", max_size=4),
)
def test_keys_that_do_not_exist_are_named(
    tmp_path: Path, above: str, name: str, value: object
) -> None:
    key = f"{above}.{name}" if above else name
    if key in KEYS or any(known.startswith(f"{key}.") for known in KEYS):
        return
    if key in {"demonstration.hit_time", "made_with"}:  # optional, so not among the dumped
        return
    message = fault(tmp_path, key, value)
    assert message.startswith(f"{key}: {value!r}")


@pytest.mark.parametrize("key", ["ball", "learning", "learning.throw", "plant", "simulator"])
@pytest.mark.parametrize("value", [3, "three", [1]], ids=str)
def test_what_is_no_mapping_is_named(tmp_path: Path, key: str, value: object) -> None:
    assert fault(tmp_path, key, value).startswith(f"{key}: {value!r}")


def test_every_number_within_its_bounds_is_taken(tmp_path: Path) -> None:
    """Each default, a little larger, alone in a file."""
    for key in NUMBERS:
        value = KEYS[key]
        if key in {"plant.time_step", "simulator.start_time", "ball.restitution"}:
            continue
        larger = value + 1 if isinstance(value, int) else value * 1.01
        assert get(load(tmp_path, nested(key, larger)), key) == larger


def contact(key: str, value: object) -> dict[str, Any]:
    return {"execution": "contact", **nested(key, value)}


@pytest.mark.parametrize("key", [f"unknown.{name}" for name in ("inertia", "mount", "restitution")])
def test_with_contact_much_may_be_unknown(tmp_path: Path, key: str) -> None:
    assert get(load(tmp_path, contact(key, 0.05)), key) == 0.05
    with pytest.raises(ScenarioError, match=r"must be in \[0, 1\), got 1.0"):
        load(tmp_path, contact(key, 1.0))


@pytest.mark.parametrize(
    ("key", "value", "reason"),
    [
        ("ball.drag_coefficient", 0.507, "must be 0 with contact"),
        ("disturbance.release", 0.03, "must be 0 with contact"),
        ("disturbance.bounce", 0.03, "must be 0 with contact"),
        ("plant.time_step", 0.02, r"must be in \[0, 0.01\]"),
        ("contact.cup_radius", 0.03, "the cup is smaller than the ball"),
        ("contact.ball_mesh", 0.02, "must be at most half the ball's radius, 0.0165"),
        ("contact.strings_stiffness", -2e4, "must be positive"),
        ("contact.strings_stiffness", 800.0, "must be at least 852"),
    ],
)
def test_what_contact_does_not_go_with(tmp_path: Path, key: str, value: float, reason: str) -> None:
    with pytest.raises(ScenarioError, match=f"{key} .*{reason}") as caught:
        load(tmp_path, contact(key, value))
    assert f"got {value}" in str(caught.value)


def test_a_larger_ball_needs_a_larger_cup(tmp_path: Path) -> None:
    large = {"execution": "contact", "ball": {"radius": 0.04}}
    with pytest.raises(ScenarioError, match=r"contact\.cup_radius must be at least"):
        load(tmp_path, large)
    assert load(tmp_path, {"ball": {"radius": 0.04}}).ball.radius == 0.04, (
        "by events none is needed"
    )
    assert load(tmp_path, {**large, "contact": {"cup_radius": 0.042}}).contact.cup_radius == 0.042


def test_the_robots_scenario_is_section_2_1s() -> None:
    scenario = load_scenario(resolve(ROBOT_SERVE), ServeScenario)
    learning, cameras = scenario.learning, scenario.cameras
    assert scenario.execution == "contact"
    assert learning.throw.control == ["x3", "y3", "z3", "x4", "y4", "z4"]
    assert learning.strike.control == ["phi6", "theta6", "psi6"]
    assert learning.position_perturbation == 0.01
    assert learning.angle_perturbation == pytest.approx(math.radians(1.0))
    assert learning.strike.gate == 0.1
    assert (cameras.see, cameras.rate) == ("samples", 60.0)
    assert 0.005 <= cameras.noise * math.sqrt(3) <= 0.010
    assert scenario.unknown.inertia == 0.05


@pytest.mark.parametrize(
    ("text", "key", "component", "last"),
    [
        ("learning: {throw: {control: [x3, x99]}}", "throw", "x99", "psi8"),
        ("learning: {strike: {control: [phi]}}", "strike", "phi", "psi8"),
        ("learning: {strike: {control: [phi06]}}", "strike", "phi06", "psi8"),
        ("demonstration: {via_points: 2}", "throw", "x3", "psi2"),
        ("demonstration: {via_points: 6}", "strike", "phi7", "psi6"),
    ],
)
def test_a_component_there_is_not_is_named_with_its_key(
    tmp_path: Path, text: str, key: str, component: str, last: str
) -> None:
    file = tmp_path / "serve.yaml"
    file.write_text(f"task: serve\n{text}\n")
    with pytest.raises(ScenarioError) as caught:
        load_scenario(file, ServeScenario)
    message = str(caught.value)
    start = f"{file}: learning.{key}.control: there is no component {component}; there are x, y, z"
    assert message.startswith(start)
    assert message.endswith(last)
