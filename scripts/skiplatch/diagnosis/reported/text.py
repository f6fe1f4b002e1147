"""A diagnosis in words."""

from collections.abc import Mapping

from skiplatch.diagnosis.fit.material import Materiality
from skiplatch.diagnosis.reported.diagnosis import Diagnosis
from skiplatch.diagnosis.reported.document import datum_json
from skiplatch.diagnosis.reported.units_told import datum_told, for_people
from skiplatch.diagnosis.reported.where import Place
from skiplatch.diagnosis.verdict.named import Named
from skiplatch.diagnosis.verdict.rules import EXPLAINS, HAS_GAP, NAMES, SEES
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.effects import effects
from skiplatch.statistics import Interval
from skiplatch.tables import listing, number, prose, table
from skiplatch.ways import LENGTH, Ways

EFFECTS_SHOW = "Where the effects show, and how far off the simulation is without them"
VERDICTS = {
    Verdict.NO_GAP: "No gap: the campaign is what the nominal simulation plays.",
    Verdict.EXPLAINED: "The gap is explained.",
    Verdict.PARTLY_EXPLAINED: "The gap is explained in part; something else is left.",
    Verdict.UNKNOWN: "There is a gap, and no effect of the catalogue explains it.",
    Verdict.UNDECIDED: "Too few touches to tell whether there is a gap.",
}
HALF = 0.5
"""Standard uncertainties by which a belief has to move to be told."""
DATUM_DECIMALS = 3
"""Of a µm or an arcsec, to which it is told where a surface lies: rounding leaves ever less."""
MOST_LISTED = 12


def as_text(diagnosis: Diagnosis) -> str:
    """Everything, for the terminal."""
    diagnosis, ways = for_people(diagnosis), diagnosis.ways
    effect_texts = [_effect_text(named, diagnosis) for named in diagnosis.effects]
    parts = [_verdict_text(diagnosis), *effect_texts]
    parts += _where_texts(diagnosis)
    if diagnosis.verdict in (Verdict.NO_GAP, Verdict.UNDECIDED):
        parts.append(_hidden_text(diagnosis.gap))
    if diagnosis.effects:
        parts.append("Gap on touches held out from the search\n" + _gap_table(diagnosis.gap))
        if told := floor_told(diagnosis):
            parts.append(told)
    parts.append(_threshold_text(diagnosis.materiality, ways))
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
    return prose("\n\n".join(parts))


def _verdict_text(diagnosis: Diagnosis) -> str:
    """Say what the diagnosis came to; without a gap also by which beliefs that is so."""
    said = VERDICTS[diagnosis.verdict]
    if diagnosis.leaves_nothing_seen:
        said = f"The gap is explained in part: {nothing_seen(diagnosis)}."
    if diagnosis.verdict is not Verdict.NO_GAP:
        return said
    beliefs = [
        f"{belief.name} is {number(now)} in place of {number(belief.value)}"
        for belief, now in diagnosis.moved_far
    ]
    where = f", where {' and '.join(beliefs)}" if beliefs else ""
    return f"{said[:-1]}{where}{but_for(diagnosis)}."


def but_for(diagnosis: Diagnosis) -> str:
    """Say how many touches are far off the rest; nothing where none is."""
    far = len(diagnosis.outliers)
    return f", but for {far} touch{'es' if far > 1 else ''} far off" if far else ""


def floor_told(diagnosis: Diagnosis) -> str:
    """Explain a noise floor above what was there; nothing where no gap is said to be either."""
    high = [gap for gap in diagnosis.gap.values() if gap.noise_floor > gap.before]
    if not any(gap.is_clear or not diagnosis.effects for gap in high):
        return ""
    if not diagnosis.effects:
        return (
            "The noise floor is what plays of the simulation score against each other. "
            "A score below it shows no gap in the mean of all touches."
        )
    return (
        "The noise floor is what plays of the simulation with the effects score against each "
        "other. A score below it is luck, or the effects scatter more than what was recorded."
    )


