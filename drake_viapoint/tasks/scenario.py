"""Scenario files: YAML into typed classes, with errors that name the key and the value."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar

import yaml
from pydrake.common.yaml import yaml_dump_typed, yaml_load_typed
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import DiagramBuilder

from drake_viapoint.errors import ScenarioError
from drake_viapoint.tasks.scenario_keys import check_keys


class Scenario(Protocol):
    """What every task's scenario can do."""

    task: str
    seed: int
    made_with: dict[str, str]

    def validate(self) -> None:
        """Check every value against its bounds; raises ScenarioError."""
        ...


_COMPONENT = re.compile(r"(?P<name>[a-z]+)(?P<number>[1-9][0-9]{0,8})")

S = TypeVar("S", bound=Scenario)


def load_scenario(path: Path, schema: type[S], changes: Mapping[str, object] | None = None) -> S:
    """Read and check a scenario; keys that are left out keep their defaults.

    Args:
        path: The file.
        schema: Class of the task's scenario.
        changes: Values that replace the file's, by their full keys, such as
            ``{"demonstration.person": 3}``.

    Raises:
        ScenarioError: The file cannot be read, has an unknown key, a value of the wrong type or
            out of its bounds. Names file, key and value.
    """
    data = read_mapping(path)
    try:
        return make_scenario(data, schema, changes)
    except ScenarioError as error:
        raise ScenarioError(f"{path}: {error}") from error


def make_scenario(
    data: Mapping[str, Any], schema: type[S], changes: Mapping[str, object] | None = None
) -> S:
    """Make and check a scenario of keys and values, as a file has them.

    Args:
        data: Keys and values; left as they are.
        schema: Class of the task's scenario.
        changes: Values that replace them, by their full keys.

    Raises:
        ScenarioError: An unknown key, a value of the wrong type or out of its bounds. Names key
            and value.
    """
    changed = dict(data)
    try:
        for key, value in (changes or {}).items():
            _change(changed, key, value)
        default = schema()
        task = changed.get("task", default.task)
        if isinstance(task, str):  # before its keys, which are another task's
            require(task == default.task, "task", task, f"must be {default.task}")
        check_keys(changed, default)
        _check_lists(changed, default)
        scenario = _load(changed, schema)
        scenario.validate()
    except RecursionError as error:
        raise ScenarioError("an anchor that holds itself") from error
    return scenario


def read_mapping(path: Path) -> dict[str, Any]:
    """A YAML file's keys and values, unchecked.

    Raises:
        ScenarioError: The file cannot be read, is empty, not YAML or holds no mapping.
    """
    try:
        text = path.read_text(encoding="utf-8")
        data = yaml.safe_load(text)
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:  # 2026-13-32 is a ValueError
        raise ScenarioError(f"{path}: not YAML: {' '.join(str(error).split())}") from error
    if data is None:
        raise ScenarioError(f"{path}: is empty; a scenario names its task")
    if not isinstance(data, dict):
        raise ScenarioError(f"{path}: a scenario is a mapping of keys to values")
    return data


def dump_scenario(scenario: Scenario) -> str:
    """A scenario as YAML, every value said."""
    text: str = yaml_dump_typed(scenario)
    return text


def require(condition: bool, key: str, value: object, bound: str) -> None:
    """Raise a ScenarioError that names key, value and bound unless the condition holds."""
    if not condition:
        raise ScenarioError(f"{key} {bound}, got {value}")


def require_positive(key: str, value: float) -> None:
    """Raise a ScenarioError unless the value is positive and finite."""
    require(math.isfinite(value) and value > 0, key, value, "must be positive")


def require_not_negative(key: str, value: float) -> None:
    """Raise a ScenarioError unless the value is finite and not negative."""
    require(0 <= value < math.inf, key, value, "must be finite and not negative")


def require_one_of(key: str, value: str, choices: tuple[str, ...]) -> None:
    """Raise a ScenarioError unless the value is one of the choices."""
    require(value in choices, key, value, f"must be {' or '.join(choices)}")


