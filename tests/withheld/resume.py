"""Going on with a drawn campaign: further touches on the same rig, with the same effects."""

from collections.abc import Collection
from dataclasses import asdict, replace

import numpy as np

from skiplatch.campaign import CONDITIONS, Touches
from tests.withheld.cases import Drawn
from tests.withheld.chain import Setup, play


def resume(
    rng: np.random.Generator, drawn: Drawn, conditions: Touches, record: Collection[str]
) -> Touches:
    """Make further touches in a session of their own, and record them as before.

    Args:
        rng: Of the outcomes, and of when the first scan starts.
        drawn: The campaign.
        conditions: The touches to make, in the order of time.
        record: Columns that are recorded now even if they were not before.
    """
    dropped = drawn.dropped - frozenset(record)
    phase_us = round(rng.uniform(0.0, drawn.setup.nominal.plc.scan_us), 3)
    setup = Setup(drawn.setup.nominal, _complete(rng, conditions, drawn.setup.touches), phase_us)
    outcomes, _ = play(setup, [part.drawn.hooks for part in drawn.parts], rng)
    made = {name: getattr(setup.touches, name) for name in CONDITIONS} | asdict(outcomes)
    return Touches.from_columns(**{k: v for k, v in made.items() if k not in dropped})


def _complete(rng: np.random.Generator, conditions: Touches, before: Touches) -> Touches:
    """Fill in what nobody wrote down: a rig has a temperature whether that is recorded or not."""
    filled = {}
    for name in ("position_mm", "rotary_deg", "temp_c"):
        values = getattr(conditions, name)
        anywhere = rng.choice(getattr(before, name), len(conditions))
        filled[name] = np.where(np.isnan(values), anywhere, values)
    return replace(conditions, **filled)
