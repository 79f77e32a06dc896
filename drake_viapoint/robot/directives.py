"""Model directives: what a user's file names, put into a plant."""

from __future__ import annotations

import re
from pathlib import Path

import yaml
from pydrake.common.yaml import yaml_load_typed
from pydrake.multibody import parsing
from pydrake.multibody.parsing import PackageMap, Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_viapoint.errors import ModelFileError
from drake_viapoint.packages import package_map

_YAML_FAULT = re.compile(
    r"(?P<file>.+?):(?P<line>\d+):\d+: YAML node of type \w+ \([^)]*\) "
    r"(?:key '(?P<unknown>.*?)' did not match any visited value entry for <root>"
    r"|has non-(?P<due>\w+) \((?P<kind>\w+)\) entry for .*? (?P<key>[\w\[\]]+)"
    r"|(?P<other>.*?))"
    r"(?: while .*)?\.?"
)
"""What Drake's reader says of a key; then it says where it was, from inside out."""

_VISITED = re.compile(r" while visiting (?:std::optional<)?drake::multibody::parsing::(\w+)")


_NEEDED = {
    "add_model": ("file", "name"),
    "add_model_instance": ("name",),
    "add_frame": ("name",),
    "add_weld": ("parent", "child"),
    "add_collision_filter_group": ("name",),
    "add_directives": ("file",),
}
"""What a directive cannot be without."""


def add_directives(plant: MultibodyPlant, path: Path, address: str | None = None) -> None:
    """Add what a directives file names to a plant.

    The file may name ``package://drake_viapoint/...``, and the package that it lies in itself (see
    ``packages.package_beside``).

    Args:
        plant: Where it goes; not yet finalised.
        path: The file.
        address: What errors call it; the path if None.

    Raises:
        ModelFileError: The file or a model it names cannot be read.
    """
    parser = Parser(plant)
    packages = parser.package_map()
    packages.AddMap(package_map(path))
    _check_said(path, packages, address or str(path))
    try:
        parser.AddModels(str(path))
    except RuntimeError as error:
        reason = " ".join(str(error).split()).removeprefix("error: ")
        if "unknown package" in reason:
            reason += f"; known are {', '.join(packages.GetPackageNames())}"
        elif "when parsing a string" in reason:  # Drake's words for what has no scheme
            reason = (
                f"{reason.partition(' is invalid')[0]} is no address: it has the form "
                "package://NAME/FILE or file:///FILE"
            )
        reason = _yaml_fault(reason, path) or reason
        raise ModelFileError(address or str(path), reason) from error


def _check_said(
    path: Path, packages: PackageMap, address: str, above: tuple[Path, ...] = ()
) -> None:
    """Check what Drake does not refuse but stops the process for; all else it says better."""
    try:
        read = yaml_load_typed(schema=parsing.ModelDirectives, filename=str(path))
    except (OSError, RuntimeError, ValueError, TypeError, AssertionError, AttributeError):
        return
    except yaml.YAMLError:
        return
    for number, directive in enumerate(read.directives, start=1):
        said = {name: getattr(directive, name) for name in _NEEDED if getattr(directive, name)}
        if len(said) != 1:
            kinds = ", ".join(said) or "nothing"
            raise ModelFileError(address, f"item {number} of directives must be one, got {kinds}")
        ((kind, its),) = said.items()
        for key in _NEEDED[kind]:
            if not getattr(its, key):
                raise ModelFileError(address, f"item {number} of directives: {kind} needs a {key}")
        if kind == "add_frame" and not its.X_PF.base_frame:
            reason = f"item {number} of directives: {kind} needs an X_PF.base_frame"
            raise ModelFileError(address, reason)
        if kind == "add_directives":
            try:
                inner = Path(packages.ResolveUrl(its.file))
            except RuntimeError:
                continue
            if inner.resolve() in (*above, path.resolve()):
                raise ModelFileError(address, f"{its.file} is added by what it adds itself")
            _check_said(inner, packages, f"{address}: {inner}", (*above, path.resolve()))


def _yaml_fault(reason: str, path: Path) -> str | None:
    """What is wrong with a key of a directives file, without what Drake's reader was doing."""
    fault = _YAML_FAULT.fullmatch(reason)
    if fault is None:
        return None
    where = "" if Path(fault["file"]) == path else f"{fault['file']}, "
    said = f"{where}line {fault['line']}: "
    if fault["other"]:
        return said + fault["other"]
    if fault["due"]:
        due, kind = fault["due"].lower(), fault["kind"].lower()
        return f"{said}{fault['key']} must be a {due}, got a {kind}"
    visited = _VISITED.search(reason)
    schema = getattr(parsing, visited[1], None) if visited else None
    known = [item.name for item in getattr(schema, "__fields__", ())] or ["directives"]
    return f"{said}unknown key {fault['unknown']}; there are {', '.join(known)}"
