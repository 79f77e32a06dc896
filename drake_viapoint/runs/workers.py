"""Workers of a sweep: what they offer, those of this machine, and what becomes of their deaths."""

from __future__ import annotations

import contextlib
import logging
import signal
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from itertools import groupby
from multiprocessing import resource_tracker
from typing import Protocol

from joblib import Parallel, delayed
from joblib.externals.loky.process_executor import ShutdownExecutorError

from drake_viapoint.runs.study import StudyRun
from drake_viapoint.runs.study_run import StudyResult, StudyWork, execute, row_without_result

_GROUPS = 4  # for each worker, at least, where runs are grouped
_DEATHS = 3  # of workers that had a run in hand, before it is tried alone


class WorkerDiedError(Exception):
    """A worker was killed, or died by itself; never seen outside a sweep."""


class Workers(Protocol):
    """Processes that execute runs."""

    @property
    def number(self) -> int:
        """How many runs they execute at once."""
        ...

    def results(
        self, work: StudyWork, groups: Iterable[Sequence[StudyRun]]
    ) -> Generator[StudyResult, None, None]:
        """Execute runs, in any order; results come as they land, a group at a time.

        Raises:
            WorkerDiedError: A worker died. What it had in hand is lost.
        """
        ...


class LocalWorkers:
    """Processes of this machine, kept and fed by joblib's loky.

    Args:
        number: Of processes; with 1 the runs are executed in this one.
    """

    def __init__(self, number: int) -> None:
        self.number = number

    def results(
        self, work: StudyWork, groups: Iterable[Sequence[StudyRun]]
    ) -> Generator[StudyResult, None, None]:
        """See ``Workers``."""
        parallel = Parallel(n_jobs=self.number, backend="loky", return_as="generator_unordered")
        return joblib_results(parallel, work, groups, BrokenProcessPool)


def joblib_results(
    parallel: Parallel,
    work: StudyWork,
    groups: Iterable[Sequence[StudyRun]],
    death: type[BaseException],
) -> Generator[StudyResult, None, None]:
    """Results of joblib's workers; they are stopped if the iterator is closed before its end."""
    with _quiet():
        with _interrupt_blocked():  # processes and threads inherit it: Ctrl-C is for this thread
            results = parallel(delayed(_in_turn)(execute, work, group) for group in groups)
        try:
            for group in results:
                yield from group
        except death as error:
            raise WorkerDiedError(str(error)) from error
        except GeneratorExit:
            with contextlib.suppress(KeyboardInterrupt):  # closing it would warn of what is lost
                results.throw(KeyboardInterrupt())
            raise


def _in_turn(
    execute_one: Callable[[StudyWork, StudyRun], StudyResult],
    work: StudyWork,
    group: Sequence[StudyRun],
) -> list[StudyResult]:
    return [execute_one(work, run) for run in group]


def results_despite_deaths(
    workers: Workers, work: StudyWork, runs: Iterable[StudyRun]
) -> Generator[StudyResult, None, None]:
    """Results of all runs, whatever kills workers.

    When a worker dies the others end with it; what was in hand is done again. A run that was in
    hand at three deaths is tried alone, and if its worker dies again, that is its result.
    """
    waiting = {run.name: run for run in runs}
    deaths: Counter[str] = Counter()
    while waiting:
        for name in [name for name in waiting if deaths[name] >= _DEATHS]:
            yield from _alone(workers, work, waiting.pop(name))
        in_hand: set[str] = set()
        groups = _groups(list(waiting.values()), work, workers.number)
        try:
            with contextlib.closing(workers.results(work, _handed_out(groups, in_hand))) as results:
                for result in results:
                    name = result.row["run"]
                    in_hand.discard(name)
                    del waiting[name]
                    yield result
        except WorkerDiedError:
            deaths.update(list(in_hand))


def _alone(workers: Workers, work: StudyWork, run: StudyRun) -> Generator[StudyResult, None, None]:
    # Never in this process, whatever the number of workers
    others = LocalWorkers(2) if isinstance(workers, LocalWorkers) else workers
    try:
        yield from others.results(work, [(run,)])
    except WorkerDiedError:
        yield StudyResult(row_without_result(work.study, run, "its worker died, time and again"))


def _groups(
    runs: Sequence[StudyRun], work: StudyWork, workers: int
) -> Sequence[Sequence[StudyRun]]:
    """Runs that one worker does one after the other.

    The conditions of one person share a demonstration, which takes half as long to watch as a run
    to make. Only where every run has a folder, so that nothing is lost with a group, and where
    there are groups enough to keep all workers busy to the end.
    """
    together = [tuple(group) for _, group in groupby(runs, lambda run: run.values)]
    if work.folder is None or len(together) < _GROUPS * workers:
        return [(run,) for run in runs]
    return together


def _handed_out(
    groups: Iterable[Sequence[StudyRun]], in_hand: set[str]
) -> Iterator[Sequence[StudyRun]]:
    for group in groups:
        in_hand.update(run.name for run in group)
        yield group


@contextlib.contextmanager
def _interrupt_blocked() -> Iterator[None]:
    resource_tracker.ensure_running()  # to begin it would unblock
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Without a traceback of joblib's feeding thread when workers are stopped under its hands."""

    def is_news(record: logging.LogRecord) -> bool:
        return not (record.exc_info and isinstance(record.exc_info[1], ShutdownExecutorError))

    logger = logging.getLogger("concurrent.futures")
    logger.addFilter(is_news)
    try:
        yield
    finally:
        logger.removeFilter(is_news)
