"""Candidates for effects that have no surrogate: their row in the simulator's table is enough.

The campaign's conditions are played with and without the effect, with the same random numbers, so
that the difference of two plays is what the effect does to each touch and nothing else.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.stats import qmc

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import InputPath, Nominal
from skiplatch.diagnosis.candidates import CANDIDATES, Candidate
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.law import Extra
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.surrogates import Parameters
from skiplatch.simulator.effects import Effect, EffectDescription, Parameter, effects
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller
from skiplatch.span import ALWAYS, Span

IndexArray = NDArray[np.intp]

SEED = 1
STARTS = 24
"""Points over the ranges of the parameters, for each of up to two of these."""
DECADES = 4.0
"""Of sizes below the largest admitted one, where a range has no smallest."""
DIGITS = 5
"""To which parameters are told apart, so that no play is repeated."""
MOST_PLAYED = 4_000
"""Touches; of a larger campaign only the part is played that was drawn from it."""
CERTAIN = 2
"""Replicates that show that an effect does the same each time."""
PLAYED_TOUCHES = 6_400
FEWEST_REPLICATES, MOST_REPLICATES = 4, 32
FINER, FINER_TICK = 1e-3, 0.125
"""What positions and stamps are rounded to over what is believed, lest rounding hide shifts."""
OFTEN = 0.8
"""Share of the plays from which on an effect counts as always there."""
SKEWED = 1.2
"""Skewness that speaks for an exponential: that of one is 2, that of a Gaussian 0."""
STRETCH_US = 1_000.0
"""Of travel, by which the speed is measured."""


@dataclass(frozen=True, slots=True)
class Simulated(Candidate):
    """An effect whose every change is played."""

    @property
    def is_named(self) -> bool:
        """It stands in the table of effects."""
        return True

    def __reduce__(self) -> tuple[Callable[[str, Span], Candidate], tuple[str, Span]]:
        """Travel to another process as the id and the span alone."""
        return _simulated_at, (self.id, self.span)


def catalogue() -> Mapping[str, Candidate]:
    """Give a candidate for every effect of the simulator's table, by id."""
    own = {name: simulated(name) for name in effects() if name not in CANDIDATES}
    return {**CANDIDATES, **own}


def _simulated_at(effect_id: str, span: Span) -> Candidate:
    always = simulated(effect_id)
    return always if span == ALWAYS else replace(always, span=span)


@cache
def simulated(effect_id: str) -> Candidate:
    """Make a candidate of a row of the table alone."""
    row = effects()[effect_id]
    names = tuple(parameter.name for parameter in row.parameters)
    starts = _starts(row.parameters)

    def change(scene: Scene, values: Parameters) -> Change:
        admitted = tuple(admitted_values(row, values).values())
        played, chosen = _played_part(scene)
        return _selected(_changed(played, effect_id, admitted), chosen)

    def applies(scene: Scene) -> bool:
        return scene.is_machine or row.stage not in ("probe", "link")

    return Simulated(
        id=effect_id,
        names=names,
        change=change,
        starts=lambda _scene, _given: starts,
        applies=applies,
    )


def admitted_values(
    row: EffectDescription, values: Sequence[float] | Parameters
) -> dict[str, float]:
    """Bring parameters that a search came upon into their ranges; by name."""
    return {
        parameter.name: _admitted(parameter, float(value))
        for parameter, value in zip(row.parameters, values, strict=True)
    }


def _admitted(parameter: Parameter, value: float) -> float:
    if parameter.unit == "deg":
        value = parameter.low + (value - parameter.low) % (parameter.high - parameter.low)
    elif parameter.low >= 0.0:
        value = abs(value)
    return float(np.clip(float(f"{value:.{DIGITS}g}"), parameter.low, parameter.high))


def _starts(parameters: Sequence[Parameter]) -> list[list[float]]:
    """Spread points evenly over the ranges, sizes on a logarithmic scale."""
    if not parameters:
        return [[]]
    count = STARTS * min(len(parameters), 2)
    points = qmc.Halton(len(parameters), scramble=False).random(count + 1)[1:]
    return [[_start(p, u) for p, u in zip(parameters, point, strict=True)] for point in points]


