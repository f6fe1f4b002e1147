"""The law of what is seen in each stream, once the physics is changed."""

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Extra, Law, spliced
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.physics import change_for, members_of, number_of, touches_of
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.library import connection, layout

TINY = 1e-9
LATTICE = "lattice"
"""Stream of the stamps of scans, off the grid that they keep together."""
AFTER_LATCH = {"position", "arrival", "report"}
"""Streams that are counted from the stamp of the latch."""


def law_under(scene: Scene, stream: Stream, change: Change) -> Law:
    """Give the law of a stream's residuals, once the believed rig is changed.

    It has n of them; those of touches that are not in the stream say nothing.
    """
    return law_of(scene, stream, scene.with_beliefs(change))


def law_of(scene: Scene, stream: Stream, change: Change) -> Law:
    """Give the same for all that differs from the chain, the effects believed in among it."""
    if change.passing:
        times = change.at_times(scene.touches.touch)
        return spliced([(rows, law_of(scene, stream, there)) for rows, there in times])
    return _law(scene, stream, change)


def _law(scene: Scene, stream: Stream, change: Change) -> Law:
    """Give the law of a stream for a change that is the same throughout: see ``stream_law.h``."""
    ffi, library = connection()
    changed, number = change_for(scene, change, [stream.name]), number_of(stream.name)
    members = members_of(scene, [(stream, changed, 0.0)])
    extra_count, count = changed.at[0].extra_counts[number], len(stream.indices)
    laws = np.empty(count, dtype=layout("sim_law_t"))
    more = np.empty((extra_count, count), dtype=layout("sim_extra_t"))
    code = library.sim_stream_laws(
        touches_of(scene).at,
        members.at,
        count,
        ffi.from_buffer("sim_law_t[]", laws, require_writable=True),
        ffi.from_buffer("sim_extra_t[]", more, require_writable=True),
    )
    if code:
        raise MemoryError

    def whole(values: FloatArray, others: FloatArray | float) -> FloatArray:
        found = np.zeros(len(scene)) + others
        found[stream.indices] = values
        return found

    def extra(share: float, row: NDArray[np.void]) -> Extra:
        names = [name for name in layout("sim_extra_t").fields or () if name != "share"]
        return Extra(share, **{name: whole(row[name], 0.0) for name in names})

    names = layout("sim_law_t").fields or ()
    law = {name: whole(laws[name], getattr(stream.chain, name)) for name in names}
    some = changed.at[0].extras[number]
    return Law(**law, extras=tuple(extra(some[k].share, row) for k, row in enumerate(more)))
