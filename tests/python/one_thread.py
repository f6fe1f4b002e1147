"""An executor for tests that replace what a task calls, which another process would not see."""

from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager

from skiplatch.workers import Workers


@contextmanager
def one_thread(_: Workers) -> Iterator[Executor]:
    """Stand in for `skiplatch.workers.opened`."""
    with ThreadPoolExecutor(1) as executor:
        yield executor
