"""A finding becomes a belief: its effects as tables of nominal.toml."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import NormalDist

from skiplatch.campaign import FORMATS, BelievedEffect, Nominal, format_effect
from skiplatch.campaign.nominal_toml import parse_nominal
from skiplatch.campaign.toml_positions import key_positions
from skiplatch.campaign.toml_text import read_toml_text
from skiplatch.diagnosis.reported.document import effects_of
from skiplatch.diagnosis.reported.schema import whole
from skiplatch.errors import InputError
from skiplatch.files import Json
from skiplatch.simulator.effects import Effect, effects

FIRST_WITH_EFFECTS = 2
"""Version of the format."""
REACH = 2.0 * NormalDist().inv_cdf(0.95)
"""Standard uncertainties that an interval of 90 % is wide."""


def adopted(document: Json) -> list[BelievedEffect]:
    """Give the effects that a diagnosis found, as beliefs about the rig as it stands now.

    What ended by itself is none any more. A parameter is as uncertain as its interval says.

    Raises:
        ValueError: It is no diagnosis.
    """
    read = whole(document)
    intervals = [entry.get("intervals", {}) for entry in read["effects"]]
    return [
        BelievedEffect(effect.id, effect.parameters, _uncertainty(effect, ends))
        for effect, ends in zip(effects_of(read), intervals, strict=True)
        if effect.span.until is None
    ]


def _uncertainty(effect: Effect, ends: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Give the standard uncertainty of each parameter whose interval has a width.

    One that may be anywhere in its range moves no touch, and stays as it is.
    """
    widths = {
        p.name: high - low
        for p in effects()[effect.id].parameters
        if p.name in ends and p.name in effect.parameters
        for low, high in [ends[p.name]]
        if (low, high) != (p.low, p.high)
    }
    return {name: float(f"{width / REACH:.3g}") for name, width in widths.items() if width > 0.0}


def with_effects(path: Path, nominal: Nominal, found: Sequence[BelievedEffect]) -> str:
    """Give the text of nominal.toml with more effects; comments and all else stay as they are.

    Args:
        path: The file.
        nominal: What it says.
        found: Effects; one that it has just so already is not written again.

    Raises:
        InputError: The file is written in a way that no table can be added to.
    """
    text = read_toml_text(path)
    known = [(effect.id, effect.values) for effect in nominal.believed_effects]
    new = [effect for effect in found if (effect.id, effect.values) not in known]
    if not new:
        return text
    tables = (line for effect in new for line in format_effect(effect))
    adopted_text = "\n".join([_in_version_2(text).rstrip("\n"), *tables]) + "\n"
    _refuse_misread(path, adopted_text, (*nominal.believed_effects, *new))
    return adopted_text


def _in_version_2(text: str) -> str:
    place = key_positions(text).get(("format",))
    if place is None or place.value_column is None:
        return text
    lines = text.split("\n")
    line, column = lines[place.line - 1], place.value_column - 1
    value = line[column:].replace(FORMATS[1], FORMATS[FIRST_WITH_EFFECTS], 1)
    lines[place.line - 1] = line[:column] + value
    return "\n".join(lines)


def _refuse_misread(path: Path, text: str, believed: Sequence[BelievedEffect]) -> None:
    try:
        read = parse_nominal(path, text).believed_effects
    except InputError:
        read = ()
    if read != believed:
        place = key_positions(text).get(("effect",)) or key_positions(text).get(("format",))
        message = "expected plain keys, and tables [[effect]], so that one can be added"
        raise InputError(path, place.line if place else None, None, message)
