"""Is an installation sound? Versions, models, a trial against a stored one, and what shows it."""

from __future__ import annotations

import gc
import hashlib
import platform
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import yaml

from drake_viapoint.errors import ViapointError
from drake_viapoint.packages import models_path, resolve
from drake_viapoint.reproduction.page import new_page
from drake_viapoint.runs.study import canonical
from drake_viapoint.runs.task_run import versions
from drake_viapoint.tasks.catalogue import ROBOT_SERVE, TASKS, build_task, scenario_in

REFERENCE = "package://drake_viapoint/reference_trials.yaml"
"""Where the shipped scenarios' first trials end, and their bits by versions and machine."""

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
"""Names under which a Chromium may be found."""

_TESTED = ("1.51.1", "1.58.0")  # versions of Drake
_CLOSE = 1e-3  # of what a first trial ends with, in its own units
_VERSIONED = ("drake", "numpy", "scipy", "python")


@dataclass(frozen=True)
class Check:
    """What was found.

    Attributes:
        name: Of what was looked at.
        ok: Whether it is as it should be.
        detail: What was found, in words.
        needed: Whether the package cannot do without it.
    """

    name: str
    ok: bool
    detail: str
    needed: bool = True


def check_versions() -> Check:
    """Drake, and what else a trial's bits hang on."""
    found = versions()
    number = tuple(int(part) for part in found["drake"].split(".")[:2])
    words = ", ".join(f"{name} {version}" for name, version in found.items())
    if number < (1, 51):
        return Check("versions", False, f"{words}; Drake must be at least 1.51")
    note = "" if found["drake"] in _TESTED else f"; tested with Drake {' and '.join(_TESTED)}"
    return Check("versions", True, words + note)


def check_models() -> Check:
    """The models, and that a scene can be built of them."""
    try:
        for kind in TASKS.values():
            build_task(scenario_in(resolve(kind.shipped)))
        scenario_in(resolve(ROBOT_SERVE))
    except (ViapointError, RuntimeError) as error:  # Drake's parser raises the latter
        return Check("models", False, " ".join(str(error).split()))
    return Check("models", True, f"found in {models_path()}; {' and '.join(TASKS)} can be built")


def check_trial(task: str) -> Check:
    """That a task's first trial ends where it should, and with the bits it has elsewhere."""
    name, here = f"a trial of the {task}", this_kind()
    reference = _reference(task)
    end, digest = first_trial(task)
    off = float(np.max(np.abs(np.subtract(end, reference["end"]))))
    if not off < _CLOSE:
        return Check(name, False, f"ends at {end}, not at {reference['end']}")
    kinds = {tuple(_kind(row).values()): str(row["sha256"]) for row in reference["bits"]}
    stored = kinds.get(tuple(here.values()))
    words = ", ".join(f"{what} {value}" for what, value in here.items())
    near = f"ends within {off:.0e} of where it should"
    if stored is None:
        return Check(name, True, f"{near}; no bits are stored for {words}")
    if stored == digest:
        return Check(name, True, f"the bits stored for {words}")
    detail = f"{near}, but not with the bits stored for {words}: a run begun elsewhere would differ"
    return Check(name, False, detail, needed=False)


def check_meshcat() -> Check:
    """That Meshcat finds a port to show things on."""
    try:
        page = new_page()
        address = page.web_url()
    except RuntimeError as error:
        return Check("Meshcat", False, " ".join(str(error).split()))
    del page
    gc.collect()  # it ends here, in the thread it began in
    return Check("Meshcat", True, f"shows at {address} when asked")


def check_browser() -> Check:
    """A Chromium, in which the tests look at pages and recordings."""
    found = browser()
    missing = "not found: tests of pages and recordings skip"
    return Check("Chromium", found is not None, found or missing, needed=False)


def check_graphviz() -> Check:
    """Graphviz, by which notebooks draw diagrams."""
    found = shutil.which("dot")
    missing = "not found: notebooks draw no diagrams"
    return Check("Graphviz", found is not None, found or missing, needed=False)


CHECKS: tuple[Callable[[], Check], ...] = (
    check_versions,
    check_models,
    *(partial(check_trial, task) for task in TASKS),
    check_meshcat,
    check_browser,
    check_graphviz,
)
"""All checks, cheap ones first."""


def browser() -> str | None:
    """Path of a Chromium; None if there is none."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


def first_trial(task: str) -> tuple[list[float], str]:
    """Where the first trial of a task's shipped scenario ends, and the digest of its bits.

    Args:
        task: Its name.

    Returns:
        The last subtask's task variable, and a digest of the whole record.
    """
    made = build_task(scenario_in(resolve(TASKS[task].shipped)))
    record = made.execute(made.via_points, 0).record()
    digest = hashlib.sha256(canonical(record).encode()).hexdigest()
    return list(record[made.subtasks[-1].task_variable]), digest


def this_kind() -> dict[str, str]:
    """What the bits of a trial hang on here."""
    found = versions()
    return {**{name: found[name] for name in _VERSIONED}, "machine": platform.machine()}


def _kind(row: Mapping[str, Any]) -> dict[str, str]:
    return {name: str(row[name]) for name in (*_VERSIONED, "machine")}


def _reference(task: str) -> Mapping[str, Any]:
    data = yaml.safe_load(resolve(REFERENCE).read_text(encoding="utf-8"))
    reference: Mapping[str, Any] = data[task]
    return reference
