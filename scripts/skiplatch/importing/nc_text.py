"""Whether a file is an NC program at all: most of its lines are words such as G1 X5, F[#1 * 2]."""

import re
from pathlib import Path

from skiplatch.errors import InputError, quoted
from skiplatch.importing.gcode import without_comments
from skiplatch.importing.log_lines import read_text
from skiplatch.numbers import PLAIN

PROGRAM = "an NC program of lines such as G38.2 Z-5 F100"
_INNERMOST = re.compile(r"\[[^\[\]]*\]")
_PARAMETER = r"#+(?:<[^>]*>|\d+|\[\])"
_VALUE = rf"(?>[-+]?(?:{PLAIN}|\d+\.|{_PARAMETER}|\[\]))"
_BLOCK = re.compile(
    rf"/?(?:[:%]\w*+|(?>[A-Z@^]{_VALUE}|{_PARAMETER}=[^\"']++)*+)(?:\*\d+)?", re.IGNORECASE
)
_FLOW = re.compile(r"(?:N\d+)?(?:O(?:<[^>]*>|\d+|\[\])|IF\[\]|WHILE\[\]|END\d|GOTO)", re.IGNORECASE)


def read_program(path: Path) -> str:
    """Read an NC program.

    Raises:
        InputError: It cannot be read, or most of its lines are none of an NC program.
    """
    text = read_text(path, PROGRAM)
    code = [(line, without_comments(raw)) for line, raw in enumerate(text.splitlines(), start=1)]
    code = [(line, block) for line, block in code if block.strip()]
    others = [(line, block) for line, block in code if not _is_block(block)]
    if 2 * len(others) > len(code):
        line, block = others[0]
        raise InputError(path, line, None, f"expected {PROGRAM}, got {quoted(block.strip())}")
    return text


def _is_block(text: str) -> bool:
    """Tell whether a line is one of an NC program, whatever stands in its brackets."""
    text, count = "".join(text.split()), 1
    while count:
        text, count = _INNERMOST.subn("\0", text)
    text = text.replace("\0", "[]")
    return bool(_FLOW.match(text) or _BLOCK.fullmatch(text))
