"""Which keys a scenario can have, and what to say of one that it cannot."""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Mapping
from typing import Any

from drake_viapoint.errors import ScenarioError


def check_keys(data: Mapping[str, Any], default: object, above: str = "") -> None:
    """Check that each key is one of its schema's; Drake's reader does not say which there are.

    Args:
        data: Keys and values, as a file has them.
        default: An object of the schema.
        above: What stands before these keys, such as ``learning.``.

    Raises:
        ScenarioError: A key is unknown; names key, value, the nearest key and all there are.
    """
    known = _fields(default)
    for key, value in data.items():
        if known and key not in known:
            near = difflib.get_close_matches(str(key), known, n=1)
            meant = f"perhaps {near[0]} is meant, " if near else ""
            raise ScenarioError(
                f"{above}{key}: {_shortened(repr(value))}: unknown key; {meant}there are "
                f"{', '.join(known)}"
            )
        if isinstance(value, dict):
            check_keys(value, getattr(default, str(key), None), f"{above}{key}.")


def _fields(default: object) -> list[str]:
    """Names of an object's fields; none where any key will do."""
    if dataclasses.is_dataclass(default):
        return [item.name for item in dataclasses.fields(default)]
    return [item.name for item in getattr(default, "__fields__", ())]  # Drake's own classes


def _shortened(text: str, longest: int = 60) -> str:
    return text if len(text) <= longest else f"{text[: longest - 3]}..."
