"""Reading nominal.toml; all that is wrong in it is told at once."""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from skiplatch.campaign.believed_effect import BelievedEffect
from skiplatch.campaign.constraints import SIZE_UM, Range
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.campaign.kind import Kind
from skiplatch.campaign.nominal import (
    FORMATS,
    KEYS,
    SECTIONS,
    Key,
    Nominal,
)
from skiplatch.campaign.nominal_text import fits
from skiplatch.campaign.toml_positions import (
    KeyPath,
    Position,
    is_nth_table,
    key_positions,
    nth_table,
)
from skiplatch.campaign.toml_text import parse_toml, read_toml_text
from skiplatch.errors import InputError, hint, quoted
from skiplatch.former_names import present_names

DATUM = "datum"
EFFECT = "effect"
NOTES = "notes"
_TABLES = (*SECTIONS, DATUM)
_LEAST, _GREATEST = ("axis", "min_mm"), ("axis", "max_mm")
_FORMAT: KeyPath = ("format",)
_KIND: KeyPath = ("kind",)
_FREE: KeyPath = (DATUM, "free")
_U_UM: KeyPath = (DATUM, "u_um")
_PARAMETER = Key("", Range("a number"), 0.0, "parameter of an effect", "")
_U = Key("", Range("a number >= 0", low=0.0), 0.0, "standard uncertainty", "")
_U_OF_DATUM = Key("µm", SIZE_UM, 0.0, "standard uncertainty", "")


class NominalError(InputError):
    """Values in nominal.toml are wrong.

    Attributes:
        so_far: What the rest says of the rig; what is wrong stands at its default there.
    """

    so_far: Nominal | None = None


def read_nominal(path: str | os.PathLike[str]) -> Nominal:
    """Read nominal.toml.

    Raises:
        InputError: The file cannot be read; it is no TOML; the format is another one; a key is
            unknown, or missing in version 1; a value is of the wrong type or makes no sense.
    """
    path = Path(path)
    return parse_nominal(path, read_toml_text(path))


def parse_nominal(path: Path, text: str) -> Nominal:
    """Read the text of nominal.toml; see `read_nominal`."""
    document = _Document(path, _entries(parse_toml(path, text)), key_positions(text))
    version = document.version()
    document.check_keys(version)
    given = {key: document.number(key, KEYS[key]) for key in KEYS if key in document.entries}
    numbers = {key: given[key][0] if key in given else KEYS[key].default for key in KEYS}
    document.check_reach(numbers[_LEAST], numbers[_GREATEST])
    kind = document.kind()
    datum, effects = document.datum(kind), document.effects()
    nominal = Nominal(
        kind=kind,
        **{name: _section(name, numbers) for name in SECTIONS},
        uncertainty={key: u for key, (_, u) in given.items() if u is not None},
        datum=datum,
        believed_effects=effects,
        version=version,
    )
    document.refuse(nominal)
    if nominal.version == 1:
        return nominal
    # A negative pretravel makes version 2 of a file of version 1, which knows no new key.
    return replace(nominal, unknown=frozenset(KEYS.keys() - given.keys()))


def _section(section: str, numbers: Mapping[tuple[str, str], float]) -> Any:  # noqa: ANN401
    """Make a section of nominal.toml, each of which has a class of its own."""
    return SECTIONS[section](**{key: v for (where, key), v in numbers.items() if where == section})


