"""Mutants of a C source: small changes, each of which a test should notice.

Comments, strings and lines of the preprocessor are left alone. A change that does not compile is
told from others by the compiler.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

SWAPS = {
    "<": ("<=", ">="),
    "<=": ("<", ">"),
    ">": (">=", "<="),
    ">=": (">", "<"),
    "==": ("!=",),
    "!=": ("==",),
    "&&": ("||",),
    "||": ("&&",),
    "+": ("-",),
    "-": ("+",),
    "*": ("+",),
    "<<": (">>",),
    ">>": ("<<",),
    "&": ("|",),
    "|": ("&",),
    "^": ("|",),
    "!": ("",),
    "~": ("",),
    "++": ("--",),
    "--": ("++",),
    "+=": ("-=",),
    "-=": ("+=",),
    "|=": ("&=",),
    "&=": ("|=",),
    "^=": ("|=",),
    "true": ("false",),
    "false": ("true",),
}
TOKEN = re.compile(
    r"""(?P<skip>/\*.*?\*/|^[ ]*\#(?:[^\n]|\\\n)*|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|->)
    |(?P<swap>\btrue\b|\bfalse\b|[<>]{2}=|<<|>>|[-+|&^<>=!]=|&&|\|\||\+\+|--|[-+*<>&|^!~])
    |(?P<number>\b(?:0[xX][0-9a-fA-F]+|\d+)(?=[uUlL]*\b))""",
    re.VERBOSE | re.MULTILINE | re.DOTALL,
)
STATEMENT = re.compile(r"^ +(?! |return\b|[}{])[^\n;{}]*;(?= *(?:/\*.*\*/)?$)", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change: what stands from a place on, and what comes there instead."""

    start: int
    old: str
    new: str

    def apply(self, text: str) -> str:
        """Give the source with the change."""
        return text[: self.start] + self.new + text[self.start + len(self.old) :]

    def describe(self, text: str) -> str:
        """Give line, column and change."""
        line = text.count("\n", 0, self.start) + 1
        column = self.start - text.rfind("\n", 0, self.start)
        return f"{line}:{column}: {self.old.strip()} => {self.new or 'nothing'}"


def mutants_of(text: str) -> Iterator[Mutant]:
    """Give every mutant of a source: other operators, numbers one higher, statements left out."""
    for found in TOKEN.finditer(text):
        token = found[0]
        if found["number"]:
            yield Mutant(found.start(), token, hex(int(token, 0) + 1))
        elif found["swap"]:
            for new in SWAPS.get(token, ()):
                yield Mutant(found.start(), token, new)
    for found in STATEMENT.finditer(text):
        yield Mutant(found.start(), found[0], ";")
