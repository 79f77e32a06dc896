"""Studies: every combination once, under a name that stays; what makes no sense is named."""

from __future__ import annotations

import string
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from small_studies import SMALL, small_study

from drake_viapoint.errors import StudyError
from drake_viapoint.packages import resolve
from drake_viapoint.runs.study import Study, StudyRun, canonical, digest
from drake_viapoint.runs.study_file import read_study
from drake_viapoint.tasks.catalogue import TASKS
from drake_viapoint.tasks.scenario import make_scenario

SHIPPED = sorted(resolve("package://drake_viapoint/package.xml").parent.glob("studies/*.yaml"))

values = st.one_of(
    st.lists(st.integers(-9, 99), min_size=1, max_size=4, unique=True),
    st.lists(st.text(string.printable, max_size=9), min_size=1, max_size=3, unique=True),
    st.lists(st.lists(st.integers(0, 9), max_size=3), min_size=1, max_size=3, unique_by=str),
).map(tuple)
keys = st.text(string.ascii_lowercase + "._", min_size=1, max_size=9)


@given(
    st.dictionaries(keys, values, max_size=3),
    st.lists(st.text(min_size=1, max_size=5), min_size=1, max_size=3, unique=True),
)
def test_every_combination_is_a_run_with_a_name_of_its_own(
    vary: dict[str, tuple[Any, ...]], names: list[str]
) -> None:
    conditions = {name: {"~way": number} for number, name in enumerate(names)}
    study = Study("upswing", {}, conditions, vary, 1, 0, ())
    runs = list(study.runs())
    product = len(names)
    for its in vary.values():
        product *= len(its)
    assert len(runs) == len(study) == product
    assert len({canonical(dict(run.changes)) for run in runs}) == product
    assert len({run.name for run in runs}) == product
    for run in runs:
        assert run.changes == {**conditions[run.condition], **run.values}
        assert set(run.name) <= set(string.ascii_letters + string.digits + "._+-")
        assert not run.name.startswith(".")
        assert len(run.name) < 100
    assert [run.condition for run in runs[: len(names)]] == names, "conditions are neighbours"


def test_a_run_keeps_its_name_when_the_study_grows(tmp_path: Path) -> None:
    small = {run.name for run in small_study(tmp_path).runs()}
    conditions = {"again": {"learning.jacobian.way": "manual"}, **SMALL["conditions"]}
    vary = {"demonstration.person": [7, 2, 1, 0], "seed": {"from": 0, "to": 7}}
    grown = small_study(tmp_path, conditions=conditions, vary=vary)
    names = {run.name for run in grown.runs()}
    assert small < names
    assert len(names) == 3 * 4 * 8


def test_a_name_says_what_the_run_is() -> None:
    run = StudyRun("my way!", {"a.person": 3, "gain": [0.1, 2]}, {"a.person": 3})
    assert run.name == f"my_way-person3-gain0.1_2-{digest({'a.person': 3})[:8]}"


@given(st.dictionaries(st.text(max_size=3), st.integers() | st.text(max_size=3), max_size=4))
def test_a_digest_does_not_see_order(data: dict[str, Any]) -> None:
    assert digest(data) == digest(dict(reversed(data.items())))


@settings(max_examples=25)
@given(
    persons=st.lists(st.integers(0, 50), min_size=1, max_size=5, unique=True),
    first=st.integers(0, 5),
    more=st.integers(0, 5),
    ways=st.lists(st.sampled_from(["fixed", "manual", "recorded"]), min_size=1, unique=True),
    max_trials=st.integers(1, 99),
    repeats=st.integers(0, 9),
    tabulate=st.lists(st.sampled_from(["T", "Td", "success", "outcome"]), unique=True),
)
def test_a_study_is_what_its_file_says(
    tmp_path_factory: pytest.TempPathFactory,
    persons: list[int],
    first: int,
    more: int,
    ways: list[str],
    max_trials: int,
    repeats: int,
    tabulate: list[str],
) -> None:
    seeds = {"from": first, "to": first + more}
    study = small_study(
        tmp_path_factory.getbasetemp(),
        conditions={f"c {way}": {"learning.jacobian.way": way} for way in ways},
        vary={"demonstration.person": persons, "seed": seeds},
        max_trials=max_trials,
        repeats=repeats,
        tabulate=tabulate,
    )
    assert study.vary == {
        "demonstration.person": tuple(persons),
        "seed": tuple(range(first, first + more + 1)),
    }
    assert list(study.conditions) == [f"c {way}" for way in ways]
    assert (study.max_trials, study.repeats) == (max_trials, repeats)
    assert study.tabulate == tuple(tabulate)
    *_, last = study.runs()
    scenario = make_scenario(study.scenario, TASKS["upswing"].scenario, last.changes)
    assert scenario.demonstration.person == persons[-1]
    assert scenario.seed == first + more
    assert scenario.learning.jacobian.way == ways[-1]


