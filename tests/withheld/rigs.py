"""The rig of a campaign, as its case wants it: what it has, and what is believed of it."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.campaign import Datum, DatumFreedom, Nominal
from tests.withheld.beliefs import Beliefs, uncertain, wrong_noise
from tests.withheld.chain import Setup
from tests.withheld.conditions import Recording, draw_setup
from tests.withheld.datum import draw_datum
from tests.withheld.effects import BOTH, EFFECTS
from tests.withheld.grammar import draw_stranger
from tests.withheld.orders import Case, Order
from tests.withheld.parts import FAINTEST, TRIES, Part, draw_part, needs, part_of
from tests.withheld.sizes import OBSERVABLES, measure
from tests.withheld.variants import FEW, at_one_place, draw_onset

OPTIONAL = ("axis", "position_mm", "rotary_deg", "temp_c", "report_us")
SELDOM_RECORDED = 0.05
HELD_BACK_TOO = 1.5
"""Touches over recorded ones."""

Rng = np.random.Generator
Span = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Rig:
    """What is played, before it is.

    Attributes:
        setup: The rig as it is, and the conditions of all touches.
        parts: Its effects in the order of the chain.
        dropped: Columns that were not recorded.
        beliefs: What the engineer believes of it.
    """

    setup: Setup
    parts: list[Part]
    dropped: frozenset[str]
    beliefs: Beliefs


def draw_rig(rng: Rng, order: Order, touches: Span) -> Rig:
    """Draw the rig of an order.

    Raises:
        ValueError: No rig of many shows what it is to have.
    """
    rig = RIGS.get(order.case, _known)(rng, order, touches)
    if rig is None:
        raise ValueError(f"no rig shows {', '.join(order.ids)} in a {order.recording} recording")
    return rig


def _known(rng: Rng, order: Order, touches: Span) -> Rig | None:
    """Draw a rig that shows every part of an order, or None if none of many does."""
    dropped = _dropped(rng, order.recording, _needed(order))
    for _ in range(TRIES):
        setup = draw_setup(rng, order.recording, touches)
        rig = _with_parts(rng, order, setup, dropped)
        if rig is not None:
            return rig
    return None


def _with_parts(rng: Rng, order: Order, setup: Setup, dropped: frozenset[str]) -> Rig | None:
    parts = [draw_part(rng, part, setup, _recorded(dropped)) for part in order.ids]
    shown = all(part.shows for part in parts)
    return Rig(setup, parts, dropped, Beliefs(setup.nominal)) if shown else None


def _stranger(rng: Rng, order: Order, touches: Span) -> Rig | None:
    """Draw a rig and a stranger of the grammar that shows on it."""
    for _ in range(TRIES):
        setup = draw_setup(rng, order.recording, touches)
        stranger = draw_stranger(rng, setup, order.recording)
        if stranger is not None:
            dropped = _dropped(rng, order.recording, stranger.needs)
            part = part_of(stranger, setup, _recorded(dropped), rng)
            return Rig(setup, [part], dropped, Beliefs(setup.nominal))
    return None


def _datum(rng: Rng, order: Order, touches: Span) -> Rig:
    """Draw a rig whose surface is off; of an axis and sense only if the engineer says so."""
    setup = draw_setup(rng, order.recording, touches)
    datum = draw_datum(rng, setup)
    dropped = _dropped(rng, order.recording, {"axis"})
    sizes = measure(datum.form, setup, _recorded(dropped), BOTH, rng)
    part = Part("datum", datum.free, datum.form, 0.0, sizes, datum.as_json())
    believed = setup.nominal
    if datum.free is DatumFreedom.AXIS_SENSE:
        believed = replace(believed, datum=Datum(datum.free))
    return Rig(_as_believed(setup, believed), [part], dropped, Beliefs(believed))


def _wrong_noise(rng: Rng, order: Order, touches: Span) -> Rig:
    setup = draw_setup(rng, order.recording, touches)
    dropped = _dropped(rng, order.recording, {"report_us"})
    return Rig(setup, [], dropped, wrong_noise(rng, setup.nominal, order.recording))


def _uncertain(rng: Rng, order: Order, touches: Span) -> Rig | None:
    rig = _known(rng, order, touches)
    if rig is None:
        return None
    beliefs = uncertain(rng, rig.setup.nominal, order.recording, order.ids)
    return replace(rig, setup=_as_believed(rig.setup, beliefs.nominal), beliefs=beliefs)


def _onset(rng: Rng, order: Order, touches: Span) -> Rig | None:
    """Draw a rig whose effect begins or ends, and shows all the same."""
    for _ in range(TRIES):
        rig = _known(rng, order, touches)
        if rig is None:
            return None
        (part,) = rig.parts
        onset = draw_onset(rng, len(rig.setup.touches))
        form = onset.of(part.drawn)
        played = rig.setup if form.delay_s is None else rig.setup.retimed(form.delay_s)
        paths = EFFECTS[part.id].paths
        sizes = measure(form, played, _recorded(rig.dropped), paths, rng)
        if sizes.visible >= FAINTEST:
            gated = replace(part, drawn=form, sizes=sizes, facts={"onset": onset.as_json()})
            return replace(rig, parts=[gated])
    return None


def _small(rng: Rng, order: Order, _touches: Span) -> Rig | None:
    """Draw few touches at one place."""
    few = (round(HELD_BACK_TOO * FEW[0]), round(HELD_BACK_TOO * FEW[1]))
    dropped = _dropped(rng, order.recording, _needed(order))
    for _ in range(TRIES):
        setup = at_one_place(rng, draw_setup(rng, order.recording, few))
        rig = _with_parts(rng, order, setup, dropped)
        if rig is not None:
            return rig
    return None


RIGS: Mapping[Case, Callable[[Rng, Order, Span], Rig | None]] = {
    Case.STRANGERS: _stranger,
    Case.DATUM: _datum,
    Case.WRONG_NOISE: _wrong_noise,
    Case.UNCERTAIN: _uncertain,
    Case.ONSET: _onset,
    Case.SMALL: _small,
}
"""Of the other cases: a rig that shows every part of the order."""


def _as_believed(setup: Setup, believed: Nominal) -> Setup:
    """Play by the version of the format that the campaign is written in."""
    return replace(setup, nominal=replace(setup.nominal, version=believed.version))


def _needed(order: Order) -> frozenset[str]:
    return frozenset[str]().union(*map(needs, order.ids))


def _recorded(dropped: Collection[str]) -> list[str]:
    return [name for name in OBSERVABLES if name not in dropped]


def _dropped(rng: Rng, recording: Recording, needed: Collection[str]) -> frozenset[str]:
    """Name columns that nobody recorded, but none without which the effect is invisible."""
    seldom = [name for name in OPTIONAL if rng.random() < SELDOM_RECORDED]
    dropped = {name for name in seldom if name not in needed}
    if "axis" in dropped:
        dropped.add("sign")
    if recording is Recording.POSITION:
        dropped |= {"latch_us", "report_us"}
    return frozenset(dropped)