def nothing_seen(diagnosis: Diagnosis) -> str:
    """Say what keeps a gap from being explained of which nothing is seen to be left."""
    wanting = diagnosis.wanting
    why = wanting.words if wanting else "but the touches are too few to be sure of all of it"
    return f"nothing is seen to be left, {why}"


def _where_texts(diagnosis: Diagnosis) -> list[str]:
    """Give a table of where each effect shows, and one of where something is left."""
    shown = [place for place in diagnosis.where if place.effects]
    left = [place for place in diagnosis.where if not place.effects]
    header = ("stretch", "stage", "paths", "size", "how")
    parts = []
    if shown:
        rows = [(*_place(place), " + ".join(place.effects)) for place in shown]
        parts.append(f"{EFFECTS_SHOW}\n" + listing([(*header, "by"), *rows]))
    if left:
        title = "Where something is left\n" if diagnosis.effects else "Where\n"
        parts.append(title + listing([header, *map(_place, left)]))
    return parts


def _place(place: Place) -> tuple[str, ...]:
    size = _size(place.size, place.unit)
    return (place.stretch, place.stage, place.paths, size, place.conditions)


def _effect_text(named: Named, diagnosis: Diagnosis) -> str:
    described = effects()[named.effect.id]
    ways = diagnosis.ways_of(described.paths)
    lines = [f"{named.effect.id} ({named.stage} stage, {described.paths}): {described.physics}"]
    for parameter in described.parameters:
        if parameter.name in named.idle:
            continue
        value = named.effect.parameters[parameter.name]
        low, high = named.intervals[parameter.name]
        limit = ", at the limit of its range" if parameter.name in named.at_limit else ""
        unit = "" if parameter.unit == "1" else f" {ways.unit_of_number(parameter.unit)}"
        lines.append(
            f"  {parameter.name} = {number(value)} ({number(low)} … {number(high)}){unit}, "
            f"{parameter.meaning}{limit}"
        )
    if named.when:
        lines.append(f"  {named.when}")
    if named.alternatives:
        lines.append(f"  cannot be told from: {', '.join(named.alternatives)}")
    of_which = " that it is one of these" if named.alternatives else ""
    lines.append(f"  confidence {named.confidence:.3f}{of_which}")
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
    data = {name: entry["value"] for name, entry in datum_json(diagnosis.rig.datum).items()}
    told = datum_told(data, diagnosis.ways)
    where = {name: number(round(value, DATUM_DECIMALS), 3) for name, value in told.items()}
    return rows + [(name, "0", lies) for name, lies in where.items()]


def _size(size: float, unit: str) -> str:
    return f"{size:.1%} of the touches" if unit == "1" else f"{number(size, 3)} {unit}"


def _threshold_text(materiality: Materiality, ways: Ways) -> str:
    """Say from which size on a change counted."""
    spread = f"{materiality.fraction:.3g} of the rig's own spread"
    times = spread if materiality.us is None else f"{materiality.us:g} µs"
    lengths = spread
    if materiality.um is not None:
        size, unit = ways.told(materiality.um, LENGTH)
        lengths = f"{size:g} {unit}"
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
            _shrunk(gap.shrink) if gap.is_clear else _no_gap(gap),
            *([] if gap.oracle_shrink is None else [_shrunk(gap.oracle_shrink)]),
        )
        for name, gap in gaps.items()
    ]
    header = ("observable", "unit", "before", "after", "noise floor", "shrunk by", "the truth does")
    return table(header[: len(rows[0])], rows) if rows else "  nothing was recorded"


def _no_gap(gap: Gap) -> str:
    return "no gap beyond the noise" if gap.before > gap.noise_floor else "below the noise floor"


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
    parts = ["Rules\n" + listing([("rule", "threshold", "finding", "why this threshold"), *rules])]
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
