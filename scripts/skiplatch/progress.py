"""A bar on stderr for what takes long; none where that is not a terminal."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from typing import TypeVar

from tqdm import tqdm

Step = TypeVar("Step")
Result = TypeVar("Result")


def shown(steps: Iterable[Step], total: int, title: str) -> Iterator[Step]:
    """Pass the steps on and show how many of them are done."""
    return iter(tqdm(steps, total=total, desc=title, leave=False, disable=None))


class Counted(Executor):
    """Has another executor work, or nobody else, and shows how many tasks are done.

    For work of which nobody knows beforehand how much it will be.
    """

    def __init__(self, executor: Executor | None, title: str) -> None:
        """Begin to count.

        Args:
            executor: Works side by side.
            title: Stands before the count.
        """
        self._executor = executor
        self._bar = tqdm(desc=title, unit=" tasks", leave=False, disable=None)

    def map(  # type: ignore[override]  # of one argument
        self, fn: Callable[[Step], Result], items: Iterable[Step]
    ) -> Iterator[Result]:
        """Give what comes of each item, in their order."""
        for result in (self._executor.map if self._executor else map)(fn, items):
            self._bar.update()
            yield result

    def __exit__(self, *_failure: object) -> None:
        """Take the count away; the other executor goes on."""
        self._bar.close()
