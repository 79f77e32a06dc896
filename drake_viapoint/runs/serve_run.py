"""Beginning, resuming and reading runs of the serve."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from drake_viapoint import __version__
from drake_viapoint.errors import RunFolderError
from drake_viapoint.packages import resolve
from drake_viapoint.runs.run_folder import SCENARIO, RunFolder
from drake_viapoint.tasks.scenario import dump_scenario, load_scenario
from drake_viapoint.tasks.serve_scenario import ServeScenario

SHIPPED = "package://drake_viapoint/scenarios/serve.yaml"
"""Address of the scenario that is used when none is named."""


@dataclass(frozen=True)
class ServeChanges:
    """What a caller may want different from a scenario file; None keeps the file's value."""

    person: int | None = None
    seed: int | None = None
    demonstration: Path | None = None
    hit_time: float | None = None

    def apply(self, scenario: ServeScenario) -> None:
        """Change the scenario and check it again."""
        watched = scenario.demonstration
        if self.person is not None:
            watched.person = self.person
        if self.demonstration is not None:
            watched.file = str(self.demonstration.absolute())
            watched.person = 0
        if self.hit_time is not None:
            watched.hit_time = self.hit_time
        if self.seed is not None:
            scenario.seed = self.seed
        scenario.validate()


def serve_scenario(path: Path | None = None, changes: ServeChanges | None = None) -> ServeScenario:
    """The scenario of a file, the shipped one if None, with changes.

    Raises:
        ScenarioError: The file or a change is not valid.
    """
    scenario = load_scenario(path or resolve(SHIPPED), ServeScenario)
    (changes or ServeChanges()).apply(scenario)
    return scenario


def begin(path: Path, scenario: ServeScenario) -> RunFolder:
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
    path: Path, file: Path | None = None, changes: ServeChanges | None = None
) -> tuple[RunFolder, ServeScenario]:
    """An interrupted run's folder and scenario.

    Args:
        path: The folder.
        file: A scenario; with the changes it must be the folder's. The folder's own if None.
        changes: Must agree with the folder's scenario.

    Raises:
        RunFolderError: No run, a run of other versions, or a file or changes of another run.
    """
    folder = RunFolder.open(path)
    try:
        scenario = read_scenario(path)
        made_with, now = scenario.made_with, versions()
        for name in sorted(now):
            if made_with.get(name) != now[name]:
                raise RunFolderError(
                    path,
                    f"was made with {name} {made_with.get(name)}, this is {now[name]}: its trials "
                    "would differ in their last bits",
                )
        asked = load_scenario(file or path / SCENARIO, ServeScenario)
        (changes or ServeChanges()).apply(asked)
        asked.made_with = made_with
        if dump_scenario(asked) != dump_scenario(scenario):
            what = "scenario" if file is not None else "person, seed or demonstration"
            raise RunFolderError(path, f"holds a run of another {what}; name another folder")
    except BaseException:
        folder.close()
        raise
    return folder, scenario


def begin_or_resume(path: Path, scenario: ServeScenario) -> tuple[RunFolder, ServeScenario]:
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


def read_scenario(path: Path) -> ServeScenario:
    """The scenario in a run's folder.

    Raises:
        RunFolderError: There is none.
        ScenarioError: It is damaged.
    """
    if not (path / SCENARIO).is_file():
        raise RunFolderError(path, f"holds no run: there is no {SCENARIO}")
    return load_scenario(path / SCENARIO, ServeScenario)


def versions() -> dict[str, str]:
    """What a trial's bits may depend on."""
    packages: dict[str, Any] = {name: version(name) for name in ("drake", "numpy", "scipy")}
    python = ".".join(platform.python_version_tuple()[:2])
    return {"drake_viapoint": __version__, "python": python, **packages}
