"""How likely the recorded touches are under a change of the physics.

The change is carried through the chain to the law of every stream it can be seen in.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.law import Extra, FloatArray, Law
from skiplatch.diagnosis.scene import Scene, Stream

MISSED = "missed"
"""Name of the stream of touches that were not latched."""
NEVER_LOST = 1e-5
"""Share of touches that may be missed for reasons of their own."""
OFF_GRID = 1e-3
"""Share of values that may lie off a coarse grid."""
SHORTEST_PERIOD = 0.1
"""Of the believed one."""
PHASES = 15
NEAR = np.linspace(-1.0, 1.0, 5)


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


def likelihood(
    scene: Scene, change: Change, widening: float = 0.0, names: Collection[str] | None = None
) -> Likelihood:
    """Evaluate the streams.

    Args:
        scene: The touches.
        change: What differs from the nominal chain.
        widening: Smoothes the laws for a coarse search: a share of the residuals' own size.
        names: Of the streams to evaluate; all without it.
    """
    values = {
        name: _stream_values(scene, stream, change, widening)
        for name, stream in scene.streams.items()
        if names is None or name in names
    }
    if names is None or MISSED in names:
        values[MISSED] = _missed(scene, change)
    return Likelihood(values)


def affected(scene: Scene, change: Change) -> frozenset[str]:
    """Name the streams whose law a change alters at all."""
    names = {
        name
        for name, stream in scene.streams.items()
        if _differ(law_under(scene, stream, change), stream.law)
        or _grid_bonus(scene, stream, change).any()
    }
    stamped = np.broadcast_to(np.asarray(change.stamp_us), (len(scene),))[scene.plc]
    if change.period_us != 0.0 or np.any(stamped != 0.0):
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
    rate = 1.0 - (1.0 - NEVER_LOST) * (1.0 - change.lost)
    missed = scene.touches.missed
    rate = min(max(rate, NEVER_LOST), 1.0 - NEVER_LOST)
    return np.asarray(np.where(missed, np.log(rate), np.log1p(-rate)))


def _stream_values(scene: Scene, stream: Stream, change: Change, widening: float) -> FloatArray:
    rows = stream.rows
    if not rows.any():
        return np.zeros(len(scene))
    law = law_under(scene, stream, change).select(rows)
    if widening:
        law = law.widened(widening * stream.size)
    if stream.name == "lattice":
        inner = _lattice_values(scene, stream, change, law)
    else:
        residuals = stream.residuals[rows]
        inner = law.log_density(residuals, _reach(residuals, law))
        inner = inner + _grid_bonus(scene, stream, change)[rows]
    values = np.zeros(len(scene))
    values[rows] = inner
    return values


def _reach(residuals: FloatArray, law: Law) -> float:
    return float(10.0 * np.median(law.spread) + np.quantile(np.abs(residuals), 0.9))


def law_under(scene: Scene, stream: Stream, change: Change) -> Law:
    """Give the law of a stream's residuals, all n of them, once the physics is changed."""
    builders = {
        "motion": _motion,
        "latch_skip": _latch,
        "latch_plc": _latch,
        "lattice": _lattice,
        "position": _position,
        "deviation_skip": _deviation,
        "deviation_plc": _deviation,
        "report": _report,
    }
    law = builders[stream.name](scene, stream.law, change)
    if change.slack == 0.0 or stream.name == "lattice":
        return law
    shift = (law.offset - stream.law.offset)[stream.rows]
    scatter = change.slack * float(np.sqrt(np.mean(shift**2))) if len(shift) else 0.0
    return replace(law, sigma=np.hypot(law.sigma, scatter))


def _motion(_scene: Scene, law: Law, change: Change) -> Law:
    return replace(law, offset=law.offset + change.contact_us)


def _mechanics_us(scene: Scene, change: Change) -> FloatArray:
    """By how much the pin changes later, counted from what the latch is counted from."""
    delay = np.broadcast_to(np.asarray(change.pin_us, dtype=float), (len(scene),))
    if not scene.is_machine:
        return delay
    speed = scene.speed * change.speed_ratio
    pretravel = np.maximum(0.0, scene.pretravel_um + change.pretravel_um)
    return delay + change.contact_us + pretravel / speed - scene.pretravel_um / scene.speed


def _on_path(scene: Scene, skip: FloatArray | float, plc: FloatArray | float) -> FloatArray:
    return np.where(scene.plc, plc, skip)


