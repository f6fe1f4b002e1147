"""Captures of oscilloscopes as CSV: of Rigol, Siglent, Keysight, Tektronix, PicoScope and others.

Voltages stand where logic analysers have levels. Above them stand lines of what the instrument
noted; the last of these names the columns, or their units, with the names in the line before.
Rigol counts samples in place of times, or has neither, and notes their start and increment.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign.csv_text import Row
from skiplatch.errors import InputError, quoted
from skiplatch.importing.analyser import Capture, only_changes, refuse_times
from skiplatch.importing.capture_csv import S_OF_UNIT, Sheet
from skiplatch.importing.units_in_heads import bracketed
from skiplatch.numbers import NUMBER, number

HYSTERESIS = 0.1  # of the span of a channel, to either side of its middle, against noise
MOST_BETWEEN = 0.25  # of the samples, within the hysteresis; noise alone has some half there
LEAST_SAMPLES = 5  # that the longer levels last; noise crosses the hysteresis at every other one
_NOTED = re.compile(rf"(t0|tInc)\s*=\s*({NUMBER})", re.IGNORECASE)
_VOLTS = re.compile(r"(?<=\d)V$")
_OVER_RANGE = {"∞": np.inf, "+∞": np.inf, "-∞": -np.inf, "\u2212∞": -np.inf}
"""How PicoScope writes a voltage that its range does not hold."""
_BEYOND = 10.0
"""Of the span of the others: where samples over the range lie if the others alone do not swing."""
_COUNTS = "sequence"
_START, _INCREMENT = "start", "increment"  # of a count, as heads name them


def with_times(sheet: Sheet) -> Sheet:
    """Put a column of times before the others, where the head notes start and increment alone."""
    noted = {m[1].lower(): float(m[2]) for cell in sheet.head if (m := _NOTED.search(cell))}
    step_s = noted.get("tinc")
    if step_s is None:
        return sheet
    names = [_VOLTS.sub("", cell) for cell in sheet.head if cell and not _NOTED.search(cell)]
    start_s = noted.get("t0", 0.0)
    rows = [(line, [repr(start_s + i * step_s), *row]) for i, (line, row) in enumerate(sheet.rows)]
    return replace(sheet, head=["Time (s)", *names], rows=rows)


def holds_voltages(sheet: Sheet) -> bool:
    """Tell voltages from levels: they have a decimal point, and are neither 0 nor 1."""
    cells = {cell for _, row in sheet.rows for cell in row[1:] if "." in cell}
    values = (_number_or_none(cell) for cell in cells)
    return any(value not in (None, 0.0, 1.0) for value in values)


def read_voltages(path: Path, sheet: Sheet) -> Capture:
    """Read a column of voltages for each channel.

    Raises:
        InputError: It has no samples, or a sample that is no number.
    """
    table: list[Row] = [(sheet.head_line, sheet.head), *sheet.rows]
    first = next((i for i, (_, row) in enumerate(table) if _is_sample(row)), len(table))
    if first in (0, len(table)):
        raise InputError(path, 1, None, "expected names of columns, and samples below them")
    samples = [(line, row) for line, row in table[first:] if any(map(str.strip, row))]
    above = [[cell.strip() for cell in row] for _, row in table[:first]]
    count = sum(1 for cell in samples[0][1] if cell.strip()) - 1
    values = _values(path, samples, count)
    heads, units = _heads_and_units(above)
    times, assumed = _times(heads, units, values[:, 0])
    refuse_times(path, times, [line for line, _ in samples])
    changes, said, noise = {}, [], []
    for name, told in zip(_names(heads, count), values.T[1:], strict=True):
        volts = _in_range(told)
        levels = _levels(volts)
        changes[name] = only_changes(times, levels)
        if _is_noise(volts, levels):
            noise.append(name)
        said.append(f"{name} from {_middle(volts):.3g}")
    high = f"high is, half way between the extremes: {', '.join(said)} on"
    step_s = float(np.median(np.diff(times))) if len(times) > 1 else None
    return Capture(changes, step_s, (*assumed, high), tuple(noise))


def _number_or_none(text: str) -> float | None:
    try:
        return number(text.strip())
    except ValueError:
        return None


def _volts_or_none(text: str) -> float | None:
    return _OVER_RANGE.get(text.strip(), _number_or_none(text))


def _is_sample(row: Sequence[str]) -> bool:
    return len(row) > 1 and None not in (_number_or_none(row[0]), _volts_or_none(row[1]))


def _values(path: Path, samples: Sequence[Row], count: int) -> FloatArray:
    """Give times and voltages, shape (n, 1 + count)."""
    found = []
    for line, row in samples:
        values = [_number_or_none(row[0]), *map(_volts_or_none, row[1 : count + 1])]
        if None in values or len(values) <= count:
            got = quoted(row[values.index(None)]) if None in values else f"{len(values)} cells"
            expected = f"expected a time and voltages of {count} channels, got {got}"
            raise InputError(path, line, None, expected)
        found.append(values)
    return np.array(found, dtype=float)


def _times(
    heads: Sequence[str], units: Sequence[str], column: FloatArray
) -> tuple[FloatArray, list[str]]:
    """Give times in s, and what was assumed of their unit."""
    if units[0].lower() == _COUNTS:
        named = zip((head.lower() for head in heads), units, strict=False)
        noted = {head: _number_or_none(cell) for head, cell in named}
        if step := noted.get(_INCREMENT):
            return (noted.get(_START) or 0.0) + column * step, []
    if unit := _unit_of(units[0]):
        return column * S_OF_UNIT[unit], []
    return column, [f"times are in seconds, as {quoted(units[0])} names no unit such as (ms)"]


def _unit_of(cell: str) -> str:
    """Give the unit of time in a cell, alone or in brackets; empty where there is none."""
    word = (bracketed(cell)[1] or cell.strip("()[]")).lower()
    return next((unit for unit in (word, f"{word}s") if unit in S_OF_UNIT), "")


def _heads_and_units(above: Sequence[Sequence[str]]) -> tuple[Sequence[str], Sequence[str]]:
    """Give the line that names the columns, and the one with their units, which may be the same."""
    last = above[-1]
    word = last[0].strip("()[]").lower()
    is_of_units = word == _COUNTS or _unit_of(word)
    return (above[-2] if is_of_units and len(above) > 1 else last), last


def _names(heads: Sequence[str], count: int) -> list[str]:
    """Give the names of channels; where the heads tell none apart, CH1 and so on."""
    names = [bracketed(head)[0].strip() for head in heads[1 : count + 1]]
    if len(names) == count == len(set(names)) and all(names):
        return names
    return [f"CH{number}" for number in range(1, count + 1)]


def _in_range(volts: FloatArray) -> FloatArray:
    """Put samples over the range at the extremes of the others, beyond if these do not swing."""
    is_held = np.isfinite(volts)
    if is_held.all():
        return volts
    held = volts[is_held] if is_held.any() else np.array([0.0, 1.0])
    low, high = float(held.min()), float(held.max())
    levels = _levels(held)
    swings = levels.min() < levels.max() and not _is_noise(held, levels)
    spare = 0.0 if swings else _BEYOND * ((high - low) or 1.0)
    placed: FloatArray = np.clip(volts, low - spare, high + spare)
    return placed


def _levels(volts: FloatArray) -> FloatArray:
    """Give 1 from above the middle of a channel on, until below it, each by some hysteresis."""
    is_told = ~_is_between(volts)
    is_told[0] = True
    told = np.maximum.accumulate(np.where(is_told, np.arange(len(volts)), 0))
    return np.asarray((volts[told] > _middle(volts)).astype(np.float64))


def _middle(volts: FloatArray) -> float:
    return float(volts.min() + volts.max()) / 2


def _is_between(volts: FloatArray) -> NDArray[np.bool_]:
    """Tell which samples are too near the middle to be high or low."""
    spare = HYSTERESIS * (volts.max() - volts.min())
    return np.asarray(np.abs(volts - _middle(volts)) <= spare)


def _is_noise(volts: FloatArray, levels: FloatArray) -> bool:
    """Tell a channel that does not swing between two levels, but idles or wanders between them."""
    if levels.min() == levels.max():
        return False
    changes = np.flatnonzero(np.diff(levels))
    lasting = np.diff(changes, prepend=-1, append=len(levels) - 1)
    is_brief = np.percentile(lasting, 75) < LEAST_SAMPLES
    return bool(is_brief or _is_between(volts).mean() > MOST_BETWEEN)
