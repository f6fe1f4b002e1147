"""How the controller is set up: the table ``[control]`` of MACHINE.toml."""

from dataclasses import fields
from pathlib import Path
from typing import Any

from skiplatch.campaign import InputPath
from skiplatch.campaign.toml_positions import KeyPath, key_positions
from skiplatch.campaign.toml_text import parse_toml, read_toml_text
from skiplatch.errors import InputError, hint
from skiplatch.kinematics.cycle import Control

SECTION = "control"
NOT_OF_THE_FILE = ("path", "tip_radius_mm")
"""These come from elsewhere: the command line, and the probe."""
KEYS = {f.name: f for f in fields(Control) if f.name not in NOT_OF_THE_FILE}
ABOVE_ZERO = ("touch_feed_mm_min", "search_mm", "start_above_mm")
MOST = 1e6


def read_control(path: Path, *, input_path: InputPath, tip_radius_mm: float) -> Control:
    """Read the table; what it leaves out is as in `Control`.

    Raises:
        InputError: The file cannot be read, or a value is wrong.
    """
    text = read_toml_text(path)
    places = key_positions(text)
    table = parse_toml(path, text).get(SECTION, {})

    def fail(key: KeyPath, message: str) -> InputError:
        place = places.get(key)
        line, column = (place.line, place.key_column) if place else (None, None)
        return InputError(path, line, column, f"{'.'.join(key)}: {message}")

    if not isinstance(table, dict):
        raise fail((SECTION,), "expected a table")
    values: dict[str, Any] = {}
    for name, value in table.items():
        if name not in KEYS:
            raise fail((SECTION, name), f"unknown key{hint(name, KEYS)}")
        if (wrong := _wrong(name, value)) is not None:
            raise fail((SECTION, name), f"expected {wrong}")
        values[name] = tuple(map(float, value)) if isinstance(value, list) else value
    return Control(path=input_path, tip_radius_mm=tip_radius_mm, **values)


def _wrong(name: str, value: object) -> str | None:
    """Tell what was expected, or nothing when the value fits."""
    default = KEYS[name].default
    if isinstance(default, bool):
        return None if isinstance(value, bool) else "true or false"
    if isinstance(default, tuple):
        fits = isinstance(value, list) and len(value) == len(default)
        is_grid = name == "hirth_deg"
        fits = fits and all(_is_number(v) and (v >= 0.0 or not is_grid) for v in value)  # type: ignore[attr-defined]
        return None if fits else f"a list of {len(default)} numbers{' from 0' if is_grid else ''}"
    if isinstance(default, int):
        fits = isinstance(value, int) and not isinstance(value, bool) and -1 <= value <= MOST
        return None if fits else "a whole number from -1"
    low = 1e-3 if name in ABOVE_ZERO else 0.0
    fits = _is_number(value) and value >= low  # type: ignore[operator]
    return None if fits else f"a number from {low:g} to {MOST:g}"


def _is_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= MOST
