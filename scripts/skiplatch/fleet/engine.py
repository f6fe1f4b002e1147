"""DuckDB: embedded, in memory, and shut off from everything but the store."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from skiplatch.errors import InputError

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

MISSING = "not installed; pip install 'skiplatch[fleet]' brings it"
Connection = Any
"""A `duckdb.DuckDBPyConnection`."""


def connect(folder: Path) -> "DuckDBPyConnection":
    """Open an engine in memory that reads and writes below a folder, and nowhere else.

    What does not fit into memory fails; nothing is swapped to the current folder.

    Raises:
        InputError: DuckDB is not installed.
    """
    try:
        import duckdb  # noqa: PLC0415 - an optional extra, and 60 MB
    except ImportError as error:
        raise InputError("duckdb", None, None, MISSING) from error
    connection = duckdb.connect(":memory:")
    connection.execute("SET temp_directory = ''")
    connection.execute("SET autoinstall_known_extensions = false")
    connection.execute(f"SET allowed_directories = [{literal(str(folder))}]")
    connection.execute("SET enable_external_access = false")
    connection.execute("SET lock_configuration = true")
    return connection


def literal(text: str) -> str:
    """Give a text as SQL has it."""
    return "'" + text.replace("'", "''") + "'"


@contextmanager
def failures_told(path: Path) -> Iterator[None]:
    """Turn what the engine stumbles over into one line on the path."""
    import duckdb  # noqa: PLC0415 - see `connect`

    try:
        yield
    except duckdb.Error as error:
        lines = [line for line in str(error).splitlines() if line.strip()]
        raise InputError(path, None, None, lines[0] if lines else "damaged") from error
