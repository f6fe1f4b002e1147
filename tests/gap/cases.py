"""The cases of a check: which effects a campaign has, and the campaign drawn from that."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from tests.gap.chain import Hook, Outcomes, Setup, Step, play
from tests.gap.conditions import Recording, draw_setup
from tests.gap.effects import BOTH, EFFECTS, draw_form
from tests.gap.forms import Draw, Form
from tests.gap.sizes import OBSERVABLES, Sizes, measure, replicates
from tests.gap.strangers import DULL, STRANGERS

FAINTEST = 0.2  # an effect that shows less is drawn again, stronger
TRIES = 12
REPLICATES = 50
HELD_BACK = 1 / 3
OPTIONAL = ("axis", "position_mm", "rotary_deg", "temp_c", "report_us")


OTHERS = {**STRANGERS, **DULL}


class Case(StrEnum):
    """What is the matter with a campaign."""

    SINGLE = "single"
    TWO = "two"
    NONE = "none"
    STRANGER = "stranger"
    DULL = "dull"


VERDICTS = {
    Case.SINGLE: "explained",
    Case.TWO: "explained",
    Case.NONE: "no_gap",
    Case.STRANGER: "unknown",
    Case.DULL: "no_gap",
}


@dataclass(frozen=True)
class Order:
    """What is to be drawn: of effects and strangers, by id, and the kind of recording."""

    case: Case
    recording: Recording
    ids: Sequence[str]


@dataclass(frozen=True, eq=False)
class Part:
    """One effect, stranger or dull variant that a campaign has.

    Attributes:
        id: Of the catalogue, or of one of the other tables.
        form: The name of its form, empty if it has only one.
        drawn: The form with its parameters.
        size: The knob.
        sizes: What it comes to.
    """

    id: str
    form: str
    drawn: Form
    size: float
    sizes: Sizes


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
    held_back: np.typing.NDArray[np.bool_]
    oracle: Mapping[str, np.typing.NDArray[np.float64]]
    nominal: Mapping[str, np.typing.NDArray[np.float64]]
    oracle_any_phase: Mapping[str, np.typing.NDArray[np.float64]]
    nominal_any_phase: Mapping[str, np.typing.NDArray[np.float64]]


def _needs(part: str) -> frozenset[str]:
    return EFFECTS[part].needs if part in EFFECTS else OTHERS[part].needs


def recordings_for(part: str) -> list[Recording]:
    """Name the kinds of recording in which an effect, a stranger or a dull variant can be seen."""
    on_bench = EFFECTS[part].on_bench if part in EFFECTS else OTHERS[part].on_bench
    kinds = [Recording.BENCH] if on_bench else []
    if part in EFFECTS or OTHERS[part].on_machine:
        kinds.append(Recording.STAMPED)
        if not _needs(part) & {"latch_us", "report_us"}:
            kinds.append(Recording.POSITION)
    return kinds


def draw_campaign(rng: np.random.Generator, order: Order, touches: tuple[int, int]) -> Drawn:
    """Draw all of a campaign, on another rig if one shows some effect at no size.

    Raises:
        ValueError: No rig of many showed it.
    """
    dropped = _dropped(rng, order)
    recorded = [name for name in OBSERVABLES if name not in dropped]
    for _ in range(TRIES):
        setup = draw_setup(rng, order.recording, touches)
        parts = [_draw_part(rng, part, setup, recorded) for part in order.ids]
        if all(part.id in DULL or part.sizes.visible >= FAINTEST for part in parts):
            break
    else:
        raise ValueError(f"no rig shows {', '.join(order.ids)} in a {order.recording} recording")
    for part in parts:
        if part.drawn.delay_s is not None:
            setup = setup.retimed(part.drawn.delay_s)
    hooks: list[Mapping[Step, Hook]] = [part.drawn.hooks for part in parts]
    outcomes, _ = play(setup, hooks, rng)
    n = len(setup.touches)
    return Drawn(
        order=order,
        setup=setup,
        parts=parts,
        dropped=dropped,
        outcomes=outcomes,
        held_back=np.isin(np.arange(n), rng.permutation(n)[: round(HELD_BACK * n)]),
        oracle=replicates(setup, hooks, rng, REPLICATES),
        nominal=replicates(setup, [], rng, REPLICATES),
        oracle_any_phase=replicates(setup, hooks, rng, REPLICATES, any_phase=True),
        nominal_any_phase=replicates(setup, [], rng, REPLICATES, any_phase=True),
    )


def _dropped(rng: np.random.Generator, order: Order) -> frozenset[str]:
    """Name columns that nobody recorded, but none without which the effect is invisible."""
    needed = frozenset[str]().union(*map(_needs, order.ids))
    dropped = {name for name in OPTIONAL if rng.random() < 0.05 and name not in needed}
    if "axis" in dropped:
        dropped.add("sign")
    if order.recording is Recording.POSITION:
        dropped |= {"latch_us", "report_us"}
    return frozenset(dropped)


def _draw_part(rng: np.random.Generator, part: str, setup: Setup, recorded: Sequence[str]) -> Part:
    size = float(np.exp(rng.uniform(np.log(0.7), np.log(30.0))))
    drawn = _draw_once(rng, part, size, setup, recorded)
    for _ in range(TRIES):
        if drawn.sizes.visible >= FAINTEST or part in DULL:
            break
        drawn = _draw_once(rng, part, 1.6 * drawn.size, setup, recorded)
    return drawn


def _draw_once(
    rng: np.random.Generator, part: str, size: float, setup: Setup, recorded: Sequence[str]
) -> Part:
    draw = Draw(rng, setup, size)
    if part in EFFECTS:
        name, form = draw_form(part, draw)
    else:
        name, form = "", OTHERS[part].make(draw)
    played = setup if form.delay_s is None else setup.retimed(form.delay_s)
    paths = EFFECTS[part].paths if part in EFFECTS else BOTH
    return Part(part, name, form, size, measure(form, played, recorded, paths, rng))
