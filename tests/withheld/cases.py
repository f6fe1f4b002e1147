"""The cases of a check: what is asked for, and the campaign drawn from that."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tests.withheld.beliefs import Beliefs
from tests.withheld.chain import BoolArray, FloatArray, Hook, Outcomes, Setup, Step, play
from tests.withheld.orders import Case, Order
from tests.withheld.parts import Part
from tests.withheld.rigs import draw_rig
from tests.withheld.sizes import replicates
from tests.withheld.variants import Outliers, draw_outliers

REPLICATES = 50
HELD_BACK = 1 / 3
RUN = (4, 16)
"""Touches that are held back in a row, so that most of the others keep the touch before them."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A campaign with all that must stay sealed.

    Attributes:
        order: What was asked for.
        setup: The rig as it is, and the conditions of all touches.
        parts: Its effects in the order of the chain.
        dropped: Columns that were not recorded.
        beliefs: What the engineer believes of the rig.
        outcomes: What all touches were recorded to be.
        outliers: Which of them are grossly off, and by how much; none of those held back.
        held_back: Which touches the diagnosis does not get, shape (n,).
        oracle: Plays of the truth for all touches, each (REPLICATES, n).
        nominal: Plays of the rig without its effects, likewise, with the true phase of the scans.
    """

    order: Order
    setup: Setup
    parts: Sequence[Part]
    dropped: frozenset[str]
    beliefs: Beliefs
    outcomes: Outcomes
    outliers: Outliers | None
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
    rig = draw_rig(rng, order, touches)
    setup = rig.setup
    for part in rig.parts:
        if part.drawn.delay_s is not None:
            setup = setup.retimed(part.drawn.delay_s)
    hooks: list[Mapping[Step, Hook]] = [part.drawn.hooks for part in rig.parts]
    outcomes, _ = play(setup, hooks, rng)
    held_back = _in_runs(rng, len(setup.touches))
    outliers = draw_outliers(rng, setup, ~held_back) if order.case is Case.OUTLIERS else None
    return Drawn(
        order=order,
        setup=setup,
        parts=rig.parts,
        dropped=rig.dropped,
        beliefs=rig.beliefs,
        outcomes=outliers.of(outcomes) if outliers else outcomes,
        outliers=outliers,
        held_back=held_back,
        oracle=replicates(setup, hooks, rng, REPLICATES),
        nominal=replicates(setup, [], rng, REPLICATES),
        oracle_any_phase=replicates(setup, hooks, rng, REPLICATES, any_phase=True),
        nominal_any_phase=replicates(setup, [], rng, REPLICATES, any_phase=True),
    )


def _in_runs(rng: np.random.Generator, n: int) -> BoolArray:
    """Hold touches back in runs, shape (n,)."""
    held_back, wanted = np.zeros(n, bool), round(HELD_BACK * n)
    while (missing := wanted - np.count_nonzero(held_back)) > 0:
        first = int(rng.integers(n))
        run = np.arange(first, min(n, first + int(rng.integers(*RUN))))
        held_back[run[~held_back[run]][:missing]] = True
    return held_back
