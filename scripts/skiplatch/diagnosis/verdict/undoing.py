"""Effects that undo each other: what both do together is the scatter of one that has no name.

A position that is 660 µs old on an axis that runs 669 µs ahead is off by a few µs of its way. Both
are far larger than anything that is seen, and no touch tells how large.
"""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.scene.scene import Scene

UNDONE = 0.2
"""Share of what the smaller of two effects does by itself, of which both together do no more."""


def undoing(scene: Scene, fit: Fit) -> list[str]:
    """Name the effects of a fit that undo each other somewhere, each more than touches scatter."""
    changes = [fit.alone(i).change(scene) for i in range(len(fit.candidates))]
    found: dict[str, None] = {}
    for (i, one), (j, other) in combinations(enumerate(changes), 2):
        shifts = (_shifts(scene, stream, one, other) for stream in _shown(scene))
        if any(both < UNDONE * min(each) and min(each) > 1.0 for *each, both in shifts):
            found |= dict.fromkeys((fit.candidates[i].id, fit.candidates[j].id))
    return list(found)


def _shown(scene: Scene) -> Iterator[Stream]:
    return (stream for stream in scene.streams.values() if stream.rows.any())


def _shifts(scene: Scene, stream: Stream, one: Change, other: Change) -> tuple[float, ...]:
    """Give what two changes and both together shift a stream by, over what it scatters by."""

    def shift(change: Change) -> float:
        moved = law_under(scene, stream, change).mean - stream.law.mean
        return float(np.sqrt(np.mean((moved / stream.law.spread)[stream.rows] ** 2)))

    return shift(one), shift(other), shift(one.joined(other))
