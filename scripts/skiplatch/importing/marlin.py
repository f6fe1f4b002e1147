"""Marlin: M48 at V2 and above, and G30; and RepRapFirmware, whose G30 S-1 is the like."""

import re
from pathlib import Path

from skiplatch.campaign.session_names import HOMING
from skiplatch.errors import InputError
from skiplatch.importing.console import (
    ADJUSTING,
    OFFSET,
    TURNING,
    Console,
    decimals,
    half_digit,
)
from skiplatch.importing.dialects import advice
from skiplatch.importing.duet_touches import HOMING as DUET_HOMING
from skiplatch.importing.duet_touches import LEVELLING, Duet, fails, is_false
from skiplatch.importing.gcode import without_comments
from skiplatch.importing.log_lines import Line, read_lines, read_text
from skiplatch.importing.marlin_attempts import Attempts
from skiplatch.importing.marlin_series import TEST, Series
from skiplatch.importing.model import Imported
from skiplatch.numbers import NUMBER, PLAIN
from skiplatch.units import UM_PER_MM

_SAMPLE = re.compile(
    rf"(?<!\d)([0-9]{{1,6}}) of ([0-9]{{1,6}}):?\s*z:\s*({NUMBER})(?:.*?[Mm]ean:\s*({NUMBER}))?"
)
_BED = re.compile(  # in lower case until 2015
    rf"Bed X:\s*({NUMBER})\s*Y:\s*({NUMBER})\s*Z:\s*({NUMBER})", re.IGNORECASE
)
_FAILED = re.compile(r"Error:?\s*Probing failed", re.IGNORECASE)
_PLACE = re.compile(rf"\bM48\b.*?\bX(-?{PLAIN}).*?\bY(-?{PLAIN})", re.IGNORECASE)
_TEST_ENDS = re.compile(r"^(?:Finished!|Standard Deviation:)")
_RESULTS = re.compile(
    rf"^Mean:\s*{NUMBER}\s*Z?Min:\s*({NUMBER})\s*Z?Max:\s*({NUMBER})", re.IGNORECASE
)
_MESH = re.compile(r"Bed Topography Report|Leveling Grid|Measured points|Mesh Bed Level", re.I)
"""Above the heights of a bed, of UBL and others, which were measured once each."""
_STEPS = re.compile(rf"\bM92\b.*?\bZ\s*({PLAIN})")
_ACCEL = re.compile(rf"\bM201\b.*?\bZ\s*({PLAIN})")
_UNIT = re.compile(r"^G2([01])\b")
_OFFSET = re.compile(rf"\bM851\b.*?\bZ\s*({NUMBER})", re.IGNORECASE)
_ECHOED = re.compile(r"\becho:", re.IGNORECASE)
_MOVED = {
    HOMING: re.compile(r"^(?:G28\b|start$|Marlin [\d.]+)", re.IGNORECASE),
    ADJUSTING: re.compile(r"^G34\b", re.IGNORECASE),
    TURNING: re.compile(r"^G35\b", re.IGNORECASE),
}


def read_marlin(path: Path, feed: float | None) -> Imported:
    """Read a console.

    Args:
        path: The log.
        feed: In mm/min; Marlin does not print it.

    Raises:
        InputError: It cannot be read, or holds no touch.
    """
    reader = _Reader(feed)
    for line in read_lines(path):
        reader.take(line)
    if not reader.has_touched:
        expected = (
            'expected lines such as "1 of 10: z: 0.185" of M48 V4, "Bed X: … Z: …" of G30, or '
            '"Stopped at height 0.185 mm" of G30 S-1'
        )
        if reader.has_tested:
            expected += ", got M48 without samples: type M48 V4"
        elif reader.has_mesh:
            expected += ", got a mesh that is done: type G29 V4, or M48 V4 at one place"
        raise InputError(path, None, None, advice(read_text(path)) or expected)
    return reader.result()