@dataclass(frozen=True, slots=True)
class _Document:
    """What stands in the file, by key, where it stands, and what is wrong with it."""

    path: Path
    entries: Mapping[KeyPath, object]
    positions: Mapping[KeyPath, Position]
    errors: list[InputError] = field(default_factory=list)

    def refuse(self, so_far: Nominal) -> None:
        """Raise what was found to be wrong, if anything was."""
        if self.errors:
            error = NominalError.together(self.errors)
            error.so_far = so_far
            raise error

    def version(self) -> int:
        """Judge the format before the keys, which another one may have others of."""
        if _FORMAT not in self.entries:
            raise self._missing([_FORMAT])
        for version, name in FORMATS.items():
            if self.entries[_FORMAT] == name:
                return version
        raise self._wrong(_FORMAT, " or ".join(f'"{name}"' for name in FORMATS.values()))

    def check_keys(self, version: int) -> None:
        """Complain of unknown keys, else of those that are missing."""
        for key in self.entries:
            if len(key) == 1 and key[0] in {*_TABLES, NOTES}:
                self._tell(self._wrong(key, "a table"))
            elif key not in _known():
                self._tell(self._unknown(key))
            elif version == 1 and key not in (_FORMAT, _KIND, *_in_version_1()):
                self._tell(self._unknown(key, f'; it needs format = "{FORMATS[2]}"'))
        missing = [key for key in (_KIND, *_in_version_1()) if key not in self.entries]
        if version == 1 and missing and not self.errors:
            self._tell(self._missing(missing))

    def check_reach(self, least_mm: float, greatest_mm: float) -> None:
        """Complain of an axis that can reach nothing."""
        if least_mm > greatest_mm:
            expected = f"at least {'.'.join(_LEAST)} = {least_mm:g} in mm"
            self._tell(self._wrong(_GREATEST, expected, greatest_mm))

    def kind(self) -> Kind:
        """Give the kind, or complain of it."""
        return Kind(self._choice(_KIND, [*Kind], Kind.MACHINE))

    def datum(self, kind: Kind) -> Datum:
        """Give how the place of the surface is unknown, or complain of it."""
        default = Datum.of_kind(kind)
        free = DatumFreedom(self._choice(_FREE, [*DatumFreedom], default.free))
        if _U_UM not in self.entries:
            return Datum(free)
        return Datum(free, self._plain(_U_UM, self.entries[_U_UM], _U_OF_DATUM))

    def effects(self) -> tuple[BelievedEffect, ...]:
        """Give the effects that are believed, or complain of each that is wrong."""
        written = self.entries.get((EFFECT,), [])
        if not isinstance(written, list):
            self._tell(self._wrong((EFFECT,), "tables written as [[effect]]"))
            return ()
        numbered = enumerate(written, 1)
        effects = [self._effect(table, (EFFECT, nth_table(n))) for n, table in numbered]
        return tuple(effect for effect in effects if effect is not None)

    def number(self, key: KeyPath, expected: Key) -> tuple[float, float | None]:
        """Give the number of a key and its standard uncertainty, if it is given one."""
        return self._measured(key, self.entries[key], expected)

    def _effect(self, table: object, where: KeyPath) -> BelievedEffect | None:
        """Give an effect, or complain of it and give none."""
        told = len(self.errors)
        if not isinstance(table, dict) or not isinstance(table.get("id"), str):
            self._tell(self._wrong(where, 'a table with id = "…"', table))
            return None
        numbers = {
            name: self._measured((*where, name), value, _PARAMETER)
            for name, value in self._named(table, where).items()
            if name != "id"
        }
        if len(self.errors) > told:
            return None
        return BelievedEffect(
            table["id"],
            {name: value for name, (value, _) in numbers.items()},
            {name: u for name, (_, u) in numbers.items() if u is not None},
        )

    def _named(self, table: dict[str, object], where: KeyPath) -> dict[str, object]:
        try:
            return present_names(table)
        except ValueError as error:
            self._tell(self._error(self._place(where), None, str(error)))
            return table

    def _choice(self, key: KeyPath, choices: Sequence[str], default: str) -> str:
        value = self.entries.get(key, default)
        if isinstance(value, str) and value in choices:
            return value
        *others, last = (f'"{choice}"' for choice in choices)
        self._tell(self._wrong(key, f"{', '.join(others)} or {last}"))
        return default

    def _measured(self, key: KeyPath, given: object, expected: Key) -> tuple[float, float | None]:
        if not isinstance(given, dict):
            return self._plain(key, given, expected), None
        if "value" not in given or given.keys() - {"value", "u"}:
            self._tell(self._wrong(key, "a number or {value = …, u = …}", given))
            return expected.default, None
        value = self._plain(key, given["value"], expected)
        return value, self._plain((*key, "u"), given["u"], _U) if "u" in given else None

    def _plain(self, key: KeyPath, value: object, expected: Key) -> float:
        unit = f" in {expected.unit}" if expected.unit else ""
        if isinstance(value, bool) or not isinstance(value, int | float):
            self._tell(self._wrong(key, f"{expected.constraint.words}{unit}", value))
            return expected.default
        number = _as_float(value)
        if not fits(expected, number):
            words = expected.constraint.words_against(number)
            self._tell(self._wrong(key, f"{words}{unit}", value))
            return expected.default
        return number

    def _tell(self, error: InputError) -> None:
        self.errors.append(error)

    def _missing(self, keys: list[KeyPath]) -> InputError:
        names = ", ".join(quoted(".".join(key)) for key in keys)
        section = self.positions.get(keys[0][:-1])
        line = section.line if section and len(keys) == 1 else None
        message = f"missing {'keys' if len(keys) > 1 else 'key'} {names}"
        if keys != [_FORMAT]:
            message += f'; with format = "{FORMATS[2]}" any may be left out'
        return InputError(self.path, line, None, message)

    def _unknown(self, key: KeyPath, why: str = "") -> InputError:
        place = self._place(key)
        name = ".".join(key)
        sections = (*_TABLES, EFFECT, NOTES)
        known = sections if len(key) == 1 else (".".join(path) for path in _known())
        column = place.key_column if place else None
        return self._error(place, column, f"unknown key {quoted(name)}{why or hint(name, known)}")

    def _wrong(self, key: KeyPath, expected: str, value: object = None) -> InputError:
        place = self._place(key)
        got = _described(self.entries[key] if value is None else value)
        column = place.value_column if place else None
        name = ".".join(part for part in key if not is_nth_table(part))
        return self._error(place, column, f"{name}: expected {expected}, got {got}")

    def _place(self, key: KeyPath) -> Position | None:
        return self.positions.get(key) or self.positions.get(key[:-1])

    def _error(self, place: Position | None, column: int | None, message: str) -> InputError:
        return InputError(self.path, place.line if place else None, column, message)


def _known() -> Iterator[KeyPath]:
    yield from (_FORMAT, _KIND, (EFFECT,), _FREE, _U_UM)
    yield from KEYS


def _in_version_1() -> Iterator[KeyPath]:
    return (path for path, key in KEYS.items() if key.since == 1)


def _entries(tables: Mapping[str, Any]) -> dict[KeyPath, object]:
    """Lay the keys of the known sections out flat, without the notes."""
    entries: dict[KeyPath, object] = {}
    for name, value in tables.items():
        if name in _TABLES and isinstance(value, dict):
            entries |= {(name, key): inner for key, inner in value.items()}
        elif name != NOTES or not isinstance(value, dict):
            entries[name,] = value
    return entries


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
