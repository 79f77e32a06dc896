"""Beginning, resuming and reading the runs of any task."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from drake_viapoint import __version__
from drake_viapoint.errors import RunFolderError
from drake_viapoint.runs.run_folder import SCENARIO, RunFolder
from drake_viapoint.tasks.catalogue import scenario_in, task_scenario
from drake_viapoint.tasks.scenario import Scenario, dump_scenario

S = TypeVar("S", bound=Scenario)


def begin(path: Path, scenario: Scenario) -> RunFolder:
    """A new run's folder, its scenario complete with versions.

    Raises:
        RunFolderError: The folder holds something or cannot be written.
    """
    scenario.made_with = versions()
    return RunFolder.create(path, dump_scenario(scenario))


def has_run(path: Path) -> bool:
    """Whether a folder holds a run, whole or interrupted: the last of its files that is made."""
    return (path / SCENARIO).exists()


def resume(
    path: Path,
    task: str | None = None,
    file: Path | None = None,
    changes: Mapping[str, object] | None = None,
) -> tuple[RunFolder, Any]:
    """An interrupted run's folder and scenario.

    Args:
        path: The folder.
        task: Must be the folder's; any if None.
        file: A scenario; with the changes it must be the folder's. The folder's own if None.
        changes: Must agree with the folder's scenario.

    Raises:
        RunFolderError: No run, a run of other versions, or a task, a file or changes of another.
    """
    folder = RunFolder.open(path)
    try:
        scenario = read_scenario(path)
        if task is not None and scenario.task != task:
            raise RunFolderError(path, f"holds a run of the {scenario.task}, not of the {task}")
        made_with, now = scenario.made_with, versions()
        for name in sorted(now):
            if made_with.get(name) != now[name]:
                raise RunFolderError(
                    path,
                    f"was made with {name} {made_with.get(name)}, this is {now[name]}: its trials "
                    "would differ in their last bits",
                )
        asked = task_scenario(scenario.task, file or path / SCENARIO, changes)
        asked.made_with = made_with
        if dump_scenario(asked) != dump_scenario(scenario):
            what = "scenario" if file is not None else ", ".join(changes or {})
            raise RunFolderError(path, f"holds a run of another {what}; name another folder")
    except BaseException:
        folder.close()
        raise
    return folder, scenario


def begin_or_resume(path: Path, scenario: S) -> tuple[RunFolder, S]:
    """The run of a scenario in a folder: gone on with if it is there, begun if not.

    Raises:
        RunFolderError: The folder holds another scenario's run, or cannot be written.
    """
    if not has_run(path):
        return begin(path, scenario), scenario
    folder, recorded = resume(path)
    scenario.made_with = recorded.made_with
    if dump_scenario(recorded) != dump_scenario(scenario):
        folder.close()
        raise RunFolderError(path, "holds a run of another scenario; name another folder")
    return folder, recorded


def read_scenario(path: Path) -> Any:
    """The scenario in a run's folder.

    Raises:
        RunFolderError: There is none.
        ScenarioError: It is damaged.
    """
    if not (path / SCENARIO).is_file():
        raise RunFolderError(path, f"holds no run: there is no {SCENARIO}")
    return scenario_in(path / SCENARIO)


def versions() -> dict[str, str]:
    """What a trial's bits may depend on."""
    packages: dict[str, Any] = {name: version(name) for name in ("drake", "numpy", "scipy")}
    python = ".".join(platform.python_version_tuple()[:2])
    return {"drake_viapoint": __version__, "python": python, **packages}
