"""Rigs that changed by the same cause, and rigs unlike the others."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np
import scipy

from skiplatch.fleet.changes import Change, level, started_log
from skiplatch.fleet.history import Entry, Gap, History

FEWEST_RIGS = 5
"""Rigs of a kind that tell what is usual."""
CHANCE = 0.01
"""Probability that of like rigs any is called unlike, in one observable whose gap is
spread lognormally over them."""
NEWEST = 3
"""Campaigns that say how a rig is now."""


@dataclass(frozen=True, slots=True)
class SharedCause:
    """Several rigs whose gap grew by one effect.

    Attributes:
        effect: The effect.
        stage: Where it acts.
        rigs: In the order in which they changed.
        first: When the first of them changed, UTC.
        last: When the last did.
    """

    effect: str
    stage: str
    rigs: list[str]
    first: datetime
    last: datetime


@dataclass(frozen=True, slots=True)
class Unlike:
    """A rig whose gap is far above that of most rigs of its kind.

    Attributes:
        rig: Its name.
        kind: Of the rig.
        observable: Of the gap.
        unit: Of both gaps.
        gap: Its own, by its newest campaigns.
        usual: The median of the rigs of its kind.
    """

    rig: str
    kind: str
    observable: str
    unit: str
    gap: float
    usual: float


def shared_causes(changes: Sequence[Change]) -> list[SharedCause]:
    """Put together the changes for the worse by the effect that grew."""
    by_effect: dict[tuple[str, str], dict[str, datetime]] = {}
    for change in sorted(changes, key=lambda change: change.began):
        if change.growth and change.is_worse:
            rigs = by_effect.setdefault((change.growth.effect, change.growth.stage), {})
            rigs.setdefault(change.rig, change.began)
    return [
        SharedCause(effect, stage, list(rigs), min(rigs.values()), max(rigs.values()))
        for (effect, stage), rigs in sorted(by_effect.items())
        if len(rigs) > 1
    ]


def unlike_others(history: History) -> list[Unlike]:
    """Find rigs whose gap lies far above the median of their kind.

    Far is in units of a median distance, in the logarithm of the gap, so that what is unlike does
    not say what is usual.
    """
    newest = {rig: entries[-NEWEST:] for rig, entries in history.items()}
    groups: dict[tuple[str, str], dict[str, list[Gap]]] = {}
    for rig, entries in newest.items():
        for name in entries[-1].gaps:
            groups.setdefault((entries[-1].kind, name), {})[rig] = _gaps(entries, name)
    return sorted(
        (rig for (kind, name), rigs in groups.items() for rig in _unlike(kind, name, rigs)),
        key=lambda unlike: (unlike.rig, unlike.observable),
    )


def _gaps(entries: Sequence[Entry], observable: str) -> list[Gap]:
    return [entry.gaps[observable] for entry in entries if observable in entry.gaps]


def _unlike(kind: str, observable: str, rigs: dict[str, list[Gap]]) -> list[Unlike]:
    if len(rigs) < FEWEST_RIGS:
        return []
    values = np.array([np.mean([started_log(gap) for gap in gaps]) for gaps in rigs.values()])
    levels = [level(gaps) for gaps in rigs.values()]
    usual, scatter = float(np.median(levels)), _scatter(values)
    far = values - np.median(values) > _limit(len(rigs)) * scatter
    return [
        Unlike(rig, kind, observable, gaps[0].unit, own, usual)
        for (rig, gaps), own, is_far in zip(rigs.items(), levels, far, strict=True)
        if is_far and own - usual > gaps[-1].noise_floor
    ]


def _scatter(values: np.ndarray) -> float:
    """Give the median distance of those above the median from it, as a standard deviation.

    Rigs without a gap stand close together below; they say nothing of those above.
    """
    above = values[values > np.median(values)]
    middle = float(np.median(above) - np.median(values)) if len(above) else 0.0
    return middle / float(scipy.special.ndtri(0.75))


def _limit(rigs: int) -> float:
    """Give the limit in standard deviations; few rigs tell theirs badly, hence Student's t."""
    return float(scipy.special.stdtrit(rigs - 1, 1.0 - CHANCE / rigs))
