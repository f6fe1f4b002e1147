"""Kinds of CSV columns: how the cells of each are read, checked and written."""

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray
from skiplatch.campaign.constraints import Constraint
from skiplatch.errors import quoted

# float64, int64 or int8: every kind of column has its own.
Values = NDArray[Any]

NOT_RECORDED = -1  # the code of an empty cell in a column of choices
LONGEST_LABEL = 100
LARGEST_SERIAL = 2**53 - 1  # what a float64, and so every spreadsheet, holds exactly

# float() takes more than the format does ("nan", "inf", "1_000", " 1", "１"); of texts made of
# these characters it takes decimal numbers only.
_FOREIGN_TO_NUMBERS = re.compile(r"[^0-9eE+.-]")
_FOREIGN_TO_SERIALS = re.compile(r"[^0-9]")
_SAY_NOTHING = {"nan", "na", "n/a", "null", "none"}


class CellError(Exception):
    """A cell is wrong.

    Attributes:
        index: Which of the cells, from 0.
        message: What was expected and what stands there.
    """

    def __init__(self, index: int, message: str) -> None:
        super().__init__(index, message)
        self.index = index
        self.message = message


@dataclass(frozen=True, slots=True, kw_only=True)
class Column(ABC):
    """One column of touches.csv.

    Attributes:
        unit: The unit of its numbers; empty where there is none.
        meaning: One line for the documentation.
        since: Version of the format that has it first.
        example: A cell.
        lost: What cannot be told where it is not recorded.
        is_outcome: Whether it tells what came of the touch; conditions.csv has none of these.
    """

    unit: str = ""
    meaning: str
    example: str = ""
    lost: str = ""
    since: int = 1
    is_outcome: bool = False

    empty: ClassVar[np.generic]

    def absent(self, rows: int) -> Values:
        """Give the values, shape (rows,), of a column that was not recorded."""
        return np.full(rows, self.empty)

    def recorded(self, values: Values) -> BoolArray:
        """Tell for each value, shape (n,), whether its cell is not empty."""
        mask: BoolArray = values != self.empty
        return mask

    def admits(self, values: Values, *, required: bool = False) -> BoolArray:
        """Tell for each value, shape (n,), whether it may stand in this column."""
        fit = self._fit(values)
        return fit if required else fit | ~self.recorded(values)

    def parse(self, cells: Sequence[str], *, required: bool = False) -> Values:
        """Turn cells into checked values, shape (n,).

        Args:
            cells: As they stand in the file.
            required: Whether none of them may be empty.

        Raises:
            CellError: The first wrong cell.
        """
        values = self._checked(cells, required)
        if values is not None:  # most files are written tidily, and need no tidying
            return values
        tidied = [self._tidied(cell) for cell in cells]
        values = self._checked(tidied, required)
        if values is None:
            index = next(i for i, c in enumerate(tidied) if self._checked([c], required) is None)
            raise CellError(index, self.complaint(cells[index]))
        return values

    @property
    @abstractmethod
    def expected(self) -> str:
        """What may stand in a cell, in words."""

    @abstractmethod
    def format(self, values: Values) -> list[str]:
        """Turn admitted values, shape (n,), into cells."""

    @abstractmethod
    def _convert(self, cells: Sequence[str]) -> Values:
        """Turn cells into values or raise LookupError, ValueError or OverflowError."""

    @abstractmethod
    def _fit(self, values: Values) -> BoolArray:
        """Tell for each value whether it is admitted, that of an empty cell being none."""

    def _expected_instead_of(self, _cell: str) -> str:
        return self.expected

    def _tidied(self, cell: str) -> str:
        """Give a cell without what people and spreadsheets put about it."""
        return tidy(cell)

    def _checked(self, cells: Sequence[str], required: bool) -> Values | None:  # noqa: FBT001
        try:
            values = self._convert(cells)
        except (LookupError, ValueError, OverflowError):
            return None
        return values if self.admits(values, required=required).all() else None

    def complaint(self, cell: str) -> str:
        """Say what is expected instead of a cell that is not admitted."""
        unit = f" in {self.unit}" if self.unit else ""
        found = quoted(cell) if cell else "an empty cell"
        return f"expected {self._expected_instead_of(cell)}{unit}, got {found}"


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberColumn(Column):
    """float64; an empty cell is NaN.

    Attributes:
        constraint: Which numbers are admitted.
        decimals: How many are written.
        trimmed: Whether zeros at their end are left out.
    """

    constraint: Constraint
    decimals: int
    trimmed: bool = True

    empty = np.float64(np.nan)

    @property
    def expected(self) -> str:
        """What may stand in a cell, in words."""
        return self.constraint.words

    def recorded(self, values: Values) -> BoolArray:
        """Tell for each value, shape (n,), whether it is a number."""
        return ~np.isnan(values)

    def format(self, values: Values) -> list[str]:
        """Write each value, shape (n,), with the column's decimals."""
        cells = ["" if isnan(v) else f"{v:z.{self.decimals}f}" for v in values.tolist()]
        return [c.rstrip("0").rstrip(".") for c in cells] if self.trimmed else cells

    def _convert(self, cells: Sequence[str]) -> Values:
        text = "".join(cells)
        if not text:
            return self.absent(len(cells))
        if _FOREIGN_TO_NUMBERS.search(text):
            raise ValueError
        return np.array([float(cell) if cell else np.nan for cell in cells])

    def _fit(self, values: Values) -> BoolArray:
        return self.constraint.holds(values)

    def _expected_instead_of(self, cell: str) -> str:
        try:
            (value,) = self._convert([cell])
        except ValueError:
            return self.expected
        return self.constraint.words_against(value)


