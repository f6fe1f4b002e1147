"""Decimal marks of a table that has semicolons or tabs between its columns.

A comma or a point may be the decimal mark there, and the other one may part thousands. Most numbers
show which it is; ``1.200`` alone does not.
"""

import re
from collections import defaultdict
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError, quoted

_PARTS = r"[.,'\u2019\u00a0\u202f]"
_DECIMAL = re.compile(
    rf"[-+]?(?:\d*|\d{{1,3}}(?:(?P<part>{_PARTS})\d{{3}})+)(?P<mark>[.,])\d+(?:[eE][-+]?\d+)?",
    re.ASCII,
)
_EITHER = re.compile(r"[-+]?[1-9]\d{0,2}(?P<mark>[.,])\d{3}", re.ASCII)
_MANY = re.compile(r"[-+]?[1-9]\d{0,2}(?P<mark>[.,])\d{3}(?:(?P=mark)\d{3})+", re.ASCII)
_SHORT = re.compile(r"[-+]?\d{1,3}", re.ASCII)
_OTHER = {",": ".", ".": ","}


@dataclass(slots=True)
class Marks:
    """What the numbers of a table show.

    Attributes:
        decimal: The decimal marks of each column that are certain.
        parting: Marks that certainly part thousands somewhere.
        either: Marks of numbers that could be read either way.
        open: Columns with such numbers.
        short: Columns with whole numbers below 1000, which are without any mark.
        thousands: Numbers such as 1.200 that were read as 1200.
        doubtful: Line, column and cell of those that could be 1.2 as well.
    """

    decimal: dict[int, set[str]] = field(default_factory=lambda: defaultdict(set))
    parting: set[str] = field(default_factory=set)
    either: set[str] = field(default_factory=set)
    open: set[int] = field(default_factory=set)
    short: set[int] = field(default_factory=set)
    thousands: list[str] = field(default_factory=list)
    doubtful: list[tuple[int, int, str]] = field(default_factory=list)

    def with_points(self, rows: Iterable[Row]) -> list[Row]:
        """Write numbers with a decimal point and without marks of thousands.

        Numbers that could be read either way stay as they are.
        """
        rows = list(rows)
        for _, row in rows:
            for column, cell in enumerate(row):
                self._see(column, cell.strip())
        return [
            (line, [self._with_point(line, i, cell) for i, cell in enumerate(row)])
            for line, row in rows
        ]

    def refuse_doubtful(self, path: Path, columns: Collection[int]) -> None:
        """Refuse numbers of these columns that could be read either way.

        Raises:
            InputError: The first one.
        """
        for line, column, cell in self.doubtful:
            if column in columns:
                whole, parts = (re.sub(_PARTS, mark, cell) for mark in ("", "."))
                message = f"{quoted(cell)} may be {whole} or {parts}: other numbers do not tell"
                raise InputError(path, line or None, None, message)

    def _see(self, column: int, cell: str) -> None:
        """Note what a cell shows."""
        if match := _EITHER.fullmatch(cell):
            self.either.add(match["mark"])
            self.open.add(column)
        elif match := _MANY.fullmatch(cell):
            self.parting.add(match["mark"])
            self.decimal[column].add(_OTHER[match["mark"]])
        elif (match := _DECIMAL.fullmatch(cell)) and match["part"] != match["mark"]:
            self.decimal[column].add(match["mark"])
            self.parting.add(match["part"] or "")
        elif _SHORT.fullmatch(cell) and float(cell):  # 0 is written so beside both
            self.short.add(column)

    def _is_decimal(self, column: int, mark: str) -> bool | None:
        """Tell whether the mark of a number such as 1.200 is the decimal mark; None if in doubt.

        Its own column tells, else the others. That those have another mark is not enough, as a
        table may be put together of several: thousands have to show. Where no other number has a
        mark, 600 beside 1.200 in a column speaks against decimals.
        """
        own = self.decimal.get(column)
        shown = own or set().union(*self.decimal.values())
        if not shown:
            return True if len(self.either) == 1 and not self.open & self.short else None
        if len(shown) > 1:
            return None
        if mark in shown:
            return True
        return False if own or column in self.short or mark in self.parting else None

    def _with_point(self, line: int, column: int, cell: str) -> str:
        text = cell.strip()
        if match := _EITHER.fullmatch(text):
            is_decimal = self._is_decimal(column, match["mark"])
            if is_decimal is None:
                self.doubtful.append((line, column, text))
                return cell
            self.thousands += [] if is_decimal else [text]
            return text.replace(match["mark"], "." if is_decimal else "")
        if match := _MANY.fullmatch(text):
            return text.replace(match["mark"], "")
        if (match := _DECIMAL.fullmatch(text)) and match["part"] != match["mark"]:
            at = match.start("mark")
            return f"{re.sub(_PARTS, '', text[:at])}.{text[at + 1 :]}"
        return cell
