"""What the log of a controller's programs can tell: it does not say where a surface lies."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from skiplatch.campaign import Campaign, DatumFreedom, Nominal, Touches
from skiplatch.campaign.datum import Datum
from skiplatch.diagnosis.experiment import words
from skiplatch.diagnosis.experiment.rehearsal import Rehearsal
from skiplatch.diagnosis.experiment.rivals import NO_EFFECT, Model

COLUMNS = frozenset({"deviation_um"})
"""Outcomes that such a log has."""


def as_imported(nominal: Nominal, touches: Touches) -> tuple[Nominal, Touches]:
    """Give touches as their log is imported: each surface may lie anywhere, with a session."""
    where = np.column_stack([touches.axis, touches.sign, touches.position_mm, touches.session])
    surfaces, numbers = np.unique(where, axis=0, return_inverse=True)
    names = tuple(map(str, range(len(surfaces))))
    apart = replace(touches, session=numbers.ravel(), session_names=names)
    return replace(nominal, datum=Datum(DatumFreedom.SESSION)), apart


def not_told(
    campaign: Campaign, models: Sequence[Model], plan: Touches, *, seed: int, jobs: int = 1
) -> list[tuple[str, ...]]:
    """Give the groups of models, no effect among them, that the log of a plan leaves tied.

    The plan is played by each model to its end, and judged by deviations from surfaces that may
    lie anywhere.

    Args:
        campaign: What was diagnosed.
        models: What the diagnosis left.
        plan: The touches to make.
        seed: Picks the random numbers.
        jobs: Threads to play on.
    """
    if not models:
        return []
    all_models = [*models, NO_EFFECT]
    nominal, touches = as_imported(campaign.nominal, plan)
    rehearsal = Rehearsal.of(campaign, all_models)
    played = rehearsal.played(nominal, touches, seed=seed, jobs=jobs)
    groups = rehearsal.groups(touches, played, COLUMNS, nominal).tolist()
    named = list(zip(map(words.name, all_models), groups, strict=True))
    tied = [tuple(name for name, other in named if other == group) for group in sorted(set(groups))]
    return [names for names in tied if len(names) > 1]
