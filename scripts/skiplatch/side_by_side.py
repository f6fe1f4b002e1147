"""The same task for each of some items, on the processes of an executor if there is one."""

import multiprocessing
import signal
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, ProcessPoolExecutor
from multiprocessing.context import ForkContext, ForkProcess
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


class _Process(ForkProcess):
    """One that ends when it is told to, even before it has begun.

    Forked from a program with a handler of its own, Python forgets a signal that comes before the
    first line of the child is run. A blocked one waits.
    """

    def start(self) -> None:
        """See `multiprocessing.Process.start`."""
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})
        try:
            super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def run(self) -> None:
        """See `multiprocessing.Process.run`."""
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
        super().run()


class _Forked(ForkContext):
    Process = _Process


def processes(jobs: int) -> Executor:
    """Give an executor of so many processes, which end when they are told to.

    Where one dies the pool tells the others to end, and waits for that. A process that was forked
    has the handler for it of its program, which would end its task alone.
    """
    is_forked = multiprocessing.get_start_method() == "fork"
    return ProcessPoolExecutor(jobs, mp_context=_Forked() if is_forked else None)


def side_by_side(
    executor: Executor | None, task: Callable[[Item], Result], items: Iterable[Item]
) -> list[Result]:
    """Give what comes of a task for each item, in their order, once all are done."""
    return list((executor.map if executor else map)(task, items))
