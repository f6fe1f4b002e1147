"""A bar on stderr for what takes long; none where that is not a terminal."""

from collections.abc import Iterable, Iterator
from typing import TypeVar

from tqdm import tqdm

Step = TypeVar("Step")


def shown(steps: Iterable[Step], total: int, title: str) -> Iterator[Step]:
    """Pass the steps on and show how many of them are done."""
    return iter(tqdm(steps, total=total, desc=title, leave=False, disable=None))
