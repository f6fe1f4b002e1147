"""How likely the recorded touches are under a change of the physics.

The change is carried through the chain to the law of every stream it can be seen in.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from skiplatch.arrays import FloatArray, median
from skiplatch.diagnosis.density import datum
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.datum import FAMILIES, SHIFTED
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.residuals import Residuals
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import CALM, TINY, law_of
from skiplatch.diagnosis.likelihood.lines import line_bonus
from skiplatch.diagnosis.likelihood.scan_grid import grid_values
from skiplatch.diagnosis.scene.scene import Scene

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
    found: dict[str, FloatArray] = {}
    for family in _families(scene, wanted):
        members = [m for n in family for m in _members(scene, n, change, widening.get(n, 0.0))]
        found |= _values(scene, members)[1]
    values = {name: found[name] for name in scene.streams if name in wanted}
    if names is None or MISSED in names:
        values[MISSED] = _missed(scene, change)
    return Likelihood(values)


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
        or line_bonus(scene, stream, change).any()
    }
    stamped = np.broadcast_to(np.asarray(change.stamp_us), (len(scene),))[scene.plc]
    if change.period_us != 0.0 or change.wait is not None or np.any(stamped != 0.0):
        names |= {"lattice"} & scene.streams.keys()
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


def _families(scene: Scene, wanted: Collection[str]) -> Iterator[list[str]]:
    """Give the streams to evaluate: together those that one datum shifts, if it is unknown."""
    shared: Sequence[tuple[str, ...]] = FAMILIES if scene.datum_groups is not None else ()
    for family in shared:
        if not set(family).intersection(wanted):
            continue
        yield [name for name in family if name in scene.streams]
    apart = {name for family in shared for name in family}
    yield from ([name] for name in wanted if name not in apart)


def with_shared_datum(scene: Scene, names: Collection[str]) -> frozenset[str]:
    """Add the streams that tell of the same datum as some others."""
    return frozenset(name for family in _families(scene, set(names)) for name in family)


def fitted_datum_um(scene: Scene, change: Change) -> dict[tuple[str, ...], FloatArray]:
    """Give the likeliest datum of each group, shape (g,), by the family of streams that tells it.

    None of a scene whose datum is known.
    """
    if scene.datum_groups is None:
        return {}
    change = scene.with_beliefs(change)
    found: dict[tuple[str, ...], FloatArray] = {}
    for family in FAMILIES:
        members = [m for n in family if n in scene.streams for m in _members(scene, n, change, 0.0)]
        if members:
            found[family] = _values(scene, members)[0]
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Member:
    """One stream under a change, laid out for evaluation."""

    stream: Stream
    law: Law
    """Of `rows` alone."""
    change: Change
    residuals: Residuals | None = None
    """None for the grid of the scans, whose law is that of all stamps together."""
    bonus: FloatArray | float = 0.0

    @classmethod
    def of(cls, scene: Scene, stream: Stream, change: Change, widening: float) -> Self:
        rows, known = stream.indices, stream.known
        law = law_of(scene, stream, change).select(rows)
        if widening:
            law = law.widened(widening)
        if stream.name == "lattice" or not len(rows):
            return cls(stream, law, change)
        if stream.name == "position" and scene.plc.any():
            known = known - _rest_of_a_tick_um(scene, stream, law, change.coarse_us)
        residuals = law.laid_out(known, 10.0 * law.usual_spread + stream.far)
        return cls(stream, law, change, residuals, line_bonus(scene, stream, change))

    def values(self, scene: Scene, logs: FloatArray | None) -> FloatArray:
        """Give the log-likelihood of each touch, shape (n,), by that of the rows."""
        values, rows = np.zeros(len(scene)), self.stream.indices
        if self.residuals is not None:
            values[rows] = self.residuals.log_densities() if logs is None else logs
        elif len(rows):
            values[rows] = grid_values(scene, self.stream, self.change, self.law)
        return values + self.bonus


def _members(scene: Scene, name: str, change: Change, widening: float) -> list[_Member]:
    """Lay a stream out under a change: in parts, where the change is not the same for all."""
    stream = scene.streams[name]
    if not change.passing:
        return [_Member.of(scene, stream, change, widening)]
    times = [(stream.part(rows), there) for rows, there in change.at_times(scene.touches.touch)]
    return [_Member.of(scene, part, there, widening) for part, there in times if part.rows.any()]


def _values(scene: Scene, members: Sequence[_Member]) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Give the likeliest datum of each group by some streams, and their log-likelihoods there."""
    parts = {
        i: datum.Part(
            m.residuals,
            scene.per_datum_um(m.stream)[m.stream.indices],
            scene.datum_groups[m.stream.indices],
        )
        for i, m in enumerate(members)
        if m.residuals is not None and scene.datum_groups is not None and m.stream.name in SHIFTED
    }
    found, known = np.zeros(scene.datum_count), dict[int, FloatArray]()
    if parts:
        found, logs = datum.at_best_datum([*parts.values()], scene.datum_count, scene.datum_u_um)
        known = dict(zip(parts, logs, strict=True))
    values: dict[str, FloatArray] = {}
    for i, m in enumerate(members):
        own = m.values(scene, known.get(i))
        values[m.stream.name] = values[m.stream.name] + own if m.stream.name in values else own
    return found, values


def _rest_of_a_tick_um(scene: Scene, stream: Stream, law: Law, coarse_us: float) -> FloatArray:
    """Give how far positions are off because scans are stamped early by a rest of a tick; (rows,).

    Where the scan period is a whole number of ticks, that is the same for all scans, and no
    scatter: the positions of all of them are off together. The touches say by how much.
    """
    speed = np.where(scene.plc, scene.speed, 0.0)[stream.indices]
    variance, half = law.variance, max(scene.nominal.skip.tick_us, coarse_us) / 2.0
    reach = CALM * np.sqrt(variance)
    off = np.clip(_off_datum(scene, stream, stream.known - law.mean), -reach, reach)
    rest_us = (speed / variance) @ off / max(float((speed / variance) @ speed), TINY)
    return np.asarray(speed * np.clip(rest_us, -half, half))


def _off_datum(scene: Scene, stream: Stream, off: FloatArray) -> FloatArray:
    """Take the middle of each group of touches away if their datum is unknown; (rows,)."""
    if scene.datum_groups is None:
        return off
    groups = scene.datum_of(stream)
    middles = [
        median(off[groups == g]) if (groups == g).any() else 0.0 for g in range(scene.datum_count)
    ]
    return np.asarray(off - np.array(middles)[groups])
