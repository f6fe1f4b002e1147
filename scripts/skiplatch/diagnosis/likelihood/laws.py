"""The law of what is seen in each stream, once the physics is changed."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import reduce

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Extra, Law, spliced
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.scan_wait import locked_waits, scan_period_us, wait_box
from skiplatch.diagnosis.scene.scene import Scene

ROUNDING = 0.01
"""Of a fine step, by which a value may miss its grid for want of digits."""
TINY = 1e-9
LATCHES = {"latch_skip", "latch_plc"}
AFTER_LATCH = {"position", "report"}
"""Streams that are counted from the stamp of the latch."""
CALM = 3.0
"""Standard deviations beyond which a touch tells no more of what others have, too."""


def law_under(scene: Scene, stream: Stream, change: Change) -> Law:
    """Give the law of a stream's residuals, all n of them, once the believed rig is changed."""
    return law_of(scene, stream, scene.with_beliefs(change))


def law_of(scene: Scene, stream: Stream, change: Change) -> Law:
    """Give the same for all that differs from the chain, the effects believed in among it."""
    if change.passing:
        times = change.at_times(scene.touches.touch)
        return spliced([(rows, law_of(scene, stream, there)) for rows, there in times])
    law = _LAWS[stream.name](scene, stream, change)
    if change.slack == 0.0 or stream.name == "lattice":
        return law
    if stream.name in AFTER_LATCH:
        return _loosened_after_latch(scene, stream, change, law)
    return law.widened(change.slack * _size(law.offset - stream.law.offset, stream.rows))


def rms(values: FloatArray, rows: BoolArray) -> float:
    """Give the root mean square of some of n values; 0 of none."""
    return float(np.sqrt(np.mean(values[rows] ** 2))) if rows.any() else 0.0


def _size(shift: FloatArray, rows: BoolArray) -> FloatArray:
    """Give the size of a shift, shape (n,), for what it shifts at all: the rest has no form."""
    size = rms(shift, rows)
    return np.where(np.abs(shift) > TINY * size, size, 0.0)


def _loosened_after_latch(scene: Scene, stream: Stream, change: Change, law: Law) -> Law:
    """Widen a law by the slack of what the latch is later by as far as the latch leaves that open.

    A contact or a clock of another form than the one fitted moves the stamp, and what is counted
    from the stamp by just as much the other way: touch by touch the stamp tells it.
    """
    timeless = replace(change, contact_us=0.0, speed_ratio=1.0, stamp_us=0.0, slack=0.0)
    own = law_of(scene, stream, timeless).offset
    per_us = scene.speed if stream.name == "position" else np.ones(len(scene))
    slack_us = change.slack * _size((law.offset - own) / per_us, stream.rows)
    mean_us, variance = _told_by_latch(scene, change, slack_us)
    of_its_own = change.slack * _size(own - stream.law.offset, stream.rows)
    return replace(
        law,
        offset=law.offset - per_us * mean_us,
        sigma=np.sqrt(law.sigma**2 + of_its_own**2 + per_us**2 * variance),
    )


