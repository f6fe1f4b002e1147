"""Workers that tasks are spread over: processes here, or a cluster, behind one kind of executor.

Pebble runs the processes, Dask the cluster; both as `concurrent.futures` has it. A task that its
worker dies of, or that takes too long, costs nothing but itself.
"""

import hashlib
import os
import platform
import queue
import re
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from itertools import islice
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
import scipy
from pebble import ProcessExpired, ProcessPool
from threadpoolctl import threadpool_limits

from skiplatch.errors import InputError, one_line
from skiplatch.simulator import SimulationError

Result = TypeVar("Result")

TRIES = 3
"""So often a task is tried: a worker that dies of something else rarely dies of it twice."""
LIMIT_S = 3600.0
"""After so long a task hangs: a campaign of 100,000 touches takes a minute."""
MOST_UNDER_WAY = 4096
"""Tasks that a scheduler knows at a time: enough for 2,000 workers, in some 200 MB."""
ANSWER_S = 30.0
"""So long a scheduler may take to answer, or to come back."""
REACHABLE = ("running", "connecting")
"""States of a client of Dask in which it still sends tasks, now or once it is connected again."""
OUT_OF_TIME = 124
"""Exit status of a worker whose task took too long, as of the command `timeout`."""
LOCAL = re.compile(r"local:([1-9][0-9]{0,3})")
MISSING = "not installed; pip install 'skiplatch[cluster]' brings it"


@dataclass(frozen=True, slots=True, kw_only=True)
class Workers:
    """Where tasks run.

    Attributes:
        jobs: Processes on this machine.
        cluster: What runs them instead: `local:N`, or the address of a Dask scheduler.
        limit_s: A task that takes longer is ended.
        loads: The module of the tasks; processes on this machine are forked from one that has it.
    """

    jobs: int = 1
    cluster: str | None = None
    limit_s: float = LIMIT_S
    loads: str = __name__


@dataclass(frozen=True, slots=True)
class Failed:
    """A task that gives no result."""

    why: str


class ForeignWorkerError(InputError):
    """A worker has other software, so that its results could be others."""


@contextmanager
def opened(workers: Workers) -> Iterator[Executor]:
    """Start what runs the tasks, and end it.

    Raises:
        InputError: No cluster answers there, or what it takes is not installed.
    """
    if workers.cluster is None:
        yield from _ended(_Processes(workers))
    else:
        with _client(workers.cluster) as client:
            yield from _ended(_Cluster(client, workers.cluster, workers.limit_s))


def finished(
    executor: Executor, task: Callable[..., Result], arguments: Sequence[Sequence[object]]
) -> Iterator[tuple[int, Result | Failed]]:
    """Give what comes of a task for each of several arguments, as it comes, with their number.

    A task whose worker was lost is tried again.

    Raises:
        ForeignWorkerError: See there.
    """
    yield from _Round(executor, task, arguments).finished()


def in_order(
    executor: Executor,
    task: Callable[..., Result],
    arguments: Sequence[Sequence[object]],
    name: str,
) -> Iterator[Result]:
    """Give what comes of a task for each of several arguments, in their order.

    Args:
        executor: Where they run.
        task: What is done.
        arguments: For each task.
        name: What a task is called, before its number.

    Raises:
        InputError: A task gives no result.
    """
    waiting: dict[int, Result] = {}
    following = 0
    for number, result in finished(executor, task, arguments):
        if isinstance(result, Failed):
            raise InputError(f"{name} {number + 1}", None, None, result.why)
        waiting[number] = result
        while following in waiting:
            yield waiting.pop(following)
            following += 1


class _Round(Generic[Result]):
    """Tasks on their way; what is done comes by a queue, so that many cost no more each."""

    def __init__(
        self, executor: Executor, task: Callable[..., Result], arguments: Sequence[Sequence[object]]
    ) -> None:
        self._executor, self._task, self._arguments = executor, task, arguments
        self._done: queue.SimpleQueue[tuple[int, Future[Result]]] = queue.SimpleQueue()
        self._tries = [0] * len(arguments)

    def finished(self) -> Iterator[tuple[int, Result | Failed]]:
        numbers = iter(range(len(self._arguments)))
        for number in islice(numbers, MOST_UNDER_WAY):
            self._submit(number)
        left = len(self._arguments)
        while left:
            number, future = self._done.get()
            why = _lost(future)
            if why and self._tries[number] < TRIES:
                self._submit(number)
                continue
            for following in islice(numbers, 1):
                self._submit(following)
            left -= 1
            if why:
                yield number, Failed(f"{why}, {TRIES} times")
            else:
                yield number, self._outcome(future)

    def _submit(self, number: int) -> None:
        self._tries[number] += 1
        future = self._executor.submit(self._task, *self._arguments[number])
        future.add_done_callback(lambda done: self._done.put((number, done)))

    @staticmethod
    def _outcome(future: "Future[Result]") -> Result | Failed:
        error = future.exception()
        if error is None:
            return future.result()
        if isinstance(error, ForeignWorkerError):
            raise error
        if isinstance(error, ModuleNotFoundError):
            raise ForeignWorkerError("worker", None, None, f"{error}; it wants {software()}")
        is_told = isinstance(error, InputError | SimulationError | OSError)
        return Failed(one_line(str(error) if is_told else f"{type(error).__name__}: {error}"))


def _lost(future: "Future[Any]") -> str:
    """Say what a task was lost by that may go well another time; nothing if it ended."""
    error = future.exception()
    if isinstance(error, CancelledError):
        return "the scheduler was lost"
    if isinstance(error, TimeoutError):
        return "it took too long"
    if isinstance(error, MemoryError):
        return "it ran out of memory"
    if isinstance(error, ProcessExpired) or type(error).__name__ == "KilledWorker":
        return "its worker died, as out of memory or time"
    return ""


class _Processes(Executor):
    """Processes on this machine, begun from one that has no threads."""

    def __init__(self, workers: Workers) -> None:
        context = get_context("forkserver")
        context.set_forkserver_preload([workers.loads])
        self._limit_s = workers.limit_s
        self._pool: Any = ProcessPool(  # not all of it has types
            max_workers=workers.jobs,
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
        future: Future[Result] = self._pool.schedule(fn, args, kwargs, self._limit_s)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002
        if cancel_futures:
            self._pool.stop()
        else:
            self._pool.close()
        if wait:
            self._pool.join()


class _Cluster(Executor):
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


def _pass_on(asked: Any, answer: "Future[Any]") -> None:  # noqa: ANN401 - a future of Dask
    """Give on what came of a task; `ClientExecutor` of Dask forgets those of a lost scheduler."""
    try:
        answer.set_result(asked.result())
    except BaseException as error:  # noqa: BLE001 - whatever it was, it is told
        answer.set_exception(error)


def _ended(executor: Executor) -> Iterator[Executor]:
    try:
        yield executor
    except BaseException:
        executor.shutdown(cancel_futures=True)
        raise
    executor.shutdown()


@contextmanager
def _client(address: str) -> Iterator[Any]:
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

        dask.config.set({"logging": {"distributed": "critical"}})
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
