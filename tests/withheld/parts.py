"""What is the matter with a campaign, drawn for a rig: an effect, a stranger, a dull variant."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tests.withheld.chain import Setup
from tests.withheld.conditions import Recording
from tests.withheld.effects import BOTH, EFFECTS, draw_form
from tests.withheld.forms import Draw, Form
from tests.withheld.grammar import Stranger
from tests.withheld.sizes import Sizes, measure
from tests.withheld.strangers import DULL, STRANGERS

FAINTEST = 0.2  # an effect that shows less is drawn again, stronger
TRIES = 12
OTHERS = {**STRANGERS, **DULL}


@dataclass(frozen=True, eq=False)
class Part:
    """One effect, stranger or dull variant that a campaign has.

    Attributes:
        id: Of the catalogue, or of one of the other tables; of a stranger of the grammar, it in
            short.
        form: The name of its form, empty if it has only one.
        drawn: The form with its parameters.
        size: The knob.
        sizes: What it comes to.
        facts: More of it, for the label.
    """

    id: str
    form: str
    drawn: Form
    size: float
    sizes: Sizes
    facts: Mapping[str, Any] = field(default_factory=dict)

    @property
    def shows(self) -> bool:
        """Whether it moves what is recorded at all; a dull variant need not."""
        return self.id in DULL or self.sizes.visible >= FAINTEST


def needs(part: str) -> frozenset[str]:
    """Name the columns without which a part cannot be told from noise."""
    return EFFECTS[part].needs if part in EFFECTS else OTHERS[part].needs


def recordings_for(part: str) -> list[Recording]:
    """Name the kinds of recording in which an effect, a stranger or a dull variant can be seen."""
    on_bench = EFFECTS[part].on_bench if part in EFFECTS else OTHERS[part].on_bench
    kinds = [Recording.BENCH] if on_bench else []
    if part in EFFECTS or OTHERS[part].on_machine:
        kinds.append(Recording.STAMPED)
        if not needs(part) & {"latch_us", "report_us"}:
            kinds.append(Recording.POSITION)
    return kinds


def draw_part(rng: np.random.Generator, part: str, setup: Setup, recorded: Sequence[str]) -> Part:
    """Draw a part by its id, stronger and stronger until it shows or it is given up."""
    size = float(np.exp(rng.uniform(np.log(0.7), np.log(30.0))))
    drawn = _draw_once(rng, part, size, setup, recorded)
    for _ in range(TRIES):
        if drawn.shows:
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


def part_of(
    stranger: Stranger, setup: Setup, recorded: Sequence[str], rng: np.random.Generator
) -> Part:
    """Make a stranger of the grammar a part."""
    sizes = measure(stranger.form, setup, recorded, BOTH, rng)
    facts = stranger.as_json()
    return Part(stranger.name, stranger.course.name, stranger.form, stranger.size, sizes, facts)
