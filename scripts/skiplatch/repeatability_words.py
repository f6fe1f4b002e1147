"""How touches repeat, in words: one sentence, and a table of figures."""

from collections.abc import Sequence
from dataclasses import dataclass

from skiplatch.campaign import InputPath
from skiplatch.repeatability import Repeatability
from skiplatch.statistics import Interval
from skiplatch.tables import number, with_interval

MOST_OUTSIDE = 0.25  # of the touches; more of them are no outliers
DIFFERS = 0.1  # of the plain standard deviation; less makes no other figure


@dataclass(frozen=True, slots=True, eq=False)
class OfPath:
    """What is told of the touches of one input path.

    Attributes:
        title: Of the path; empty where there is no other.
        sentence: All of it in one.
        figures: Rows of name, value and interval.
    """

    path: InputPath
    title: str
    found: Repeatability
    sentence: str
    figures: Sequence[Sequence[str]]


def sentence(found: Repeatability) -> str:
    """Say it in one sentence."""
    unit = found.unit
    parts = [f"{_what(found)} by σ = {_words(found.sigma, unit)}"]
    if found.is_limited_by_resolution:
        step = f" of {found.step:.4g} {unit}" if found.step else ""
        parts.append(f"that is limited by the resolution{step}")
    parts += _by_feed(found)
    if found.first is not None and "first" in found.told:
        way = way_of(found, found.first.value, ("higher", "lower"))
        parts.append(f"the first of a series is off by {_words(found.first, unit)}, {way}")
    if found.drift is not None and "order" in found.told:
        way = way_of(found, found.drift.value, ("rises", "falls"))
        parts.append(f"they drift {_drift(found, found.drift)}, {way}")
    if found.axis_drift is not None and "axis" in found.told:
        way = "up" if found.axis_drift.value > 0.0 else "down"
        parts.append(f"the axis drifts {way}, {_drift(found, found.axis_drift)}")
    parts += _without_warmth(found)
    if found.in_a_row is not None and found.in_a_row.is_less:
        sigma = _words(found.in_a_row.sigma, unit)
        parts.append(
            f"from one touch of a surface to the next they scatter by no more than {sigma}"
        )
    parts += _reversed(found)
    if found.outliers:
        parts.append(_outside(len(found.outliers), len(found.touches)))
    parts += _all_in(found)
    if found.missed:
        parts.append(f"besides, {found.missed} {_were(found.missed)} missed")
    if found.false:
        parts.append(f"besides, {found.false} {_were(found.false)} latched without a contact")
    return "; ".join(parts) + "."


def _by_feed(found: Repeatability) -> list[str]:
    """Say how touches go with the feed, or that nothing can tell it."""
    if found.feeds_are_apart:
        return ["feeds differ between surfaces or sessions alone, so that a delay does not show"]
    if found.slope is None or "speed" not in found.told:
        return []
    sense = "later" if found.slope.value > 0.0 else "earlier"
    return [f"they come {sense} with the feed, by {_words(found.slope, 'ms')}"]


def _without_warmth(found: Repeatability) -> list[str]:
    """Say what scatter the temperature leaves, where touches go with it and that is less."""
    warmth = found.warmth.get(found.warmest)
    if not warmth or warmth.sigma.value > (1.0 - DIFFERS) * found.sigma.value:
        return []
    slope = f"by {_words(warmth.slope, f'{found.unit}/K')}"
    sigma = f"σ = {_words(warmth.sigma, found.unit)}"
    thermometer = f"the temperature ({found.warmest})"
    if found.told & {"order", "axis"}:  # the two are one and the same: both would count it twice
        return [f"in place of that drift, {thermometer} tells more: {slope}, which leaves {sigma}"]
    return [f"they go with {thermometer}, {slope}, and without that {sigma}"]


def _reversed(found: Repeatability) -> list[str]:
    """Say what positions differ by that were met in both senses."""
    if found.reversal is None:
        return []
    mean = _words(found.reversal.mean, found.unit)
    return [f"the reversal error at {found.reversal.positions} positions is {mean} in the mean"]


def _all_in(found: Repeatability) -> list[str]:
    """Give the plain standard deviation where it is another one, as controllers print it."""
    if not differs(found):
        return []
    return [f"all touches as they are scatter by {number(found.plain, 3)} {found.unit}"]


