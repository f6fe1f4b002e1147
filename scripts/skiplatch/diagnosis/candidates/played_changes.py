"""What plays without and with an effect say that it makes of the physics."""

from functools import lru_cache

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray, calmed
from skiplatch.diagnosis.candidates.played_pairs import FEWEST_REPLICATES, Pair, Player, is_same
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Extra
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect, effects

OFTEN = 0.8
"""Share of the plays from which on an effect counts as always there."""
SKEWED = 1.2
"""Skewness that speaks for an exponential: that of one is 2, that of a Gaussian 0."""


@lru_cache(maxsize=64)
def changed(scene: Scene, effect_id: str, values: tuple[float, ...]) -> Change:
    """Turn plays into what they say of the physics: each stage changes something else."""
    row = effects()[effect_id]
    names = (parameter.name for parameter in row.parameters)
    player = Player(scene, Effect(effect_id, dict(zip(names, values, strict=True))))
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


def _of_motion(player: Player) -> Change:
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


def _of_pin(player: Player) -> Change:
    pair = player.pair(all_skip=True)
    later, extras = _shift(pair.latch_us)
    return Change(pin_us=later, pin_extra=extras, lost=pair.lost)


def _of_clock(player: Player) -> Change:
    pair = player.pair(all_skip=False)
    return Change(
        stamp_us=_shift(pair.latch_us)[0],
        position_um=_shift(pair.deviation_um)[0],
        report_us=_shift(pair.report_us)[0],
        lost=pair.lost,
    )


def _of_position(player: Player) -> Change:
    pair = player.pair(all_skip=False)
    moved, extras = _shift(pair.position_um)
    return Change(position_um=moved, position_extra=extras, lost=pair.lost)


def _of_report(player: Player) -> Change:
    pair = player.pair(all_skip=False)
    later, extras = _shift(pair.travel_us)
    return Change(report_us=later, report_extra=extras, lost=pair.lost)


def _of_skip(player: Player) -> Change:
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


def _of_scan(player: Player) -> Change:
    """Of scans: a stamp moves by whole periods or off their grid, and both count."""
    pair = player.often(FEWEST_REPLICATES)
    rows = pair.scene.plc
    mean, _ = _shift(pair.latch_us, rows)
    scatter = Extra(1.0, sigma=_excess(pair, rows))
    return Change(
        plc_us=mean, scan_extra=(scatter,), lattice_extra=_off_grid(pair, rows), lost=pair.lost
    )


def _off_grid(pair: Pair, rows: BoolArray) -> tuple[Extra, ...]:
    """Stamps that a whole number of periods does not bring back onto the grid."""
    chain = pair.scene.nominal
    later = pair.latch_us[:, rows]
    off = later - np.rint(later / chain.plc.scan_us) * chain.plc.scan_us
    known = off[~np.isnan(off)]
    hits = known[np.abs(known) > chain.skip.tick_us]
    return (_now_and_then(hits, len(hits) / len(known)),) if len(hits) else ()


def _excess(pair: Pair, rows: BoolArray) -> float:
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
    if is_same(inner):
        return _everywhere(mean, rows), ()
    hit = np.abs(inner) > 1e-2
    ever = hit.any(axis=0)
    if ever.any() and np.mean(hit[:, ever]) < OFTEN:
        return np.zeros(count), (_now_and_then(inner[hit], float(np.mean(hit))),)
    replicates, variance = len(inner), np.var(inner, axis=0, ddof=1)
    pooled = float(np.mean(variance))
    mean = calmed(mean, pooled / replicates)
    variance = np.maximum(calmed(variance, 2.0 * pooled**2 / (replicates - 1)), 0.0)
    sigma = _everywhere(np.sqrt(variance), rows)
    return _everywhere(mean, rows), (Extra(1.0, sigma=sigma),)


def _everywhere(values: FloatArray, rows: BoolArray) -> FloatArray:
    full = np.zeros(len(rows))
    full[rows] = values
    return full


def _now_and_then(hits: FloatArray, share: float) -> Extra:
    """What only some touches get: an exponential if it is skewed like one, else a Gaussian."""
    mean, sigma, least = float(hits.mean()), float(hits.std()), float(hits.min())
    if sigma > 1e-3 * abs(mean) and scipy.stats.skew(hits) > SKEWED:
        return Extra(share, offset=least, mean=mean - least)
    return Extra(share, offset=mean, sigma=sigma)
