"""Everything the paper has, from runs made here and now, on one page in one folder."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drake_viapoint.reproduction.experiments import BY_NAME, EXPERIMENTS, Experiment
from drake_viapoint.reproduction.findings import Findings
from drake_viapoint.reproduction.ledger import (
    Entry,
    Ledger,
    differences,
    models_digest,
    now_in_words,
    source_digest,
)
from drake_viapoint.reproduction.progress import Progress
from drake_viapoint.reproduction.report import write_report


@dataclass(frozen=True)
class Reproduced:
    """What became of one experiment in a call.

    Attributes:
        name: Of the experiment.
        unchanged: Whether it was there, and nothing had to be done.
        seconds: That it took, now or when it was made [s].
        findings: What it brought.
    """

    name: str
    unchanged: bool
    seconds: float
    findings: Findings


def reproduce(
    out: Path,
    sizes: Mapping[str, int],
    progress: Progress,
    say: Callable[[str], None] = lambda _: None,
) -> list[Reproduced]:
    """Make experiments that a folder lacks, and a page of all that it holds.

    An experiment is done again if its scenario or a version has changed: its earlier runs are moved
    to ``earlier/``, none is deleted. If only the code that draws has changed, or a file is gone, it
    is drawn anew from the runs that are there. A larger study than the one asked for stays.

    Args:
        out: Folder of figures, recordings, tables, runs, and of ``index.html``.
        sizes: How large each experiment is to be, by its name; others are left alone.
        progress: Shows what goes on.
        say: Told what is done, and what is not done and why.

    Raises:
        ViapointError: The folder cannot be written or holds runs that are not in its ledger.
    """
    ledger, source = Ledger(out), source_digest()
    plans = [_plan(ledger, BY_NAME[name], size, source) for name, size in sizes.items()]
    clock = _Clock(sum(plan.duration for plan in plans))
    done = []
    for number, plan in enumerate(plans, start=1):
        where = f"{plan.experiment.name} ({number} of {len(plans)}"
        if plan.kept is not None:
            say(f"{where}): as made {plan.kept.finished}; {plan.why}")
        else:
            say(f"{where}{clock.left()}): {plan.why}")
        done.append(_carry_out(plan, out, ledger, source, progress, say))
        if plan.kept is None:
            clock.passed(plan.duration)
        # as far as it goes: what comes later may be interrupted
        write_report(out, {e.name: ledger.read(e.name) for e in EXPERIMENTS})
    return done


@dataclass(frozen=True)
class _Plan:
    """What is to be done for an experiment, and why."""

    experiment: Experiment
    depends: Mapping[str, Any]
    size: int
    missing: int  # of its runs
    why: str
    kept: Entry | None = None  # what need not be done again
    outdated: bool = False  # whether runs of another scenario or version are in the way

    @property
    def duration(self) -> float:
        return 0.0 if self.kept else self.experiment.duration(self.missing)


def _plan(ledger: Ledger, experiment: Experiment, size: int, source: str) -> _Plan:
    depends = json.loads(json.dumps({**experiment.depends(), "models": models_digest()}))
    entry = ledger.read(experiment.name)
    counted = f"{size} {experiment.unit}" if experiment.unit else "one run"
    if entry is None:
        return _Plan(experiment, depends, size, size, counted)
    if changed := differences(entry.depends, depends):
        more = f" and {len(changed) - 3} more" if len(changed) > 3 else ""
        why = f"done again, as {', '.join(changed[:3])}{more}"
        return _Plan(experiment, depends, size, size, why, outdated=True)
    if entry.findings is None:
        return _Plan(experiment, depends, size, size, f"{counted}; going on")
    if size > entry.size:
        why = f"{counted}, of which {entry.size} are there"
        return _Plan(experiment, depends, size, size - entry.size, why)
    if missing := ledger.missing(entry.findings):
        why = f"drawn anew, as {missing[0]} is gone; its runs are kept"
        return _Plan(experiment, depends, entry.size, 0, why)
    if entry.source != source:
        why = "drawn anew, as the package's code has changed; its runs are kept"
        return _Plan(experiment, depends, entry.size, 0, why)
    larger = f" ({entry.size} {experiment.unit}, more than asked for)" if size < entry.size else ""
    why = f"nothing has changed, so it is not done again{larger}"
    return _Plan(experiment, depends, entry.size, 0, why, kept=entry)


def _carry_out(
    plan: _Plan,
    out: Path,
    ledger: Ledger,
    source: str,
    progress: Progress,
    say: Callable[[str], None],
) -> Reproduced:
    name, kept = plan.experiment.name, plan.kept
    if kept is not None and kept.findings is not None:
        return Reproduced(name, True, kept.seconds, kept.findings)
    if plan.outdated and (aside := ledger.set_aside(plan.experiment.runs)):
        say(f"  its earlier runs are in {aside}")
    ledger.write(name, Entry(plan.depends, plan.size, source))
    began = time.monotonic()
    findings = plan.experiment.make(out, plan.size, progress)
    seconds = time.monotonic() - began
    entry = Entry(plan.depends, plan.size, source, now_in_words(), seconds, findings)
    ledger.write(name, entry)
    for line in (*findings.lines, *findings.where):
        say(f"  {line}")
    return Reproduced(name, False, seconds, findings)


class _Clock:
    """Tells how much time is left, from how long what is done took."""

    def __init__(self, expected: float) -> None:
        self._began = time.monotonic()
        self._expected = expected
        self._passed = 0.0

    def passed(self, expected: float) -> None:
        """Something is done that was expected to take so long [s]."""
        self._passed += expected

    def left(self) -> str:
        """In words."""
        pace = (time.monotonic() - self._began) / self._passed if self._passed else 1.0
        minutes = pace * (self._expected - self._passed) / 60
        return f", about {minutes:.0f} min left" if minutes >= 1.5 else ", about a minute left"