def _latch(scene: Scene, law: Law, change: Change) -> Law:
    later = _mechanics_us(scene, change) + change.stamp_us
    later = later + _on_path(scene, change.skip_us, change.plc_us)
    coarser = _coarser_us(scene, change)
    law = replace(law, offset=law.offset + later - coarser, box_b=law.box_b + coarser)
    return _with_extras(scene, _scanned(scene, law, change, 1.0), change, 1.0)


def scan_period_us(scene: Scene, change: Change) -> float:
    """Give the changed scan period, within what is a scan period still."""
    believed = scene.nominal.plc.scan_us
    return max(believed + change.period_us, SHORTEST_PERIOD * believed)


def _scanned(scene: Scene, law: Law, change: Change, scale: FloatArray | float) -> Law:
    """Take care of the wait for the scan; `scale` turns µs into the law's unit."""
    period = scan_period_us(scene, change)
    if change.wait is None:
        wider = _on_path(scene, 0.0, period - scene.nominal.plc.scan_us)
        return replace(law, box_a=np.maximum(law.box_a + wider * scale, 0.0))
    wider = _on_path(scene, 0.0, period - scene.nominal.plc.scan_us)
    return replace(law, box_a=np.maximum(law.box_a + wider * scale, 0.0))


def _locked(scene: Scene, change: Change) -> tuple[Extra, ...]:
    """Touches whose wait for the scan is about one value, as extras that lack the scan's box."""
    if change.wait is None:
        return ()
    centre, spread, unlocked = change.wait
    period = scan_period_us(scene, change)
    return (
        Extra(
            1.0 - unlocked,
            offset=_on_path(scene, 0.0, centre * period),
            sigma=_on_path(scene, 0.0, spread * period),
            boxless=_on_path(scene, 0.0, 1.0),
        ),
    )


def _with_extras(scene: Scene, law: Law, change: Change, scale: FloatArray | float) -> Law:
    """Add the extras of the pin, of the interrupt and of late scans."""
    extras = [_scaled(extra, scale) for extra in change.pin_extra]
    on_skip = np.where(scene.plc, 0.0, 1.0) * scale
    on_plc = np.where(scene.plc, 1.0, 0.0) * scale
    both = Change(pin_extra=tuple(extras))
    both = both.joined(Change(pin_extra=tuple(_scaled(e, on_skip) for e in change.skip_extra)))
    both = both.joined(Change(pin_extra=tuple(_scaled(e, on_plc) for e in change.scan_extra)))
    both = both.joined(Change(pin_extra=tuple(_scaled(e, scale) for e in _locked(scene, change))))
    return replace(law, extras=both.pin_extra)


def _scaled(extra: Extra, scale: FloatArray | float) -> Extra:
    return replace(
        extra,
        offset=extra.offset * scale,
        width=extra.width * scale,
        mean=extra.mean * scale,
        sigma=extra.sigma * scale,
        boxless=np.where(np.asarray(scale) > 0.0, extra.boxless, 0.0),
    )


def _coarser_us(scene: Scene, change: Change) -> FloatArray:
    """By how much a tick of the stamps is longer than believed; skip path only."""
    return _on_path(scene, max(0.0, change.coarse_us - scene.nominal.skip.tick_us), 0.0)


def _coarser_um(scene: Scene, change: Change) -> float:
    return max(0.0, change.coarse_um - scene.nominal.axis.resolution_um)


def _lattice(_scene: Scene, law: Law, change: Change) -> Law:
    return replace(law, extras=change.lattice_extra)


def _lattice_table(scene: Scene, law: Law, period: float) -> tuple[FloatArray, FloatArray]:
    """Tabulate the logarithm of the density off the grid, over one period; fine near the peak."""
    tick = scene.nominal.skip.tick_us
    peak = np.linspace(-4.0 * tick, 4.0 * tick, 129)
    rest = np.linspace(-0.5, 0.5, 257) * period
    where = np.unique(np.concatenate([peak, rest]))
    around = (0, 1) if law.extras else (0,)
    one = np.ones_like(where)
    parts = [one * part[0] for part in (law.offset, law.sigma, law.box_a, law.box_b)]
    scalar = Law(parts[0], parts[1], parts[2], parts[3], law.extras)
    logs = [scalar.log_density(where + k * period, period) for k in around]
    return where, np.logaddexp.reduce(logs) + np.log(period)


