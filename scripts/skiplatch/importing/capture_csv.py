"""Captures of logic analysers as CSV: of Saleae's Logic, sigrok, DSView and the like."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign.csv_text import Row, delimiter_of
from skiplatch.errors import InputError, quoted
from skiplatch.importing.analyser import RATE, Capture, hertz, only_changes, refuse_times
from skiplatch.importing.decimal_marks import Marks
from skiplatch.importing.encodings import is_windows
from skiplatch.importing.log_lines import read_text
from skiplatch.importing.units_in_heads import UNITS, bracketed
from skiplatch.numbers import number
from skiplatch.units import NS_PER_S

_SAMPLED = re.compile(rf"^;.*?Sample ?rate:\s*{RATE}", re.IGNORECASE | re.MULTILINE)
_CHANNELS = re.compile(r"^;\s*Channels[^:\n]*:\s*(.+)$", re.IGNORECASE | re.MULTILINE)
_LEVELS = {"0": 0.0, "1": 1.0, "0.0": 0.0, "1.0": 1.0, "X": np.nan}
STEP_DIGITS = 9  # that a difference of two times holds
_S_OF_WORD = {
    "seconds": 1.0,
    "milliseconds": 1e-3,
    "microseconds": 1e-6,
    "nanoseconds": 1e-9,
    "picoseconds": 1e-12,
}
_WORDS = tuple(_S_OF_WORD)
"""Each a thousandth of the one before."""
S_OF_UNIT = {**UNITS["s"], **_S_OF_WORD, "sec": 1.0, "ps": 1e-12}
_ENDING = re.compile(rf"\w[ _]+(?P<unit>{'|'.join(S_OF_UNIT)}|\u03bcs)$")


@dataclass(frozen=True, slots=True)
class Sheet:
    """The rows of a file, and what its comments say.

    Attributes:
        head: Names of the columns.
        head_line: Line of the head.
        rows: Line number and cells of the others.
        names: Of the channels, in order of their columns; empty where no comment tells them.
        rate_hz: How often was sampled; None where no comment tells it.
        is_windows: Letters beyond ASCII were read as Windows-1252 has them.
    """

    head: list[str]
    head_line: int
    rows: list[Row]
    names: list[str]
    rate_hz: float | None
    is_windows: bool = False


def read_levels(path: Path, sheet: Sheet) -> Capture:
    """Read a column for each channel, as Saleae's Logic or sigrok export them.

    Saleae puts a time before each change. sigrok writes a row for each sample and the sample rate
    into a comment, with or without a time, and names the columns or only says what they hold.

    Raises:
        InputError: It does not tell when its levels changed.
    """
    if _is_time(sheet.head[0]):
        names = sheet.names or sheet.head[1:]
        times, assumed = _times(path, sheet)
        refuse_times(path, times, [line for line, _ in sheet.rows])
        levels = _levels(path, sheet, 1, len(names))
    elif sheet.rate_hz:
        names, assumed = sheet.names or sheet.head, ()
        levels = _levels(path, sheet, 0, len(names))
        times = np.arange(len(levels), dtype=np.float64) / sheet.rate_hz
    else:
        expected = 'expected a header such as "Time [s],Channel 0,Channel 1"'
        raise InputError(path, 1, None, expected)
    if len(set(names)) < len(names):
        same = next(name for name in names if names.count(name) > 1)
        message = f"two channels are named {quoted(same)}: name them apart (sigrok: label=channel)"
        raise InputError(path, sheet.head_line, None, message)
    step_s = 1.0 / sheet.rate_hz if sheet.rate_hz else _step(times)
    return Capture(_by_name(times, names, levels), step_s, assumed)


def read_sheet(path: Path) -> Sheet:
    """Read the rows of a file with commas, semicolons or tabs between its columns.

    Raises:
        InputError: It cannot be read.
    """
    text = read_text(path, or_windows=True)
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and line[0] not in "#;"
    ]
    delimiter = delimiter_of(lines[0][1] if lines else "")
    reader = csv.reader((line for _, line in lines), skipinitialspace=True, delimiter=delimiter)
    try:
        rows = [(lines[reader.line_num - 1][0], row) for row in reader]
    except csv.Error as error:
        raise InputError(path, None, None, f"no CSV: {error}") from error
    if delimiter != ",":  # as a spreadsheet writes it that has a decimal comma
        marks = Marks()
        rows = marks.with_points(rows)
        marks.refuse_doubtful(path, {0})
    head_line, head = rows[0] if rows else (1, [""])
    channels, sampled = _CHANNELS.search(text), _SAMPLED.search(text)
    return Sheet(
        head=[cell.strip() for cell in head],
        head_line=head_line,
        rows=rows[1:],
        names=[name.strip() for name in channels[1].split(",")] if channels else [],
        rate_hz=hertz(path, sampled) if sampled else None,
        is_windows=not text.isascii() and is_windows(path),
    )


def _is_time(head: str) -> bool:
    is_named = head.lower().startswith("time") or _is_word(head)
    return is_named or bracketed(head)[1].lower() in S_OF_UNIT


def _unit_in(head: str) -> str:
    """Give the unit in brackets, known or not, or a known one behind a blank or an underscore."""
    ending = _ENDING.search(head.lower())
    return bracketed(head)[1].lower() or (ending["unit"].replace("\u03bc", "µ") if ending else "")


def _is_word(head: str) -> bool:
    return head.lower() in _S_OF_WORD


def _times(path: Path, sheet: Sheet) -> tuple[FloatArray, tuple[str, ...]]:
    """Give times in s, and what was assumed: numbers, or dates of ISO 8601 since the first."""
    texts = [row[0] for _, row in sheet.rows]
    if any("T" in text for text in texts):
        return _since_first(path, texts), ()
    times = _numbers(path, sheet.rows)
    head, unit = sheet.head[0], _unit_in(sheet.head[0])
    if unit:
        if unit not in S_OF_UNIT:
            message = f"expected a unit of time such as [s] or [us], got {quoted(head)}"
            raise InputError(path, sheet.head_line, None, message)
        return times * S_OF_UNIT[unit], ()
    if sheet.rate_hz and len(times):
        return _sigrok_times(path, sheet, times, sheet.rate_hz)
    if _is_word(head):
        return times * _S_OF_WORD[head.lower()], ()
    return times, (f"times are in seconds, as {quoted(head)} names no unit such as [us]",)


def _sigrok_times(
    path: Path, sheet: Sheet, times: FloatArray, rate_hz: float
) -> tuple[FloatArray, tuple[str, ...]]:
    """Give times in s of libsigrok, which counts them in the unit that the head says.

    Where it says none: the longest of second, millisecond and so on that a sample lasts. Up to 0.5
    the first sample is at its end, and its duration is cut to whole units: at 24 MHz to 41 ns.
    """
    head = sheet.head[0]
    by_rate = next(power for power in range(len(_WORDS)) if 1000**power >= rate_hz)
    power = _WORDS.index(head.lower()) if _is_word(head) else by_rate
    word, duration = _WORDS[power], 1000**power / rate_hz
    near = np.flatnonzero((gaps := np.diff(times)) < duration // 1.0)  # as whole units are left
    if len(near):
        rows = f"rows at least {duration:g} {word} apart, as the sample rate says"
        line = sheet.rows[int(near[0]) + 1][0]
        raise InputError(path, line, None, f"expected {rows}, got {gaps[near[0]]:g}")
    if 1.0 <= times[0] == duration // 1.0 < duration:
        said = f"{word} are off, as libsigrok cut {duration:.6g} a sample to {times[0]:g}: mended"
        return times / (times[0] * rate_hz), (said,)
    said = f"times are in {word}, as libsigrok writes them at {rate_hz / 1e6:g} MHz"
    return times * _S_OF_WORD[word], () if _is_word(head) else (said,)


def _since_first(path: Path, texts: list[str]) -> FloatArray:
    try:
        stamps = np.array([text.strip().split("+")[0].rstrip("Z") for text in texts], "M8[ns]")
        return np.asarray((stamps - stamps[:1]).astype(np.float64) / NS_PER_S)
    except (ValueError, OverflowError) as error:
        raise InputError(path, None, None, f"expected times: {error}") from error


def _numbers(path: Path, rows: list[Row]) -> FloatArray:
    """Give the numbers of the first column."""
    found = []
    for line, row in rows:
        try:
            found.append(number(row[0]))
        except ValueError:
            found.append(np.nan)
        if not np.isfinite(found[-1]):
            raise InputError(path, line, None, f"expected a time, got {quoted(row[0])}")
    return np.array(found)


def _levels(path: Path, sheet: Sheet, first: int, count: int) -> FloatArray:
    """Give levels 0 and 1 from a column on, NaN where a channel was off; shape (n, count)."""
    if not count or not sheet.rows:
        raise InputError(path, None, None, "expected rows of a time and levels")
    found = []
    for line, row in sheet.rows:
        levels = [_LEVELS.get(cell.strip().upper()) for cell in row[first : first + count]]
        if None in levels:
            wrong = quoted(row[first + levels.index(None)])
            raise InputError(path, line, None, f"expected levels 0 and 1, got {wrong}")
        if len(levels) < count:
            message = f"expected levels of {count} channels, got {len(levels)}"
            raise InputError(path, line, None, message)
        found.append(levels)
    return np.array(found, dtype=float)


def _by_name(
    times: FloatArray, names: list[str], levels: FloatArray
) -> dict[str, tuple[FloatArray, FloatArray]]:
    known = [~np.isnan(levels[:, i]) for i in range(len(names))]
    return {
        name: only_changes(times[rows], levels[rows, i])
        for i, (name, rows) in enumerate(zip(names, known, strict=True))
        if rows.any()
    }


def _step(times: FloatArray) -> float | None:
    """Give the distance of samples that all times are multiples of, as far as decimals show it."""
    gaps = np.diff(np.unique(times))
    if not len(gaps):
        return None
    least = float(gaps.min())
    parts = gaps / least
    is_grid = bool((np.abs(parts - np.round(parts)) < 0.02 * np.maximum(parts, 1.0) / 10.0).all())
    return float(f"{least:.{STEP_DIGITS}g}") if is_grid and least > 0 else None
