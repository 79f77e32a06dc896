"""Whether a study makes sense: nothing twice, and every value one that its scenario can have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from drake_viapoint.errors import ScenarioError, StudyError
from drake_viapoint.runs.study import MOST, Study, canonical
from drake_viapoint.tasks.catalogue import TASKS
from drake_viapoint.tasks.scenario import make_scenario


def check_study(path: Path, study: Study, changes: Mapping[str, Any]) -> None:
    """Check a study's conditions, values and columns against each other and the scenario.

    Args:
        path: What to call the study in an error.
        study: All of it.
        changes: To the scenario of every run, which the study's scenario has already.

    Raises:
        StudyError: A run or a column would be there twice, a key would have two values, or a
            scenario refuses a value.
    """
    _check_keys(path, study, changes)
    _check_runs(path, study)
    _check_values(path, study)


def _check_keys(path: Path, study: Study, changes: Mapping[str, Any]) -> None:
    """Nothing has two values at once, in a scenario or in a table."""
    places = [("changes", changes)]
    places += [(f"conditions: {name}", its) for name, its in study.conditions.items()]
    for name, varied in (("vary", study.vary), ("together", study.together)):
        for key in varied:
            for where, keys in places:
                for other in keys:
                    if f"{key}.".startswith(f"{other}.") or f"{other}.".startswith(f"{key}."):
                        raise StudyError(
                            path, f"{name}: {key} is set in {where}, too; which is it?"
                        )
        places.append((name, varied))
    columns = study.columns()
    for column in columns:
        if columns.count(column) > 1:
            raise StudyError(path, f"tabulate: two columns would be called {column!r}")


def _check_runs(path: Path, study: Study) -> None:
    if len(study) > MOST:
        raise StudyError(path, f"{len(study)} runs are more than the {MOST} a study may have")
    for key, values in study.vary.items():
        _check_different(path, f"vary: {key}", [(str(value), value) for value in values])
    steps = [list(step) for step in zip(*study.together.values(), strict=True)]
    _check_different(path, "together", [(str(step), step) for step in steps])
    _check_different(path, "conditions", list(study.conditions.items()))


def _check_different(path: Path, where: str, named: list[tuple[str, Any]]) -> None:
    """No two are the same run: equal numbers are, however they are written."""
    seen: dict[str, str] = {}
    for name, value in named:
        text = canonical(_as_number(value))
        if text in seen:
            raise StudyError(path, f"{where}: {name} and {seen[text]} would be the same runs")
        seen[text] = name


def _as_number(value: object) -> object:
    if isinstance(value, dict):
        return {key: _as_number(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_as_number(item) for item in value]
    if isinstance(value, float) and value.is_integer():
        return int(value)
    return value


def _check_values(path: Path, study: Study) -> None:
    schema = TASKS[study.task].scenario
    first = next(study.runs())
    for where, changes in _one_by_one(study, first.changes):
        try:
            make_scenario(study.scenario, schema, changes)
        except ScenarioError as error:
            place, fault = _fault_alone(study, schema, where, changes) or (where, error)
            raise StudyError(path, f"{place}: {fault}") from error


def _fault_alone(
    study: Study, schema: type[Any], where: str, changes: Mapping[str, Any]
) -> tuple[str, ScenarioError] | None:
    """The change that makes no sense even alone, and where it stands; None if all do."""
    for key, value in changes.items():
        try:
            make_scenario(study.scenario, schema, {key: value})
        except ScenarioError as error:
            for name, varied in (("vary", study.vary), ("together", study.together)):
                if key in varied:
                    where = f"{name}: {key}"
            return where, error
    return None


def _one_by_one(study: Study, first: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Where it stands, and the changes of the first run with one condition or value replaced."""
    varied = {key: first[key] for key in study.varied}
    for name, changes in study.conditions.items():
        yield f"conditions: {name}", {**changes, **varied}
    for key, values in study.vary.items():
        for value in _ends(values):
            yield f"vary: {key}", {**first, key: value}
    for step in _ends(tuple(zip(*study.together.values(), strict=True))):
        yield "together", {**first, **dict(zip(study.together, step, strict=True))}


def _ends(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """The least and the largest where all are whole numbers, or tuples of such; else all."""
    numbers = [value if isinstance(value, tuple) else (value,) for value in values]
    whole = all(isinstance(n, int) and not isinstance(n, bool) for row in numbers for n in row)
    return tuple({min(values): None, max(values): None}) if whole and values else values
