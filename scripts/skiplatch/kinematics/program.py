"""NC programs with touch-probe cycles, as HEIDENHAIN's documents print them.

A cycle is a block ``12 TCH PROBE 450 NAME ~`` and its parameters, ``Q410=+0 ;MODE ~``: ``~`` says
that the block goes on. The documents break a parameter before its comment and put empty lines
between; both are read. What a parameter means, and its range, is the cycle's affair.

ISO programs say ``N12 G450 Q410=+0 *``: parameters in the block or in lines after it, with or
without comments and ``~``, ``*`` at an end; ``%NAME G71 *`` around it, G70 for inches.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from skiplatch.errors import InputError, quoted
from skiplatch.files import read_text

MOST_BYTES = 1_000_000

BLOCK = re.compile(r"N?(?P<number>\d+)\s+(?P<text>\S.*)")
CYCLE = re.compile(r"TCH PROBE (?P<cycle>\d{1,9})\b[^~;]*")
ISO_CYCLE = re.compile(r"G(?P<cycle>45\d)\b[^~;]*")
ISO_TOOL = re.compile(r'T\s*(?:"(?P<name>[^"]*)"|(?P<index>\d+))\s*(?P<axis>G1[789]).*')
ISO_FRAME = re.compile(r"%(?P<name>.*\S)\s+G7(?P<unit>[01])")
ISO_PARAMETER = re.compile(r"\bQS?\d+\s*=")
TOOL = re.compile(r'TOOL CALL\s+(?:"(?P<name>[^"]*)"|(?P<index>\d+))\s*(?P<axis>[XYZ]?).*')
BEGIN = re.compile(r"BEGIN PGM\s+(?P<name>\S.*?)\s+(?P<unit>MM|INCH)")
END = re.compile(r"END PGM\b.*")
PARAMETER = re.compile(r"(?P<kind>QS?)(?P<number>\d{1,9})\s*=\s*(?P<value>\"[^\"]*\"|[^\s;~]+)")
_BLOCKS = "TOOL CALL, TCH PROBE 450 to 453, BEGIN PGM or END PGM"
WORDS = {"FMAX", "FAUTO", "PREDEF"}
CYCLES = (450, 451, 452, 453)


@dataclass(frozen=True, slots=True)
class Value:
    """What a parameter was given, and where.

    Attributes:
        value: A number, a name in quotes (without them), or ``FMAX``, ``FAUTO``, ``PREDEF``.
        line: Line in the file, from 1.
        column: Character position in the line, from 1.
    """

    value: float | str
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Cycle:
    """A call of a cycle: its number and its parameters by the number of the Q parameter."""

    number: int
    line: int
    parameters: Mapping[int, Value]


@dataclass(frozen=True, slots=True)
class Program:
    """What a program says: the probe that was called, and the cycles in their order.

    Attributes:
        path: The file.
        tool: Name or number of the tool that was called last, empty when none was.
        is_inch: Lengths of the parameters are in inches.
        cycles: The calls.
    """

    path: Path
    tool: str
    is_inch: bool
    cycles: tuple[Cycle, ...]


@dataclass(frozen=True, slots=True)
class _Line:
    number: int
    text: str
    indent: int


def _parts(number: int, line: str) -> Iterator[_Line]:
    text = line.strip()
    if text:
        yield _Line(number, text, len(line) - len(line.lstrip()))


def _iso_parts(number: int, line: str) -> Iterator[_Line]:
    """Take an ISO line apart, so that each parameter begins one; without the end of the block."""
    code, comment, rest = line.partition(";")
    starts = [0, *(given.start() for given in ISO_PARAMETER.finditer(code)), len(code)]
    for begin, end in pairwise(starts):
        part = code[begin:end].rstrip().removesuffix("*").rstrip()
        text = f"{part.lstrip()} {comment}{rest.rstrip()}" if end == len(code) else part.lstrip()
        if text.strip():
            yield _Line(number, text.strip(), begin + len(part) - len(part.lstrip()))


class _Reader:
    """Goes through the lines of one program."""

    def __init__(self, path: Path, text: str) -> None:
        self._path = path
        self._is_iso = text.lstrip().startswith("%")
        self._lines = [
            part
            for i, line in enumerate(text.splitlines(), start=1)
            for part in (_iso_parts(i, line) if self._is_iso else _parts(i, line))
        ]
        self._at = 0
        self.tool = ""
        self.is_inch = False
        self.cycles: list[Cycle] = []

    def _fail(self, line: _Line, column: int, message: str) -> InputError:
        return InputError(self._path, line.number, line.indent + column, message)

    def read(self) -> Program:
        while self._at < len(self._lines):
            self._block()
        if not self.cycles:
            raise InputError(self._path, None, None, "no TCH PROBE cycle in this program")
        return Program(self._path, self.tool, self.is_inch, tuple(self.cycles))

    def _block(self) -> None:
        line = self._lines[self._at]
        self._at += 1
        if line.text.startswith(";"):
            return
        block = BLOCK.fullmatch(line.text)
        column = block.start("text") + 1 if block else 1
        text = block["text"] if block else line.text
        if cycle := (ISO_CYCLE if self._is_iso else CYCLE).match(text):
            self._cycle(line, column, int(cycle["cycle"]), text[cycle.end() :])
        elif tool := (ISO_TOOL if self._is_iso else TOOL).fullmatch(text):
            self.tool = tool["name"] if tool["name"] is not None else tool["index"]
        elif begin := (ISO_FRAME if self._is_iso else BEGIN).fullmatch(text):
            self.is_inch = begin["unit"] in ("INCH", "0")
        elif self._is_iso or not END.fullmatch(text):
            blocks = "T, G450 to G453 or %" if self._is_iso else _BLOCKS
            raise self._fail(line, column, f"expected a block {blocks}, got {quoted(text)}")

    def _cycle(self, line: _Line, column: int, number: int, rest: str) -> None:
        if number not in CYCLES:
            raise self._fail(line, column, f"expected cycle 450, 451, 452 or 453, got {number}")
        parameters: dict[int, Value] = {}
        goes_on = rest.strip() == "~"
        while (goes_on or self._is_iso) and self._at < len(self._lines):
            given = self._lines[self._at]
            if not given.text.startswith("Q"):
                break
            goes_on = self._parameter(given, parameters)
        if goes_on:
            last = self._lines[self._at - 1]
            message = 'expected a parameter such as "Q406=+0" after "~"'
            raise self._fail(last, len(last.text), message)
        self.cycles.append(Cycle(number, line.number, parameters))

    def _parameter(self, line: _Line, parameters: dict[int, Value]) -> bool:
        """Read one parameter with its comment; tell whether the block goes on."""
        given = PARAMETER.match(line.text)
        if given is None:
            expected = 'expected a parameter such as "Q406=+0"'
            raise self._fail(line, 1, f"{expected}, got {quoted(line.text)}")
        number = int(given["number"])
        if number in parameters:
            message = f"Q{number} is given twice, first in line {parameters[number].line}"
            raise self._fail(line, 1, message)
        column = given.start("value") + 1
        parameters[number] = Value(
            self._value(line, column, given["kind"], given["value"]),
            line.number,
            line.indent + column,
        )
        rest = line.text[given.end() :].strip()
        self._at += 1
        if not rest and self._at < len(self._lines) and self._lines[self._at].text[0] == ";":
            rest = self._lines[self._at].text
            self._at += 1
        if rest and rest != "~" and not rest.startswith(";"):
            message = f'expected ";" and a comment, or "~", got {quoted(rest)}'
            raise self._fail(line, given.end() + 1, message)
        return rest.endswith("~")

    def _value(self, line: _Line, column: int, kind: str, text: str) -> float | str:
        if text.startswith('"'):
            return text[1:-1]
        if text in WORDS:
            return text
        try:
            if kind == "Q":
                return _number(text)
        except ValueError:
            pass
        expected = "a name in quotes" if kind == "QS" else "a number"
        raise self._fail(line, column, f"expected {expected}, got {quoted(text)}")


def _number(text: str) -> float:
    """Read digits with a point, and a sign where there is one; nothing else that Python takes."""
    if not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)", text, flags=re.ASCII):
        raise ValueError(text)
    return float(text)


def read_program(path: Path) -> Program:
    """Read a program.

    Raises:
        InputError: It cannot be read, or is not such a program.
    """
    return _Reader(path, read_text(path, MOST_BYTES)).read()


def texts(program: Program) -> Iterator[str]:
    """Give each cycle in one line, as it was understood."""
    for cycle in program.cycles:
        given = " ".join(f"Q{n}={_shown(v.value)}" for n, v in cycle.parameters.items())
        yield f"TCH PROBE {cycle.number} {given}"


def _shown(value: float | str) -> str:
    return f"{value:+g}" if isinstance(value, float) else value
