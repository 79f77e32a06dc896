"""The manual's code runs as it stands, and its tables say everything there is."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
import yaml
from markdown_pages import ROOT, fences, texts

from drake_viapoint.errors import RunFolderError
from drake_viapoint.runs.run_folder import RunFolder, read_trials
from drake_viapoint.runs.study import Study
from drake_viapoint.runs.task_run import begin
from drake_viapoint.tasks.catalogue import TASKS, task_scenario
from drake_viapoint.tasks.scenario import dump_scenario
from drake_viapoint.tasks.whole_scenario import meanings

PAGES = {page: text for page, text in texts().items() if page.startswith("docs/")}
WITH_CODE = [p for p, t in PAGES.items() if any(f.info.startswith("python") for f in fences(t))]

Page = dict[str, Any]


def executed(page: str) -> Page:
    """What a page's Python has named, run in its order in the current folder.

    Other blocks with a title are files of that name.
    """
    names: Page = {"__name__": "manual"}
    for info, code in fences(PAGES[page]):
        if title := re.search(r'title="(.+?)"', info):
            Path(title[1]).write_text(code)
        elif info.startswith("python"):
            exec(compile(code, page, "exec"), names)
    return names


@pytest.mark.parametrize("page", WITH_CODE)
def test_code_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    executed(page)


def test_a_real_robot_goes_on_with_no_other_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The simulation's is the one that the README begins, in a folder like its own."""
    monkeypatch.chdir(tmp_path)
    page = executed("docs/real-robot.md")
    robot = page["StandIn"](seed=1)
    begin(Path("simulated"), task_scenario("serve")).close()
    RunFolder.create(Path("longer"), page["ABOUT"] + "and: more\n").close()
    for foreign in ("simulated", "longer"):
        with pytest.raises(RunFolderError, match=f"^{foreign}: holds a run of something else"):
            page["run"](Path(foreign), robot, max_trials=1)
        assert read_trials(Path(foreign)) == []
    assert robot.trials == 0


def keys(values: Page, prefix: str = "") -> set[str]:
    """Full keys of a scenario, down to what is no mapping."""
    found: set[str] = set()
    for key, value in values.items():
        inner = isinstance(value, dict) and value
        found |= keys(value, f"{prefix}{key}.") if inner else {f"{prefix}{key}"}
    return found


def documented(task: str, column: int = 2) -> dict[str, str]:
    """Full keys in the tables of a task's scenario, and what a column says: 2 the default."""
    title = task.capitalize()
    found, section = {}, None
    for line in PAGES["docs/scenario.md"].splitlines():
        if heading := re.fullmatch(r"##+ (.*)", line):
            name = re.fullmatch(rf"{title}: (?:top level|`(.+)`)", heading[1])
            section = None if name is None else f"{name[1]}." if name[1] else ""
        elif section is not None and (row := re.match(r"\| `(\w+)` \|", line)):
            found[section + row[1]] = re.split(r" *(?<!\\)\| ?", line)[column]
    return found


@pytest.mark.parametrize("task", TASKS)
def test_the_scenarios_page_has_every_key_and_its_default(task: str) -> None:
    values = yaml.safe_load(dump_scenario(TASKS[task].scenario()))
    drakes = {"plant": values.pop("plant"), "simulator": values.pop("simulator")}
    told = documented(task)
    there = keys(values)
    optional = {key for key, default in told.items() if default == "–"}
    assert set(told) == there | optional | set(drakes)
    for key in there:
        value: Any = values
        for word in key.split("."):
            value = value[word]
        assert yaml.safe_load(told[key].strip("`")) == value, key
    page = PAGES["docs/scenario.md"]
    assert [key for key in sorted(keys(drakes)) if f"`{key}`" not in page] == []
    for key in optional:
        task_scenario(task, changes={key: 0.5})  # there is such a key


@pytest.mark.parametrize("task", TASKS)
def test_the_scenarios_page_has_the_units_of_the_code(task: str) -> None:
    for key, unit in documented(task, column=3).items():
        part = TASKS[task].scenario()
        *above, name = key.split(".")
        for word in above:
            part = getattr(part, word)
        meaning = meanings(type(part))[name]
        told = set(re.findall(r"\[([^\]]+)\]", meaning))
        assert (unit in told) if unit else not {u for u in told if re.fullmatch(r"\S{1,5}", u)}, key


def test_the_scenarios_page_says_what_the_robots_changes() -> None:
    part = PAGES["docs/scenario.md"].partition("### What the robot's scenario changes")[2]
    told = dict(re.findall(r"\| `([\w.]+)` \| `(.+?)` \|", part.partition("\n## ")[0]))
    robots = ROOT / "models" / "scenarios" / "serve_robot.yaml"
    plain = yaml.safe_load(dump_scenario(TASKS["serve"].scenario()))
    scenario = yaml.safe_load(dump_scenario(task_scenario("serve", robots)))

    def at(values: Any, key: str) -> Any:
        for word in key.split("."):
            values = values[word]
        return values

    changed = {k: at(scenario, k) for k in keys(plain) if at(scenario, k) != at(plain, k)}
    assert {key: yaml.safe_load(value) for key, value in told.items()} == changed


@pytest.mark.parametrize(("run", "parts"), [("serve", "A serve"), ("upswing", "An upswing")])
def test_the_run_folders_page_has_every_field_of_a_line(run: str, parts: str) -> None:
    scenario = task_scenario(run)
    task = TASKS[run].task(scenario, None, None)
    record = task.execute(task.via_points, 0).record()
    page = PAGES["docs/run-folder.md"]
    told = page.partition("## Every line")[2].partition("\n## ")[0]
    told += page.partition(f"## {parts}\n")[2].partition("\n## ")[0]
    assert [name for name in record if f"`{name}`" not in told] == []


def test_the_studies_page_has_every_column() -> None:
    study = Study("serve", {}, {"all": {}}, {}, 1, 1, ())
    assert [c for c in study.columns() if f"`{c}`" not in PAGES["docs/study.md"]] == []


def test_every_module_has_its_page() -> None:
    """A page shows a sub-package with all its modules, so each sub-package needs one."""
    package = ROOT / "drake_viapoint"
    parts = {path.parent.name for path in package.glob("*/__init__.py")} - {"cli"}
    parts |= {path.stem for path in package.glob("*.py")} - {"__init__"}
    shown = {
        name
        for page, text in PAGES.items()
        for name in re.findall(r"(?m)^::: drake_viapoint\.(\w+)$", text)
        if page.startswith("docs/api/")
    }
    assert shown == parts
    for name in parts:
        assert import_module(f"drake_viapoint.{name}").__doc__
