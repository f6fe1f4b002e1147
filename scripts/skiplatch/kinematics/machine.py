"""What is believed of a machine's rotary axes: ``MACHINE.toml``."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from sys import float_info
from typing import Any

from skiplatch.campaign.toml_positions import KeyPath, key_positions
from skiplatch.campaign.toml_text import parse_toml, read_toml_text
from skiplatch.errors import InputError, hint, quoted
from skiplatch.kinematics.grid import Grid, GridError, grid_of

LETTERS = ("A", "B", "C")
DEFAULT_TRAVEL_DEG = {"A": (-90.0, 90.0), "B": (-90.0, 90.0), "C": (-180.0, 180.0)}
AXIS_KEYS = ("direction", "point_mm", "range_deg", "datum_deg")
SPINDLE = "spindle_mm"
PRESET = "preset_mm"
TIP = "tip_shift_mm"
GRID = "grid"
CONTROL = "control"  # see `read_control`
NOTES = "notes"
TOP_KEYS = ("table", "head", "tool_mm", TIP, SPINDLE, PRESET, GRID, "axes", CONTROL, NOTES)
UNIT_TOLERANCE = 1e-4
OWN_COSINE_MIN = 0.5
FARTHEST_MM = 1e5
TURNS_MAX_DEG = 3600.0
DATUM_MAX_DEG = 360.0

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class RotaryAxis:
    """A rotary axis as believed, with every axis at 0.

    Attributes:
        letter: ``A``, ``B`` or ``C``.
        in_head: It carries the tool, not the sphere.
        direction: Unit vector in machine coordinates; the sense of positive angles.
        point_mm: A point of the axis line, in machine coordinates.
        travel_deg: Lowest and highest angle, for recommended positions.
        datum_deg: The control shows so much more than the axis's encoder.
    """

    letter: str
    in_head: bool
    direction: Vector
    point_mm: Vector
    travel_deg: tuple[float, float]
    datum_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class Machine:
    """The chain: table axes from the bed outwards, then head axes from the ram to the tool.

    Attributes:
        axes: The rotary axes.
        tool_mm: The probe's tip with every axis at 0, or None where it is not known.
        tip_shift_mm: How far the tip has since moved from there, by cycle 452: coordinates are
            those of the machine as it was.
        grid: Where cycle 453 measures, and what it compensates; None where there is none.
    """

    axes: tuple[RotaryAxis, ...]
    tool_mm: Vector | None
    tip_shift_mm: Vector = (0.0, 0.0, 0.0)
    grid: Grid | None = None

    @property
    def letters(self) -> tuple[str, ...]:
        """The names of the axes, in the order of the chain."""
        return tuple(axis.letter for axis in self.axes)


class _Reader:
    """Takes values out of the parsed file, and knows where they stand."""

    def __init__(self, path: Path) -> None:
        text = read_toml_text(path)
        self._path = path
        self._places = key_positions(text)
        self.document = parse_toml(path, text)

    def fail(self, key: KeyPath, message: str) -> InputError:
        place = self._places.get(key)
        if place is None:
            return InputError(self._path, None, None, f"{'.'.join(key)}: {message}")
        column = place.key_column if place.value_column is None else place.value_column
        return InputError(self._path, place.line, column, f"{'.'.join(key)}: {message}")

    def letters(self, key: str) -> list[str]:
        value = self.document.get(key, [])
        if not isinstance(value, list) or not all(letter in LETTERS for letter in value):
            raise self.fail((key,), 'expected a list of "A", "B" and "C"')
        return value

    def numbers(self, table: Mapping[str, Any], key: KeyPath, count: int) -> list[float]:
        value = table[key[-1]]
        if not isinstance(value, list) or len(value) != count or not all(map(_is_number, value)):
            raise self.fail(key, f"expected a list of {count} finite numbers")
        return [float(number) for number in value]

    def vector(self, table: Mapping[str, Any], key: KeyPath) -> Vector:
        x, y, z = self.numbers(table, key, 3)
        if max(abs(x), abs(y), abs(z)) > FARTHEST_MM:
            raise self.fail(key, f"expected coordinates of at most {FARTHEST_MM:g}")
        return x, y, z

    def refuse_unknown(
        self, table: Mapping[str, Any], prefix: KeyPath, known: tuple[str, ...]
    ) -> None:
        for key in table:
            if key not in known:
                expected = hint(key, known) or f"; expected one of {', '.join(known)}"
                raise self.fail((*prefix, key), f"unknown key{expected}")


def _is_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= float_info.max


def read_machine(path: Path) -> Machine:
    """Read ``MACHINE.toml``; in a table ``[notes]`` anything may stand.

    Raises:
        InputError: The file cannot be read, or a value is wrong.
    """
    reader = _Reader(path)
    document = reader.document
    reader.refuse_unknown(document, (), TOP_KEYS)
    table, head = reader.letters("table"), reader.letters("head")
    chain = [*table, *head]
    if not chain:
        raise reader.fail(("table",), 'expected at least one axis in "table" or "head"')
    for letter in sorted(set(chain)):
        if chain.count(letter) > 1:
            key = "table" if letter in table else "head"
            raise reader.fail((key,), f"axis {letter} stands in the chain twice")
    axes = _axes(reader, chain)
    tool_mm = reader.vector(document, ("tool_mm",)) if "tool_mm" in document else None
    rotary = (
        _axis(reader, axes[name], name, place >= len(table)) for place, name in enumerate(chain)
    )
    shift_mm = reader.vector(document, (TIP,)) if TIP in document else (0.0, 0.0, 0.0)
    grid = _grid(reader, document[GRID], chain) if GRID in document else None
    return Machine(tuple(rotary), tool_mm, shift_mm, grid)


def _grid(reader: _Reader, table: object, letters: list[str]) -> Grid:
    if not isinstance(table, dict):
        raise reader.fail((GRID,), "expected a table, such as [grid] with C = [-90, 0, 90]")
    try:
        return grid_of(table, letters)
    except GridError as error:
        key = (GRID,) if error.key is None else (GRID, error.key)
        raise reader.fail(key, str(error)) from error


def read_spindle(path: Path) -> Vector:
    """Read where the spindle nose is with every axis at 0: the start of the chain, else the origin.

    Raises:
        InputError: The file cannot be read, or the place is none.
    """
    reader = _Reader(path)
    if SPINDLE not in reader.document:
        return 0.0, 0.0, 0.0
    return reader.vector(reader.document, (SPINDLE,))


def read_preset(path: Path) -> Vector | None:
    """Read where the preset was set for cycle 452, with every axis at 0; None if it is not told.

    Raises:
        InputError: The file cannot be read, or the place is none.
    """
    reader = _Reader(path)
    return reader.vector(reader.document, (PRESET,)) if PRESET in reader.document else None


def is_possible(machine: Machine) -> bool:
    """Tell whether `read_machine` could have given it."""
    points_mm = [axis.point_mm for axis in machine.axes]
    points_mm += [machine.tip_shift_mm]
    points_mm += [machine.tool_mm] if machine.tool_mm is not None else []
    return (
        0 < len(machine.axes) == len(set(machine.letters))
        and all(abs(coordinate) <= FARTHEST_MM for point in points_mm for coordinate in point)
        and all(map(_is_possible_axis, machine.axes))
    )


def _is_possible_axis(axis: RotaryAxis) -> bool:
    low, high = axis.travel_deg
    return (
        axis.letter in LETTERS
        and abs(math.hypot(*axis.direction) - 1.0) <= UNIT_TOLERANCE
        and -TURNS_MAX_DEG <= low < high <= TURNS_MAX_DEG
        and abs(axis.datum_deg) <= DATUM_MAX_DEG
    )


def _axes(reader: _Reader, chain: list[str]) -> dict[str, dict[str, Any]]:
    axes = reader.document.get("axes", {})
    if not isinstance(axes, dict):
        raise reader.fail(("axes",), "expected a table for each axis, such as [axes.A]")
    for letter in chain:
        if not isinstance(axes.get(letter), dict):
            raise reader.fail(("axes", letter), f"axis {letter} has no table [axes.{letter}]")
    for letter in axes:
        if letter not in chain:
            message = f'axis {quoted(letter)} is neither in "table" nor in "head"'
            raise reader.fail(("axes", letter), message)
    return axes


def _axis(reader: _Reader, table: Mapping[str, Any], letter: str, in_head: bool) -> RotaryAxis:  # noqa: FBT001
    section = ("axes", letter)
    reader.refuse_unknown(table, section, AXIS_KEYS)
    for key in ("direction", "point_mm"):
        if key not in table:
            raise reader.fail(section, f'missing key "{key}"')
    travel = DEFAULT_TRAVEL_DEG[letter]
    if "range_deg" in table:
        travel = _travel(reader, table, (*section, "range_deg"))
    datum_deg = table.get("datum_deg", 0.0)
    if not _is_number(datum_deg) or abs(datum_deg) > DATUM_MAX_DEG:
        message = f"expected a number of at most {DATUM_MAX_DEG:g}"
        raise reader.fail((*section, "datum_deg"), message)
    return RotaryAxis(
        letter,
        in_head,
        _direction(reader, table, (*section, "direction"), letter),
        reader.vector(table, (*section, "point_mm")),
        travel,
        float(datum_deg),
    )


def _direction(reader: _Reader, table: Mapping[str, Any], key: KeyPath, letter: str) -> Vector:
    x, y, z = reader.vector(table, key)
    length = math.hypot(x, y, z)
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise reader.fail(key, f"expected a unit vector, got one of length {length:.6g}")
    own = LETTERS.index(letter)
    if abs((x, y, z)[own]) < OWN_COSINE_MIN:
        raise reader.fail(key, f"axis {letter} has to turn about {'XYZ'[own]}, within 60°")
    return x / length, y / length, z / length


def _travel(reader: _Reader, table: Mapping[str, Any], key: KeyPath) -> tuple[float, float]:
    low, high = reader.numbers(table, key, 2)
    if not -TURNS_MAX_DEG <= low < high <= TURNS_MAX_DEG:
        raise reader.fail(key, "expected the lowest and the highest angle in degrees")
    return low, high
