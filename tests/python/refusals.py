"""What is said of bad input."""

from collections.abc import Callable
from pathlib import Path

import pytest

from skiplatch.errors import InputError

Program = Callable[..., str]
"""Called with arguments of the command line that are refused; see the fixture `refused`."""


def refusal(call: Callable[..., object], *arguments: object, folder: Path | None = None) -> str:
    """What a call says that is refused; of paths in the folder, if one is given, without it."""
    with pytest.raises(InputError) as caught:
        call(*arguments)
    return str(caught.value).removeprefix(f"{folder}/")