def _start(parameter: Parameter, share: float) -> float:
    """Give the value a share of the way through a range; never 0, where a search would stay."""
    low, high = parameter.low, parameter.high
    if parameter.unit == "deg":
        return low + share * (high - low)
    if low < 0.0 < high:
        end = low if share < 0.5 else high
        return float(end * 10.0 ** (-DECADES * (1.0 - 2.0 * share % 1.0)))
    near, far = (low, high) if abs(low) < abs(high) else (high, low)
    near = near or far * 10.0**-DECADES
    return float(near * (far / near) ** share)


def _played_part(scene: Scene) -> tuple[Scene, IndexArray]:
    """Find the largest part that is played, for effects remember, and which of it the scene is."""
    chosen: IndexArray = np.arange(len(scene))
    while (whole := scene.whole) is not None and len(whole) <= MOST_PLAYED:
        chosen = np.asarray(scene.chosen)[chosen]
        scene = whole
    return scene, chosen


def _selected(change: Change, chosen: IndexArray) -> Change:
    """Give the part of a change that belongs to some of the touches."""

    def part(value: FloatArray | float) -> FloatArray | float:
        return value[chosen] if isinstance(value, np.ndarray) else value

    parts: dict[str, Any] = {}
    for field in fields(change):
        value = getattr(change, field.name)
        if isinstance(value, tuple):
            parts[field.name] = tuple(replace(e, sigma=part(e.sigma)) for e in value)
        elif isinstance(value, np.ndarray):
            parts[field.name] = value[chosen]
    return replace(change, **parts)


@dataclass(frozen=True, slots=True, eq=False)
class _Pair:
    """Plays without and with an effect; arrays of shape (r, n)."""

    scene: Scene
    without: Outcomes
    with_it: Outcomes

    @property
    def contact_us(self) -> FloatArray:
        """By how much the recorded edge comes later; bench only."""
        return self.with_it.edge_us - self.without.edge_us

    @property
    def latch_us(self) -> FloatArray:
        """By how much the latch comes later, after what it is counted from."""
        later = self.with_it.latch_us - self.without.latch_us
        return later if self.scene.is_machine else later - self.contact_us

    @property
    def deviation_um(self) -> FloatArray:
        return self.with_it.deviation_um - self.without.deviation_um

    @property
    def position_um(self) -> FloatArray:
        """By how much the position differs beyond the way of the latch's own time."""
        return self.deviation_um - self.scene.speed * self.latch_us

    @property
    def report_us(self) -> FloatArray:
        return self.with_it.report_us - self.without.report_us

    @property
    def travel_us(self) -> FloatArray:
        """By how much the report takes longer."""
        return self.report_us - (self.with_it.latch_us - self.without.latch_us)

    @property
    def lost(self) -> float:
        """Share of the touches that are missed because of the effect."""
        return max(0.0, float(np.mean(self.without.ok)) - float(np.mean(self.with_it.ok)))


