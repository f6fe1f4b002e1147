"""A finding becomes a belief: its effects as tables of nominal.toml."""

import re
from collections.abc import Mapping, Sequence
from statistics import NormalDist
from typing import Any

from skiplatch.campaign import FORMATS, BelievedEffect, Nominal, format_effect
from skiplatch.diagnosis.reported.document import effects_from_json
from skiplatch.diagnosis.reported.schema import whole

Json = Any

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
    found = effects_from_json(document)
    intervals = [entry.get("intervals", {}) for entry in whole(document)["effects"]]
    return [
        BelievedEffect(effect.id, effect.parameters, _uncertainty(effect.parameters, ends))
        for effect, ends in zip(found, intervals, strict=True)
        if effect.span.until is None
    ]


def _uncertainty(
    values: Mapping[str, float], ends: Mapping[str, Sequence[float]]
) -> dict[str, float]:
    """Give the standard uncertainty of each parameter whose interval has a width."""
    widths = {name: high - low for name, (low, high) in ends.items() if name in values}
    return {name: float(f"{width / REACH:.3g}") for name, width in widths.items() if width > 0.0}


def with_effects(text: str, nominal: Nominal, found: Sequence[BelievedEffect]) -> str:
    """Give the text of nominal.toml with more effects; comments and all else stay as they are.

    Args:
        text: Of the file.
        nominal: What it says.
        found: Effects; one that it has just so already is not written again.
    """
    known = [(effect.id, effect.values) for effect in nominal.believed_effects]
    new = [effect for effect in found if (effect.id, effect.values) not in known]
    if not new:
        return text
    older, named = re.escape(FORMATS[1]), FORMATS[FIRST_WITH_EFFECTS]
    text = re.sub(rf"""^(\s*format\s*=\s*)["']{older}["']""", rf'\1"{named}"', text, flags=re.M)
    tables = (line for effect in new for line in format_effect(effect))
    return "\n".join([text.rstrip("\n"), *tables]) + "\n"
