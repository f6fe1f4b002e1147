"""What the page says in words and tables."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from skiplatch.diagnosis import Diagnosis, Named, Verdict
from skiplatch.diagnosis.experiment import Experiment, remarks, touches_table
from skiplatch.diagnosis.reported.text import but_for, nothing_seen
from skiplatch.diagnosis.reported.where import Place
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.latch.text import TITLES
from skiplatch.report.evidence import Missed
from skiplatch.report.layout import Table
from skiplatch.simulator.effects import effects
from skiplatch.statistics import Interval
from skiplatch.tables import NOTHING, number, with_interval

DIGITS = 3
LEAST = 1e-3  # µm, arcsec or µs
MOST_LEFT = 8
PATHS = {"both": "both paths", "skip": "the skip path", "plc": "the PLC path"}


@dataclass(frozen=True, slots=True)
class Found:
    """An effect that was found, in words."""

    id: str
    physics: str
    sits: str
    when: str
    confidence: str
    alternatives: str
    parameters: Table


@dataclass(frozen=True, slots=True)
class Next:
    """What to record or to touch next: why, which touches, and what is expected of them."""

    why: str
    touches: Table
    remarks: Sequence[str]


def headline(diagnosis: Diagnosis) -> str:
    """Say the finding in one line."""
    names = " and ".join(named.effect.id for named in diagnosis.effects)
    many = len(diagnosis.effects) > 1
    if diagnosis.seems_whole:
        return f"{names} {'explain' if many else 'explains'} the gap, as far as these touches tell"
    moved = " and ".join(belief.name for belief, _ in diagnosis.moved_far)
    return {
        Verdict.NO_GAP: "No gap: the simulation plays what was recorded"
        + (f", with another {moved}" if moved else "")
        + but_for(diagnosis),
        Verdict.EXPLAINED: f"{names} {'explain' if many else 'explains'} the gap",
        Verdict.PARTLY_EXPLAINED: f"{names} {'explain' if many else 'explains'} part of the gap",
        Verdict.UNKNOWN: "There is a gap, and no effect of the catalogue explains it",
        Verdict.UNDECIDED: "Too few touches to tell whether there is a gap",
    }[diagnosis.verdict]


def lead(diagnosis: Diagnosis, telling: str) -> str:
    """Say what follows from the finding, in a sentence or two."""
    if diagnosis.verdict == Verdict.NO_GAP:
        return (
            "Nothing that was recorded differs from the nominal simulation by more than chance "
            "would make it, or by so much that it would matter."
        )
    if diagnosis.verdict == Verdict.UNDECIDED:
        return "A gap as large as the rig's own noise could have hidden in these touches."
    if not diagnosis.where:
        return "No single stretch of the chain tells where it sits."
    if diagnosis.verdict == Verdict.UNKNOWN:
        shows = _listed([place.stretch for place in diagnosis.where])
        looks = _listed([place.conditions for place in diagnosis.where])
        return f"It shows in {shows}. What it depends on or looks like: {looks}."
    return _lead_of_effects(diagnosis, telling) + (
        f" {nothing_seen(diagnosis).capitalize()}." if diagnosis.leaves_nothing_seen else ""
    )


def _lead_of_effects(diagnosis: Diagnosis, telling: str) -> str:
    gap = _shown(diagnosis, telling)
    many = len(diagnosis.effects) > 1
    said = "Simulated along with the rest, " + _listed([n.effect.id for n in diagnosis.effects])
    if gap is None:
        return f"{said} {'make' if many else 'makes'} the simulation play what was recorded."
    if not gap.is_clear:
        return (
            f"Over all paths and feeds together, what it does to {gap.title} is within "
            "the noise of the touches held out; the pictures show where it stands out."
        )
    return (
        f"{said} {'shrink' if many else 'shrinks'} the gap in {gap.title} "
        f"by {_shrunk(gap)}, from {_size(gap.before)} to {_size(gap.after)} {gap.unit}, "
        "on touches that served neither fitting nor naming."
    )


def _shown(diagnosis: Diagnosis, telling: str) -> Gap | None:
    """Give the gap to speak of: that of the telling observable, or else one that is clear."""
    first = diagnosis.gap.get(telling)
    clear = [gap for gap in diagnosis.gap.values() if gap.is_clear]
    return first if first is None or first.is_clear or not clear else clear[0]


def found(named: Named, diagnosis: Diagnosis) -> Found:
    """Describe an effect that was found."""
    described = effects()[named.effect.id]
    ways = diagnosis.ways_of(described.paths)
    rows = []
    for parameter in described.parameters:
        if parameter.name in named.idle:
            continue
        value = named.effect.parameters.get(parameter.name, 0.0)
        low, high = named.intervals.get(parameter.name, (value, value))
        figures = with_interval(Interval(value, low, high))
        unit = "" if parameter.unit == "1" else ways.unit_of_number(parameter.unit)
        rows.append((parameter.name, *figures, unit, parameter.meaning))
    return Found(
        id=named.effect.id,
        physics=described.physics,
        sits=f"{named.stage} stage, {PATHS[described.paths]}",
        when=named.when,
        confidence=f"{named.confidence:.3f}",
        alternatives=", ".join(named.alternatives),
        parameters=Table(("parameter", "value", "90 % interval", "unit", "meaning"), rows),
    )


def where_table(diagnosis: Diagnosis) -> Table:
    """Give where the gap sits: where the effects show, if there are any."""
    header = ("stretch", "stage", "where", "size", "how")
    if not diagnosis.effects:
        return Table(header, [_place(place) for place in diagnosis.where])
    rows = [(*_place(p), " and ".join(p.effects)) for p in diagnosis.where if p.effects]
    return Table((*header, "by"), rows)


def _place(place: Place) -> tuple[str, ...]:
    size = _with_unit(place.size, place.unit)
    return (place.stretch, place.stage, PATHS[place.paths], size, place.conditions)


def left_table(diagnosis: Diagnosis) -> Table:
    """Give what no effect accounts for."""
    rows = [
        (
            f"{one.observable}, {PATHS[one.path]}",
            one.looks_like,
            _with_unit(one.size, one.unit),
            f"{one.p_value:.1g}",
        )
        for one in diagnosis.left[:MOST_LEFT]
    ]
    return Table(("stretch", "looks like", "size", "p"), rows)


def gap_table(gaps: Iterable[Gap], *, after: bool) -> Table:
    """Give the gap of each observable, and what the effects make of it."""
    if not after:
        header = ("observable", "unit", "gap", "noise floor")
        return Table(
            header,
            [(g.title, g.unit, _size(g.before), _size(g.noise_floor)) for g in gaps],
        )
    rows = [
        (
            gap.title,
            _shrunk(gap) if gap.is_clear else "no gap",
            gap.unit,
            _size(gap.before),
            _size(gap.after),
            _size(gap.noise_floor),
        )
        for gap in gaps
    ]
    return Table(("observable", "shrunk by", "unit", "before", "after", "noise floor"), rows)


def next_touches(experiment: Experiment) -> Next:
    """Give the next experiment."""
    return Next(experiment.words, Table(*touches_table(experiment)), remarks(experiment))


def missed_table(missed: Sequence[Missed]) -> Table | None:
    """Give the share of touches without a latch; None where none was missed anywhere."""
    if not any(m.recorded or m.before or m.after for m in missed):
        return None
    rows = [
        (TITLES[m.path], *(NOTHING if s is None else f"{s:.1%}" for s in shares))
        for m in missed
        for shares in [(m.recorded, m.before, m.after)]
    ]
    return Table(("missed touches", "recorded", "nominal", "with the effects"), rows)


def _shrunk(gap: Gap) -> str:
    value, low, high = map(_percent, (gap.shrink.value, gap.shrink.low, gap.shrink.high))
    return value if value == low == high else f"{value} ({low} … {high})"


def _percent(share: float) -> str:
    """Give whole per cent, and 0 without a sign."""
    return f"{round(share, 2) + 0.0:.0%}"


def _size(value: float) -> str:
    """Give a distance, no finer than it can matter."""
    return number(value, DIGITS) if value >= LEAST else f"< {LEAST:g}"


def _with_unit(size: float, unit: str) -> str:
    return f"{_percent(size)} of the touches" if unit == "1" else f"{number(size, DIGITS)} {unit}"


def _listed(words: Sequence[str]) -> str:
    """Join words, each once."""
    unique = list(dict.fromkeys(words))
    return " and ".join([", ".join(unique[:-1]), unique[-1]] if unique[1:] else unique)