class _Player:
    """Plays one effect with one set of parameters."""

    def __init__(self, scene: Scene, effect: Effect) -> None:
        self._scene = scene
        self._effect = effect

    def pair(self, *, all_skip: bool) -> _Pair:
        """Play as often as needed: twice what does the same each time, else more often."""
        pair = self.often(CERTAIN, all_skip=all_skip)
        same = all(map(_is_same, (pair.latch_us, pair.deviation_um, pair.report_us)))
        if same and np.all(pair.with_it.ok == pair.without.ok):
            return pair
        often = np.clip(PLAYED_TOUCHES // len(self._scene), FEWEST_REPLICATES, MOST_REPLICATES)
        return self.often(int(often), all_skip=all_skip)

    def often(self, replicates: int, *, all_skip: bool = False) -> _Pair:
        """Play so many times, as recorded or all touches on the skip path."""
        without = _without(self._scene, replicates, all_skip=all_skip)
        with_it = _play(self._scene, self._effect, replicates, all_skip=all_skip)
        return _Pair(self._scene, without, with_it)

    def speed_ratio(self) -> FloatArray:
        """Measure how far the axis goes in a little more time; shape (n,)."""
        near = _play(self._scene, self._effect, 1, all_skip=True)
        far = _play(self._scene, self._effect, 1, all_skip=True, later_us=STRETCH_US)
        way_um = far.deviation_um[0] - near.deviation_um[0]
        ratio = way_um / (far.latch_us[0] - near.latch_us[0]) / self._scene.speed
        return np.asarray(np.nan_to_num(ratio, nan=1.0))


def _is_same(differences: FloatArray) -> bool:
    """Tell whether all replicates show the same, but for rounding."""
    known = differences[:, ~np.isnan(differences).any(axis=0)]
    return bool(np.all(np.ptp(known, axis=0) <= 1e-3 * np.abs(known).max(initial=0.0) + 1e-2))


@lru_cache(maxsize=8)
def _without(scene: Scene, replicates: int, *, all_skip: bool) -> Outcomes:
    return _play(scene, None, replicates, all_skip=all_skip)


def _play(
    scene: Scene,
    effect: Effect | None,
    replicates: int,
    *,
    all_skip: bool,
    later_us: float = 0.0,
) -> Outcomes:
    """Play the touches; on the skip path a shift does not have to wait for a scan to be seen."""
    touches = scene.touches
    if all_skip:
        touches = replace(touches, path=np.full_like(touches.path, InputPath.SKIP))
    return play(
        _finer(scene.nominal, later_us),
        Controller.for_campaign(scene.nominal, touches),
        touches,
        seed=SEED,
        replicates=replicates,
        switched_on=[effect] if effect else [],
    )


def _finer(nominal: Nominal, later_us: float) -> Nominal:
    resolution_um = FINER * nominal.axis.resolution_um
    filter_us = nominal.input.filter_us + later_us
    return replace(
        nominal,
        axis=replace(nominal.axis, resolution_um=resolution_um),
        skip=replace(nominal.skip, tick_us=FINER_TICK * nominal.skip.tick_us),
        input=replace(nominal.input, filter_us=filter_us),
    )


@lru_cache(maxsize=64)
def _changed(scene: Scene, effect_id: str, values: tuple[float, ...]) -> Change:
    """Turn plays into what they say of the physics: each stage changes something else."""
    row = effects()[effect_id]
    names = (parameter.name for parameter in row.parameters)
    player = _Player(scene, Effect(effect_id, dict(zip(names, values, strict=True))))
    if row.stage == "motion":
        return _of_motion(player)
    if row.stage == "latch" and row.paths == "both":
        return _of_clock(player)
    if row.stage == "position":
        return _of_position(player)
    if row.stage == "report":
        return _of_report(player)
    if row.paths == "both":
        return _of_pin(player)
    return _of_skip(player) if row.paths == "skip" else _of_scan(player)


def _of_motion(player: _Player) -> Change:
    pair = player.pair(all_skip=True)
    scene, ratio = pair.scene, player.speed_ratio()
    if not scene.is_machine:
        later, _ = _shift(pair.contact_us)
        return Change(contact_us=later, speed_ratio=ratio, lost=pair.lost)
    later, extras = _shift(pair.latch_us)
    on_the_way_us = scene.pretravel_um / scene.speed * (1.0 / ratio - 1.0)
    return Change(
        contact_us=later - on_the_way_us, speed_ratio=ratio, pin_extra=extras, lost=pair.lost
    )


def _of_pin(player: _Player) -> Change:
    pair = player.pair(all_skip=True)
    later, extras = _shift(pair.latch_us)
    return Change(pin_us=later, pin_extra=extras, lost=pair.lost)


def _of_clock(player: _Player) -> Change:
    pair = player.pair(all_skip=False)
    return Change(
        stamp_us=_shift(pair.latch_us)[0],
        position_um=_shift(pair.deviation_um)[0],
        report_us=_shift(pair.report_us)[0],
        lost=pair.lost,
    )


def _of_position(player: _Player) -> Change:
    pair = player.pair(all_skip=False)
    moved, extras = _shift(pair.position_um)
    return Change(position_um=moved, position_extra=extras, lost=pair.lost)


def _of_report(player: _Player) -> Change:
    pair = player.pair(all_skip=False)
    later, extras = _shift(pair.travel_us)
    return Change(report_us=later, report_extra=extras, lost=pair.lost)


def _of_skip(player: _Player) -> Change:
    """Of an edge interrupt that is late, or of its stamp alone: then position stays behind."""
    pair = player.pair(all_skip=False)
    rows = ~pair.scene.plc
    later, extras = _shift(pair.latch_us, rows)
    moved, scatter = _shift(pair.position_um, rows)
    travel, _ = _shift(pair.travel_us, rows)
    return Change(
        skip_us=later,
        skip_extra=extras,
        position_um=moved,
        position_extra=scatter,
        report_us=travel,
        lost=pair.lost,
    )


def _of_scan(player: _Player) -> Change:
    """Of scans: a stamp moves by whole periods or off their grid, and both count."""
    pair = player.often(FEWEST_REPLICATES)
    rows = pair.scene.plc
    mean, _ = _shift(pair.latch_us, rows)
    scatter = Extra(1.0, sigma=_excess(pair, rows))
    return Change(
        plc_us=mean, scan_extra=(scatter,), lattice_extra=_off_grid(pair, rows), lost=pair.lost
    )


def _off_grid(pair: _Pair, rows: BoolArray) -> tuple[Extra, ...]:
    """Stamps that a whole number of periods does not bring back onto the grid."""
    chain = pair.scene.nominal
    later = pair.latch_us[:, rows]
    off = later - np.rint(later / chain.plc.scan_us) * chain.plc.scan_us
    known = off[~np.isnan(off)]
    hits = known[np.abs(known) > chain.skip.tick_us]
    return (_now_and_then(hits, len(hits) / len(known)),) if len(hits) else ()


def _excess(pair: _Pair, rows: BoolArray) -> float:
    """Scatter of the latch that was not there without the effect, over all touches."""
    seen = rows & ~np.isnan(pair.latch_us).any(axis=0)
    if not seen.any():
        return 0.0
    after, before = (np.var(o.latch_us[:, seen], axis=0) for o in (pair.with_it, pair.without))
    return float(np.sqrt(max(0.0, float(np.mean(after - before)))))


def _shift(
    differences: FloatArray, rows: BoolArray | None = None
) -> tuple[FloatArray, tuple[Extra, ...]]:
    """Summarise differences, shape (r, n), as a shift of each touch, shape (n,), and extras.

    Args:
        differences: NaN where a touch was missed.
        rows: The touches that can differ, shape (n,); without it all.
    """
    count = differences.shape[1]
    rows = np.full(count, fill_value=True) if rows is None else rows
    rows = rows & ~np.isnan(differences).all(axis=0)
    if not rows.any():
        return np.zeros(count), ()
    inner = differences[:, rows]
    mean = np.nanmean(inner, axis=0)
    inner = np.where(np.isnan(inner), mean, inner)
    if _is_same(inner):
        return _everywhere(mean, rows), ()
    hit = np.abs(inner) > 1e-2
    if np.mean(hit[:, hit.any(axis=0)]) < OFTEN:
        return np.zeros(count), (_now_and_then(inner[hit], float(np.mean(hit))),)
    replicates, variance = len(inner), np.var(inner, axis=0, ddof=1)
    pooled = float(np.mean(variance))
    mean = _calmed(mean, pooled / replicates)
    variance = np.maximum(_calmed(variance, 2.0 * pooled**2 / (replicates - 1)), 0.0)
    sigma = _everywhere(np.sqrt(variance), rows)
    return _everywhere(mean, rows), (Extra(1.0, sigma=sigma),)


def _everywhere(values: FloatArray, rows: BoolArray) -> FloatArray:
    full = np.zeros(len(rows))
    full[rows] = values
    return full


def _calmed(values: FloatArray, error_variance: float) -> FloatArray:
    """Draw estimates towards their mean by the share of their variance that is their error."""
    variance = float(np.var(values))
    kept = max(0.0, 1.0 - error_variance / variance) if variance > 0.0 else 0.0
    return np.asarray(values.mean() + kept * (values - values.mean()))


def _now_and_then(hits: FloatArray, share: float) -> Extra:
    """What only some touches get: an exponential if it is skewed like one, else a Gaussian."""
    mean, sigma, least = float(hits.mean()), float(hits.std()), float(hits.min())
    if sigma > 1e-3 * abs(mean) and stats.skew(hits) > SKEWED:
        return Extra(share, offset=least, mean=mean - least)
    return Extra(share, offset=mean, sigma=sigma)
