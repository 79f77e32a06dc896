"""Workers of a Dask cluster, anywhere, all of the same versions (optional extra ``cluster``)."""

from __future__ import annotations

import asyncio
import importlib
import logging
import warnings
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

from joblib import Parallel

from drake_viapoint import __name__ as package
from drake_viapoint.errors import ClusterError, VersionsError, ViapointError
from drake_viapoint.runs.study import StudyRun
from drake_viapoint.runs.study_run import StudyResult, StudyWork
from drake_viapoint.runs.task_run import versions
from drake_viapoint.runs.workers import WorkerDiedError, joblib_results

_ANSWER = 5.0  # [s] a scheduler has to answer
_COME = 10.0  # [s] a first worker has to come


class ClusterWorkers:
    """Threads of the workers that a Dask scheduler has.

    A worker that is killed is Dask's to replace.

    Args:
        address: Of the scheduler.
        client: Connected to it.
    """

    def __init__(self, address: str, client: Any) -> None:
        self.address = address
        self._client = client

    @property
    def number(self) -> int:
        """How many runs the workers execute at once."""
        return max(1, sum(map(int, self._client.ncores().values())))

    def results(
        self, work: StudyWork, groups: Iterable[Sequence[StudyRun]]
    ) -> Generator[StudyResult, None, None]:
        """See ``Workers``.

        Raises:
            ClusterError: The scheduler is gone, or a worker cannot execute runs at all.
        """
        from distributed.scheduler import KilledWorker

        from drake_viapoint.runs.cluster_backend import ClusterBackend

        parallel = Parallel(
            n_jobs=-1,
            backend=ClusterBackend(client=self._client),
            return_as="generator_unordered",
        )
        try:
            yield from joblib_results(parallel, work, groups, KilledWorker)
        except (ViapointError, WorkerDiedError, OSError):
            raise
        except Exception as error:
            raise _fault(self.address, f"or a worker of it failed: {_said(error)}") from error


@contextmanager
def cluster_workers(address: str) -> Iterator[ClusterWorkers]:
    """Connect to a scheduler and check its workers; leave it at the end.

    Workers of other versions are refused here, and refuse by themselves if they come later.

    Args:
        address: Of the scheduler, such as ``tcp://10.0.0.1:8786``.

    Raises:
        ClusterError: There is no scheduler, or it has no workers, or distributed is not installed.
        VersionsError: A worker is of other versions.
    """
    try:
        import distributed
    except ImportError as error:
        raise ClusterError(
            f"--scheduler needs distributed: pip install 'drake-viapoint[cluster]' ({error})"
        ) from error
    with _quiet():
        _check_scheduler(address)
        client = distributed.Client(address, timeout=_ANSWER, set_as_default=False)
        try:
            _check_workers(address, client)
            yield ClusterWorkers(address, client)
        finally:
            client.close(timeout=1)


def _check_scheduler(address: str) -> None:
    """Ask who is there: a client would ask for longer, and not go away when nobody answers."""
    with ThreadPoolExecutor(1) as thread:  # a notebook's own thread has a loop already
        try:
            kind = thread.submit(asyncio.run, _kind(address)).result()
        except OSError as error:
            raise _fault(address, f"does not answer within {_ANSWER:g} s") from error
        except Exception as error:  # what an address can be wrong in has no kind of its own
            raise _fault(address, f"is no address like tcp://10.0.0.1:8786: {error}") from error
    if kind != "Scheduler":
        raise _fault(address, f"is no scheduler, but a {kind}")


async def _kind(address: str) -> str:
    from distributed import rpc

    async def identity() -> str:
        async with rpc(address, timeout=_ANSWER) as there:
            return str((await there.identity())["type"])

    return await asyncio.wait_for(identity(), _ANSWER)


def _check_workers(address: str, client: Any) -> None:
    try:
        client.run_on_scheduler(importlib.import_module, package)
    except Exception as error:  # what another environment can lack has no kind of its own
        raise _fault(address, f"needs the package, too, to pass runs on: {_said(error)}") from error
    try:
        client.wait_for_workers(1, timeout=_COME)
    except TimeoutError as error:
        raise _fault(address, f"has no workers after {_COME:g} s") from error
    # In two steps, as what asks for versions is itself part of the package
    for call, arguments in ((importlib.import_module, (package,)), (versions, ())):
        answers: dict[str, Any] = client.run(call, *arguments, on_error="return")
        for worker, answer in answers.items():
            if isinstance(answer, BaseException):
                raise _fault(address, f"worker {worker} cannot be used: {_said(answer)}")
    for name, ours in versions().items():
        for worker, its in answers.items():
            if its.get(name) != ours:
                raise VersionsError(worker, name, its.get(name), ours)


def _fault(address: str, reason: str) -> ClusterError:
    return ClusterError(" ".join(f"scheduler {address} {reason}".split()))


def _said(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"


@contextmanager
def _quiet() -> Iterator[None]:
    """Without what distributed logs: what matters is raised, and said in one line."""
    loggers = [
        logging.getLogger(name)
        for name in logging.root.manager.loggerDict
        if name.split(".")[0] in ("distributed", "tornado", "asyncio")
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for logger in loggers:
            logger.disabled = True
        try:
            yield
        finally:
            for logger in loggers:
                logger.disabled = False
