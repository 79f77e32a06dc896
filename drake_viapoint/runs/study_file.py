"""Study files: YAML into a study, refused with the key and the value that make no sense of it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from drake_viapoint.errors import ScenarioError, StudyError
from drake_viapoint.runs.study import MOST, ONLY_CONDITION, Study, canonical
from drake_viapoint.runs.study_check import check_study
from drake_viapoint.tasks.catalogue import TASKS, task_scenario
from drake_viapoint.tasks.scenario import dump_scenario, make_scenario, read_mapping

_KEYS = (
    "task",
    "scenario",
    "changes",
    "conditions",
    "vary",
    "together",
    "max_trials",
    "repeats",
    "tabulate",
)
_MAX_TRIALS = 60  # as of `learn`


def read_study(path: Path) -> Study:
    """Read and check a study's file.

    Every condition is tried with the first values, and every value with the first condition; of a
    range of whole numbers the ends are, as the bounds of a scenario's numbers are intervals. What
    only another combination shows is said by the row of its run.

    Raises:
        StudyError: The file cannot be read, has an unknown key, a value that cannot be, nothing to
            vary where something is due, or a run twice. Names file, key, value and bound.
    """
    try:
        study = _study(path, _numbers(read_mapping(path)))
    except ScenarioError as error:
        raise StudyError(path, str(error).removeprefix(f"{path}: ")) from error
    except RecursionError as error:
        raise StudyError(path, "an anchor that holds itself") from error
    return study


def _study(path: Path, data: Mapping[Any, Any]) -> Study:
    for key in data:
        if key not in _KEYS:
            raise StudyError(path, f"unknown key {key!r}; there are {', '.join(_KEYS)}")
    task = data.get("task")
    if not isinstance(task, str) or task not in TASKS:
        raise StudyError(path, f"task must be {' or '.join(TASKS)}, got {task!r}")
    changes = _changes(path, "changes", data.get("changes"))
    file = data.get("scenario")
    if file is not None and not isinstance(file, str):
        raise StudyError(path, f"scenario must be the name of a file, got {file!r}")
    scenario = task_scenario(task, None if file is None else path.parent / file)
    scenario.made_with = {}
    plain = yaml.safe_load(dump_scenario(scenario))
    try:
        scenario = make_scenario(plain, TASKS[task].scenario, changes)
    except ScenarioError as error:
        raise StudyError(path, f"changes: {error}") from error
    study = Study(
        task=task,
        scenario=yaml.safe_load(dump_scenario(scenario)),
        conditions=_conditions(path, data),
        vary=_vary(path, data, "vary"),
        together=_together(path, data),
        max_trials=_count(path, "max_trials", data.get("max_trials", _MAX_TRIALS), least=1),
        repeats=_count(path, "repeats", data.get("repeats", 0), least=0),
        tabulate=_tabulate(path, data.get("tabulate", [])),
    )
    check_study(path, study, changes)
    return study


def _numbers(value: Any) -> Any:
    """Numbers as people write them: PyYAML takes 1e-3 for a word."""
    if isinstance(value, dict):
        return {key: _numbers(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_numbers(item) for item in value]
    is_number = isinstance(value, str) and re.fullmatch(r"[-+]?\d+[eE][-+]?\d+", value)
    return float(value) if is_number else value


def _count(path: Path, key: str, value: object, least: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= MOST:
        raise StudyError(
            path, f"{key} must be a whole number from {least} to {MOST}, got {value!r}"
        )
    return value


def _tabulate(path: Path, names: object) -> tuple[str, ...]:
    if not isinstance(names, list) or not all(isinstance(name, str) and name for name in names):
        raise StudyError(path, f"tabulate must be a list of fields of a trial, got {names!r}")
    return tuple(names)


def _changes(path: Path, where: str, changes: object) -> dict[str, Any]:
    """Full keys and plain values."""
    if changes is None:
        return {}
    if not isinstance(changes, dict):
        raise StudyError(path, f"{where} must map a scenario's keys to values, got {changes!r}")
    for key, value in changes.items():
        _check_key(path, where, key)
        _check_plain(path, f"{where}: {key}", value)
    return changes


def _conditions(path: Path, data: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    conditions = data.get("conditions", {ONLY_CONDITION: {}})
    if not isinstance(conditions, dict) or not conditions:
        raise StudyError(path, f"conditions must name at least one, got {conditions!r}")
    for name in conditions:
        if not isinstance(name, str) or not name.isprintable() or not name.strip():
            raise StudyError(path, f"conditions: a name must be a word, got {name!r}")
    return {name: _changes(path, f"conditions: {name}", its) for name, its in conditions.items()}


def _vary(path: Path, data: Mapping[str, Any], name: str) -> dict[str, tuple[Any, ...]]:
    vary = data.get(name, {})
    if not isinstance(vary, dict) or (name in data and not vary):
        raise StudyError(path, f"{name} must map a scenario's keys to values, got {vary!r}")
    return {key: tuple(_varied(path, name, key, values)) for key, values in vary.items()}


def _together(path: Path, data: Mapping[str, Any]) -> dict[str, tuple[Any, ...]]:
    together = _vary(path, data, "together")
    numbers = {key: len(values) for key, values in together.items()}
    if len(set(numbers.values())) > 1:
        counted = ", ".join(f"{key} has {number}" for key, number in numbers.items())
        raise StudyError(path, f"together: every key needs as many values, but {counted}")
    return together


def _varied(path: Path, name: str, key: object, values: object) -> list[Any] | range:
    """Values of one key: a list, or all whole numbers from one to another."""
    where = f"{name}: {_check_key(path, name, key)}"
    if isinstance(values, dict):
        if values.keys() != {"from", "to"}:
            raise StudyError(path, f"{where} must be a list or {{from: .., to: ..}}, got {values}")
        first, last = values["from"], values["to"]
        if any(isinstance(end, bool) or not isinstance(end, int) for end in (first, last)):
            raise StudyError(path, f"{where}: from and to must be whole numbers, got {values}")
        if not 0 <= last - first < MOST:
            bound = f"from must not be above to, nor {MOST} or more below"
            raise StudyError(path, f"{where}: {bound}, got {values}")
        return range(first, last + 1)
    if not isinstance(values, list) or not values:
        raise StudyError(path, f"{where} must be a list of at least one value, got {values!r}")
    for value in values:
        _check_plain(path, where, value)
    kinds = {_kind(value) for value in values if value is not None}
    if len(kinds) > 1:
        raise StudyError(path, f"{where} must be values of one kind, got {values!r}")
    return values


def _kind(value: object) -> str:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return "number"
    return type(value).__name__


def _check_key(path: Path, where: str, key: object) -> str:
    if not isinstance(key, str) or not all(key.split(".")):
        raise StudyError(path, f"{where}: {key!r} is no key of a scenario")
    if key.split(".")[0] in ("task", "made_with"):
        raise StudyError(path, f"{where}: {key} is not for a study to change")
    return key


def _check_plain(path: Path, where: str, value: object) -> None:
    """A number, a word, true, false, null, or a list of such: what a table and a name can hold."""
    try:
        canonical(value)
        plain = not _has_mapping(value)
    except (TypeError, ValueError, RecursionError):
        plain = False
    if not plain:
        shown = str(value) if len(str(value)) < 80 else f"{str(value)[:80]}..."
        raise StudyError(path, f"{where} must be a finite number, a word or a list, got {shown}")


def _has_mapping(value: object) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and any(_has_mapping(item) for item in value)
    )
