"""A scenario with all that can be set in it, said by the scenario classes' own documentation."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import itertools
import textwrap
from collections.abc import Iterator
from typing import Any

import yaml

from drake_viapoint.tasks.scenario import Scenario, dump_scenario

_WIDTH = 100


def whole_scenario(scenario: Scenario) -> str:
    """A scenario as YAML, with a comment at the place of each key that is not given.

    A value that is None has no line in a scenario's file. Here its key stands in a comment, below
    what it means; the text loads as the same scenario.
    """
    lines = dump_scenario(scenario).splitlines()
    mapping = yaml.compose("\n".join(lines))
    for line, column, part, name in reversed(list(_not_given(scenario, mapping, len(lines)))):
        mark = " " * column + "# "
        meaning = meanings(type(part)).get(name, "")
        said = textwrap.wrap(meaning, _WIDTH, initial_indent=mark, subsequent_indent=mark)
        lines[line:line] = [*said, f"{mark}{name}:"]
    return "\n".join(lines) + "\n"


def meanings(schema: type) -> dict[str, str]:
    """What the fields of a scenario's class mean, by their names: the docstrings below them.

    Only the source has them; where an installation lacks it there are none.
    """
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(schema)))
    except (OSError, TypeError, SyntaxError):
        return {}
    (defined,) = tree.body
    found: dict[str, str] = {}
    body = defined.body if isinstance(defined, ast.ClassDef) else []
    for above, below in itertools.pairwise(body):
        if isinstance(above, ast.AnnAssign) and isinstance(above.target, ast.Name):
            match below:
                case ast.Expr(value=ast.Constant(value=str(text))):
                    found[above.target.id] = " ".join(text.split())
    return found


def _not_given(part: Any, mapping: Any, end: int) -> Iterator[tuple[int, int, Any, str]]:
    """Line and column of every field that is None, with the part it is of and its name.

    Args:
        part: A scenario or a part of it.
        mapping: Its node in the YAML.
        end: The line after it.
    """
    nodes = {key.value: (key, value) for key, value in mapping.value}
    names = [item.name for item in dataclasses.fields(part)]
    there = [name for name in names if name in nodes]
    column = mapping.start_mark.column
    for number, name in enumerate(names):
        following = next((n for n in names[number + 1 :] if n in nodes), None)
        line = nodes[following][0].start_mark.line if following else end
        value = getattr(part, name)
        if value is None and there:
            yield line, column, part, name
        elif dataclasses.is_dataclass(value):
            yield from _not_given(value, nodes[name][1], line)
