"""Reading and writing nominal.toml."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from skiplatch.campaign.nominal import FORMAT, KEYS, SECTIONS, Key, Kind, Nominal
from skiplatch.campaign.toml_positions import KeyPath, Position, key_positions
from skiplatch.campaign.toml_text import parse_toml, read_toml_text
from skiplatch.errors import InputError, hint, quoted
from skiplatch.files import atomic_write_text

_FORMAT_KEY = ("format",)
_KIND_KEY = ("kind",)
_REQUIRED: tuple[KeyPath, ...] = (_KIND_KEY, *KEYS)


def read_nominal(path: str | os.PathLike[str]) -> Nominal:
    """Read nominal.toml.

    Raises:
        InputError: The file cannot be read; it is no TOML; the format is another one; a key is
            unknown or missing; a value is of the wrong type or makes no sense.
    """
    path = Path(path)
    text = read_toml_text(path)
    document = _Document(path, _entries(parse_toml(path, text)), key_positions(text))
    document.check_format()
    document.check_keys()
    return Nominal(
        kind=document.kind(),
        **{name: values(**document.numbers(name)) for name, values in SECTIONS.items()},
    )


def write_nominal(path: str | os.PathLike[str], nominal: Nominal) -> None:
    """Write nominal.toml so that it is read back exactly.

    Raises:
        InputError: The file cannot be written.
        ValueError: Some number is none that the format admits.
    """
    atomic_write_text(path, format_nominal(nominal))


def format_nominal(nominal: Nominal) -> str:
    """Give the text of nominal.toml."""
    lines = [f'format = "{FORMAT}"', f'kind = "{nominal.kind}"']
    previous = None
    for (section, name), key in KEYS.items():
        value = float(getattr(getattr(nominal, section), name))
        if not _fits(key, value):
            raise ValueError(f"{section}.{name}: expected {key.constraint.words}, got {value}")
        if section != previous:
            lines += ["", f"[{section}]"]
            previous = section
        lines.append(f"{name} = {value!r}")
    return "\n".join(lines) + "\n"


@dataclass(frozen=True, slots=True)
class _Document:
    """What stands in the file, by key, and where it stands."""

    path: Path
    entries: Mapping[KeyPath, object]
    positions: Mapping[KeyPath, Position]

    def check_format(self) -> None:
        """Judge the format before the keys, which another one may have others of."""
        self._require(_FORMAT_KEY)
        if self.entries[_FORMAT_KEY] != FORMAT:
            raise self._wrong_value(_FORMAT_KEY, f'"{FORMAT}"')

    def check_keys(self) -> None:
        """Complain of the first unknown key, else of the first missing one."""
        for key in self.entries:
            if len(key) == 1 and key[0] in SECTIONS:
                raise self._wrong_value(key, "a table")
            if key != _FORMAT_KEY and key not in _REQUIRED:
                raise self._unknown(key)
        for key in _REQUIRED:
            self._require(key)

    def kind(self) -> Kind:
        """Give the kind or complain of it."""
        for kind in Kind:
            if self.entries[_KIND_KEY] == kind:
                return kind
        raise self._wrong_value(_KIND_KEY, " or ".join(f'"{kind}"' for kind in Kind))

    def numbers(self, section: str) -> dict[str, float]:
        """Give the numbers of a section by name, or complain of one."""
        return {key[1]: self._number(key) for key in KEYS if key[0] == section}

    def _number(self, key: tuple[str, str]) -> float:
        value, unit, constraint = self.entries[key], KEYS[key].unit, KEYS[key].constraint
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._wrong_value(key, f"{constraint.words} in {unit}")
        number = _as_float(value)
        if not _fits(KEYS[key], number):
            raise self._wrong_value(key, f"{constraint.words_against(number)} in {unit}")
        return number

    def _require(self, key: KeyPath) -> None:
        if key not in self.entries:
            section = self.positions.get(key[:-1])
            line = section.line if section else None
            raise InputError(self.path, line, None, f"missing key {quoted('.'.join(key))}")

    def _unknown(self, key: KeyPath) -> InputError:
        place = self._place(key)
        name = ".".join(key)
        known = SECTIONS if len(key) == 1 else (".".join(path) for path in KEYS)
        column = place.key_column if place else None
        return self._error(place, column, f"unknown key {quoted(name)}{hint(name, known)}")

    def _wrong_value(self, key: KeyPath, expected: str) -> InputError:
        place = self._place(key)
        got = _described(self.entries[key])
        column = place.value_column if place else None
        return self._error(place, column, f"{'.'.join(key)}: expected {expected}, got {got}")

    def _place(self, key: KeyPath) -> Position | None:
        return self.positions.get(key) or self.positions.get(key[:-1])

    def _error(self, place: Position | None, column: int | None, message: str) -> InputError:
        return InputError(self.path, place.line if place else None, column, message)


def _entries(tables: Mapping[str, Any]) -> dict[KeyPath, object]:
    """Lay the keys of the known sections out flat."""
    entries: dict[KeyPath, object] = {}
    for name, value in tables.items():
        if name in SECTIONS and isinstance(value, dict):
            entries |= {(name, key): inner for key, inner in value.items()}
        else:
            entries[name,] = value
    return entries


def _fits(key: Key, value: float) -> bool:
    return bool(key.constraint.holds(np.array(value)))


def _as_float(value: float) -> float:
    """Turn an integer into a float, one that is too large into infinity."""
    try:
        return float(value)
    except OverflowError:
        return float("inf") if value > 0 else float("-inf")


def _described(value: object) -> str:
    match value:
        case str():
            return quoted(value)
        case bool():
            return "true" if value else "false"
        case int() if abs(value) >= 10**20:
            return "a whole number of many digits"
        case dict():
            return "a table"
        case list():
            return "an array"
    return str(value)
