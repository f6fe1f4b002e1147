"""Strangers of a grammar: a place in the chain × a cause × a course × an amount.

None of them stands in a list, so that nobody can write a test for each; every seed has new ones.
What is in effect an effect of the catalogue is left out: by its words in `grammar_rules`, by its
figures in `grammar_apart`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.withheld.chain import FloatArray, Numbers, Setup, State
from tests.withheld.conditions import Recording
from tests.withheld.forms import Draw, Form
from tests.withheld.grammar_apart import (
    Apart,
    scatter_apart,
    share_apart,
    shift_apart,
    size_of_shift,
)
from tests.withheld.grammar_causes import CAUSES, Kind, draw_cause, values_of
from tests.withheld.grammar_places import PLACES, Place, Seen, draw_place
from tests.withheld.grammar_rules import excluded
from tests.withheld.grammar_shapes import INTERACTION, Carrier, draw_course, interaction

TRIES = 400
FEWEST_SHARE = 0.04
"""Of the touches, that a level or a course must set apart."""
FAINT_SHARE = 0.2
FAINT, WELL_ABOVE = (0.3, 1.5), (1.5, 20.0)
"""Sizes of strangers, in spreads of what they move: most are well above the noise."""
CARRIERS = {Carrier.SHIFT: 0.6, Carrier.SCATTER: 0.2, Carrier.NOW_AND_THEN: 0.2}
TOGETHER = 0.2
"""Share of the shifts that are an interaction of two causes."""
LEAST_EVENT = 4.0
"""Spreads: what comes now and then has to stand out where it comes."""


@dataclass(frozen=True, eq=False)
class Course:
    """How strongly a stranger acts on each touch.

    Attributes:
        causes: What it goes with, by name.
        name: Of the course.
        values: From 0 to about 1, shape (n,).
    """

    causes: tuple[str, ...]
    name: str
    values: FloatArray


@dataclass(frozen=True, eq=False)
class Stranger:
    """A stranger that was drawn.

    Attributes:
        form: To play it with.
        place: Where it sits, by name.
        carrier: What of it follows the course.
        course: Over its causes.
        size: In spreads of what it moves.
        amount: In the unit of its place.
        apart: How far it is from the catalogue.
    """

    form: Form
    place: str
    carrier: Carrier
    course: Course
    size: float
    amount: float
    apart: Apart

    @property
    def name(self) -> str:
        """Say it in short."""
        return f"{self.place}: {self.carrier}, {self.course.name}, {_with(self.course)}"

    @property
    def needs(self) -> frozenset[str]:
        """Columns that have to be recorded."""
        reports = {"report_us"} if self.place == "report" else set[str]()
        return frozenset(reports).union(*(CAUSES[cause].needs for cause in self.course.causes))

    def as_json(self) -> dict[str, Any]:
        """Give it in plain types, for the label."""
        return {
            "place": self.place,
            "stage": PLACES[self.place].stage,
            "causes": list(self.course.causes),
            "families": sorted({str(CAUSES[cause].family) for cause in self.course.causes}),
            "carrier": self.carrier,
            "course": self.course.name,
            "amount": self.amount,
            "nearest": self.apart.nearest,
            "share_left": round(self.apart.share, 4),
            "nats_left": round(self.apart.nats, 1),
        }


def _with(course: Course) -> str:
    return " × ".join(course.causes)


def draw_stranger(rng: np.random.Generator, setup: Setup, recording: Recording) -> Stranger | None:
    """Draw a stranger for a rig and its touches, or None if none of many shows on them."""
    for _ in range(TRIES):
        found = _draw_once(rng, setup, recording)
        if found is not None and found.apart.is_far:
            return found
    return None


def _draw_once(rng: np.random.Generator, setup: Setup, recording: Recording) -> Stranger | None:
    """Draw a place, a cause and a course; None if that is no stranger, or makes no sense."""
    place = draw_place(rng, recording)
    carrier = list(CARRIERS)[int(rng.choice(len(CARRIERS), p=list(CARRIERS.values())))]
    faint = rng.random() < FAINT_SHARE and carrier is Carrier.SHIFT
    low, high = FAINT if faint else WELL_ABOVE
    size = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    draw = Draw(rng, setup, size)
    course = _draw_course(draw, carrier)
    if any(excluded(place, cause, carrier, course.name) for cause in course.causes):
        return None
    seen = PLACES[place].see(setup, recording)
    if not seen.rows.any() or not _varies(course.values[seen.rows]):
        return None
    made = MAKERS[carrier](draw, PLACES[place], seen, course)
    if made is None:
        return None
    form, amount, apart = made
    words = f"{form.words}; place: {place}; goes with {_with(course)}; course: {course.name}"
    return Stranger(replace(form, words=words), place, carrier, course, size, amount, apart)


def _draw_course(d: Draw, carrier: Carrier) -> Course:
    first, name, values = _of_one(d)
    if carrier is not Carrier.SHIFT or d.rng.random() >= TOGETHER:
        return Course((first,), name, values)
    second, _, others = _of_one(d)
    if second == first:
        return Course((first,), name, values)
    return Course((first, second), INTERACTION, interaction(values, others))


def _of_one(d: Draw) -> tuple[str, str, FloatArray]:
    name = draw_cause(d.rng)
    kind: Kind = CAUSES[name].kind
    return name, *draw_course(d, kind, values_of(CAUSES[name], d))


def _varies(values: FloatArray) -> bool:
    """Tell whether a course sets enough touches apart."""
    if np.isnan(values).any() or np.ptp(values) < 1e-6:
        return False
    high = float(np.mean(values > values.min() + 0.5 * np.ptp(values)))
    return FEWEST_SHARE < high < 1 - FEWEST_SHARE


Made = tuple[Form, float, Apart]
Maker = Callable[[Draw, Place, Seen, Course], Made | None]


def _shift(d: Draw, place: Place, seen: Seen, course: Course) -> Made | None:
    unit = size_of_shift(d.setup, seen, course.values)
    amount = d.size / max(unit, 1e-12)
    if not np.isfinite(amount) or amount > place.most(d.setup.nominal):
        return None
    if place.belief is None:
        amount *= d.sense()
        shift = amount * course.values
    else:
        believed = place.belief(d.setup.nominal)
        shift = amount * course.values
        shift = shift - min(believed, float(shift.mean()))
    form = Form(f"{amount:+.4g}", place.hang(lambda _: shift))
    return form, amount, shift_apart(d.setup, seen, shift)


def _scatter(d: Draw, place: Place, seen: Seen, course: Course) -> Made | None:
    relative = (seen.factor * course.values / seen.noise)[seen.rows]
    amount = d.size / max(float(np.sqrt(np.mean(relative**2))), 1e-12)
    if not np.isfinite(amount) or amount > place.most(d.setup.nominal):
        return None
    sigma = amount * course.values
    late = place.belief is not None

    def scatter(s: State) -> Numbers:
        drawn: Numbers = sigma * s.rng.normal(0.0, 1.0, s.n)
        return np.abs(drawn) if late else drawn

    words = f"scatter of {amount:.4g}, late only" if late else f"scatter of {amount:.4g}"
    return Form(words, place.hang(scatter)), amount, scatter_apart(d.setup, seen, sigma)


def _now_and_then(d: Draw, place: Place, seen: Seen, course: Course) -> Made | None:
    seldom, often = d.pick(0.0, 0.01, 0.03), d.between(0.15, 0.7)
    share = np.clip(seldom + (often - seldom) * course.values, 0.0, 0.9)
    relative = (seen.factor / seen.noise)[seen.rows]
    amount = d.size / float(np.sqrt(np.mean(share[seen.rows] * relative**2)))
    amount = max(amount, LEAST_EVENT / float(np.median(np.abs(relative))))
    if not np.isfinite(amount) or amount > place.most(d.setup.nominal):
        return None
    tail = d.pick(0.05, 0.05, 0.4)
    sense = 1.0 if place.belief is not None else d.sense()

    def comes(s: State) -> FloatArray:
        size = sense * amount * np.abs(s.rng.normal(1.0, tail, s.n))
        return np.where(s.rng.random(s.n) < share, size, 0.0)

    words = f"{sense * amount:+.4g} at {100 * seldom:.0f} … {100 * often:.0f} % of the touches"
    return Form(words, place.hang(comes)), amount, share_apart(seen, share)


MAKERS: dict[Carrier, Maker] = {
    Carrier.SHIFT: _shift,
    Carrier.SCATTER: _scatter,
    Carrier.NOW_AND_THEN: _now_and_then,
}
