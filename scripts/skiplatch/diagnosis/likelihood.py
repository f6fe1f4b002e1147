"""How likely the recorded touches are under a change of the physics.

The change is carried through the chain to the law of every stream it can be seen in.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from functools import lru_cache, reduce
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy import fft, ndimage, special

from skiplatch.arrays import BoolArray, FloatArray, median
from skiplatch.diagnosis import datum
from skiplatch.diagnosis.change import Change, Number
from skiplatch.diagnosis.datum import FAMILIES, SHIFTED
from skiplatch.diagnosis.grid import folded
from skiplatch.diagnosis.law import Extra, Law, spliced
from skiplatch.diagnosis.scene import Scene, Stream
from skiplatch.simulator import Residuals

MISSED = "missed"
"""Name of the stream of touches that were not latched."""
NEVER_LOST = 1e-5
"""Share of touches that may be missed for reasons of their own."""
OFF_GRID = 1e-3
"""Share of values that may lie off a coarse grid."""
MOSTLY = 0.5
"""Share of values from which on those that keep no grid say that there is none."""
KNOWN_TO = 2.0
"""Believed ticks to which the lines of a foreign clock are known: its ticks are rounded so."""
FAR_APART = 8.0
"""Believed ticks between such lines from which on stamps show them: closer ones beat with these."""
FAR_OFF = 0.01
"""Of the mean density of a law, beyond which a value is none of it."""
ROUNDING = 0.01
"""Of a fine step, by which a value may miss its grid for want of digits."""
SHORTEST_PERIOD = 0.1
"""Of the believed one."""
PHASES = 15
NEAR = np.linspace(-1.0, 1.0, 5)
FINER = 4.0
"""By how much each step is finer than the one before, for NEAR to leave nothing out between."""
FINEST_STEP = 0.08
"""Of a tick."""
EDGE = np.linspace(-4.0, 4.0, 17)
"""Ticks about the edge of a law at which it is tabulated."""
BINS = (8, 13)
"""Fewest and most phases of the scans that are tried, as powers of 2."""
ANYWHERE = 0.25
"""Standard deviation, over a period, from which on stamps lie anywhere on the grid."""
NEIGHBOURS = 9
"""Stamps in a row by which one tells where the grid is while it wanders."""
NO_ACCIDENT = 20.0
"""Of stamps about a grid: their number times the square of their mean turn; a period that is
searched for holds any a little."""
SCATTERED = 0.3
"""Nats a stamp that speak against a scatter for which a grid has no reason."""
TINY = 1e-9
TURNS = np.array([-1.0, 0.0, 1.0])
LEAST_PART = 1e-3
"""Of a law folded onto a turn, that counts."""
SHARP: Mapping[str, float] = {}
LATCHES = {"latch_skip", "latch_plc"}
AFTER_LATCH = {"position", "report"}
"""Streams that are counted from the stamp of the latch."""
CALM = 3.0
"""Standard deviations beyond which a touch tells no more of what others have, too."""
MOST_TURNS = 4
"""Periods after which a late scan is not followed further."""


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
    scene: Scene,
    change: Change,
    names: Collection[str] | None = None,
    widening: Mapping[str, float] = SHARP,
) -> Likelihood:
    """Evaluate the streams.

    Args:
        scene: The touches.
        change: What differs from the nominal chain.
        names: Of the streams to evaluate; all without it.
        widening: Smoothes the laws of some streams for a coarse search, by so much in their unit.
    """
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
        if _differ(law_under(scene, stream, change), stream.law)
        or _grid_bonus(scene, stream, change).any()
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
    off: FloatArray = field(default_factory=lambda: np.zeros(0))
    """By how much they are off the middle of the law."""
    bonus: FloatArray | float = 0.0

    @classmethod
    def of(cls, scene: Scene, stream: Stream, change: Change, widening: float) -> Self:
        rows, known = stream.indices, stream.known
        law = law_under(scene, stream, change).select(rows)
        if widening:
            law = law.widened(widening)
        if stream.name == "lattice" or not len(rows):
            return cls(stream, law, change)
        if stream.name == "position" and scene.plc.any():
            known = known - _rest_of_a_tick_um(scene, stream, law, change.coarse_us)
        residuals = law.laid_out(known, 10.0 * law.usual_spread + stream.far)
        off = known - law.mean if scene.datum_groups is not None else known
        return cls(stream, law, change, residuals, off, _grid_bonus(scene, stream, change))

    def values(self, scene: Scene, logs: FloatArray | None) -> FloatArray:
        """Give the log-likelihood of each touch, shape (n,), by that of the rows."""
        values, rows = np.zeros(len(scene)), self.stream.indices
        if self.residuals is not None:
            values[rows] = self.residuals.log_densities() if logs is None else logs
        elif len(rows):
            values[rows] = _lattice_values(scene, self.stream, self.change, self.law)
        return values + self.bonus


def _members(scene: Scene, name: str, change: Change, widening: float) -> list[_Member]:
    """Lay a stream out under a change: in parts, where the change is not the same for all."""
    stream = scene.streams[name]
    if not change.passing:
        return [_Member.of(scene, stream, change, widening)]
    times = [
        (replace(stream, rows=stream.rows & rows), there)
        for rows, there in change.at_times(scene.touches.touch)
    ]
    return [_Member.of(scene, part, there, widening) for part, there in times if part.rows.any()]


def _values(scene: Scene, members: Sequence[_Member]) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Give the likeliest datum of each group by some streams, and their log-likelihoods there."""
    parts = {
        i: datum.Part(
            m.residuals,
            m.off,
            m.law.variance,
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


def law_under(scene: Scene, stream: Stream, change: Change) -> Law:
    """Give the law of a stream's residuals, all n of them, once the physics is changed."""
    if change.passing:
        times = change.at_times(scene.touches.touch)
        return spliced([(rows, law_under(scene, stream, there)) for rows, there in times])
    law = _LAWS[stream.name](scene, stream, change)
    if change.slack == 0.0 or stream.name == "lattice":
        return law
    if stream.name in AFTER_LATCH:
        return _loosened_after_latch(scene, stream, change, law)
    return law.widened(change.slack * _size(law.offset - stream.law.offset, stream.rows))


def _rms(values: FloatArray, rows: BoolArray) -> float:
    return float(np.sqrt(np.mean(values[rows] ** 2))) if rows.any() else 0.0


def _size(shift: FloatArray, rows: BoolArray) -> FloatArray:
    """Give the size of a shift, shape (n,), for what it shifts at all: the rest has no form."""
    size = _rms(shift, rows)
    return np.where(np.abs(shift) > TINY * size, size, 0.0)


def _loosened_after_latch(scene: Scene, stream: Stream, change: Change, law: Law) -> Law:
    """Widen a law by the slack of what the latch is later by as far as the latch leaves that open.

    A contact or a clock of another form than the one fitted moves the stamp, and what is counted
    from the stamp by just as much the other way: touch by touch the stamp tells it.
    """
    timeless = replace(change, contact_us=0.0, speed_ratio=1.0, stamp_us=0.0, slack=0.0)
    own = law_under(scene, stream, timeless).offset
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
        law = law_under(scene, stream, replace(change, slack=0.0))
        both = law.variance + slack_us**2
        reach = CALM * np.sqrt(both)
        off = np.clip(stream.residuals - law.mean, -reach, reach)
        mean_us = np.where(stream.rows, slack_us**2 / both * off, mean_us)
        variance = np.where(stream.rows, slack_us**2 * law.variance / both, variance)
    return mean_us, variance


def _motion(_scene: Scene, stream: Stream, change: Change) -> Law:
    return replace(stream.law, offset=stream.law.offset + change.contact_us)


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
    law = stream.law
    later = _mechanics_us(scene, change) + change.stamp_us + _path_us(stream, change)
    coarser = _coarser_tick_us(scene, change)
    is_held = change.tick_line_us == 0.0
    rounded = _rounded_again(coarser, scene.nominal.skip.tick_us, is_held=is_held)
    return Law(
        offset=law.offset + later - coarser,
        sigma=np.hypot(law.sigma, rounded),
        box_a=_waiting(scene, stream, law.box_a, change, 1.0),
        box_b=law.box_b + coarser,
        extras=_latch_extras(scene, stream, change, 1.0),
    )


def scan_period_us(scene: Scene, change: Change) -> float:
    """Give the changed scan period, within what is a scan period still."""
    believed = scene.nominal.plc.scan_us
    return max(believed + change.period_us, SHORTEST_PERIOD * believed)


def _waiting(
    scene: Scene, stream: Stream, box: FloatArray, change: Change, scale: FloatArray | float
) -> FloatArray:
    """Give the box of the wait for the scan; `scale` turns µs into the law's unit."""
    if not stream.is_polled:
        return box
    wider = scan_period_us(scene, change) - scene.nominal.plc.scan_us
    return np.maximum(box + wider * scale, 0.0)


def _locked(scene: Scene, change: Change) -> tuple[Extra, ...]:
    """Touches whose wait for the scan is about one value, as extras that lack the scan's box."""
    if change.wait is None:
        return ()
    centre, spread, unlocked = change.wait
    period = scan_period_us(scene, change)
    return tuple(
        Extra((1.0 - unlocked) * share, offset=mean * period, sigma=sigma * period, boxless=1.0)
        for share, mean, sigma in _wrapped(centre, spread)
    )


@lru_cache(maxsize=64)
def _wrapped(centre: float, spread: float) -> list[tuple[float, float, float]]:
    """Fold a normal law onto one turn: shares, means and standard deviations of its parts."""
    if CALM * spread <= centre <= 1.0 - CALM * spread:
        return [(1.0, centre, spread)]
    low, high = ((end - centre - TURNS) / spread for end in (0.0, 1.0))
    shares = special.ndtr(high) - special.ndtr(low)
    known = shares > LEAST_PART
    low, high, shares = low[known], high[known], shares[known]
    # The truncated normal law's; scipy.stats takes longer over them than the density itself.
    at_low, at_high = (
        np.exp(-0.5 * end**2) / (np.sqrt(2.0 * np.pi) * shares) for end in (low, high)
    )
    means = at_low - at_high
    variances = np.maximum(1.0 + low * at_low - high * at_high - means**2, 0.0)
    columns = (shares, centre + TURNS[known] + spread * means, spread * np.sqrt(variances))
    return list(zip(*(column.tolist() for column in columns), strict=True))


def _latch_extras(
    scene: Scene, stream: Stream, change: Change, scale: FloatArray | float
) -> tuple[Extra, ...]:
    """Give the extras of the pin, and of the interrupt or of late scans, in the law's unit."""
    if stream.is_polled:
        extras = _joint(change.pin_extra, change.scan_extra, _locked(scene, change))
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
    law = replace(stream.law, box_a=stream.law.box_a + box, extras=change.lattice_extra)
    return replace(law, offset=law.offset - box / 2.0)


def _lattice_table(scene: Scene, law: Law, period: float) -> tuple[FloatArray, FloatArray]:
    """Tabulate the logarithm of the density off the grid, over one period; fine at its edges."""
    # It is the same for all stamps.
    parts = (law.offset, law.sigma, law.box_a, law.box_b)
    extras = tuple(tuple(_number(value) for value in astuple(extra)) for extra in law.extras)
    tick = scene.nominal.skip.tick_us
    return _tabulated(tuple(_number(part) for part in parts), extras, tick, period)


def _number(value: Number) -> float:
    """Give the first of values, which stands for all."""
    return float(np.asarray(value).flat[0])


@lru_cache(maxsize=64)
def _tabulated(
    parts: tuple[float, ...], numbers: tuple[tuple[float, ...], ...], tick: float, period: float
) -> tuple[FloatArray, FloatArray]:
    """Give the same by the numbers of the law and of its extras: most change only the stamps."""
    offset, sigma, box_a, box_b = (np.asarray(part) for part in parts)
    law = Law(offset, sigma, box_a, box_b, tuple(Extra(*extra) for extra in numbers))
    begins = np.array([extra.offset for extra in law.extras])
    ends = begins + np.array([extra.width for extra in law.extras])
    box = np.array([0.0, 1.0]) * law.box_a
    edges = np.concatenate([law.offset + box, begins, ends])
    edges = edges[edges != 0.0]
    where = _lattice_places(tick, period)
    if len(edges):
        near = (edges[:, None] + EDGE * tick).ravel()  # which may pass the end of the period
        where = np.unique(np.append(where, folded(near, period)))
    turns = int(min(np.max(ends, initial=0.0) // period, MOST_TURNS)) + 2 if law.extras else 1
    places = (where + period * np.arange(turns)[:, None]).ravel()
    logs = law.log_density(places, period).reshape(turns, len(where))
    return where, np.logaddexp.reduce(logs) + np.log(period)


@lru_cache(maxsize=16)
def _lattice_places(tick: float, period: float) -> FloatArray:
    peak = np.linspace(-4.0 * tick, 4.0 * tick, 129)
    rest = np.linspace(-0.5, 0.5, 257) * period
    return np.unique(np.concatenate([peak, rest]))


def _bins(period: float, tick: float) -> int:
    """Give how many phases of late scans are tried: a tick apart, if they are not too many."""
    return int(2.0 ** np.clip(np.ceil(np.log2(period / tick)), *BINS))


def _phase(turns: FloatArray, where: FloatArray, table: FloatArray, bins: int) -> float:
    """Give the best of so many phases of late scans, as a share of the period.

    The likelihood of all phases at once is a correlation of the stamps with the table.
    """
    period = float(where[-1] - where[0])
    logs = np.interp(_bin_places(bins) * period, where, table)
    totals = fft.irfft(_spectrum(turns.tobytes(), bins) * fft.rfft(logs).conj(), bins)
    return int(np.argmax(totals)) / bins


@lru_cache(maxsize=8)
def _bin_places(bins: int) -> FloatArray:
    return folded(np.arange(bins) / bins, 1.0)


@lru_cache(maxsize=8)
def _spectrum(turns: bytes, bins: int) -> NDArray[np.complex128]:
    """Transform the stamps, which stay the same while the law of late scans is searched for."""
    places = (np.frombuffer(turns) * bins).astype(np.intp) % bins
    return np.asarray(fft.rfft(np.bincount(places, minlength=bins)))


def _ever_finer(step: float, tick: float) -> Iterator[float]:
    """Give a first step, and ever finer ones as far as to a fraction of the tick."""
    while step > FINEST_STEP * tick:
        yield step
        step /= FINER


def _lattice_values(scene: Scene, stream: Stream, change: Change, law: Law) -> FloatArray:
    """How much likelier stamps are for the grid, whose phase is chosen to fit best; shape (rows,).

    A factor on the density of the wait, which knows nothing of the grid: 1 for stamps anywhere.
    """
    rows = stream.indices
    period, tick = scan_period_us(scene, change), scene.nominal.skip.tick_us
    shift = np.broadcast_to(np.asarray(change.stamp_us, dtype=float), (len(scene),))
    slack_us = change.slack * _rms(shift, stream.rows)
    if slack_us > ANYWHERE * period:
        return np.zeros(len(rows))  # a clock this far from known tells no grid
    law = law.widened(slack_us)
    stamps = (scene.touches.latch_us - change.stamp_us)[rows]
    turns = (stamps / period) % 1.0
    where, table = _lattice_table(scene, law, period)

    def best(phases: FloatArray) -> tuple[float, FloatArray]:
        off = folded(turns - phases[:, None], 1.0)
        values = np.interp(off * period, where, table)
        i = int(np.argmax(values.sum(axis=1)))
        return float(phases[i]), values[i]

    step = tick / period
    if law.extras:
        bins = _bins(period, tick)
        phases = np.array([_phase(turns, where, table, bins)])
        step = max(step, 1.0 / bins)
    else:
        phases = np.unique(turns)
        if len(phases) > PHASES:
            phases = np.quantile(phases, np.linspace(0.0, 1.0, PHASES))
    phase, found = best(phases)
    for finer in _ever_finer(step, tick / period):
        phase, found = best(phase + finer * NEAR)
    if change.period_us and not law.extras:
        found = max([found, *_about_a_grid(turns, tick / period)], key=np.sum)
    if change.wait is None:
        return found
    # Scans that begin with the motion need not keep a grid: all of them, or those bound to it.
    _, _, unlocked = change.wait
    share = float(np.clip(unlocked, TINY, 1.0 - TINY))
    partly = np.logaddexp(np.log(share) + found, np.log1p(-share))
    return max(found, partly, np.zeros(len(turns)), key=np.sum)


def _about_a_grid(turns: FloatArray, tick: float) -> Iterator[FloatArray]:
    """How much likelier stamps are about the grid of a period, in turns of it and order of time.

    A period that differs seldom stays the same: its grid runs ahead and lags again, which stamps
    close to each other in time show alike. Where they do not, each scan is late by itself, and that
    is another effect's; the little it counts here leads to the period that both have together.
    Each touch is held against the others only, with von Mises' law for what is on a circle.
    """
    points = np.exp(2j * np.pi * turns)
    window = min(NEIGHBOURS, len(points)) | 1
    near = ndimage.convolve1d(points, np.ones(window), mode="mirror") - points
    everywhere = points.sum() - points
    for middle, cost in ((near, 0.0), (everywhere, SCATTERED)):
        off = np.angle(points * np.conj(middle))
        kept = float(np.mean(np.cos(off)))
        if kept > 0.0 and len(points) * kept**2 > NO_ACCIDENT:
            # Concentration by Banerjee et al., J. Mach. Learn. Res. 6 (2005), eq. 4.4.
            sharp = kept * (2.0 - kept**2) / max(1.0 - kept**2, TINY)
            sharp = min(sharp, 1.0 / (2.0 * np.pi * tick) ** 2)
            yield sharp * (np.cos(off) - 1.0) - np.log(special.ive(0, sharp)) - cost


def _position(scene: Scene, stream: Stream, change: Change) -> Law:
    law, stamps = stream.law, scene.touches.latch_us
    speed = scene.speed * change.speed_ratio
    begin = scene.begin_us + (change.contact_us if scene.is_machine else 0.0)
    believed = scene.speed * (stamps - scene.begin_us)
    shift = speed * (stamps - change.stamp_us - begin) - believed + change.position_um
    coarser_um = _coarser_um(scene, change)
    return Law(
        offset=law.offset + np.where(scene.has_stamps, shift, 0.0) - coarser_um / 2.0,
        sigma=_position_sigma(scene, law, change),
        box_a=law.box_a + scene.speed * _position_after_stamp_us(scene, change),
        box_b=law.box_b + coarser_um,
        extras=_position_extras(change),
    )


def _position_sigma(scene: Scene, law: Law, change: Change) -> FloatArray:
    resolution = scene.nominal.axis.resolution_um
    is_held = not np.any(change.line_um)
    rounded = _rounded_again(_coarser_um(scene, change), resolution, is_held=is_held)
    return np.asarray(np.hypot(law.sigma, np.hypot(change.position_sigma_um, rounded)))


def _position_extras(change: Change) -> tuple[Extra, ...]:
    is_boxed = np.any(np.asarray(change.position_box_um) > 0.0)
    box = (Extra(1.0, width=change.position_box_um),) if is_boxed else ()
    return _joint(change.position_extra, box)


def _deviation(scene: Scene, stream: Stream, change: Change) -> Law:
    law = stream.law
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
        sigma=_position_sigma(scene, law, change),
        box_a=_waiting(scene, stream, law.box_a * change.speed_ratio, change, speed),
        box_b=law.box_b + coarser + sooner,
        extras=_joint(extras, _position_extras(change)),
    )


def _report(scene: Scene, stream: Stream, change: Change) -> Law:
    law = stream.law
    shift = change.report_us - change.stamp_us
    return Law(
        offset=law.offset + np.where(scene.has_stamps, shift, 0.0),
        sigma=law.sigma,
        box_a=law.box_a,
        box_b=law.box_b + _coarser_tick_us(scene, change),
        extras=change.report_extra,
    )


def _grid_bonus(scene: Scene, stream: Stream, change: Change) -> FloatArray:
    """A coarse grid holds all its probability on few values: what that adds to the logarithm."""
    if stream.name == "latch_skip":
        return _in_ticks(scene, stream, change) + _in_slots(scene, stream, change)
    if stream.unit == "µm":
        deviation_um, fine_um = scene.touches.deviation_um, scene.nominal.axis.resolution_um
        return _by_lines(deviation_um, change.line_um, change.coarse_um, fine_um, stream.rows)
    return np.zeros(len(scene))


def _in_ticks(scene: Scene, stream: Stream, change: Change) -> FloatArray:
    """Weigh stamps by whether they lie on coarse ticks."""
    tick_us, line_us, coarse_us = scene.nominal.skip.tick_us, change.tick_line_us, change.coarse_us
    if line_us and coarse_us < FAR_APART * tick_us:
        return np.zeros(len(scene))
    fine_us = KNOWN_TO * tick_us if line_us else tick_us
    return _by_lines(scene.touches.latch_us, line_us, coarse_us, fine_us, stream.rows)


def _in_slots(scene: Scene, stream: Stream, change: Change) -> FloatArray:
    """Weigh stamps by the slots that triggers arrive in: latched so soon after the end of one.

    How long a trigger waits for that is in the law already, wherever the slots end.
    """
    width_us = scene.nominal.skip.jitter_us + scene.nominal.skip.tick_us
    if change.slots is None or change.slots[0] < 2.0 * width_us:
        return np.zeros(len(scene))
    slot_us, phase_us = change.slots
    behind_us = scene.nominal.input.filter_us + scene.nominal.skip.latency_us + change.skip_us
    off_us = folded(scene.touches.latch_us - behind_us - change.stamp_us - phase_us, slot_us)
    sharp = replace(stream.law, sigma=np.zeros(len(scene)), box_a=scene.scatter_us)
    density = np.exp(sharp.log_density(np.nan_to_num(off_us), slot_us)) * stream.rows
    share_off = float(np.mean(density[stream.rows] * width_us < FAR_OFF))
    anywhere = _share_anywhere(share_off, slot_us, width_us)
    return np.where(stream.rows, np.log(anywhere + (1.0 - anywhere) * slot_us * density), 0.0)


def _share_anywhere(share_off: float, period: float, width: float) -> float:
    """Give the likeliest share of values that keep no grid, if so many are off lines so wide.

    All of them, unless most are on its lines: some grid of so many holds a few by accident.
    """
    share = max(share_off * period / (period - width), OFF_GRID)
    return share if share < MOSTLY else 1.0


def _by_lines(
    values: FloatArray, line: Number, coarse: float, fine: float, rows: BoolArray
) -> FloatArray:
    """Weigh values by whether they lie on lines `coarse` apart, shape (n,); 0 of what is unknown.

    Of lines that are told by the touches, these decide as well how many keep them at all: steps of
    more than one size do not, nor do those of another surface than the one recorded.

    Args:
        values: Shape (n,).
        line: Where one line is for each value; 0 for all where the believed grid has it, too.
        coarse: Distance of the lines.
        fine: What the values are rounded to, to the nearest or down.
        rows: Which of them count; shape (n,).
    """
    if coarse <= fine:
        return np.zeros(len(values))
    known = rows & ~np.isnan(values)
    off = folded(values - line, coarse) / fine
    nearest, down = np.abs(off) < 0.5, (off > ROUNDING - 1.0) & (off < ROUNDING)
    is_on = nearest if nearest[known].sum() >= down[known].sum() else down
    anywhere = OFF_GRID
    if np.any(line):
        share_off = float(np.mean(~is_on[known])) if known.any() else 1.0
        anywhere = _share_anywhere(share_off, coarse, fine)
    on_a_line = anywhere + (1.0 - anywhere) * coarse / fine
    return np.where(known, np.log(np.where(is_on, on_a_line, anywhere)), 0.0)


_LAWS = {
    "motion": _motion,
    "latch_skip": _latch,
    "latch_plc": _latch,
    "lattice": _lattice,
    "position": _position,
    "deviation_skip": _deviation,
    "deviation_plc": _deviation,
    "report": _report,
}
