"""Writing nominal.toml."""

import os
from collections.abc import Iterator

import numpy as np

from skiplatch.campaign.believed_effect import BelievedEffect
from skiplatch.campaign.datum import Datum
from skiplatch.campaign.nominal import FORMATS, KEYS, Key, Nominal
from skiplatch.files import atomic_write_text


def write_nominal(path: str | os.PathLike[str], nominal: Nominal) -> None:
    """Write nominal.toml so that it is read back exactly.

    Raises:
        InputError: The file cannot be written.
        ValueError: Some number is none that the format admits.
    """
    atomic_write_text(path, format_nominal(nominal))


def format_nominal(nominal: Nominal) -> str:
    """Give the text of nominal.toml, in its version of the format."""
    if nominal.axis.min_mm > nominal.axis.max_mm:
        raise ValueError("axis.max_mm: expected at least axis.min_mm")
    lines = [f'format = "{FORMATS[nominal.version]}"', f'kind = "{nominal.kind}"']
    previous = None
    for (section, name), text in _numbers(nominal):
        if section != previous:
            lines += ["", f"[{section}]"]
            previous = section
        lines.append(f"{name} = {text}")
    if nominal.datum != Datum.of_kind(nominal.kind):
        lines += _datum(nominal.datum)
    for effect in nominal.believed_effects:
        lines += format_effect(effect)
    return "\n".join(lines) + "\n"


def fits(key: Key, value: float) -> bool:
    """Tell whether a number may stand for a key."""
    return bool(key.constraint.holds(np.array(value)))


def _numbers(nominal: Nominal) -> Iterator[tuple[tuple[str, str], str]]:
    for path, key in KEYS.items():
        value = nominal.number(*path)
        said = path in nominal.uncertainty or value != key.default
        if path in nominal.unknown or (key.since > 1 and not said):
            continue
        if not fits(key, value):
            words = key.constraint.words
            raise ValueError(f"{'.'.join(path)}: expected {words}, got {value}")
        yield path, _number(value, nominal.uncertainty.get(path))


def _number(value: float, u: float | None) -> str:
    return repr(value) if u is None else f"{{value = {value!r}, u = {u!r}}}"


def _datum(datum: Datum) -> list[str]:
    lines = ["", "[datum]", f'free = "{datum.free}"']
    return lines if datum.u_um is None else [*lines, f"u_um = {datum.u_um!r}"]


def format_effect(effect: BelievedEffect) -> list[str]:
    """Give the lines of a table of an effect, an empty one first."""
    numbers = (
        f"{name} = {_number(value, effect.uncertainty.get(name))}"
        for name, value in effect.values.items()
    )
    return ["", "[[effect]]", f'id = "{effect.id}"', *numbers]
