"""Tables for pandas or polars, whichever is installed; neither is needed for anything else."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any, Literal

Library = Literal["pandas", "polars"]
LIBRARIES: tuple[Library, ...] = ("pandas", "polars")

DataFrame = Any
"""A ``pandas.DataFrame`` or a ``polars.DataFrame``."""


def dataframe(columns: Mapping[str, Any], library: Library | None = None) -> DataFrame:
    """Make a data frame of columns, each an array or a list of n values.

    Args:
        columns: By name.
        library: Which to use; without it pandas, or else polars.

    Raises:
        ImportError: It is not installed.
        ValueError: `library` is neither of the two.
    """
    if library is not None and library not in LIBRARIES:
        raise ValueError(f"expected {' or '.join(LIBRARIES)}, got {library!r}")
    for name in (library,) if library else LIBRARIES:
        try:
            module = import_module(name)
        except ImportError:
            continue
        return module.DataFrame(dict(columns))
    wanted = library or " or ".join(LIBRARIES)
    brings = f"pip install 'skiplatch[{library or LIBRARIES[0]}]' brings it"
    raise ImportError(f"a data frame needs {wanted}, which is not installed; {brings}")
