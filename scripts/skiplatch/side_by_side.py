"""The same task for each of some items, on the processes of an executor if there is one."""

from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def side_by_side(
    executor: Executor | None, task: Callable[[Item], Result], items: Iterable[Item]
) -> list[Result]:
    """Give what comes of a task for each item, in their order, once all are done."""
    return list((executor.map if executor else map)(task, items))
