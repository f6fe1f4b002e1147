"""How likely the recorded touches are under a change of the physics.

The change is carried through the chain to the law of every stream it can be seen in; C does that,
see ``streams.h``, but for touches that were not latched.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.datum import FAMILIES, SHIFTED
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import LATTICE, law_of
from skiplatch.diagnosis.likelihood.physics import (
    change_for,
    line_bonus,
    members_of,
    number_of,
    touches_of,
)
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.library import connection

MISSED = "missed"
"""Name of the stream of touches that were not latched."""
NEVER_LOST = 1e-5
"""Share of touches that may be missed for reasons of their own."""
SHARP: Mapping[str, float] = {}


@dataclass(frozen=True, slots=True, eq=False)
class Likelihood:
    """Log-likelihood by stream: arrays of shape (n,), 0 where nothing was recorded."""

    streams: Mapping[str, FloatArray]

    @property
    def per_touch(self) -> FloatArray:
        """Sum over the streams; shape (n,)."""
        return np.asarray(sum(self.streams.values()))

    @property
    def total(self) -> float:
        """Of all touches."""
        return float(self.per_touch.sum())

    def differing(self, other: "Likelihood") -> frozenset[str]:
        """Name the streams in which another likelihood is not the same."""
        both = self.streams.items()
        return frozenset(n for n, own in both if not np.array_equal(own, other.streams[n]))


def likelihood(
    scene: Scene,
    change: Change,
    names: Collection[str] | None = None,
    widening: Mapping[str, float] = SHARP,
) -> Likelihood:
    """Evaluate the streams.

    Args:
        scene: The touches.
        change: What differs from the believed rig.
        names: Of the streams to evaluate; all without it.
        widening: Smoothes the laws of some streams for a coarse search, by so much in their unit.
    """
    change = scene.with_beliefs(change)
    wanted = set(scene.streams if names is None else names) & scene.streams.keys()
    found, _ = _evaluated(scene, change, with_shared_datum(scene, wanted), widening)
    values = {name: found[name] for name in scene.streams if name in wanted}
    if names is None or MISSED in names:
        values[MISSED] = _missed(scene, change)
    return Likelihood(values)


def _evaluated(
    scene: Scene, change: Change, names: Collection[str], widening: Mapping[str, float]
) -> tuple[dict[str, FloatArray], FloatArray]:
    """Evaluate some streams, with all that share a datum with any of them.

    Returns:
        The log-likelihood of each touch by stream, and the likeliest datum of each group by family
        of streams, shape (f, g).
    """
    ffi, library = connection()
    # Always in the same order: sums that are rounded otherwise may lead a search elsewhere.
    streams = {name: stream for name, stream in scene.streams.items() if name in names}
    values = np.zeros((library.SIM_STREAM_COUNT, len(scene)))
    datum_um = np.zeros((library.SIM_FAMILY_COUNT, scene.datum_count))
    parts = []
    for rows, there in _at_times(scene, change):
        laid_out = change_for(scene, there, streams)
        for name, all_of_it in streams.items():
            stream = all_of_it if rows is None else all_of_it.part(rows)
            if len(stream.indices):
                parts.append((stream, laid_out, widening.get(name, 0.0)))
    code = library.sim_streams_log_likelihood(
        touches_of(scene).at,
        members_of(scene, parts).at,
        len(parts),
        ffi.from_buffer("double[]", values, require_writable=True),
        ffi.from_buffer("double[]", datum_um, require_writable=True),
    )
    if code:
        raise MemoryError
    return {name: values[number_of(name)] for name in streams}, datum_um


def _at_times(scene: Scene, change: Change) -> Iterable[tuple[BoolArray | None, Change]]:
    """Give what differs with the touches for which it does: None for all of them."""
    return change.at_times(scene.touches.touch) if change.passing else [(None, change)]


def affected(scene: Scene, change: Change) -> frozenset[str]:
    """Name the streams whose law a change alters at all."""
    if change.passing:
        return frozenset().union(
            *(affected(scene, there) for _, there in change.at_times(scene.touches.touch))
        )
    names = {
        name
        for name, stream in scene.streams.items()
        if _differ(law_of(scene, stream, change), stream.chain)
        or (name != LATTICE and line_bonus(scene, stream, change).any())
    }
    stamped = np.broadcast_to(np.asarray(change.stamp_us), (len(scene),))[scene.plc]
    if change.period_us != 0.0 or change.wait is not None or np.any(stamped != 0.0):
        names |= {LATTICE} & scene.streams.keys()
    if change.lost > 0.0:
        names.add(MISSED)
    return frozenset(names)


def _differ(law: Law, other: Law) -> bool:
    return bool(law.extras) or any(
        not np.array_equal(getattr(law, name), getattr(other, name))
        for name in ("offset", "sigma", "box_a", "box_b")
    )


def _missed(scene: Scene, change: Change) -> FloatArray:
    if change.passing:
        times = change.at_times(scene.touches.touch)
        return np.asarray(sum(_missed(scene, there) * rows for rows, there in times))
    rate = 1.0 - (1.0 - NEVER_LOST) * (1.0 - change.lost)
    missed = scene.touches.missed
    rate = min(max(rate, NEVER_LOST), 1.0 - NEVER_LOST)
    return np.asarray(np.where(missed, np.log(rate), np.log1p(-rate)))


def with_shared_datum(scene: Scene, names: Collection[str]) -> frozenset[str]:
    """Add the streams that tell of the same datum as some others."""
    found = set(names)
    if scene.datum_groups is not None:
        for family in FAMILIES:
            if found.intersection(family):
                found.update(family)
    return frozenset(found & scene.streams.keys())


def fitted_datum_um(scene: Scene, change: Change) -> dict[tuple[str, ...], FloatArray]:
    """Give the likeliest datum of each group, shape (g,), by the family of streams that tells it.

    None of a scene whose datum is known.
    """
    if scene.datum_groups is None:
        return {}
    names = SHIFTED & scene.streams.keys()
    _, datum_um = _evaluated(scene, scene.with_beliefs(change), names, SHARP)
    families = zip(FAMILIES, datum_um, strict=True)
    return {family: found for family, found in families if names.intersection(family)}


def shifted_by_datum(
    scene: Scene, stream: Stream, data_um: Mapping[tuple[str, ...], FloatArray]
) -> FloatArray:
    """Give by what data shift the residuals of a stream's rows, in its unit; shape (m,).

    Args:
        scene: The touches.
        stream: One of theirs.
        data_um: As `fitted_datum_um` gives them; a family that is not there has none.
    """
    none = np.zeros(scene.datum_count)
    found = next((um for family, um in data_um.items() if stream.name in family), none)
    return np.asarray(found[scene.datum_of(stream)] * scene.per_datum_um(stream)[stream.rows])
