"""joblib's Dask backend, told of runs that Dask gives up."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, NamedTuple

from joblib._dask import DaskDistributedBackend

from drake_viapoint.errors import ClusterError


class _GivenUp(NamedTuple):
    error: BaseException


class ClusterBackend(DaskDistributedBackend):
    """The same, but an error of Dask itself is an error of the sweep.

    joblib's own waits for ever: it hears of tasks that return, even with an exception, but not of
    those whose workers were killed, nor of those that cannot be unpickled, nor of a scheduler that
    is gone (joblib 1.5).
    """

    def effective_n_jobs(self, n_jobs: int) -> int:
        """Threads of the workers, but never 1: joblib would do all runs in its own process."""
        return max(2, int(super().effective_n_jobs(n_jobs)))

    def submit(self, func: Any, callback: Callable[[Any], Any] | None = None) -> Any:
        """Submit a batch of tasks."""
        future = super().submit(func, callback)
        if callback is not None:

            def say(done: Future[Any]) -> None:
                error = done.exception()
                if error is not None:
                    callback(_GivenUp(error))

            future.add_done_callback(say)
        return future

    def retrieve_result_callback(self, out: Any) -> Any:
        """Results of a batch; raises what made Dask give it up."""
        if isinstance(out, _GivenUp):
            raise out.error
        results = super().retrieve_result_callback(out)
        if not isinstance(results, list):  # a future that was cancelled
            raise ClusterError(f"the scheduler lost tasks: {results}")
        return results
