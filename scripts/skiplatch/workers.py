"""Workers that tasks are spread over, wherever they run: `executors` has the places.

A task that its worker dies of, or that takes too long, costs nothing but itself. Dask blames such a
death on all tasks that the worker had. So tasks that it gives up are tried again one at a time.
"""

import queue
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Generic, TypeVar

import click
from pebble import ProcessExpired

from skiplatch.errors import InputError, as_told, one_line
from skiplatch.executors import Cluster, ForeignWorkerError, Processes, client_of, software
from skiplatch.simulator.library import SimulationError

Result = TypeVar("Result")

TRIES = 3
"""So often a task is tried: a worker that dies of something else rarely dies of it twice."""
LIMIT_S = 3600.0
"""After so long a task hangs: a campaign of 100,000 touches takes a minute."""
MOST_UNDER_WAY = 4096
"""Tasks that a scheduler knows at a time: enough for 2,000 workers, in some 200 MB."""


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


class Keeper:
    """Keeps what is done, so that the same command goes on where it was cut; this one nothing."""

    folder: Path | None = None

    def key(self, _task: Callable[..., object], _arguments: Sequence[object]) -> str:
        """Tell a result from all others."""
        return ""

    def keep(self, _key: str, _result: object) -> None:
        """Keep a result, whatever comes."""

    def recall(self, _key: str) -> tuple[Any] | None:
        """Give a result that was kept; None if it was not."""
        return None


NOT_KEPT = Keeper()


@contextmanager
def opened(workers: Workers) -> Iterator[Executor]:
    """Start what runs the tasks, and end it.

    Raises:
        InputError: No cluster answers there, or what it takes is not installed.
    """
    if workers.cluster is None:
        yield from _ended(Processes(workers.jobs, workers.limit_s, workers.loads))
    else:
        with client_of(workers.cluster) as client:
            yield from _ended(Cluster(client, workers.cluster, workers.limit_s))


def _ended(executor: Executor) -> Iterator[Executor]:
    try:
        yield executor
    except BaseException:
        executor.shutdown(cancel_futures=True)
        raise
    executor.shutdown()


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
    names: Sequence[str],
    keeper: Keeper = NOT_KEPT,
) -> Iterator[Result]:
    """Give what comes of a task for each of several arguments, in their order.

    Args:
        executor: Where they run.
        task: What is done.
        arguments: For each task.
        names: What each task is called.
        keeper: Keeps what is done; what it has is not done again.

    Raises:
        InputError: Some give no result, which is told of each; the others are done and kept.
    """
    keys = [keeper.key(task, one) for one in arguments]
    missing = [number for number, key in enumerate(keys) if keeper.recall(key) is None]
    waiting: dict[int, Result] = {}
    failed: dict[int, InputError] = {}
    following = 0
    coming = finished(executor, task, [arguments[number] for number in missing])
    undone = set(missing)
    for place, result in coming:
        number = missing[place]
        if isinstance(result, Failed):
            failed[number] = InputError(names[number], None, None, result.why)
            waiting.clear()
            continue
        keeper.keep(keys[number], result)
        if failed:  # nothing more is given, so nothing has to wait
            continue
        waiting[number] = result
        while following < len(keys) and (following in waiting or following not in undone):
            yield _next(following, waiting, keeper, keys)
            following += 1
    if failed:
        _refuse([failed[number] for number in sorted(failed)], len(keys) - len(failed), keeper)
    yield from (_next(number, waiting, keeper, keys) for number in range(following, len(keys)))


def _next(number: int, waiting: dict[int, Result], keeper: Keeper, keys: Sequence[str]) -> Result:
    if number in waiting:
        return waiting.pop(number)
    kept = keeper.recall(keys[number])
    if kept is None:
        raise InputError(keeper.folder or "answers", None, None, "an answer was taken away")
    result: Result = kept[0]
    return result


def _refuse(failed: Sequence[InputError], done: int, keeper: Keeper) -> None:
    for error in failed[:-1]:
        click.echo(as_told(error), err=True)
    if keeper.folder is not None:
        click.echo(f"{done} done are kept in {keeper.folder}; the same command goes on", err=True)
    raise failed[-1]


class _Round(Generic[Result]):
    """Tasks on their way; what is done comes by a queue, so that many cost no more each."""

    def __init__(
        self, executor: Executor, task: Callable[..., Result], arguments: Sequence[Sequence[object]]
    ) -> None:
        self._executor, self._task, self._arguments = executor, task, arguments
        self._done: queue.SimpleQueue[tuple[int, Future[Result]]] = queue.SimpleQueue()
        self._tries = [0] * len(arguments)
        self._fresh = iter(range(len(arguments)))
        self._suspects: deque[int] = deque()
        self._under_way = 0

    def finished(self) -> Iterator[tuple[int, Result | Failed]]:
        self._submit_fresh(MOST_UNDER_WAY)
        while self._under_way:
            number, future = self._done.get()
            self._under_way -= 1
            why = _lost(future)
            if why and self._tries[number] < TRIES:
                self._try_again(number, future)
                continue
            self._submit_fresh(1)
            self._submit_suspect()
            if why:
                yield number, Failed(f"{why}, {TRIES} times")
            else:
                yield number, self._outcome(future)

    def _submit_fresh(self, count: int) -> None:
        for number in islice(self._fresh, count):
            self._submit(number)

    def _try_again(self, number: int, future: "Future[Result]") -> None:
        """Try a task again: later and alone, if it was perhaps lost with another's worker."""
        if not _is_suspect(future):
            self._submit(number)
            return
        self._suspects.append(number)
        self._submit_fresh(1)
        self._submit_suspect()

    def _submit_suspect(self) -> None:
        if self._suspects and not self._under_way:
            self._submit(self._suspects.popleft())

    def _submit(self, number: int) -> None:
        self._under_way += 1
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
    if isinstance(error, ProcessExpired) or _is_suspect(future):
        return "its worker died, as out of memory or time"
    return ""


def _is_suspect(future: "Future[Any]") -> bool:
    """Whether workers of Dask died that had this task, perhaps beside the one they died of."""
    return type(future.exception()).__name__ == "KilledWorker"
