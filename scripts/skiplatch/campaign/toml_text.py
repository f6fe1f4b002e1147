"""Reading a small TOML file within limits, with the place of a syntax error."""

import re
import tomllib
from pathlib import Path
from typing import Any

from skiplatch.errors import InputError
from skiplatch.files import read_text

# tomllib takes time and memory that grow with the square of a dotted key's length.
MAX_BYTES = 65_536
MAX_LINE_CHARACTERS = 1_000

_PLACE = re.compile(r" \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)$")
_CLEARER = {"Cannot overwrite a value": "the key stands here a second time"}


def read_toml_text(path: Path) -> str:
    """Read a small UTF-8 text; a byte order mark is accepted.

    Raises:
        InputError: The file cannot be read, is too large, or is no UTF-8 text.
    """
    text = read_text(path, MAX_BYTES)
    for number, line_text in enumerate(text.split("\n"), 1):
        if len(line_text) > MAX_LINE_CHARACTERS:
            message = f"line of more than {MAX_LINE_CHARACTERS} characters"
            raise InputError(path, number, None, message)
    return text


def parse_toml(path: Path, text: str) -> dict[str, Any]:
    """Parse the text of the file.

    Raises:
        InputError: The text is no TOML.
    """
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise InputError(path, None, None, "not valid TOML: nested too deeply") from error
    except ValueError as error:
        message = str(error)
        if not (place := _PLACE.search(message)):
            raise InputError(path, None, None, f"not valid TOML: {message}") from error
        reason = message[: place.start()]
        line, column = place["line"], place["column"]
        raise InputError(
            path,
            int(line) if line else text.rstrip("\n").count("\n") + 1,
            int(column) if column else None,
            f"not valid TOML: {_CLEARER.get(reason, reason)}",
        ) from error
