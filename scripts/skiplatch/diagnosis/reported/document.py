"""A diagnosis as a JSON document: written, and read back."""

from dataclasses import asdict
from typing import Any

from skiplatch.campaign import Nominal
from skiplatch.campaign.nominal import KEYS
from skiplatch.diagnosis.fit.beliefs import believing
from skiplatch.diagnosis.plays.playing import FittedDatum, Rig
from skiplatch.diagnosis.reported.diagnosis import Diagnosis
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.simulator.effects import Effect
from skiplatch.span import Span

FORMAT = "skiplatch-diagnosis/2"
FORMATS = ("skiplatch-diagnosis/1", FORMAT)
"""Those that can be read."""
Json = Any
SURFACE, COORDINATE = "surface_um", "coordinate_um"
"""What is off of a datum."""


def as_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """Everything, in plain types."""
    return {
        "format": FORMAT,
        "verdict": diagnosis.verdict.value,
        "where": [
            {
                "stage": p.stage,
                "paths": p.paths,
                "observable": p.observable,
                "conditions": p.conditions,
                "size": p.size,
                "unit": p.unit,
            }
            for p in diagnosis.where
        ],
        "effects": [
            {
                "id": named.effect.id,
                "stage": named.stage,
                "params": dict(named.effect.parameters),
                "intervals": {name: list(ends) for name, ends in named.intervals.items()},
                "since": named.effect.span.since,
                "until": named.effect.span.until,
                "alternatives": list(named.alternatives),
                "confidence": named.confidence,
                "at_limit": {name: name in named.at_limit for name in named.effect.parameters},
            }
            for named in diagnosis.effects
        ],
        "gap": {name: _gap_json(gap) for name, gap in diagnosis.gap.items()},
        "left": [
            {
                "observable": one.observable,
                "path": one.path,
                "condition": one.looks_like,
                "size": float(one.size),
                "unit": one.unit,
                "p": one.p_value,
            }
            for one in diagnosis.left
        ],
        "outliers": list(diagnosis.outliers),
        "beliefs": _beliefs_json(diagnosis),
        "failed": [asdict(failure) for failure in diagnosis.failures],
        "material": asdict(diagnosis.materiality),
        "touches": diagnosis.touches,
        "touches_searched": diagnosis.used,
        "notes": list(diagnosis.notes),
    }


def _beliefs_json(diagnosis: Diagnosis) -> dict[str, dict[str, Any]]:
    """Give beliefs by name: what was believed, its standard uncertainty, and what was fitted."""
    known = {
        belief.name: {"value": belief.value, "u": belief.u_absolute, "fitted": value}
        for belief, value in diagnosis.beliefs
    }
    data = datum_json(diagnosis.rig.datum)
    return known | {
        f"datum.{name}": {"value": 0.0, "u": None, "fitted": entry["value"]}
        for name, entry in data.items()
    }


def datum_json(datum: FittedDatum) -> dict[str, dict[str, float]]:
    """Give what each datum is off by, by name and kind."""
    kinds = {SURFACE: datum.surface_um, COORDINATE: datum.coordinate_um}
    return {
        f"{name}.{kind}": {"value": value}
        for kind, values in kinds.items()
        for name, value in values.items()
    }


def _gap_json(gap: Gap) -> dict[str, Any]:
    known = {
        "before": gap.before,
        "after": gap.after,
        "noise_floor": gap.noise_floor,
        "unit": gap.unit,
        "shrink": gap.shrink.value,
        "shrink_interval": [gap.shrink.low, gap.shrink.high],
        "beyond_noise": gap.is_clear,
        "could_hide": gap.could_hide,
    }
    if gap.oracle_shrink is None:
        return known
    oracle = gap.oracle_shrink
    truth = {"oracle": gap.oracle, "oracle_shrink": oracle.value}
    return {**known, **truth, "oracle_shrink_interval": [oracle.low, oracle.high]}


def effects_from_json(document: Json) -> list[Effect]:
    """Read back which effects a diagnosis found.

    Raises:
        ValueError: It is no diagnosis.
    """
    if not isinstance(document, dict) or document.get("format") not in FORMATS:
        raise ValueError(f'expected a diagnosis of the format "{FORMAT}"')
    try:
        return [
            Effect(
                str(entry["id"]),
                {str(k): float(v) for k, v in entry["params"].items()},
                Span(_touch(entry.get("since")), _touch(entry.get("until"))),
            )
            for entry in document["effects"]
        ]
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"not a whole diagnosis: {error!r}") from error


def _touch(number: Json) -> int | None:
    """Read the number of a touch, or none.

    Raises:
        TypeError: It is something else.
    """
    if number is None or (isinstance(number, int) and not isinstance(number, bool)):
        return number
    raise TypeError(f"expected the number of a touch or null, got {number!r}")


def rig_from_json(document: Json, nominal: Nominal) -> Rig:
    """Read back what a diagnosis says the rig is: effects, beliefs and data.

    Args:
        document: As `as_json` gives it.
        nominal: What was believed.

    Raises:
        ValueError: It is no diagnosis.
    """
    found = effects_from_json(document)
    try:
        beliefs = {
            str(name): float(entry["fitted"]) for name, entry in document.get("beliefs", {}).items()
        }
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"not a whole diagnosis: {error!r}") from error
    kinds: dict[str, dict[str, float]] = {SURFACE: {}, COORDINATE: {}}
    values, believed = {}, {effect.id for effect in nominal.believed_effects}
    for name, value in beliefs.items():
        first, _, rest = name.partition(".")
        datum, _, kind = rest.rpartition(".")
        if first == "datum" and kind in kinds:
            kinds[kind][datum] = value
        elif (first, rest) in KEYS or first in believed:
            values[first, rest] = value
        else:
            raise ValueError(f"no belief is called {name!r}")
    return Rig(believing(nominal, values), found, FittedDatum(kinds[SURFACE], kinds[COORDINATE]))