def require_components(
    key: str, control: Sequence[str], names: Sequence[str], via_points: int
) -> None:
    """Raise a ScenarioError unless each component is one of the movement's.

    Args:
        key: Where they are said.
        control: The components, such as ``x3``.
        names: Of the dimensions.
        via_points: How many there are.
    """
    for component in control:
        match = _COMPONENT.fullmatch(component)
        if not match or match["name"] not in names or int(match["number"]) > via_points:
            raise ScenarioError(
                f"{key}: there is no component {component}; there are {', '.join(names)} of "
                f"via-points 1 to {via_points} (demonstration.via_points), {names[0]}1 to "
                f"{names[-1]}{via_points}"
            )


def validate_simulation(
    plant: MultibodyPlantConfig, simulator: SimulatorConfig, *, contact: bool = False
) -> None:
    """Check Drake's own configuration: some values it does not refuse but stops the process for.

    Args:
        plant: Of the plant.
        simulator: Of the simulator.
        contact: Whether bodies touch: then the plant may move in steps of its own, and integrators
            that solve for contact may be used.

    Raises:
        ScenarioError: Names the value and the bound.
    """
    step = plant.time_step
    scheme = simulator.integration_scheme
    if contact:
        require(0 <= step <= 0.01, "plant.time_step", step, "must be in [0, 0.01]")
    else:
        require(step == 0, "plant.time_step", step, "must be 0: trials are in continuous time")
        require(scheme != "cenic", "simulator.integration_scheme", scheme, "must not need contact")
    for name in ("penetration_allowance", "stiction_tolerance", "sap_near_rigid_threshold"):
        require_positive(f"plant.{name}", getattr(plant, name))
    longest, accuracy, start = simulator.max_step_size, simulator.accuracy, simulator.start_time
    require(1e-6 <= longest <= 1, "simulator.max_step_size", longest, "must be in [1e-6, 1]")
    require(1e-12 <= accuracy <= 1, "simulator.accuracy", accuracy, "must be in [1e-12, 1]")
    require(start == 0, "simulator.start_time", start, "must be 0")
    try:
        builder = DiagramBuilder()  # some integrators want to see a plant
        AddMultibodyPlant(plant, builder)[0].Finalize()
        ApplySimulatorConfig(simulator, Simulator(builder.Build()))
    except RuntimeError as error:
        raise ScenarioError(f"plant or simulator: {' '.join(str(error).split())}") from error


_YAML_FAULTS = (RuntimeError, ValueError, TypeError, AssertionError, AttributeError)


def _change(data: dict[str, Any], key: str, value: object) -> None:
    """Put a value under a dotted key; what is above it and no mapping gives way to one."""
    *above, last = key.split(".")
    for part in above:
        inner = data.get(part)
        data[part] = dict(inner) if isinstance(inner, dict) else {}
        data = data[part]
    data[last] = value


def _load(data: dict[str, Any], schema: type[S]) -> S:
    try:
        loaded: S = yaml_load_typed(schema=schema, data=yaml.safe_dump(data), defaults=schema())
    except _YAML_FAULTS as error:
        key, value = _culprit(data, schema)
        reason = " ".join(str(error).split()) or "of the wrong type"
        raise ScenarioError(f"{key}: {value!r}: {reason}") from error
    return loaded


def _culprit(data: dict[str, Any], schema: type[S]) -> tuple[str, object]:
    """The key that cannot be loaded even alone; Drake's reader names only its last part."""
    for keys, value in _leaves(data):
        alone: object = value
        for key in reversed(keys):
            alone = {key: alone}
        try:
            yaml_load_typed(schema=schema, data=yaml.safe_dump(alone), defaults=schema())
        except _YAML_FAULTS:
            return ".".join(map(str, keys)), value
    return "the whole", data


def _leaves(data: dict[str, Any], above: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    leaves: list[tuple[tuple[str, ...], Any]] = []
    for key, value in data.items():
        keys = (*above, key)
        leaves += _leaves(value, keys) if isinstance(value, dict) and value else [(keys, value)]
    return leaves


def _check_lists(data: dict[str, Any], defaults: object, above: str = "") -> None:
    """Where a list is due, Drake's reader would take a word for the list of its letters."""
    for key, value in data.items():
        default = getattr(defaults, str(key), None)
        if isinstance(default, list):
            require(isinstance(value, list), f"{above}{key}", repr(value), "must be a list")
        elif isinstance(value, dict):
            _check_lists(value, default, f"{above}{key}.")