@dataclass(frozen=True, slots=True, kw_only=True)
class SerialColumn(Column):
    """int64; whole numbers from 0, written in digits only."""

    empty = np.int64(NOT_RECORDED)

    @property
    def expected(self) -> str:
        """What may stand in a cell, in words."""
        return f"a whole number from 0 to {LARGEST_SERIAL}"

    def format(self, values: Values) -> list[str]:
        """Write each value, shape (n,)."""
        return [str(value) for value in values.tolist()]

    def _convert(self, cells: Sequence[str]) -> Values:
        if _FOREIGN_TO_SERIALS.search("".join(cells)):
            raise ValueError
        return np.array([int(cell) for cell in cells], dtype=np.int64)

    def _fit(self, values: Values) -> BoolArray:
        return (values >= 0) & (values <= LARGEST_SERIAL)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChoiceColumn(Column):
    """int8 codes; `NOT_RECORDED` for an empty cell.

    Attributes:
        codes: The admitted texts and the code of each.
    """

    codes: Mapping[str, int]

    empty = np.int8(NOT_RECORDED)

    @property
    def expected(self) -> str:
        """What may stand in a cell, in words."""
        *others, last = self.codes
        return f"{', '.join(others)} or {last}"

    def format(self, values: Values) -> list[str]:
        """Write the text of each code, shape (n,)."""
        text_of = {code: text for text, code in self.codes.items()} | {NOT_RECORDED: ""}
        return [text_of[code] for code in values.tolist()]

    def _convert(self, cells: Sequence[str]) -> Values:
        code_of = {**self.codes, "": NOT_RECORDED}
        return np.array([code_of[cell] for cell in cells], dtype=np.int8)

    def _tidied(self, cell: str) -> str:
        cell = tidy(cell)
        return next((text for text in self.codes if text.lower() == cell.lower()), cell)

    def _fit(self, values: Values) -> BoolArray:
        return np.isin(values, list(self.codes.values()))


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelColumn(Column):
    """Any text in one line; an empty cell is a label like any other."""

    empty = np.str_("")

    @property
    def expected(self) -> str:
        """What may stand in a cell, in words."""
        return f"a text of at most {LONGEST_LABEL} printable characters"

    def recorded(self, values: Values) -> BoolArray:
        """Tell for each value, shape (n,), whether its cell is not empty."""
        return np.array([bool(value) for value in values.tolist()], dtype=bool)

    def format(self, values: Values) -> list[str]:
        """Quote each text, shape (n,), where it has to be."""
        return [_quoted_cell(value) for value in values.tolist()]

    def _convert(self, cells: Sequence[str]) -> Values:
        return np.array(cells, dtype=object)

    def _fit(self, values: Values) -> BoolArray:
        fit = [len(v) <= LONGEST_LABEL and (v.isprintable()) for v in values.tolist()]
        return np.array(fit, dtype=bool)


def tidy(cell: str) -> str:
    """Give what stands in a cell; nothing where that stands for an empty one, as "n/a" does."""
    cell = cell.strip()
    return "" if cell.lower() in _SAY_NOTHING else cell


def _quoted_cell(text: str) -> str:
    if not any(c in text for c in '",;#') and text == text.strip():
        return text
    doubled = text.replace('"', '""')
    return f'"{doubled}"'