def _told_by_latch(
    scene: Scene, change: Change, slack_us: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Mean and variance of a normal slack once the latch is known, in µs and µs²; shape (n,)."""
    mean_us, variance = np.zeros(len(scene)), slack_us**2
    if not slack_us.any():
        return mean_us, variance
    for name in LATCHES & scene.streams.keys():
        stream = scene.streams[name]
        law = law_of(scene, stream, replace(change, slack=0.0))
        both = law.variance + slack_us**2
        reach = CALM * np.sqrt(both)
        off = np.clip(stream.residuals - law.mean, -reach, reach)
        mean_us = np.where(stream.rows, slack_us**2 / both * off, mean_us)
        variance = np.where(stream.rows, slack_us**2 * law.variance / both, variance)
    return mean_us, variance


def _motion(_scene: Scene, stream: Stream, change: Change) -> Law:
    return replace(stream.chain, offset=stream.chain.offset + change.contact_us)


def _mechanics_us(scene: Scene, change: Change) -> FloatArray:
    """By how much the pin changes later, counted from what the latch is counted from."""
    if not scene.is_machine:
        return np.full(len(scene), change.pin_us, dtype=float)
    speed = scene.speed * change.speed_ratio
    pretravel = np.maximum(scene.least_pretravel_um, scene.pretravel_um + change.pretravel_um)
    sooner = scene.pretravel_um / scene.speed
    return np.asarray(change.pin_us + change.contact_us + pretravel / speed - sooner)


def _path_us(stream: Stream, change: Change) -> FloatArray | float:
    """Give the delay behind the pin, on the path of the stream."""
    return change.plc_us if stream.is_polled else change.skip_us


def _latch(scene: Scene, stream: Stream, change: Change) -> Law:
    law = stream.chain
    later = _mechanics_us(scene, change) + change.stamp_us + _path_us(stream, change)
    coarser = _coarser_tick_us(scene, change)
    is_held = change.tick_line_us == 0.0
    rounded = _rounded_again(coarser, scene.nominal.skip.tick_us, is_held=is_held)
    return Law(
        offset=law.offset + later - coarser,
        sigma=np.hypot(law.sigma, rounded),
        box_a=wait_box(scene, stream, law.box_a, change, 1.0),
        box_b=law.box_b + coarser,
        extras=_latch_extras(scene, stream, change, 1.0),
    )


def _latch_extras(
    scene: Scene, stream: Stream, change: Change, scale: FloatArray | float
) -> tuple[Extra, ...]:
    """Give the extras of the pin, and of the interrupt or of late scans, in the law's unit."""
    if stream.is_polled:
        extras = _joint(change.pin_extra, change.scan_extra, locked_waits(scene, change))
    else:
        extras = _joint(change.pin_extra, change.skip_extra)
    return tuple(_scaled(extra, scale) for extra in extras)


def _joint(*groups: tuple[Extra, ...]) -> tuple[Extra, ...]:
    """Give the extras of independent causes together."""
    some = [extras for extras in groups if extras]
    if len(some) < 2:
        return some[0] if some else ()
    changes = (Change(pin_extra=extras) for extras in some)
    return reduce(Change.joined, changes).pin_extra


def _scaled(extra: Extra, scale: FloatArray | float) -> Extra:
    return Extra(
        extra.share,
        offset=extra.offset * scale,
        width=extra.width * scale,
        mean=extra.mean * scale,
        sigma=extra.sigma * scale,
        boxless=extra.boxless,
    )


def _coarser_tick_us(scene: Scene, change: Change) -> float:
    return max(0.0, change.coarse_us - scene.nominal.skip.tick_us)


def _position_after_stamp_us(scene: Scene, change: Change) -> FloatArray:
    """By how much the position of a scan is later than its coarse stamp, at the most; shape (n,).

    On the skip path the position is captured along with the tick.
    """
    return np.where(scene.plc, _coarser_tick_us(scene, change), 0.0)


def _coarser_um(scene: Scene, change: Change) -> float:
    return max(0.0, change.coarse_um - scene.nominal.axis.resolution_um)


def _rounded_again(coarser: float, fine: float, *, is_held: bool) -> float:
    """Give the standard deviation of what a fine grid adds to a coarse one that it does not hold.

    It holds none whose steps are no whole number of its own. Beside the box of the coarse grid that
    of the fine one only takes the edges off.
    """
    steps = coarser / fine
    is_held = is_held and abs(steps - np.rint(steps)) < ROUNDING
    return 0.0 if coarser == 0.0 or is_held else fine / np.sqrt(12.0)


def _lattice(scene: Scene, stream: Stream, change: Change) -> Law:
    coarser = _coarser_tick_us(scene, change)
    period = scan_period_us(scene, change)
    ticks = period / max(change.coarse_us, TINY)
    # Scans a whole number of ticks apart are all stamped early by the same rest; else it wanders.
    scans = float(np.ptp(scene.touches.latch_us[stream.indices])) / period
    box = coarser * min(1.0, abs(ticks - np.rint(ticks)) * scans)
    law = replace(stream.chain, box_a=stream.chain.box_a + box, extras=change.lattice_extra)
    return replace(law, offset=law.offset - box / 2.0)


def _position(scene: Scene, stream: Stream, change: Change) -> Law:
    law, stamps = stream.chain, scene.touches.latch_us
    speed = scene.speed * change.speed_ratio
    begin = scene.begin_us + (change.contact_us if scene.is_machine else 0.0)
    believed = scene.speed * (stamps - scene.begin_us)
    shift = speed * (stamps - change.stamp_us - begin) - believed + change.position_um
    coarser_um = _coarser_um(scene, change)
    return Law(
        offset=law.offset + np.where(scene.has_stamps, shift, 0.0) - coarser_um / 2.0,
        sigma=np.asarray(np.hypot(law.sigma, change.position_sigma_um)),
        box_a=law.box_a + scene.speed * _position_after_stamp_us(scene, change),
        box_b=law.box_b + coarser_um,
        extras=_position_extras(change),
    )


def _position_extras(change: Change) -> tuple[Extra, ...]:
    is_boxed = np.any(np.asarray(change.position_box_um) > 0.0)
    box = (Extra(1.0, width=change.position_box_um),) if is_boxed else ()
    return _joint(change.position_extra, box)


def _deviation(scene: Scene, stream: Stream, change: Change) -> Law:
    law = stream.chain
    speed = scene.speed * change.speed_ratio
    delays = change.pin_us + _path_us(stream, change)
    shift = (
        np.maximum(scene.least_pretravel_um, scene.pretravel_um + change.pretravel_um)
        - scene.pretravel_um
        + (speed - scene.speed) * scene.wait_us
        + speed * delays
        + change.position_um
    )
    coarser = _coarser_um(scene, change)
    sooner = 0.0 if stream.is_polled else speed * _coarser_tick_us(scene, change)
    extras = _latch_extras(scene, stream, change, speed)
    return Law(
        offset=law.offset + shift - coarser / 2.0 - sooner,
        sigma=np.asarray(np.hypot(law.sigma, change.position_sigma_um)),
        box_a=wait_box(scene, stream, law.box_a * change.speed_ratio, change, speed),
        box_b=law.box_b + coarser + sooner,
        extras=_joint(extras, _position_extras(change)),
    )


def _report(scene: Scene, stream: Stream, change: Change) -> Law:
    law = stream.chain
    shift = change.report_us - change.stamp_us
    return Law(
        offset=law.offset + np.where(scene.has_stamps, shift, 0.0),
        sigma=law.sigma,
        box_a=law.box_a,
        box_b=law.box_b + _coarser_tick_us(scene, change),
        extras=change.report_extra,
    )


_LAWS: Mapping[str, Callable[[Scene, Stream, Change], Law]] = {
    "motion": _motion,
    "latch_skip": _latch,
    "latch_plc": _latch,
    "lattice": _lattice,
    "position": _position,
    "deviation_skip": _deviation,
    "deviation_plc": _deviation,
    "report": _report,
}
