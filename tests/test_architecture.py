"""Who may import whom, and who may print: the rules of the house, read off the source."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import drake_viapoint

PACKAGE = Path(drake_viapoint.__file__).resolve().parent
SOURCES = {
    ".".join(("drake_viapoint", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(
        ".__init__"
    ): path.read_text()
    for path in sorted(PACKAGE.rglob("*.py"))
    if "models" not in path.relative_to(PACKAGE).parts
}

# From the ground up; what shares a floor does not know its neighbours.
FLOORS = (
    ("errors",),
    ("packages",),
    ("motion",),
    ("learning", "robot", "demonstration"),
    ("tasks",),
    ("runs",),
    ("reproduction",),
    ("cli",),
    ("__main__",),
)
FLOOR = {name: number for number, names in enumerate(FLOORS) for name in names}
WITHOUT_DRAKE = ("motion", "learning", "demonstration")
STDLIB = frozenset(sys.stdlib_module_names)


def part(module: str) -> str:
    """The part of the house a module is in: ``learning`` of ``drake_viapoint.learning.gain``."""
    return f"{module}.".split(".")[1]


def imports(module: str, source: str) -> Iterator[tuple[int, str]]:
    """Every import, wherever it stands: its line and the full name of what it brings."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            origin = node.module or ""
            if node.level:
                base = module.split(".")[: -node.level]
                origin = ".".join([*base, origin] if origin else base)
            yield from ((node.lineno, f"{origin}.{alias.name}") for alias in node.names)


def broken_rules(module: str, source: str) -> list[str]:
    """What a module's source does against the rules, one line each."""
    here = part(module)
    broken = []
    for line, name in imports(module, source):
        if name.startswith("drake_viapoint."):
            there = part(name)
            if there in FLOOR and there != here and here and FLOOR[there] >= FLOOR[here]:
                broken.append(f"{module}:{line} imports upwards or sideways: {name}")
        if name == "pydrake.all" or name.startswith("pydrake.all."):
            broken.append(f"{module}:{line} imports pydrake.all")
        root = name.split(".")[0]
        if root == "pydrake" and (here in WITHOUT_DRAKE or not here):
            broken.append(f"{module}:{line} imports Drake: {name}")
        if here == "learning" and root not in STDLIB | {"numpy", "drake_viapoint"}:
            broken.append(f"{module}:{line} learning is numpy only: {name}")
        if here == "learning" and root in {"io", "json", "os", "pathlib", "pickle"}:
            broken.append(f"{module}:{line} learning knows no files: {name}")
        if root == "click" and here != "cli":
            broken.append(f"{module}:{line} only the command line imports click")
    broken += [
        f"{module}:{node.lineno} prints"
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "print" and here != "cli"
    ]
    return broken


@pytest.mark.parametrize("module", SOURCES)
def test_module_keeps_the_rules(module: str) -> None:
    assert broken_rules(module, SOURCES[module]) == []


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("drake_viapoint.motion.extraction", "from drake_viapoint.learning.gain import Gain"),
        ("drake_viapoint.robot.arm", "from drake_viapoint.learning import gain"),
        ("drake_viapoint.robot.arm", "from ..tasks import serve"),
        ("drake_viapoint.tasks.serve", "def f():\n    import drake_viapoint.cli"),
        ("drake_viapoint.errors", "from drake_viapoint import motion"),
        ("drake_viapoint.tasks.serve", "import pydrake.all"),
        ("drake_viapoint.tasks.serve", "from pydrake.all import MultibodyPlant"),
        ("drake_viapoint.tasks.serve", "from pydrake import all"),
        ("drake_viapoint.learning.gain", "import pydrake"),
        ("drake_viapoint.demonstration.c3d", "from pydrake.math import RigidTransform"),
        ("drake_viapoint", "from pydrake.math import RigidTransform"),
        ("drake_viapoint.learning.gain", "import matplotlib"),
        ("drake_viapoint.learning.gain", "from pathlib import Path"),
        ("drake_viapoint.runs.run", "print('trial')"),
        ("drake_viapoint.runs.run", "import click"),
    ],
)
def test_a_broken_rule_is_seen(module: str, source: str) -> None:
    assert broken_rules(module, source)


def test_every_part_of_the_package_has_its_floor() -> None:
    assert {part(module) for module in SOURCES} - {""} <= set(FLOOR)


def test_imports_run_in_no_circle() -> None:
    graph = {
        module: {
            known
            for _, name in imports(module, source)
            for known in (name, name.rpartition(".")[0])
            if known in SOURCES and known != module
        }
        for module, source in SOURCES.items()
    }
    while leaves := {module for module, needs in graph.items() if not needs}:
        graph = {m: needs - leaves for m, needs in graph.items() if m not in leaves}
    assert graph == {}


def test_names_say_what_is_inside() -> None:
    vague = {"utils", "util", "helpers", "helper", "manager", "common", "misc"}
    words = {word for module in SOURCES for word in module.replace(".", "_").split("_")}
    assert not words & vague


def test_motion_learning_and_demonstration_run_without_drake() -> None:
    modules = [module for module in SOURCES if part(module) in WITHOUT_DRAKE]
    program = (
        f"import importlib, sys\n"
        f"for name in {modules!r}: importlib.import_module(name)\n"
        f"sys.exit(', '.join(m for m in sys.modules if m.split('.')[0] == 'pydrake') or 0)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        check=False,
        capture_output=True,
        text=True,
        cwd=PACKAGE.parent,
    )
    assert done.returncode == 0, done.stderr
