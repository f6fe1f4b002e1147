"""The cases of a check: which effects a campaign has, and the campaign drawn from that."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from tests.gap.chain import BoolArray, FloatArray, Hook, Outcomes, Setup, Step, play
from tests.gap.conditions import Recording, draw_setup
from tests.gap.grammar import draw_stranger
from tests.gap.parts import TRIES, Part, draw_part, needs, part_of
from tests.gap.sizes import OBSERVABLES, replicates

REPLICATES = 50
HELD_BACK = 1 / 3
RUN = (4, 16)
"""Touches that are held back in a row, so that most of the others keep the touch before them."""
OPTIONAL = ("axis", "position_mm", "rotary_deg", "temp_c", "report_us")
SELDOM_RECORDED = 0.05


class Case(StrEnum):
    """What is the matter with a campaign."""

    SINGLE = "single"
    TWO = "two"
    NONE = "none"
    STRANGER = "stranger"
    """One of those that were written down by hand."""
    DULL = "dull"
    STRANGERS = "strangers"
    """One of the grammar."""


VERDICTS = {
    Case.SINGLE: "explained",
    Case.TWO: "explained",
    Case.NONE: "no_gap",
    Case.STRANGER: "unknown",
    Case.DULL: "no_gap",
    Case.STRANGERS: "unknown",
}


@dataclass(frozen=True)
class Order:
    """What is to be drawn: of effects and strangers, by id, and the kind of recording."""

    case: Case
    recording: Recording
    ids: Sequence[str]


@dataclass(frozen=True, eq=False)
class Rig:
    """What is played, before it is.

    Attributes:
        setup: The rig and the conditions of all touches.
        parts: Its effects in the order of the chain.
        dropped: Columns that were not recorded.
    """

    setup: Setup
    parts: Sequence[Part]
    dropped: frozenset[str]


@dataclass(frozen=True, eq=False)
class Drawn:
    """A campaign with all that must stay sealed.

    Attributes:
        order: What was asked for.
        setup: The rig and the conditions of all touches.
        parts: Its effects in the order of the chain.
        dropped: Columns that were not recorded.
        outcomes: What all touches were recorded to be.
        held_back: Which touches the diagnosis does not get, shape (n,).
        oracle: Plays of the truth for all touches, each (REPLICATES, n).
        nominal: Plays of the unchanged chain, likewise, with the true phase of the scans.
    """

    order: Order
    setup: Setup
    parts: Sequence[Part]
    dropped: frozenset[str]
    outcomes: Outcomes
    held_back: BoolArray
    oracle: Mapping[str, FloatArray]
    nominal: Mapping[str, FloatArray]
    oracle_any_phase: Mapping[str, FloatArray]
    nominal_any_phase: Mapping[str, FloatArray]


def draw_campaign(rng: np.random.Generator, order: Order, touches: tuple[int, int]) -> Drawn:
    """Draw all of a campaign, on another rig if one shows some effect at no size.

    Raises:
        ValueError: No rig of many showed it.
    """
    draw_rig = _stranger if order.case is Case.STRANGERS else _known
    rig = draw_rig(rng, order, touches)
    if rig is None:
        raise ValueError(f"no rig shows {', '.join(order.ids)} in a {order.recording} recording")
    setup = rig.setup
    for part in rig.parts:
        if part.drawn.delay_s is not None:
            setup = setup.retimed(part.drawn.delay_s)
    hooks: list[Mapping[Step, Hook]] = [part.drawn.hooks for part in rig.parts]
    outcomes, _ = play(setup, hooks, rng)
    return Drawn(
        order=order,
        setup=setup,
        parts=rig.parts,
        dropped=rig.dropped,
        outcomes=outcomes,
        held_back=_in_runs(rng, len(setup.touches)),
        oracle=replicates(setup, hooks, rng, REPLICATES),
        nominal=replicates(setup, [], rng, REPLICATES),
        oracle_any_phase=replicates(setup, hooks, rng, REPLICATES, any_phase=True),
        nominal_any_phase=replicates(setup, [], rng, REPLICATES, any_phase=True),
    )


def _known(rng: np.random.Generator, order: Order, touches: tuple[int, int]) -> Rig | None:
    """Draw a rig that shows every part of an order, or None if none of many does."""
    dropped = _dropped(rng, order.recording, frozenset[str]().union(*map(needs, order.ids)))
    for _ in range(TRIES):
        setup = draw_setup(rng, order.recording, touches)
        parts = [draw_part(rng, part, setup, _recorded(dropped)) for part in order.ids]
        if all(part.shows for part in parts):
            return Rig(setup, parts, dropped)
    return None


def _stranger(rng: np.random.Generator, order: Order, touches: tuple[int, int]) -> Rig | None:
    """Draw a rig and a stranger of the grammar that shows on it."""
    for _ in range(TRIES):
        setup = draw_setup(rng, order.recording, touches)
        stranger = draw_stranger(rng, setup, order.recording)
        if stranger is not None:
            dropped = _dropped(rng, order.recording, stranger.needs)
            return Rig(setup, [part_of(stranger, setup, _recorded(dropped), rng)], dropped)
    return None


def _recorded(dropped: Collection[str]) -> list[str]:
    return [name for name in OBSERVABLES if name not in dropped]


def _dropped(
    rng: np.random.Generator, recording: Recording, needed: Collection[str]
) -> frozenset[str]:
    """Name columns that nobody recorded, but none without which the effect is invisible."""
    seldom = [name for name in OPTIONAL if rng.random() < SELDOM_RECORDED]
    dropped = {name for name in seldom if name not in needed}
    if "axis" in dropped:
        dropped.add("sign")
    if recording is Recording.POSITION:
        dropped |= {"latch_us", "report_us"}
    return frozenset(dropped)


def _in_runs(rng: np.random.Generator, n: int) -> BoolArray:
    """Hold touches back in runs, shape (n,)."""
    held_back, wanted = np.zeros(n, bool), round(HELD_BACK * n)
    while (missing := wanted - np.count_nonzero(held_back)) > 0:
        first = int(rng.integers(n))
        run = np.arange(first, min(n, first + int(rng.integers(*RUN))))
        held_back[run[~held_back[run]][:missing]] = True
    return held_back
