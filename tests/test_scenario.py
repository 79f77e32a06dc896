"""Reading scenarios of any kind: what is wrong is named by file, key and value."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, is_dataclass
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from drake_viapoint.errors import ScenarioError
from drake_viapoint.tasks.catalogue import TASKS, task_scenario
from drake_viapoint.tasks.scenario import dump_scenario, load_scenario, require, require_positive
from drake_viapoint.tasks.whole_scenario import meanings, whole_scenario


@dataclass
class Tools:
    racket: str = "oval"
    weight: float = 0.3
    strings: list[str] = field(default_factory=lambda: ["gut"])


@dataclass
class Toy:
    """A scenario of a task nobody has."""

    task: str = "toy"
    seed: int = 0
    tools: Tools = field(default_factory=Tools)
    share: float | None = None

    def validate(self) -> None:
        require_positive("tools.weight", self.tools.weight)
        require(self.seed >= 0, "seed", self.seed, "must not be negative")


def load(folder: Path, text: str) -> Toy:
    file = folder / "toy.yaml"
    file.write_text(text)
    return load_scenario(file, Toy)


def fault(folder: Path, text: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        load(folder, text)
    message = str(caught.value)
    assert message.startswith(f"{folder / 'toy.yaml'}: ")
    assert "\n" not in message
    return message.removeprefix(f"{folder / 'toy.yaml'}: ")


@pytest.mark.parametrize("text", ["{}", "task: toy"])
def test_what_is_left_out_keeps_its_default(tmp_path: Path, text: str) -> None:
    assert load(tmp_path, text) == Toy()


def test_what_is_said_counts(tmp_path: Path) -> None:
    toy = load(tmp_path, "seed: 7\ntools: {weight: 0.25, strings: [a, b]}\nshare: 0.5\n")
    assert toy == Toy(seed=7, tools=Tools(weight=0.25, strings=["a", "b"]), share=0.5)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=50)
@given(
    st.builds(
        Toy,
        seed=st.integers(0, 10**9),
        share=st.none() | st.floats(-1e9, 1e9),
        tools=st.builds(
            Tools,
            racket=st.text(st.characters(codec="utf-8", categories=["L", "N", "P", "Zs"])),
            weight=st.floats(1e-12, 1e12),
            strings=st.lists(st.text("abc #:'\"-0123", max_size=5)),
        ),
    )
)
def test_what_is_dumped_loads_again(tmp_path: Path, toy: Toy) -> None:
    assert load(tmp_path, dump_scenario(toy)) == toy


def test_a_dump_says_everything() -> None:
    data = yaml.safe_load(dump_scenario(Toy(share=0.5)))
    assert data == {
        "task": "toy",
        "seed": 0,
        "tools": {"racket": "oval", "weight": 0.3, "strings": ["gut"]},
        "share": 0.5,
    }


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("sede: 7", "sede", "7"),
        ("seed: seven", "seed", "'seven'"),
        ("seed: 1.5", "seed", "1.5"),
        ("tools: {wieght: 0.2}", "tools.wieght", "0.2"),
        ("tools: {weight: heavy}", "tools.weight", "'heavy'"),
        ("tools: {weight: [1, 2]}", "tools.weight", "[1, 2]"),
        ("tools: {weight: {a: 1}}", "tools.weight.a", "1"),
        ("tools: {weight: null}", "tools.weight", "None"),
        ("tools: {strings: gut}", "tools.strings", "'gut'"),
        ("tools: {strings: 3}", "tools.strings", "3"),
        ("tools: {strings: {a: b}}", "tools.strings", "{'a': 'b'}"),
        ("tools: {strings: [[a]]}", "tools.strings", "[['a']]"),
        ("tools: 3", "tools", "3"),
        ("share: half", "share", "'half'"),
        ("tools: {weight: -0.3}", "tools.weight", "-0.3"),
        ("tools: {weight: .nan}", "tools.weight", "nan"),
        ("tools: {weight: .inf}", "tools.weight", "inf"),
        ("seed: -1", "seed", "-1"),
        ("seed: 1\ntools: {weight: 0.2}\n7: 8", "7", "8"),
    ],
)
def test_key_and_value_are_named(tmp_path: Path, text: str, key: str, value: str) -> None:
    message = fault(tmp_path, text)
    assert message.startswith(key)
    assert value in message


def test_the_right_one_of_two_alike_is_named(tmp_path: Path) -> None:
    """Drake's reader says but the last part of a key."""
    assert fault(tmp_path, "seed: 3\ntools: {seed: 3}").startswith("tools.seed: 3")


