"""A diagnosis as a JSON document: written, and read back."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from skiplatch.campaign import Nominal
from skiplatch.campaign.constraints import LENGTH_UM
from skiplatch.campaign.nominal import KEYS
from skiplatch.diagnosis.fit.beliefs import believing
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.surfaces import FittedDatum
from skiplatch.diagnosis.reported.diagnosis import Diagnosis
from skiplatch.diagnosis.reported.schema import FORMAT, key_path, whole
from skiplatch.diagnosis.verdict.named import Named
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.files import Json
from skiplatch.simulator.effects import Effect
from skiplatch.span import Span

SURFACE, COORDINATE = "surface_um", "coordinate_um"
"""What is off of a datum."""


def as_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """Everything, in plain types."""
    return {
        "format": FORMAT,
        "verdict": diagnosis.verdict.value,
        "where": [{**asdict(one), "effects": list(one.effects)} for one in diagnosis.where],
        "effects": [
            {
                "id": named.effect.id,
                "stage": named.stage,
                "params": {name: named.effect.parameters[name] for name in _told(named)},
                "intervals": {name: list(named.intervals[name]) for name in _told(named)},
                "since": named.effect.span.since,
                "until": named.effect.span.until,
                "alternatives": list(named.alternatives),
                "confidence": named.confidence,
                "at_limit": {name: name in named.at_limit for name in _told(named)},
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
        "closest": list(diagnosis.closest),
        "material": asdict(diagnosis.materiality),
        "touches": diagnosis.touches,
        "fingerprint": diagnosis.fingerprint,
        "touches_searched": diagnosis.used,
        "notes": list(diagnosis.notes),
    }


def _told(named: Named) -> list[str]:
    """Name the parameters but for those at rest of which no touch tells, as of other axes."""
    values = named.effect.parameters
    return [name for name, value in values.items() if value or name not in named.idle]


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
    return effects_of(whole(document))


def effects_of(read: Mapping[str, Json]) -> list[Effect]:
    """Give the same of a document that `whole` has read."""
    return [
        Effect(
            entry["id"],
            {name: float(value) for name, value in entry["params"].items()},
            Span(entry.get("since"), entry.get("until")),
        )
        for entry in read["effects"]
    ]


def rig_from_json(document: Json, nominal: Nominal) -> Rig:
    """Read back what a diagnosis says the rig is: effects, beliefs and data.

    Args:
        document: As `as_json` gives it.
        nominal: What was believed.

    Raises:
        ValueError: It is no diagnosis, or one of another rig.
    """
    read = whole(document)
    kinds: dict[str, dict[str, float]] = {SURFACE: {}, COORDINATE: {}}
    values = {}
    believed = {(one.id, name) for one in nominal.believed_effects for name in one.values}
    for name, entry in read.get("beliefs", {}).items():
        first, _, rest = name.partition(".")
        datum, _, kind = rest.rpartition(".")
        if first == "datum" and kind in kinds:
            kinds[kind][datum] = _place_um(key_path("beliefs", name), entry["fitted"])
        elif (first, rest) in KEYS or (first, rest) in believed:
            values[first, rest] = entry["fitted"]
        else:
            where = key_path("beliefs", name)
            raise ValueError(f"{where}: no such belief about the rig in nominal.toml")
    found = FittedDatum(kinds[SURFACE], kinds[COORDINATE])
    return Rig(believing(nominal, values), effects_of(read), found)


def _place_um(where: str, value: float) -> float:
    low, high = LENGTH_UM.low, LENGTH_UM.high
    if not low <= value <= high:
        raise ValueError(f"{where}: expected {low:g} to {high:g} µm, got {value:g}")
    return value
