"""Which changes matter: significant is not material, for a large campaign always differs.

What an effect moves in a stretch of the chain is held against a threshold: a fraction of the
stretch's own spread, or what the engineer has said in µs and µm.
"""

from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Extra, Law, extra_variance
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.fit.beliefs import LOBES_U
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.likelihood.likelihood import MISSED, affected
from skiplatch.diagnosis.scene.scene import Scene, rounding_step

RELATIVE = 0.25
"""What variance counts for, beside the square of a shift."""
ROUNDING = 0.3
"""Share of what a stretch is rounded to, below which no scatter is material."""
RESOLVED = 0.1
"""Share of it below which no shift is: rounding need not be as random as its law has it."""
CALIBRATED = 2.0 * LOBES_U
"""Share of the believed lobes within which a probe counts as calibrated."""
WIDE = 20.0
"""Standard deviations from which on a box has edges that can be seen to be left."""
IMPOSSIBLE = 0.02
"""Share of touches with a wide box outside its edges that it is material to bring in."""
ERRORS = 3.0
"""Standard errors by which what is left has to be smaller to be left out."""
MICROSECONDS = "µs"


@dataclass(frozen=True, slots=True)
class Materiality:
    """From which size on a gap matters; what is lost or seen falsely always does."""

    fraction: float = 0.2
    """Root mean square of the change over the rig's own spread, touch by touch."""
    us: float | None = None
    """Root mean square of the change in stretches of time, in place of the fraction."""
    um: float | None = None
    """The same in stretches of length."""

    def absolute(self, unit: str) -> float | None:
        """Give the threshold in µs or µm, if there is one."""
        return self.us if unit == MICROSECONDS else self.um

    def is_exceeded(self, size: float, relative: float, unit: str) -> bool:
        """Tell whether a size is above the threshold, be it of its unit or of the noise."""
        least = self.absolute(unit)
        return relative > self.fraction if least is None else size > least

    @property
    def nats_a_touch(self) -> float:
        """Gain below which no shift can be material: half of the fraction, everywhere."""
        if self.us is not None or self.um is not None:
            return 0.0
        return (0.5 * self.fraction) ** 2 / 2.0


DEFAULT = Materiality()


def is_material(scene: Scene, change: Change, materiality: Materiality = DEFAULT) -> bool:
    """Tell whether an effect changes some stretch of the chain by more than the threshold.

    One that comes or goes is held against it where it is there.
    """
    if change.passing:
        times = change.at_times(scene.touches.touch)
        return any(is_material(scene, there, materiality) for _, there in times)
    change = _beyond_calibration(scene, change, materiality)
    names = affected(scene, change)
    return MISSED in names or any(
        _is_material_in(scene, scene.streams[name], change, materiality) for name in names
    )


def _beyond_calibration(scene: Scene, change: Change, materiality: Materiality) -> Change:
    """Leave out lobes that differ by less than a probe's calibration is good for.

    A nominal simulation believes its calibrated lobes to the last digit, and a probe of large lobes
    and small scatter shows the smallest error in them. Who states a size in µm means it.
    """
    is_calibrated = _rms(change.pretravel_um) <= CALIBRATED * _rms(scene.lobes_um)
    if materiality.um is None and is_calibrated:
        return replace(change, pretravel_um=0.0)
    return change


def _is_material_in(scene: Scene, stream: Stream, change: Change, materiality: Materiality) -> bool:
    law = law_under(scene, stream, change)
    if stream.name == "lattice":
        return is_off_grid(scene, change, law, materiality.us or 0.0)
    if not stream.rows.any():
        return False
    spread = stream.law.spread[stream.rows]
    shift = np.abs(law.mean - stream.law.mean)[stream.rows]
    variance = np.abs(law.variance - stream.law.spread**2)
    scatter = np.sqrt(variance[stream.rows])
    if not _is_resolved(scene, stream, shift, scatter):
        return False
    moved = np.sqrt(shift**2 + RELATIVE * scatter**2)
    threshold = materiality.absolute(stream.unit)
    if threshold is not None:
        return _rms(moved) > threshold
    return _rms(moved / spread) > materiality.fraction or _makes_possible(scene, stream, law)


def _makes_possible(scene: Scene, stream: Stream, law: Law) -> bool:
    """Tell whether a law brings touches to where the believed wait for a scan cannot bring them.

    A box is wide beside what takes touches out of it: hardly any change of its spread, but a
    measuring error beyond the largest one that is believed.
    """
    believed = stream.law
    is_wide = stream.rows & (np.maximum(believed.box_a, believed.box_b) > WIDE * believed.sigma)
    is_out, is_still = (_outside(scene, stream, one) for one in (believed, law))
    return bool((is_out & ~is_still)[is_wide].sum() > IMPOSSIBLE * is_wide.sum())


def _outside(scene: Scene, stream: Stream, law: Law) -> BoolArray:
    """Tell which touches lie beyond the edges of a law, shape (n,); its extras may be later."""
    margin = ERRORS * law.sigma + rounding_step(scene, stream.unit)
    off = stream.residuals - law.offset
    latest = law.box_a + law.box_b + margin + sum(map(_latest, law.extras))
    is_open = np.any([np.asarray(extra.mean) < 0.0 for extra in law.extras], axis=0)
    return np.asarray((off < -margin) & ~is_open | (off > latest))


def _latest(extra: Extra) -> FloatArray:
    later = (
        np.maximum(extra.offset, 0.0) + np.asarray(extra.width) + ERRORS * np.asarray(extra.sigma)
    )
    return np.asarray(np.where(np.asarray(extra.mean) > 0.0, np.inf, later))


def _is_resolved(scene: Scene, stream: Stream, shift: FloatArray, scatter: FloatArray) -> bool:
    """Tell whether rounding lets see what it is off by: shift and scatter of shape (rows,)."""
    step = rounding_step(scene, stream.unit)
    tick = scene.nominal.skip.tick_us
    ticks = scene.speed[stream.rows] * tick if stream.unit != MICROSECONDS else tick
    return _rms(scatter) > ROUNDING * step or bool(np.any(shift > RESOLVED * step + ticks))


def _rms(values: FloatArray | float) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _unbound_us(scene: Scene, change: Change) -> float:
    """How far stamps are off the grid of the others where scans begin with some of the moves."""
    if change.wait is None or change.wait.unlocked == 0.0:
        return 0.0
    return float(np.sqrt((1.0 - change.wait.unlocked) / 12.0)) * scene.nominal.plc.scan_us


def is_off_grid(scene: Scene, change: Change, law: Law, least_us: float = 0.0) -> bool:
    """Tell whether stamps lie off the believed grid, by more than a tick and what is stated."""
    one = int(scene.plc.argmax())  # to all of them the same
    scatter = float(np.sqrt(max(extra_variance(law)[one], 0.0)))
    late = float((law.mean - law.offset - (law.box_a + law.box_b) / 2.0)[one])
    stamps = np.broadcast_to(np.asarray(change.stamp_us, dtype=float), (len(scene),))[scene.plc]
    drifted = _rms(np.nan_to_num(stamps))
    least_seen_us = max(scene.nominal.skip.tick_us, least_us)
    moved = max(abs(change.period_us), _unbound_us(scene, change))
    return moved > least_us or max(scatter, late, drifted) > least_seen_us
