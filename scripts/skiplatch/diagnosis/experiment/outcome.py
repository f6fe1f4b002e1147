"""What the touches of an experiment say of the models that it was to tell apart."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.campaign import Campaign
from skiplatch.diagnosis.experiment.channels import recorded
from skiplatch.diagnosis.experiment.joint import added_nats, as_fit, some, suited
from skiplatch.diagnosis.experiment.rehearsal import Rehearsal
from skiplatch.diagnosis.experiment.rivals import NO_EFFECT, Model
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.search.groups import TIED


@dataclass(frozen=True, slots=True)
class Standing:
    """How a model stands after the experiment."""

    model: Model
    behind_nats: float
    """By so much it expects the new touches less than the best model does; 0 for that one."""
    is_expected: bool
    """Whether such touches are expected to tell it from the best model."""

    @property
    def is_left(self) -> bool:
        """Whether the new touches leave it possible: to be out, it should have lost and has.

        What falls behind unexpectedly does so by its form, which is never just the real one.
        """
        return self.behind_nats < TIED or not self.is_expected


def outcome(
    campaign: Campaign, further: Campaign, models: Sequence[Model], *, seed: int, jobs: int = 1
) -> list[Standing]:
    """Hold models against the touches of an experiment, the best one first.

    The first campaign could not tell them apart, so only what the new touches add counts: the
    log-likelihood of both, with the parameters that suit both, less that of the first alone.

    Args:
        campaign: What was diagnosed.
        further: The touches that were made since, as a campaign of its own.
        models: What the diagnosis left; see `rivals`.
        seed: Of the plays that say what was to be expected.
        jobs: Threads to play on.
    """
    before, new = Rehearsal.of(campaign, models), scene_of(further)
    added = [added_nats(before.old, new, fit) for fit in before.fits]
    played = before.played(new.nominal, new.touches, seed=seed, jobs=jobs)
    columns = recorded(new.nominal, new.touches)
    groups = before.groups(new.touches, played, columns, new.nominal)
    best = int(np.argmax(added))
    standings = [
        Standing(model, added[best] - nats, bool(group != groups[best]))
        for model, nats, group in zip(models, added, groups, strict=True)
    ]
    return sorted(standings, key=lambda standing: standing.behind_nats)


def borne_out_nats(campaign: Campaign, further: Campaign, model: Model) -> float:
    """Give what the new touches add to a model, less what they add to no effect at all.

    Where that is about 0 they tell nothing of it, however much the first campaign did.
    """
    old, new = some(scene_of(campaign)), scene_of(further)
    with_it, without = (
        added_nats(old, new, suited([old], as_fit(one))) for one in (model, NO_EFFECT)
    )
    return with_it - without
