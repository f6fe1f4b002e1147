"""A diagnosis in words and in JSON."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from skiplatch.campaign import Nominal
from skiplatch.campaign.nominal import KEYS
from skiplatch.diagnosis.beliefs import believing
from skiplatch.diagnosis.diagnose import Diagnosis
from skiplatch.diagnosis.material import Materiality
from skiplatch.diagnosis.named import Named
from skiplatch.diagnosis.playing import FittedDatum, Rig
from skiplatch.diagnosis.shrink import Gap
from skiplatch.diagnosis.verdict import EXPLAINS, HAS_GAP, NAMES, SEES, Verdict
from skiplatch.simulator.effects import Effect, effects
from skiplatch.span import Span
from skiplatch.statistics import Interval
from skiplatch.tables import number, table

FORMAT = "skiplatch-diagnosis/2"
FORMATS = ("skiplatch-diagnosis/1", FORMAT)
"""Those that can be read."""
Json = Any

VERDICTS = {
    Verdict.NO_GAP: "No gap: the campaign is what the nominal simulation plays.",
    Verdict.EXPLAINED: "The gap is explained.",
    Verdict.PARTLY_EXPLAINED: "The gap is explained in part; something else is left.",
    Verdict.UNKNOWN: "There is a gap, and no effect of the catalogue explains it.",
    Verdict.UNDECIDED: "Too few touches to tell whether there is a gap.",
}
HALF = 0.5
"""Standard uncertainties by which a belief has to move to be told."""
SURFACE, COORDINATE = "surface_um", "coordinate_um"
"""What is off of a datum."""
MOST_LISTED = 12


def as_text(diagnosis: Diagnosis) -> str:
    """Everything, for the terminal."""
    parts = [VERDICTS[diagnosis.verdict], *map(_effect_text, diagnosis.effects)]
    if diagnosis.where:
        rows = [
            (p.observable, p.stage, p.paths, _size(p.size, p.unit), p.conditions)
            for p in diagnosis.where
        ]
        parts.append("Where\n" + table(("stretch", "stage", "paths", "size", "how"), rows))
    if diagnosis.verdict in (Verdict.NO_GAP, Verdict.UNDECIDED):
        parts.append(_hidden_text(diagnosis.gap))
    if diagnosis.effects:
        parts.append("Gap on touches held out from the search\n" + _gap_table(diagnosis.gap))
    parts.append(_threshold_text(diagnosis.materiality))
    if moved := _moved(diagnosis):
        parts.append(
            "Beliefs, as the touches move them\n" + table(("belief", "believed", "now"), moved)
        )
    if diagnosis.outliers:
        listed = ", ".join(map(str, diagnosis.outliers[:MOST_LISTED]))
        more = "" if len(diagnosis.outliers) <= MOST_LISTED else ", …"
        parts.append(f"Far off the rest, by touch: {listed}{more}")
    if diagnosis.notes:
        parts.append("\n".join(diagnosis.notes))
    return "\n\n".join(parts)


def _effect_text(named: Named) -> str:
    described = effects()[named.effect.id]
    lines = [f"{named.effect.id} ({named.stage} stage, {described.paths}): {described.physics}"]
    for parameter in described.parameters:
        if parameter.name in named.idle:
            continue
        value = named.effect.parameters[parameter.name]
        low, high = named.intervals[parameter.name]
        limit = ", at the limit of its range" if parameter.name in named.at_limit else ""
        lines.append(
            f"  {parameter.name} = {number(value)} ({number(low)} … {number(high)}) "
            f"{parameter.unit}, {parameter.meaning}{limit}"
        )
    if named.when:
        lines.append(f"  {named.when}")
    lines.append(f"  confidence {named.confidence:.3f}")
    if named.alternatives:
        lines.append(f"  cannot be told from: {', '.join(named.alternatives)}")
    return "\n".join(lines)


def _hidden_text(gaps: Mapping[str, Gap]) -> str:
    rows = [(name, gap.unit, number(gap.could_hide, 2)) for name, gap in gaps.items()]
    title = "A shift of half of the touches against the others that could have hidden (95 %)"
    return f"{title}\n" + table(("observable", "unit", "size"), rows)


def _moved(diagnosis: Diagnosis) -> list[tuple[str, str, str]]:
    """Give the beliefs that have moved by half their uncertainty, and every datum."""
    rows = [
        (belief.name, number(belief.value), number(value))
        for belief, value in diagnosis.beliefs
        if abs(belief.uncertainties(value)) > HALF
    ]
    data = _datum_json(diagnosis.rig.datum)
    return rows + [(name, "0", number(entry["value"], 3)) for name, entry in data.items()]


def _size(size: float, unit: str) -> str:
    return f"{size:.1%} of the touches" if unit == "1" else f"{number(size, 3)} {unit}"


def _threshold_text(materiality: Materiality) -> str:
    """Say from which size on a change counted."""
    spread = f"{materiality.fraction:.3g} of the rig's own spread"
    times = spread if materiality.us is None else f"{materiality.us:g} µs"
    lengths = spread if materiality.um is None else f"{materiality.um:g} µm"
    if times == lengths:
        return f"A gap counts from {spread} on."
    return f"A gap counts from {times} on in times, and from {lengths} on in lengths."


def _gap_table(gaps: Mapping[str, Gap]) -> str:
    rows = [
        (
            name,
            gap.unit,
            number(gap.before, 3),
            number(gap.after, 3),
            number(gap.noise_floor, 3),
            _shrunk(gap.shrink) if gap.is_clear else "no gap beyond the noise",
            *([] if gap.oracle_shrink is None else [_shrunk(gap.oracle_shrink)]),
        )
        for name, gap in gaps.items()
    ]
    header = ("observable", "unit", "before", "after", "noise floor", "shrunk by", "the truth does")
    return table(header[: len(rows[0])], rows) if rows else "  nothing was recorded"


def _shrunk(share: Interval) -> str:
    return f"{share.value:.0%} ({share.low:.0%} … {share.high:.0%})"


def explained(diagnosis: Diagnosis) -> str:
    """Give every rule with what the finding misses of it, and what other models are short of."""
    missed = {failure.rule: failure.words for failure in diagnosis.failures}
    rules = [
        (rule.name, number(rule.threshold), missed.get(rule.name, "not missed"), rule.reason)
        for group in (NAMES, EXPLAINS, HAS_GAP, SEES)
        for rule in group
    ]
    parts = ["Rules\n" + table(("rule", "threshold", "finding", "why this threshold"), rules)]
    if diagnosis.ranking:
        best = diagnosis.ranking[0].score_nats
        tried = [
            (
                " + ".join(effect.id for effect in model.effects),
                number(model.score_nats),
                "gains no more than chance"
                if model.score_nats <= 0.0
                else f"{number(best - model.score_nats)} nats behind",
            )
            for model in diagnosis.ranking
        ]
        parts.append("Models tried last\n" + table(("model", "gain, nats", "short of"), tried))
    return "\n\n".join(parts)


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
    data = _datum_json(diagnosis.rig.datum)
    return known | {
        f"datum.{name}": {"value": 0.0, "u": None, "fitted": entry["value"]}
        for name, entry in data.items()
    }


def _datum_json(datum: FittedDatum) -> dict[str, dict[str, float]]:
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
