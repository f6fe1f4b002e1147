"""Lines of G-code as far as probing moves need them: words, modes, positions, parameters.

What is not known is left out rather than guessed: a move to a place that hangs on an unknown
parameter has no target.
"""

import ast
import functools
import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from skiplatch.importing.probe_move import AXES, LINEAR, ProbeMove, direction_of
from skiplatch.numbers import PLAIN
from skiplatch.units import MM_PER_INCH

_TOUCH, _RELEASE = "G38.2", "G38.4"  # and G38.3, and G38.5
_NO_MOTION = (4.0, 10.0, 28.0, 30.0, 43.0, 43.1, 43.2, 52.0, 92.0)  # whatever axes they name
LATCHED = [str(number) for number in range(5061, 5070)]  # parameters: the place of the last touch
LAST_OF_USER = 5000  # parameters beyond it tell of the machine, such as its offsets
HAS_TOUCHED = "5070"  # the parameter that is 1 after a probing move with a contact

_COMMENT = re.compile(r"\([^)]*(?:\)|$)|;.*$")
_WORD = re.compile(rf"([A-Z])\s*([-+]?\s*{PLAIN}|#[<\w]+>?|\[)", re.IGNORECASE)
_ASSIGNMENT = re.compile(r"^\s*#\s*(<[^>]*>|[0-9]+)\s*=\s*(.+)$")
_PARAMETER = re.compile(r"#\s*(<[^>]*>|[0-9]+)")
_OPERATORS: Mapping[type[ast.AST], Callable[..., float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
    ast.Mod: math.fmod,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
_WORDS = {"LT": "<", "LE": "<=", "GT": ">", "GE": ">=", "EQ": "==", "NE": "!=", "MOD": "%"}
_OPERATOR_WORD = re.compile(rf"\b(?:{'|'.join(_WORDS)})\b")
_NUMBER = re.compile(rf"[-+]? *{PLAIN}")
_PYTHONS_ALONE = re.compile(r"\d[A-Z_]", re.ASCII)  # 1_0, 1E3, 0X10 are none of G-code


@dataclass(slots=True)
class Machine:
    """Modes and position of a controller that is fed line by line."""

    is_relative: bool = False
    is_inch: bool = False
    feed: float | None = None
    motion: str = "G0"
    position: dict[str, float] = field(default_factory=dict)
    parameters: dict[str, float | None] = field(default_factory=dict)
    """By name or number; None where one was set to what is not known."""

    def execute(self, line: str, number: int) -> ProbeMove | None:
        """Carry out a line and give the probing move in it."""
        text = without_comments(line).strip()
        if assignment := _ASSIGNMENT.match(text):
            self.parameters[assignment[1].lower()] = self.value(assignment[2])
            return None
        words = self.words(text)
        is_absolute_here = self._set_modes(words)
        targets = {letter: value for letter, value in words if letter in AXES}
        if any(letter == "G" and value in _NO_MOTION for letter, value in words):
            self._offsets_change(words)
            return None
        if not targets or self.motion not in {"G0", "G1", _TOUCH, _RELEASE}:
            return None
        return self._move(targets, number, is_absolute_here=is_absolute_here)

    def touched(self, latched: Sequence[float]) -> None:
        """Go on from where a probing move was latched.

        Args:
            latched: X Y Z A B C U V W as the program counts them, or nothing if not known.
        """
        for name in LATCHED:
            self.parameters.pop(name, None)
        self.parameters.update(zip(LATCHED, latched, strict=False))
        self.parameters[HAS_TOUCHED] = 1.0
        self.position |= {
            axis: value * self.unit_of(axis) for axis, value in zip(AXES, latched, strict=False)
        }

    def words(self, text: str) -> list[tuple[str, float | None]]:
        """Give letters and values of a line; None where a value is not known."""
        found: list[tuple[str, float | None]] = []
        at = 0
        while match := _WORD.search(text, at):
            letter, value = match[1].upper(), match[2]
            if value == "[":
                end = _closing(text, match.end() - 1)
                found.append((letter, self.value(text[match.end() : end])))
                at = end + 1
            else:
                found.append((letter, self.value(value)))
                at = match.end()
        return found

    def value(self, text: str) -> float | None:
        """Work out an expression; None where something in it is not known."""
        if _NUMBER.fullmatch(text):
            return _finite(float(text.replace(" ", "")))
        python = _OPERATOR_WORD.sub(lambda match: _WORDS[match[0]], text.upper())
        known = True

        def parameter(match: re.Match[str]) -> str:
            nonlocal known
            value = self._parameter(match[1].lower())
            known = known and value is not None
            return f"({value})"

        python = _PARAMETER.sub(parameter, python).replace("[", "(").replace("]", ")")
        if not known or _PYTHONS_ALONE.search(_PARAMETER.sub("", text.upper())):
            return None
        try:
            return _finite(_evaluated(_parsed(python.strip().replace(" ", ""))))
        except (SyntaxError, ValueError, ArithmeticError, RecursionError):
            return None

    def _parameter(self, name: str) -> float | None:
        """Give a parameter; one of the user's that was never set is 0, as controllers have it."""
        if name not in self.parameters and name.isdecimal() and float(name) <= LAST_OF_USER:
            return 0.0
        return self.parameters.get(name)

    def _set_modes(self, words: list[tuple[str, float | None]]) -> bool:
        codes = [value for letter, value in words if letter == "G" and value is not None]
        for code in codes:
            if code in (90.0, 91.0):
                self.is_relative = code == 91.0
            elif code in (20.0, 21.0):
                self.is_inch = code == 20.0
            elif code in (0.0, 1.0, 2.0, 3.0, 80.0):
                self.motion = f"G{code:g}"
            elif 38.0 < code < 39.0:
                self.motion = _RELEASE if code in (38.4, 38.5) else _TOUCH
        for letter, value in words:
            if letter == "F":
                self.feed = value * self._unit if value else None  # nothing moves at F0
        return 53.0 in codes

    @property
    def _unit(self) -> float:
        return MM_PER_INCH if self.is_inch else 1.0

    def unit_of(self, axis: str) -> float:
        """Give how many mm or degrees a number of an axis counts."""
        return self._unit if axis in LINEAR else 1.0

    def _offsets_change(self, words: list[tuple[str, float | None]]) -> None:
        """Forget the coordinates that G10 or G92 have set anew, or that G28 went to."""
        if not any(letter == "G" and value == 4.0 for letter, value in words):
            for letter, _ in words:
                self.position.pop(letter, None)

    def _move(
        self, targets: Mapping[str, float | None], number: int, *, is_absolute_here: bool
    ) -> ProbeMove | None:
        start = dict(self.position)
        ways: dict[str, float | None] = {}
        for axis, value in targets.items():
            here = start.get(axis)
            unit = self.unit_of(axis)
            if value is None:
                ways[axis] = None
                self.position.pop(axis, None)
            elif self.is_relative and not is_absolute_here:
                ways[axis] = value * unit
                if here is not None:
                    self.position[axis] = here + value * unit
            else:
                ways[axis] = None if here is None else value * unit - here
                self.position[axis] = value * unit
        if is_absolute_here:
            self.position.clear()
        if self.motion not in (_TOUCH, _RELEASE):
            return None
        ends = {axis: self.position.get(axis) for axis in targets}
        self.position = {k: v for k, v in start.items() if k not in targets}
        is_release = self.motion == _RELEASE
        way = direction_of(ways)
        return ProbeMove(number, *way, start, self.feed, ends, is_release, self.is_inch)


def without_comments(line: str) -> str:
    """Give a line without what stands in parentheses, closed or not, or after a semicolon."""
    return _COMMENT.sub("", line)


def bracketed(text: str) -> Iterator[str]:
    """Give what stands in each pair of brackets, the outermost ones."""
    at = text.find("[")
    while at >= 0:
        end = _closing(text, at)
        yield text[at + 1 : end]
        at = text.find("[", end + 1)


def _closing(text: str, start: int) -> int:
    """Give where the bracket at `start` closes."""
    depth = 0
    for at in range(start, len(text)):
        depth += {"[": 1, "]": -1}.get(text[at], 0)
        if depth == 0:
            return at
    return len(text)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


@functools.lru_cache(maxsize=1024)  # a loop works out the same texts again and again
def _parsed(python: str) -> ast.expr:
    """Give the tree of an expression; SyntaxError or ValueError where it is none."""
    return ast.parse(python, mode="eval").body


def _evaluated(node: ast.AST) -> float:
    """Work out a tree of numbers and operators."""
    match node:
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.UnaryOp(op=op, operand=operand):
            return _OPERATORS[type(op)](_evaluated(operand))
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](_evaluated(left), _evaluated(right))
        case ast.Compare(left=left, ops=[op], comparators=[right]):
            return float(_OPERATORS[type(op)](_evaluated(left), _evaluated(right)))
    raise ValueError("an expression that is not worked out")