class _Reader(Console):
    """Follows a log line by line."""

    def __init__(self, feed: float | None) -> None:
        super().__init__(feed)
        self.has_tested = self.has_mesh = False
        self._place: tuple[float, ...] = ()
        self._in_test = False
        self._sum = 0.0
        self._steps: float | None = None
        self._is_inch = self._steps_in_inches = False
        self._offset: float | None = None
        self._accel: float | None = None
        self._from_means = 0
        self._is_bed_last = False
        self._series = Series()
        self._duet = Duet()
        self._attempts = Attempts()

    def take(self, line: Line) -> None:
        """Take in a line, without comments."""
        text = without_comments(line.text)
        self._attempts.take(line)
        self.take_temperatures(text)
        if match := _SAMPLE.search(text):
            self._sample(match, line)
            return
        self._series.take(text, line.number)
        if self._takes_of_duet(text, line):
            return
        if match := _PLACE.search(text):
            self._place, self._in_test = (float(match[1]), float(match[2])), False
        elif match := _BED.search(text):
            self._bed(match, line)
        elif match := _RESULTS.match(text):
            self.has_tested = True
            self.take_extremes(match[1], match[2], line)
        elif self.take_moved(text, _MOVED) or _TEST_ENDS.match(text):
            self._in_test = False
        elif _FAILED.search(text):
            if self._attempts.fails(line):
                self.add(None, self._place, line, feed=self.feed)
                self._series.fails()
        else:
            self._settings(text, line)
            self.has_mesh |= bool(_MESH.search(text))
        if TEST.search(text):
            self._in_test = self.has_tested = True

    def _takes_of_duet(self, text: str, line: Line) -> bool:
        """Take a touch of RepRapFirmware, or what tells of the next one."""
        duet, feed = self._duet, self.feed or self._duet.feed
        if (z := duet.height(text)) is not None:
            self._attempts.touched()
            self.add(z, duet.place, line, feed=feed)
            return True
        if fails(text) or is_false(text):
            if self._attempts.fails(line):
                self.add(None, duet.place, line, feed=feed, is_false=is_false(text))
            return True
        duet.take(text)
        return duet.has_touched and bool(self.take_moved(text, {HOMING: DUET_HOMING} | LEVELLING))

    def _settings(self, text: str, line: Line) -> None:
        """Take a setting, as typed or as M503 lists it."""
        if match := _UNIT.match(text):
            self._is_inch = match[1] == "0"
        elif match := _OFFSET.search(text):
            self._sets_offset(float(match[1]), line)
        elif self._is_inch:  # of which versions of Marlin print other multiples
            self._steps_in_inches |= bool(_STEPS.search(text))
        elif match := _STEPS.search(text):
            self._steps = float(match[1])
        elif match := _ACCEL.search(text):
            self._accel = float(match[1])

    def _sets_offset(self, offset: float, line: Line) -> None:
        """Take the probe's offset; another one moves where z is 0."""
        is_same = offset == self._offset or (self._offset is None and _ECHOED.search(line.raw))
        if not is_same:
            self.take_moved(line.text, {OFFSET: _OFFSET})
        self._offset = offset

    def _sample(self, match: re.Match[str], line: Line) -> None:
        """Take z, with more digits where the running mean gives them."""
        number, z = int(match[1]), float(match[3])
        self._attempts.touched()
        is_next = self._series.takes(number, int(match[2]), line.number)
        if number == 1:
            self._sum = 0.0
            self._begins_with(z, half_digit(match[3]))
        if match[4] is not None:
            total = float(match[4]) * number
            exact = total - self._sum
            self._sum = total
            is_finer = decimals(match[4]) > decimals(match[3]) + 1
            if is_next and is_finer and abs(exact - z) < half_digit(match[3]):
                digit = 0.5 * 10.0 ** -decimals(match[4]) * (2 * number - 1)
                if digit < half_digit(match[3]):
                    z, self._from_means = round(exact, 6), self._from_means + 1
        self.add(z, self._place, line, feed=self.feed)
        self._series.measured(z, half_digit(match[3]))
        self._is_bed_last = False

    def _begins_with(self, z: float, half: float) -> None:
        """Begin a series; a result right before it, in a log without its title, is its first."""
        last = self.touches[-1] if self.touches else None
        if self._is_bed_last and last and abs((last.coordinate or 0.0) - z) < half:
            self.touches.pop()
            self._place = last.place
        self.test_begins()

    def _bed(self, match: re.Match[str], line: Line) -> None:
        """Take a result of G30; in a test it only repeats the first sample."""
        place = (float(match[1]), float(match[2]))
        if self._in_test:
            self._place = place
        else:
            self._attempts.touched()
            self.add(float(match[3]), place, line, feed=self.feed)
        self._is_bed_last = not self._in_test

    def result(self) -> Imported:
        """Say what was found."""
        self._series.ends()
        found = self.imported("marlin")
        self._series.say(found)
        self._attempts.say(found)
        found.known.append("the z of each touch")
        self.say_temperatures(found)
        if self._from_means:
            found.known.append(f"{self._from_means} of them finer than printed, from the means")
        if self._steps:
            found.figure("axis", "resolution_um", UM_PER_MM / self._steps, "M92 of the log")
        elif self._steps_in_inches:
            found.assumed.append(
                "400 steps/mm of Z, Marlin's default: settings in inches (G20) do not tell them "
                "for certain; type G21 and M503"
            )
        else:
            prints = (
                "type M92 Z with yours" if self._duet.has_touched else "M503 prints yours (M92)"
            )
            found.assumed.append(f"400 steps/mm of Z, Marlin's default; {prints}")
        if self._accel:
            found.figure("axis", "accel_mm_s2", self._accel, "M201 of the log")
        if self._duet.taps > 1:
            several = f"M558 A{self._duet.taps}: a height may be the mean of so many touches"
            found.assumed.append(f"{several}; with A1 it is one")
        if self._duet.has_touched and all(touch.feed for touch in self.touches):
            found.known.append("feeds from M558, or as given")
        elif self._duet.has_touched:
            found.assume("the feed is not known before M558 tells it", "--feed", by="give")
        elif self.feed is None:
            found.assume(
                "the feed is not known: Marlin does not print it (Z_PROBE_FEEDRATE_SLOW of "
                "Configuration.h, mm/min)",
                "--feed",
                by="give",
            )
        return found
