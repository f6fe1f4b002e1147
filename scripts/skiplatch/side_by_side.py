"""The same task for each of some items, on the processes of an executor if there is one."""

import signal
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, ProcessPoolExecutor
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def processes(jobs: int) -> Executor:
    """Give an executor of so many processes, which end when they are told to.

    Where one dies the pool tells the others to end, and waits for that. A process has the handler
    for it of the program that it was forked from, which would end its task alone.
    """
    return ProcessPoolExecutor(jobs, initializer=_end_when_told)


def _end_when_told() -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def side_by_side(
    executor: Executor | None, task: Callable[[Item], Result], items: Iterable[Item]
) -> list[Result]:
    """Give what comes of a task for each item, in their order, once all are done."""
    return list((executor.map if executor else map)(task, items))