def differs(found: Repeatability) -> bool:
    """Tell whether lines, first touches or outliers make the scatter another one."""
    return abs(found.plain - found.sigma.value) > DIFFERS * found.plain


def way_of(found: Repeatability, value: float, words: tuple[str, str]) -> str:
    """Say in words which way a figure along the approach goes; of an axis that is known, its own.

    Args:
        found: Of which touches.
        value: Positive is further along the approach, or later.
        words: Of the axis where its coordinate is larger, and smaller.
    """
    if found.unit == "µs":
        return "later" if value > 0.0 else "earlier"
    if found.coordinate and not found.is_directed:
        return f"{found.coordinate} {words[0 if value > 0.0 else 1]}"
    way = "further along the approach" if value > 0.0 else "less far along the approach"
    if not found.coordinate or not found.sense:
        return way
    return f"{way} ({found.coordinate} {words[0 if value * found.sense > 0.0 else 1]})"


def _were(n: int) -> str:
    return "was" if n == 1 else "were"


def _outside(n: int, touches: int) -> str:
    if n > MOST_OUTSIDE * touches:
        return (
            f"{n} lie apart from the others: what is taken for one condition are two, "
            "such as two feeds that were not recorded, or two input paths"
        )
    return f"{n} {'lies' if n == 1 else 'lie'} far outside"


def _what(found: Repeatability) -> str:
    n = len(found.touches)
    if found.unit == "µs":
        return f"{n} latches come {_words(found.mean, 'µs')} after their edges and scatter"
    surfaces = "one surface" if found.surfaces == 1 else f"{found.surfaces} surfaces"
    return f"{n} touches of {surfaces} scatter"


def _drift(found: Repeatability, drift: Interval) -> str:
    """Say how fast touches drift, by what they go with."""
    rate = an_hour(found, drift)
    if rate is None:
        return f"by {_words(drift, found.unit)} a touch"
    return f"with time, by {_words(rate, found.unit)} an hour"


def an_hour(found: Repeatability, drift: Interval | None) -> Interval | None:
    """Give a drift an hour; None where it goes by the number of the touch."""
    rate = found.touches_per_h
    if drift is None or rate is None:
        return None
    return Interval(drift.value * rate, drift.low * rate, drift.high * rate)


def _words(figure: Interval, unit: str) -> str:
    value, interval = with_interval(figure)
    return f"{value} {unit} ({interval})"


def _drift_rows(found: Repeatability) -> list[tuple[str, Interval | None]]:
    drifts = {"drift": found.drift, "drift of the axis": found.axis_drift}
    if found.touches_per_h is None:
        return [(f"{name}, {found.unit}/touch", drift) for name, drift in drifts.items()]
    return [(f"{name}, {found.unit}/h", an_hour(found, drift)) for name, drift in drifts.items()]


def rows_of(found: Repeatability) -> list[tuple[str, ...]]:
    """Give all figures: name, value and interval."""
    unit = found.unit
    mean = "mean from edge to latch" if unit == "µs" else "mean deviation"
    figures: list[tuple[str, Interval | None]] = [
        (f"{mean}, {unit}", found.mean),
        (f"σ, {unit}", found.sigma),
        (f"σ from touch to touch, {unit}", found.in_a_row.sigma if found.in_a_row else None),
        (f"first touch, {unit}", found.first),
        (f"mean reversal error, {unit}", found.reversal.mean if found.reversal else None),
        *_drift_rows(found),
        ("slope with the feed, ms", found.slope),
        *((f"drift by {name}, {unit}/K", slope) for name, slope in found.per_kelvin.items()),
    ]
    rows: list[tuple[str, ...]] = [
        (name, *with_interval(figure)) for name, figure in figures if figure is not None
    ]
    if found.reversal is not None:
        name = f"widest reversal error, {unit}, at {found.reversal.at:g}"
        rows.append((name, number(found.reversal.widest, 3), ""))
    if differs(found):
        rows.insert(2, (f"σ of all as they are, {unit}", number(found.plain, 3), ""))
    rows.insert(2, (f"widest range, {unit}", f"{found.range:.4g}", ""))
    return rows