def test_what_is_left_out_has_a_default(tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text("task: serve\n")
    study = read_study(tmp_path / "s.yaml")
    assert [(run.condition, dict(run.changes)) for run in study.runs()] == [("all", {})]
    assert (study.max_trials, study.repeats, study.tabulate) == (60, 0, ())


def test_a_scenario_beside_the_study_and_changes_to_it(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("task: upswing\npendulum: {length: 0.3}\n")
    changes = {"learning.repeats": 2, "robot.position_threshold": "1e-3"}
    text = yaml.safe_dump({**SMALL, "scenario": "mine.yaml", "changes": changes})
    (tmp_path / "study.yaml").write_text(text.replace("'1e-3'", "1e-3"))  # as people write it
    study = read_study(tmp_path / "study.yaml")
    assert study.scenario["pendulum"]["length"] == 0.3
    assert study.scenario["learning"]["repeats"] == 2
    assert study.scenario["robot"]["position_threshold"] == 1e-3


def test_values_that_change_in_step(tmp_path: Path) -> None:
    together = {"demonstration.person": {"from": 4, "to": 6}, "seed": [1, 2, 3]}
    study = small_study(tmp_path, vary={"pendulum.damping": [0.0, 0.1]}, together=together)
    runs = list(study.runs())
    assert len(study) == len(runs) == 3 * 2 * 2
    pairs = {(run.values["demonstration.person"], run.values["seed"]) for run in runs}
    assert pairs == {(4, 1), (5, 2), (6, 3)}


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_a_shipped_study_is_one(path: Path) -> None:
    assert len(read_study(path)) > 1


def test_many_values_are_not_tried_one_by_one(tmp_path: Path) -> None:
    study = small_study(tmp_path, vary={"seed": {"from": 0, "to": 99_999}})
    assert len(study) == 200_000
    with pytest.raises(StudyError, match="seed must not be negative, got -1"):
        small_study(tmp_path, vary={"seed": {"from": -1, "to": 99_999}})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"task": "golf"}, ("task must be serve or upswing", "golf")),
        ({"task": None}, ("task", "None")),
        ({"repeat": 3}, ("unknown key 'repeat'", "repeats")),
        ({1: 3}, ("unknown key 1",)),
        ({"scenario": "nowhere.yaml"}, ("nowhere.yaml",)),
        ({"scenario": 3}, ("scenario", "3")),
        ({"changes": [1]}, ("changes", "[1]")),
        ({"changes": {"pendulum.lenght": 1.0}}, ("changes", "lenght")),
        ({"changes": {"pendulum.length": -1.0}}, ("pendulum.length must be positive", "-1.0")),
        ({"changes": {"pendulum": {"length": 1.0}}}, ("changes: pendulum", "length")),
        ({"changes": {"task": "serve"}}, ("task is not for a study to change",)),
        ({"changes": {"made_with.drake": "2"}}, ("made_with.drake",)),
        ({"changes": {"seed": 3}}, ("vary: seed is set in changes",)),
        ({"conditions": {}}, ("conditions", "at least one")),
        ({"conditions": ["a"]}, ("conditions", "['a']")),
        ({"conditions": {"a": {}, "b": {}}}, ("a", "b", "same runs")),
        ({"conditions": {3: {}}}, ("conditions", "3")),
        ({"conditions": {"a": 3}}, ("conditions: a", "3")),
        ({"conditions": {"a": {"hnad": "x"}}}, ("conditions: a", "hnad")),
        ({"conditions": {"a": {"hand": "held"}}}, ("conditions: a", "hand", "held", "tracked")),
        ({"conditions": {"a": {"seed": 1}}}, ("vary: seed is set in conditions: a",)),
        ({"vary": {}}, ("vary",)),
        ({"vary": [1]}, ("vary", "[1]")),
        ({"vary": {"seed": []}}, ("vary: seed", "at least one")),
        ({"vary": {"seed": 3}}, ("vary: seed", "list", "3")),
        ({"vary": {"seed": {"from": 3}}}, ("vary: seed", "from")),
        ({"vary": {"seed": {"from": 3, "to": 2}}}, ("vary: seed", "from", "'to': 2")),
        ({"vary": {"seed": {"from": 0.5, "to": 2}}}, ("vary: seed", "whole", "0.5")),
        ({"vary": {"seed": {"from": 0, "to": 10**9}}}, ("vary: seed", "1000000")),
        ({"vary": {"seed": [1, 2, 1]}}, ("vary: seed", "1 and 1")),
        ({"vary": {"pendulum.length": [1, 1.0]}}, ("vary: pendulum.length", "1.0 and 1")),
        ({"vary": {"seed": [1, "a"]}}, ("vary: seed", "one kind")),
        ({"vary": {"seed": [1.5]}}, ("vary: seed", "1.5")),
        ({"vary": {"seed": [{"a": 1}]}}, ("vary: seed", "{'a': 1}")),
        ({"vary": {"seed": [float("nan")]}}, ("vary: seed", "finite", "nan")),
        ({"vary": {"sed": [1]}}, ("vary: sed", "sed")),
        ({"vary": {"": [1]}}, ("vary",)),
        ({"vary": {"learning..gain": [1]}}, ("learning..gain",)),
        ({"vary": {"demonstration.person": [0, -1]}}, ("demonstration.person", "-1")),
        ({"vary": {"learning.jacobian.way": ["fixed"]}}, ("is set in conditions: fixed",)),
        ({"vary": {"learning.jacobian": ["fixed"]}}, ("is set in conditions: fixed",)),
        ({"together": {"pendulum.mass": [0.1], "time_step": [0.1, 0.2]}}, ("as many values",)),
        ({"together": {"seed": [1, 2]}}, ("seed is set in vary",)),
        ({"max_trials": 0}, ("max_trials", "from 1", "0")),
        ({"max_trials": True}, ("max_trials", "True")),
        ({"max_trials": 10**7}, ("max_trials", "1000000")),
        ({"repeats": -1}, ("repeats", "-1")),
        ({"repeats": 1.5}, ("repeats", "1.5")),
        ({"tabulate": "T"}, ("tabulate", "T")),
        ({"tabulate": [1]}, ("tabulate", "[1]")),
        ({"tabulate": ["T", "T"]}, ("tabulate", "'T'")),
        ({"tabulate": ["seed"]}, ("tabulate", "'seed'")),
        ({"tabulate": ["trials"]}, ("tabulate", "'trials'")),
        ({"tabulate": ["T", "repeated_T"]}, ("tabulate", "'repeated_T'")),
    ],
    ids=str,
)
def test_studies_that_make_no_sense(
    tmp_path: Path, changes: dict[Any, Any], words: tuple[str, ...]
) -> None:
    path = tmp_path / "study.yaml"
    data = {key: value for key, value in {**SMALL, **changes}.items() if value is not None}
    path.write_text(yaml.safe_dump(data, sort_keys=False))
    with pytest.raises(StudyError) as refused:
        read_study(path)
    message = str(refused.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    "text",
    ["", "[1]", "task: [", "task: upswing\nvary: {seed: [2026-01-01]}", "task: {}", "? [1]\n: 2",
     "task: upswing\nvary: {seed: &a [*a]}", "task: upswing\nvary: {seed: !!set {1, 2}}",
     "task: upswing\nvary: &a {seed: *a}"],
)  # fmt: skip
def test_files_that_hold_no_study(tmp_path: Path, text: str) -> None:
    (tmp_path / "s.yaml").write_text(text)
    with pytest.raises(StudyError, match=r"s.yaml: "):
        read_study(tmp_path / "s.yaml")


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    for path in (tmp_path / "missing.yaml", tmp_path, tmp_path / "bytes.yaml"):
        with pytest.raises(StudyError, match="cannot be read"):
            read_study(path)
