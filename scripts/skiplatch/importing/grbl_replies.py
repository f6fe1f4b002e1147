"""Replies of grbl to a probing move, ``[PRB:…]``: what they hold, and in which unit."""

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass

from skiplatch.numbers import number
from skiplatch.units import MM_PER_INCH

_DECIMALS_INCH = 4
_LINEAR_AXES = 3

_PRB = re.compile(r"\[PRB:\s*([-+0-9eE.,\s]+?):\s*([01])\s*\]", re.IGNORECASE)
_BEGUN = re.compile(r"\[PRB:\s*(?:[-+.\d]|$)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Reply:
    """A reply to a probing move.

    Attributes:
        begin: Where it begins in its line.
        numbers: The coordinates, as printed; none where the reply is cut or garbled.
        decimals: That each of the linear ones is printed with, at least.
        has_touched: Whether the move ended with a touch.
    """

    begin: int
    numbers: tuple[float, ...] = ()
    decimals: int = 0
    has_touched: bool = False


def reply_in(text: str) -> Reply | None:
    """Give the reply in a line, also one that is cut or garbled."""
    whole = _PRB.search(text)
    if whole is None:
        begun = _BEGUN.search(text)
        return Reply(begun.start()) if begun else None
    words = [word.strip() for word in whole[1].split(",")]
    try:
        numbers = tuple(number(word) for word in words)
    except ValueError:
        return Reply(whole.start())
    decimals = min(len(word.partition(".")[2]) for word in words[:_LINEAR_AXES])
    return Reply(whole.start(), numbers, decimals, whole[2] == "1")


class Unit:
    """The unit of the replies: as $13 says, else ``--inch``, else their decimals.

    grbl, grblHAL and FluidNC print inches with four decimals and mm with three.
    """

    def __init__(self, *, inch: bool) -> None:
        self.is_inch = inch
        self._is_given = inch
        self._is_told = inch
        self._taken: set[bool] = set()  # by the decimals

    def tell(self, *, inch: bool) -> None:
        """Take what $13 says."""
        self._is_told, self.is_inch = True, inch

    @property
    def mm(self) -> float:
        """How many mm it has."""
        return MM_PER_INCH if self.is_inch else 1.0

    def position(self, reply: Reply) -> tuple[float, ...]:
        """Give the coordinates of a reply in mm, those of rotary axes in degrees."""
        if not self._is_told:
            self.is_inch = reply.decimals == _DECIMALS_INCH
            self._taken.add(self.is_inch)
        linear = (number * self.mm for number in reply.numbers[:_LINEAR_AXES])
        return (*linear, *reply.numbers[_LINEAR_AXES:])

    def assumed(self, command_units: Collection[str]) -> Iterator[tuple[str, ...]]:
        """Say which units were taken where nothing tells them, each with options that would.

        Args:
            command_units: Which of G20 and G21 the log has.
        """
        if True in self._taken:
            yield ("replies in inches, as they have four decimals and no $13 says otherwise",)
        if False in self._taken and "G20" in command_units:
            few = "replies in mm, as they have fewer than four decimals"
            yield f"{few}, though commands are in inches (G20)", "--inch"
        if self.is_inch and not command_units and not self._is_given:
            yield "commands in mm, as the log has neither G20 nor G21", "--inch"
