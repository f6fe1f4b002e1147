"""The grid of scans that PLC stamps lie on, whose phase is taken from the stamps themselves."""

from collections.abc import Iterator
from dataclasses import astuple
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import fft, ndimage, special

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.change import Change, Number
from skiplatch.diagnosis.density.law import Extra, Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import TINY
from skiplatch.diagnosis.likelihood.scan_wait import scan_period_us
from skiplatch.diagnosis.scene.grid import folded
from skiplatch.diagnosis.scene.scene import Scene

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
MOST_TURNS = 4
"""Periods after which a late scan is not followed further."""


def _table(scene: Scene, law: Law, period: float) -> tuple[FloatArray, FloatArray]:
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
    where = _places(tick, period)
    if len(edges):
        near = (edges[:, None] + EDGE * tick).ravel()  # which may pass the end of the period
        where = np.unique(np.append(where, folded(near, period)))
    turns = int(min(np.max(ends, initial=0.0) // period, MOST_TURNS)) + 2 if law.extras else 1
    places = (where + period * np.arange(turns)[:, None]).ravel()
    logs = law.log_density(places, period).reshape(turns, len(where))
    return where, np.logaddexp.reduce(logs) + np.log(period)


@lru_cache(maxsize=16)
def _places(tick: float, period: float) -> FloatArray:
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


def grid_values(scene: Scene, stream: Stream, change: Change, law: Law) -> FloatArray:
    """How much likelier stamps are for the grid, whose phase is chosen to fit best; shape (rows,).

    A factor on the density of the wait, which knows nothing of the grid: 1 for stamps anywhere.
    """
    rows = stream.indices
    period, tick = scan_period_us(scene, change), scene.nominal.skip.tick_us
    shift = np.broadcast_to(np.asarray(change.stamp_us, dtype=float), (len(scene),))
    slack_us = change.slack * float(np.sqrt(np.mean(shift[rows] ** 2)))
    if slack_us > ANYWHERE * period:
        return np.zeros(len(rows))  # a clock this far from known tells no grid
    law = law.widened(slack_us)
    stamps = (scene.touches.latch_us - change.stamp_us)[rows]
    turns = (stamps / period) % 1.0
    where, table = _table(scene, law, period)

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
            evenly = np.linspace(0.0, len(phases) - 1.0, PHASES)
            phases = np.interp(evenly, np.arange(len(phases)), phases)  # quantiles
    phase, found = best(phases)
    for finer in _ever_finer(step, tick / period):
        phase, found = best(phase + finer * NEAR)
    if change.period_us and not law.extras:
        found = max([found, *_about_a_grid(turns, tick / period)], key=np.sum)
    if change.wait is None:
        return found
    # Scans that begin with the motion need not keep a grid: all of them, or those bound to it.
    share = float(np.clip(change.wait.unlocked, TINY, 1.0 - TINY))
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