@pytest.mark.parametrize("text", ["", "\n", "# nothing said\n", "---\n", "null"])
def test_an_empty_file_is_no_scenario(tmp_path: Path, text: str) -> None:
    """It would be the whole default: what was to be written into it is not what runs."""
    assert fault(tmp_path, text).startswith("is empty")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "sede: 7",
            "sede: 7: unknown key; perhaps seed is meant, there are task, seed, tools, share",
        ),
        (
            "tools: {wieght: {a: 1}}",
            "tools.wieght: {'a': 1}: unknown key; perhaps weight is meant, there are racket, "
            "weight, strings",
        ),
        ("x: 1", "x: 1: unknown key; there are task, seed, tools, share"),
    ],
)
def test_an_unknown_key_is_told_from_those_there_are(
    tmp_path: Path, text: str, message: str
) -> None:
    assert fault(tmp_path, text) == message


def test_an_unknown_key_of_drakes_is_told_too() -> None:
    for key, near in (("plant.time_stop", "time_step"), ("simulator.acuracy", "accuracy")):
        with pytest.raises(ScenarioError, match=f"^.*{key}: 0.0: unknown key; perhaps {near} is"):
            task_scenario("serve", changes={key: 0.0})


@pytest.mark.parametrize("text", ["[1, 2]", "toy", "3", "- task: toy"])
def test_what_is_no_mapping_is_refused(tmp_path: Path, text: str) -> None:
    assert "mapping of keys to values" in fault(tmp_path, text)


@pytest.mark.parametrize("text", ["{", "a: b: c", "\t- x", "seed: 2026-13-32", "*x", "[" * 2000])
def test_what_is_no_yaml_is_refused(tmp_path: Path, text: str) -> None:
    assert fault(tmp_path, text).startswith("not YAML: ")


def test_what_cannot_be_read_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"none\.yaml: cannot be read"):
        load_scenario(tmp_path / "none.yaml", Toy)
    with pytest.raises(ScenarioError, match="cannot be read"):
        load_scenario(tmp_path, Toy)
    (tmp_path / "latin.yaml").write_bytes(b"task: caf\xe9")
    with pytest.raises(ScenarioError, match=r"latin\.yaml: cannot be read"):
        load_scenario(tmp_path / "latin.yaml", Toy)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=100)
