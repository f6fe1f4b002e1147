"""How a simulated machine truly is: TRUTH.toml, or drawn by a seed."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from skiplatch.campaign.toml_positions import KeyPath, key_positions
from skiplatch.campaign.toml_text import parse_toml, read_toml_text
from skiplatch.errors import InputError, hint
from skiplatch.kinematics.five_axis import RotaryTruth, Truth
from skiplatch.kinematics.machine import LETTERS, Machine, Vector

MOST = 1e5
OFFSET_UM, TILT_ARCSEC = 100.0, 30.0
BACKLASH_ARCSEC, SWING_ARCSEC, REPEATABILITY_ARCSEC = 8.0, 1.0, 0.2
PLAIN_KEYS = tuple(
    f.name for f in fields(RotaryTruth) if f.name not in ("offset_um", "tilt_arcsec", "zero_arcsec")
)
TOP_KEYS = tuple(f.name for f in fields(Truth))


def draw_truth(machine: Machine, seed: int) -> Truth:
    """Draw what a machine some years after its calibration may be, the same for the same seed."""
    dice = np.random.default_rng(seed)
    axes = {axis.letter: _draw_axis(axis.letter, dice) for axis in machine.axes}
    return Truth(axes=axes)


def _draw_axis(letter: str, dice: np.random.Generator) -> RotaryTruth:
    offset_um = dice.uniform(-OFFSET_UM, OFFSET_UM, 3)
    tilt_arcsec = dice.uniform(-TILT_ARCSEC, TILT_ARCSEC, 3)
    offset_um[LETTERS.index(letter)] = tilt_arcsec[LETTERS.index(letter)] = 0.0
    return RotaryTruth(
        offset_um=cast(Vector, tuple(offset_um)),
        tilt_arcsec=cast(Vector, tuple(tilt_arcsec)),
        backlash_arcsec=dice.uniform(0.0, BACKLASH_ARCSEC),
        twice_arcsec=dice.uniform(0.0, SWING_ARCSEC),
        twice_phase_deg=dice.uniform(0.0, 360.0),
        repeatability_arcsec=REPEATABILITY_ARCSEC,
    )


def read_truth(path: Path, machine: Machine) -> Truth:
    """Read TRUTH.toml: for each axis the location errors by name, and its own errors.

    Raises:
        InputError: The file cannot be read, or a value is wrong.
    """
    return _Reader(path).truth(machine)


class _Reader:
    def __init__(self, path: Path) -> None:
        text = read_toml_text(path)
        self._path = path
        self._places = key_positions(text)
        self._document = parse_toml(path, text)

    def _fail(self, key: KeyPath, message: str) -> InputError:
        place = self._places.get(key)
        line = place.line if place else None
        column = (place.value_column or place.key_column) if place else None
        return InputError(self._path, line, column, f"{'.'.join(key)}: {message}")

    def _unknown(self, key: KeyPath, known: Sequence[str]) -> InputError:
        place = self._places.get(key)
        line, column = (place.line, place.key_column) if place else (None, None)
        message = f"{'.'.join(key)}: unknown key{hint(key[-1], known)}"
        return InputError(self._path, line, column, message)

    def truth(self, machine: Machine) -> Truth:
        values: dict[str, Any] = {}
        for key, value in self._document.items():
            if key not in TOP_KEYS:
                raise self._unknown((key,), TOP_KEYS)
            if key == "axes":
                values[key] = self._axes(value, machine)
            elif key.endswith("radius_mm"):
                values[key] = self._number((key,), value)
            else:
                values[key] = self._vector((key,), value)
        return replace(Truth(), **values)

    def _axes(self, axes: object, machine: Machine) -> dict[str, RotaryTruth]:
        if not isinstance(axes, dict):
            raise self._fail(("axes",), "expected a table for each axis, such as [axes.C]")
        for letter, table in axes.items():
            if letter not in machine.letters or not isinstance(table, dict):
                raise self._fail(("axes", letter), "expected a table of an axis of the machine")
        return {letter: self._axis(letter, table) for letter, table in axes.items()}

    def _axis(self, letter: str, table: Mapping[str, Any]) -> RotaryTruth:
        known = [*_error_names(letter), *PLAIN_KEYS]
        values: dict[str, float] = {}
        for name, value in table.items():
            if name not in known:
                raise self._unknown(("axes", letter, name), known)
            values[name] = self._number(("axes", letter, name), value)
        return RotaryTruth(
            offset_um=_three(values, [f"{x}O{letter}_um" for x in "XYZ"]),
            tilt_arcsec=_three(
                values, [f"{x}O{letter}_arcsec" if x != letter else "" for x in LETTERS]
            ),
            zero_arcsec=values.get(f"{letter}O{letter}_arcsec", 0.0),
            **{name: value for name, value in values.items() if name in PLAIN_KEYS},
        )

    def _number(self, key: KeyPath, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= MOST:
            raise self._fail(key, f"expected a number of at most {MOST:g}")
        if key[-1].startswith(("backlash", "repeatability")) and value < 0.0:
            raise self._fail(key, "expected a number of at least 0")
        if key[-1].endswith("radius_mm") and value <= 0.0:
            raise self._fail(key, "expected a number above 0")
        return float(value)

    def _vector(self, key: KeyPath, value: object) -> Vector:
        if not isinstance(value, list) or len(value) != len(LETTERS):
            raise self._fail(key, "expected a list of 3 numbers")
        return cast(Vector, tuple(self._number(key, item) for item in value))


def _error_names(letter: str) -> list[str]:
    offsets = [f"{x}O{letter}_um" for x, own in zip("XYZ", LETTERS, strict=True) if own != letter]
    return offsets + [f"{x}O{letter}_arcsec" for x in LETTERS]


def _three(values: Mapping[str, float], names: list[str]) -> Vector:
    return cast(Vector, tuple(values.get(name, 0.0) for name in names))