def _lattice_values(scene: Scene, stream: Stream, change: Change, law: Law) -> FloatArray:
    """How much likelier stamps are for the grid, whose phase is chosen to fit best; shape (rows,).

    A factor on the density of the wait, which knows nothing of the grid: 1 for stamps anywhere.
    """
    rows = stream.rows
    period = scan_period_us(scene, change)
    stamps = (scene.touches.latch_us - change.stamp_us)[rows]
    turns = (stamps / period) % 1.0
    where, table = _lattice_table(scene, law, period)

    def values(phase: float) -> FloatArray:
        off = (turns - phase + 0.5) % 1.0 - 0.5
        return np.interp(off * period, where, table)

    phases = np.unique(turns)
    if len(phases) > PHASES:
        phases = np.quantile(phases, np.linspace(0.0, 1.0, PHASES))
    best = max(phases, key=lambda phase: float(values(phase).sum()))
    step = scene.nominal.skip.tick_us / period
    near = best + step * NEAR
    found = values(max(near, key=lambda phase: float(values(phase).sum())))
    if change.wait is not None and found.sum() < 0.0:
        return np.zeros(len(turns))  # scans that wait for the motion need not keep a grid
    return found


def _position(scene: Scene, law: Law, change: Change) -> Law:
    stamps = scene.touches.latch_us
    speed = scene.speed * change.speed_ratio
    begin = scene.begin_us + (change.contact_us if scene.is_machine else 0.0)
    believed = scene.speed * (stamps - scene.begin_us)
    shift = speed * (stamps - change.stamp_us - begin) - believed + change.position_um
    coarser_um = _coarser_um(scene, change)
    law = replace(
        law,
        offset=law.offset + np.nan_to_num(shift) - coarser_um / 2.0,
        box_a=law.box_a + scene.speed * _coarser_us(scene, change),
        box_b=law.box_b + coarser_um,
    )
    return _with_position_box(law, change)


def _with_position_box(law: Law, change: Change) -> Law:
    law = replace(
        law,
        sigma=np.hypot(law.sigma, change.position_sigma_um),
        extras=Change(pin_extra=law.extras)
        .joined(Change(pin_extra=change.position_extra))
        .pin_extra,
    )
    if np.any(np.asarray(change.position_box_um) > 0.0):
        box = Change(pin_extra=(Extra(1.0, width=change.position_box_um),))
        return replace(law, extras=Change(pin_extra=law.extras).joined(box).pin_extra)
    return law


def _deviation(scene: Scene, law: Law, change: Change) -> Law:
    speed = scene.speed * change.speed_ratio
    delays = change.pin_us + _on_path(scene, change.skip_us, change.plc_us)
    shift = (
        np.maximum(0.0, scene.pretravel_um + change.pretravel_um)
        - scene.pretravel_um
        + (speed - scene.speed) * scene.wait_us
        + speed * delays
        + change.position_um
    )
    coarser = _coarser_um(scene, change)
    law = replace(law, offset=law.offset + shift - coarser / 2.0, box_b=law.box_b + coarser)
    law = replace(law, box_a=law.box_a * change.speed_ratio)
    law = _with_extras(scene, _scanned(scene, law, change, speed), change, speed)
    return _with_position_box(law, change)


def _report(scene: Scene, law: Law, change: Change) -> Law:
    shift = change.report_us - change.stamp_us
    return replace(
        law,
        offset=law.offset + np.nan_to_num(shift),
        box_b=law.box_b + _coarser_us(scene, change),
        extras=change.report_extra,
    )


def _grid_bonus(scene: Scene, stream: Stream, change: Change) -> FloatArray:
    """A coarse grid holds all its probability on few values: what that adds to the logarithm."""
    if stream.name == "latch_skip" and change.coarse_us > 0.0 and change.is_on_grid:
        return _on_grid(scene.touches.latch_us, change.coarse_us, scene.nominal.skip.tick_us)
    is_length = stream.unit == "µm"
    if is_length and change.coarse_um > 0.0 and change.is_on_grid:
        resolution = scene.nominal.axis.resolution_um
        return _on_grid(scene.touches.deviation_um, change.coarse_um, resolution)
    return np.zeros(len(scene))


def _on_grid(values: FloatArray, coarse: float, fine: float) -> FloatArray:
    if coarse <= fine:
        return np.zeros(len(values))
    off = np.abs(values - np.rint(values / coarse) * coarse)
    return np.asarray(np.where(off < 0.5 * fine, np.log(coarse / fine), np.log(OFF_GRID)))