@given(st.binary(max_size=40) | st.text("seed: {}[]-&*!\n0123tols", max_size=40).map(str.encode))
def test_any_bytes_load_or_are_refused(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "toy.yaml"
    file.write_bytes(content)
    message = None
    try:
        assert isinstance(load_scenario(file, Toy), Toy)
    except ScenarioError as error:
        message = str(error)
    if message is not None:
        assert message.startswith(f"{file}: ")
        assert "\n" not in message


def test_a_mapping_that_holds_itself_is_refused(tmp_path: Path) -> None:
    assert "holds itself" in fault(tmp_path, "tools: &tools {racket: *tools}")


# ----------------------------------------------------------- what can be set, and what it means


@dataclass
class Grip:
    force: float | None = None
    """How firmly the
    racket is held [N]."""
    hand: str | None = None
    """By which hand."""
    glove: str = "none"
    turn: float | None = None


@dataclass
class Held:
    """A scenario in which much is left open, at the ends and in between."""

    first: int | None = None
    """Nothing stands above it."""
    task: str = "held"
    grip: Grip = field(default_factory=Grip)
    seed: int = 0
    last: float | None = None
    made_with: dict[str, str] = field(default_factory=dict)

    def validate(self) -> None:
        require(self.seed >= 0, "seed", self.seed, "must not be negative")


OPEN = {"force": "0.5", "hand": "left", "turn": "-1.5", "first": "3", "last": "2.5"}


def uncommented(text: str, name: str, value: str) -> str:
    """With a value at the place of a key that is not given."""
    found = re.subn(rf"(?m)^( *)# {name}:$", rf"\1{name}: {value}", text)
    assert found[1] == 1, name
    return found[0]


def test_what_is_not_given_is_said_where_it_belongs() -> None:
    assert whole_scenario(Held()) == (
        "# Nothing stands above it.\n"
        "# first:\n"
        "task: held\n"
        "grip:\n"
        "  # How firmly the racket is held [N].\n"
        "  # force:\n"
        "  # By which hand.\n"
        "  # hand:\n"
        "  glove: none\n"
        "  # turn:\n"
        "seed: 0\n"
        "# last:\n"
        "made_with: {}\n"
    )


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=100)
@given(
    st.builds(
        Held,
        first=st.none() | st.integers(-9, 9),
        last=st.none() | st.floats(-9, 9),
        grip=st.builds(
            Grip,
            force=st.none() | st.floats(-9, 9),
            hand=st.none() | st.sampled_from(["left", "# hand:", "  # turn:", "a # b"]),
            glove=st.sampled_from(["none", "# force:", "a: b", "", "{}", "two\nlines\n", "- x"]),
            turn=st.none() | st.floats(-9, 9),
        ),
    )
)
def test_a_whole_scenario_loads_as_itself_and_takes_what_it_offers(
    tmp_path: Path, held: Held
) -> None:
    file = tmp_path / "held.yaml"
    file.write_text(whole := whole_scenario(held))
    assert load_scenario(file, Held) == held
    grip = held.grip
    given_values = {"first": held.first, "last": held.last}
    given_values |= {"force": grip.force, "hand": grip.hand, "turn": grip.turn}
    for name in [name for name, value in given_values.items() if value is None]:
        file.write_text(uncommented(whole, name, OPEN[name]))
        taken = load_scenario(file, Held)
        part = taken if hasattr(taken, name) else taken.grip
        assert str(getattr(part, name)) == OPEN[name]
        setattr(part, name, None)
        assert taken == held


def parts(scenario: object, above: str = "") -> Iterator[tuple[str, object]]:
    """A scenario and its parts, by the keys they are below."""
    yield above, scenario
    for item in fields(scenario):
        if is_dataclass(part := getattr(scenario, item.name)):
            yield from parts(part, f"{above}{item.name}.")


@pytest.mark.parametrize("task", TASKS)
def test_the_shipped_scenarios_say_every_key(tmp_path: Path, task: str) -> None:
    scenario = task_scenario(task)
    file = tmp_path / "whole.yaml"
    file.write_text(whole := whole_scenario(scenario))
    assert dump_scenario(task_scenario(task, file)) == dump_scenario(scenario)
    for above, part in parts(scenario):
        for item in fields(part):
            assert re.search(rf"(?m)^ *(# )?{item.name}:", whole), item.name
            if getattr(part, item.name) is None:
                file.write_text(uncommented(whole, item.name, "0.25"))
                changed = task_scenario(task, changes={f"{above}{item.name}": 0.25})
                assert dump_scenario(task_scenario(task, file)) == dump_scenario(changed)


def without_meaning(scenario: object) -> list[str]:
    """Full keys of the fields that are described neither below them nor by their class."""
    bare = []
    for above, part in parts(scenario):
        told = meanings(type(part))
        for item in fields(part):
            inner = getattr(part, item.name)
            kind = type(inner)
            made_up = is_dataclass(kind) and (kind.__doc__ or "").startswith(f"{kind.__name__}(")
            if not told.get(item.name) and (made_up or not is_dataclass(kind)):
                bare.append(f"{above}{item.name}")
    return bare


@pytest.mark.parametrize("task", TASKS)
def test_every_field_of_a_scenario_has_its_meaning(task: str) -> None:
    assert without_meaning(TASKS[task].scenario()) == []


def test_a_field_without_a_meaning_is_found() -> None:
    bare = ["task", "grip", "seed", "last", "made_with", "grip.glove", "grip.turn"]
    assert without_meaning(Held()) == bare


def test_without_source_there_are_no_meanings() -> None:
    made = dataclass(type("Made", (), {"__annotations__": {"share": float | None}, "share": None}))
    assert meanings(made) == {}
