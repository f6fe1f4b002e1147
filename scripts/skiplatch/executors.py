"""Where tasks run: processes here or a cluster, behind one kind of executor.

Pebble runs the processes, Dask the cluster; both as `concurrent.futures` has it.
"""

import hashlib
import os
import platform
import re
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import scipy
from pebble import ProcessPool
from threadpoolctl import threadpool_limits

from skiplatch.errors import InputError

Result = TypeVar("Result")

ANSWER_S = 30.0
"""So long a scheduler may take to answer, or to come back."""
REACHABLE = ("running", "connecting")
"""States of a client of Dask in which it still sends tasks, now or once it is connected again."""
OUT_OF_TIME = 124
"""Exit status of a worker whose task took too long, as of the command `timeout`."""
LOGGERS = ("distributed", "distributed.client")
"""Loggers of Dask to which its own configuration gives a level: one does not silence the other."""
TRIMMING = "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_"
"""Setting of Dask by which workers give memory back at once, and take it anew for each array.

A campaign of 400 touches then has 250,000 faults of pages in place of 28,000.
"""
PROFILING = "distributed.worker.profile.enabled"
"""Setting of Dask by which a worker looks at its task 100 times a second: 7 % of its time.

The deeper the calls of a task, the longer it is held up; only a dashboard would show what was seen.
"""
LOCAL = re.compile(r"local:([1-9][0-9]{0,3})")
MISSING = "not installed; pip install 'skiplatch[cluster]' brings it"


class ForeignWorkerError(InputError):
    """A worker has other software, so that its results could be others."""


class Processes(Executor):
    """Processes on this machine, begun from one that has no threads."""

    def __init__(self, jobs: int, limit_s: float, loads: str) -> None:
        context = get_context("forkserver")
        context.set_forkserver_preload([loads])
        self._limit_s = limit_s
        self._pool: Any = ProcessPool(  # not all of it has types
            max_workers=jobs,
            initializer=_one_thread,
            context=context,
        )

    def submit(
        self,
        fn: Callable[..., Result],
        /,
        *args: Any,  # noqa: ANN401 - as the base
        **kwargs: Any,  # noqa: ANN401 - likewise
    ) -> "Future[Result]":
        """Give a task to the next process that is free."""
        future: Future[Result] = self._pool.schedule(fn, args, kwargs, self._limit_s)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002
        """End the processes: after what was submitted, or at once."""
        if cancel_futures:
            self._pool.stop()
        else:
            self._pool.close()
        if wait:
            self._pool.join()


class Cluster(Executor):
    """A Dask cluster. Its scheduler gives tasks of workers that died to others."""

    def __init__(self, client: Any, address: str, limit_s: float) -> None:  # noqa: ANN401 - an extra
        self._client, self._address, self._limit_s = client, address, limit_s

    def submit(
        self,
        fn: Callable[..., Result],
        /,
        *args: Any,  # noqa: ANN401 - as the base
        **kwargs: Any,  # noqa: ANN401 - likewise
    ) -> "Future[Result]":
        """Send a task to the scheduler.

        Raises:
            InputError: The scheduler was lost, and did not come back.
        """
        if self._client.status not in REACHABLE:
            message = f"the scheduler was lost, and did not come back within {ANSWER_S:g} s"
            raise InputError(self._address, None, None, message)
        answer: Future[Result] = Future()
        words = software(), self._limit_s, fn, args, kwargs
        self._client.submit(_on_worker, *words, pure=False).add_done_callback(
            lambda asked: _pass_on(asked, answer)
        )
        return answer

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002
        """Do nothing: what is still under way ends with the client."""


@contextmanager
def client_of(address: str) -> Iterator[Any]:
    """Give a client of the scheduler at an address, or of a cluster that is started here.

    Raises:
        InputError: No cluster answers there, or what it takes is not installed.
    """
    distributed = _distributed()
    local = LOCAL.fullmatch(address)
    if local is None:
        with _connected(distributed, address) as client:
            yield client
        return
    with (
        _started(distributed, address, int(local[1])) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        yield client


def _pass_on(asked: Any, answer: "Future[Any]") -> None:  # noqa: ANN401 - a future of Dask
    """Give on what came of a task; `ClientExecutor` of Dask forgets those of a lost scheduler."""
    try:
        answer.set_result(asked.result())
    except BaseException as error:  # noqa: BLE001 - whatever it was, it is told
        answer.set_exception(error)


def _started(distributed: Any, address: str, workers: int) -> Any:  # noqa: ANN401 - an optional extra
    try:
        return distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=":0"
        )
    except RuntimeError as error:
        raise InputError(address, None, None, str(error)) from error


def _distributed() -> Any:  # noqa: ANN401 - an optional extra
    """Import Dask, whose loggers tell in many lines what is told here in one."""
    try:
        import dask  # noqa: PLC0415 - an optional extra

        quiet = {"logging": dict.fromkeys(LOGGERS, "critical")}
        dask.config.set({**quiet, TRIMMING: None, PROFILING: False})
        import distributed  # noqa: PLC0415 - reads its configuration then
    except ImportError as error:
        raise InputError("distributed", None, None, MISSING) from error
    return distributed


def _connected(distributed: Any, address: str) -> Any:  # noqa: ANN401 - an optional extra
    try:
        return distributed.Client(address, timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError) as error:
        said = f"no Dask scheduler answers there within {ANSWER_S:g} s"
        raise InputError(address, None, None, said) from error


def _on_worker(
    wanted: str,
    limit_s: float,
    task: Callable[..., Result],
    args: Sequence[Any],
    kwargs: dict[str, Any],
) -> Result:
    """Do a task on a worker of a cluster, which dies if it takes too long."""
    if software() != wanted:
        raise ForeignWorkerError(
            platform.node(), None, None, f"its worker has {software()}; it wants {wanted}"
        )
    timer = threading.Timer(limit_s, os._exit, [OUT_OF_TIME])
    timer.daemon = True
    timer.start()
    try:
        with threadpool_limits(1):
            return task(*args, **kwargs)
    finally:
        timer.cancel()


def _one_thread() -> None:
    """Let products of matrices have one thread, for the same bits wherever they are made."""
    threadpool_limits(1)


@cache
def software() -> str:
    """Tell the software that results depend on to the last bit."""
    package = Path(__file__).parent
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        digest.update(f"{path.relative_to(package).as_posix()}\n".encode() + path.read_bytes())
    python = ".".join(platform.python_version_tuple()[:2])
    return (
        f"skiplatch {version('skiplatch')} ({digest.hexdigest()[:12]}), Python {python}, "
        f"numpy {np.__version__}, scipy {scipy.__version__}"
    )
