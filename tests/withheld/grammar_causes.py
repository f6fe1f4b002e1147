"""What a stranger may go with: recorded conditions, the sequence of touches, what nobody records.

A cause gives every touch a number. A smooth one runs from 0 to about 1 and may go beyond; an angle
is a share of a turn; a level is 0 or 1.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from skiplatch.campaign import Touches
from tests.withheld.chain import FloatArray
from tests.withheld.forms import Draw

FIRST_REST_S = 10.0
"""Before the first touch, as nothing is known of what came before it."""


class Family(StrEnum):
    """Who could know a cause."""

    RECORDED = "recorded"
    SEQUENCE = "sequence"
    HIDDEN = "hidden"


class Kind(StrEnum):
    """What the numbers of a cause are."""

    SMOOTH = "smooth"
    ANGLE = "angle"
    LEVEL = "level"


@dataclass(frozen=True)
class Cause:
    """Something that an error may go with.

    Attributes:
        family: Who could know it.
        kind: What its numbers are.
        make: Draws its numbers, shape (n,), on no scale yet if it is smooth.
        needs: Columns that tell it; they are always recorded then.
    """

    family: Family
    kind: Kind
    make: Callable[[Draw], FloatArray]
    needs: frozenset[str] = frozenset()


def values_of(cause: Cause, draw: Draw) -> FloatArray:
    """Draw the numbers of a cause, shape (n,), a smooth one on its scale from 0 on."""
    raw = np.asarray(cause.make(draw), np.float64)
    if cause.kind is not Kind.SMOOTH:
        return raw
    low, high = raw.min(), np.quantile(raw, 0.98)
    return np.asarray((raw - low) / max(float(high - low), 1e-12))


def _column(name: str) -> Callable[[Draw], FloatArray]:
    return lambda d: np.asarray(getattr(d.setup.touches, name), np.float64)


def _turned(name: str) -> Callable[[Draw], FloatArray]:
    return lambda d: np.asarray(getattr(d.setup.touches, name) / 360.0 % 1.0)


def _one_axis(d: Draw) -> FloatArray:
    axes = np.unique(d.setup.touches.axis)
    return np.asarray(d.setup.touches.axis == axes[d.rng.integers(len(axes))], np.float64)


def _one_sense(d: Draw) -> FloatArray:
    return np.asarray(d.setup.touches.sign == d.sense(), np.float64)


def _before(values: FloatArray) -> FloatArray:
    """What the touch before had; the first one has its own."""
    return np.concatenate([values[:1], values[:-1]])


def rest_s(touches: Touches) -> FloatArray:
    """Time since the touch before, shape (n,)."""
    return np.diff(touches.time_s, prepend=touches.time_s[0] - FIRST_REST_S)


def _rest(d: Draw) -> FloatArray:
    return rest_s(d.setup.touches)


def _way(d: Draw) -> FloatArray:
    position = d.setup.touches.position_mm
    return np.asarray(np.abs(position - _before(position)))


def _changed(name: str) -> Callable[[Draw], FloatArray]:
    """Mark touches before which a condition had another value."""

    def make(d: Draw) -> FloatArray:
        values = np.asarray(getattr(d.setup.touches, name), np.float64)
        return np.asarray(values != _before(values), np.float64)

    return make


def _every_kth(d: Draw) -> FloatArray:
    every = int(d.rng.integers(2, 13))
    phase = int(d.rng.integers(every))
    return np.asarray(d.setup.touches.touch % every == phase, np.float64)


def _number(d: Draw) -> FloatArray:
    return np.arange(len(d.setup.touches), dtype=np.float64)


def _activity(d: Draw) -> FloatArray:
    """Touches that were made of late, each forgotten by and by."""
    forgets_s, so_far = d.between(20.0, 200.0), 0.0
    busy = np.zeros(len(d.setup.touches))
    for i, rest in enumerate(rest_s(d.setup.touches)):
        so_far = busy[i] = (so_far + 1.0) * np.exp(-rest / forgets_s)
    return busy


def _walk(d: Draw) -> FloatArray:
    """A random walk, smoothed so that it takes some touches to go anywhere."""
    n = len(d.setup.touches)
    width = max(3, round(n * d.between(0.01, 0.05)))
    steps = np.convolve(d.rng.normal(0.0, 1.0, n + width), np.ones(width) / width, "valid")[:n]
    return np.asarray(np.cumsum(steps))


def _cycle(d: Draw) -> FloatArray:
    """Turns that come from nowhere, of five touches or of half a campaign, not quite even."""
    time_s, n = d.setup.touches.time_s, len(d.setup.touches)
    touches = np.exp(d.between(np.log(5.0), np.log(n / 2)))
    period_s = float(time_s[-1]) / n * touches
    turns = time_s / period_s + 0.05 * np.sin(time_s / (3.7 * period_s)) + d.between(0.0, 1.0)
    return np.asarray(turns % 1.0)


def _two_states(d: Draw) -> FloatArray:
    """A state that lasts for some touches and then gives way to the other one."""
    n, lasts = len(d.setup.touches), np.exp(d.between(np.log(4.0), np.log(60.0)))
    flips = d.rng.random(n) < 1.0 / lasts
    return np.asarray((np.cumsum(flips) + d.rng.integers(2)) % 2, np.float64)


R, S, H = Family.RECORDED, Family.SEQUENCE, Family.HIDDEN
_PLACED = frozenset({"axis", "position_mm"})

CAUSES: Mapping[str, Cause] = {
    "feed": Cause(R, Kind.SMOOTH, _column("feed_mm_min")),
    "approach": Cause(R, Kind.SMOOTH, _column("approach_mm")),
    "position": Cause(R, Kind.SMOOTH, _column("position_mm"), _PLACED),
    "alpha": Cause(R, Kind.ANGLE, _turned("alpha_deg")),
    "beta": Cause(R, Kind.SMOOTH, _column("beta_deg")),
    "sign": Cause(R, Kind.LEVEL, _one_sense, frozenset({"axis", "sign"})),
    "axis": Cause(R, Kind.LEVEL, _one_axis, frozenset({"axis"})),
    "rotary": Cause(R, Kind.ANGLE, _turned("rotary_deg"), frozenset({"rotary_deg"})),
    "temperature": Cause(R, Kind.SMOOTH, _column("temp_c"), frozenset({"temp_c"})),
    "time": Cause(R, Kind.SMOOTH, _column("time_s")),
    "rest": Cause(S, Kind.SMOOTH, _rest),
    "way": Cause(S, Kind.SMOOTH, _way, _PLACED),
    "turn of axis": Cause(S, Kind.LEVEL, _changed("axis"), frozenset({"axis"})),
    "turn of sense": Cause(S, Kind.LEVEL, _changed("sign"), frozenset({"axis", "sign"})),
    "change of path": Cause(S, Kind.LEVEL, _changed("path")),
    "every kth": Cause(S, Kind.LEVEL, _every_kth),
    "number": Cause(S, Kind.SMOOTH, _number),
    "activity": Cause(S, Kind.SMOOTH, _activity),
    "alpha before": Cause(S, Kind.ANGLE, lambda d: _before(_turned("alpha_deg")(d))),
    "feed before": Cause(S, Kind.SMOOTH, lambda d: _before(d.setup.touches.feed_mm_min)),
    "walk": Cause(H, Kind.SMOOTH, _walk),
    "cycle": Cause(H, Kind.ANGLE, _cycle),
    "two states": Cause(H, Kind.LEVEL, _two_states),
}

SHARES: Mapping[Family, float] = {R: 0.4, S: 0.4, H: 0.2}
"""Of the families among strangers."""


def draw_cause(rng: np.random.Generator) -> str:
    """Draw a cause by its name: its family first, by its share."""
    family = list(SHARES)[int(rng.choice(len(SHARES), p=list(SHARES.values())))]
    names = [name for name, cause in CAUSES.items() if cause.family is family]
    return names[int(rng.integers(len(names)))]
