"""Series of M48: which samples a log lacks, and what Marlin itself works out of them.

M48 numbers its samples, ``4 of 10``. V2 prints them with three decimals; what Marlin works out of
them is from all of its digits.
"""

import re
from statistics import pstdev

from skiplatch.importing.model import Imported
from skiplatch.importing.named_lines import NAMED
from skiplatch.numbers import NUMBER
from skiplatch.units import UM_PER_MM

TEST = re.compile(r"M48 Z-Probe Repeatability Test", re.IGNORECASE)
_RESULT = re.compile(r"^(?:Finished!|Mean:|Standard Deviation:)", re.IGNORECASE)
_SIGMA = re.compile(rf"^Standard Deviation:\s*({NUMBER})", re.IGNORECASE)
_DIFFERS = 0.05
"""By which share Marlin's own result differs from that of what it prints, where that is told."""
_DIGIT_MM = 1e-6  # of the standard deviation that it prints
_OTHER = "standard deviations (by n) that those samples do not have"
_ROUNDED = "standard deviations (by n) that Marlin tells from more digits than it prints of each z"


class Series:
    """Follows the samples of one series after the other."""

    def __init__(self) -> None:
        self._lacking: list[str] = []
        self._wrong: list[str] = []
        self._rounded: list[str] = []
        self._last = self._total = self._line = 0
        self._z: list[float] = []
        self._half_digit_mm = 0.0
        self._is_whole = True

    def takes(self, number: int, total: int, line: int) -> bool:
        """Take a sample by its number, and tell whether it is the next one of its series."""
        if total != self._total or number < self._last:
            self.ends()
        if self._last == 0:
            self._z, self._is_whole = [], True
        is_next = number == self._last + 1
        if number > self._last:  # one that stands there twice is no gap
            self._lacks(self._last + 1, number - 1, total, f"before line {line}")
        self._last, self._total, self._line = number, total, line
        return is_next

    def measured(self, z: float, half_digit_mm: float) -> None:
        """Take the z of the sample that was taken last, and by how much that may be off."""
        self._z.append(z)
        self._half_digit_mm = half_digit_mm

    def take(self, text: str, line: int) -> None:
        """Take a line that is no sample: a series may end there."""
        if TEST.search(text):
            self.ends()
            self._z = []
        elif _RESULT.match(text):
            self.ends()
            if (sigma := _SIGMA.match(text)) and self._is_whole and len(self._z) > 1:
                self._hold_against(float(sigma[1]), line)

    def fails(self) -> None:
        """Take that Marlin gave the series up: no samples follow."""
        self._last = self._total = 0
        self._z = []

    def ends(self) -> None:
        """End a series, whose results may still follow."""
        if self._last:
            self._lacks(self._last + 1, self._total, self._total, f"after line {self._line}")
        self._last = self._total = 0

    def _lacks(self, first: int, last: int, total: int, where: str) -> None:
        if first <= last <= total:
            numbers = f"{first}" if first == last else f"{first} to {last}"
            self._lacking.append(f"{numbers} of {total}, {where}")
            self._is_whole = False

    def _hold_against(self, told_mm: float, line: int) -> None:
        """Hold Marlin's own standard deviation against that of the samples, by n as well."""
        found_mm = pstdev(self._z)
        off_mm = abs(found_mm - told_mm)
        told, found = (f"{value * UM_PER_MM:.3g} µm" for value in (told_mm, found_mm))
        if off_mm > self._half_digit_mm + _DIGIT_MM:  # which rounding each z cannot do
            self._wrong.append(f"line {line}, {told} in place of {found}")
        elif off_mm > max(_DIFFERS * told_mm, _DIGIT_MM):
            self._rounded.append(f"line {line}, {told} in place of {found}")

    def say(self, found: Imported) -> None:
        """Say which samples are missing, and where Marlin tells the scatter from more digits."""
        for said, parts, about in (
            (found.unread, self._lacking, "samples of M48 that are missing"),
            (found.unread, self._wrong, _OTHER),
            (found.known, self._rounded, _ROUNDED),
        ):
            if parts:
                more = len(parts) - NAMED
                besides = f"; and {more} more" if more > 0 else ""
                said.append(f"{about}: {'; '.join(parts[:NAMED])}{besides}")
