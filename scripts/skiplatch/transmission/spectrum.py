"""The orders of a transmission error: sines over the output turn, fitted to uneven samples.

Peaks of the windowed spectrum are where the fit begins; orders, amplitudes and phases are then
fitted together (Gauss and Newton), so that neighbours do not pull at one another and an order is
found to far less than one over the number of turns.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft, signal

from skiplatch.arrays import FloatArray

MOST_ORDERS = 32
FALSE_ALARM = 1e-6
"""Rate at which a spectrum of noise alone shows an order."""
BANDS = 32
"""Stretches of the spectrum that each have a noise floor of their own."""
APART_BINS = 2.5
"""Peaks nearer than that to a higher one are its side lobes; the next round looks again."""
SLOWEST_BINS = 0.9
"""What has fewer periods in the samples is not told from a drift."""
ROUNDS = 8
SMALLEST_SHARE = 0.02
"""Of the highest peak of a round: what is lower waits until the higher ones are fitted."""
ITERATIONS = 5
CONVERGED_BINS = 1e-5
DRIFT_TURNS = 3.0
"""From so many turns on a drift is told from the slowest order."""
CHUNK = 1 << 13
"""Samples of which the sines are held at a time."""


@dataclass(frozen=True, slots=True)
class Order:
    """``amplitude_arcsec · sin(2π · order · turns + phase)``, the turns those of the output."""

    order: float
    amplitude_arcsec: float
    phase_deg: float


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Sines and a drift fitted to samples."""

    orders: FloatArray
    """Cycles per output turn; shape (k,)."""
    waves: NDArray[np.complex128]
    """Amplitude and phase of each sine, at turn 0; shape (k,), arcsec."""
    mean_arcsec: float
    drift_arcsec_per_turn: float
    noise_arcsec: float
    """Root mean square of what the fit leaves."""

    def sorted_orders(self) -> list[Order]:
        """Give the sines, the largest first."""
        by_size = np.argsort(-np.abs(self.waves))
        return [
            Order(float(self.orders[i]), float(abs(self.waves[i])), _degrees(self.waves[i]))
            for i in by_size
        ]


def fit_orders(turns: FloatArray, delta_arcsec: FloatArray, per_turn: float) -> Fit:
    """Find the sines in samples, shape (n,), that lie on places of a grid of `per_turn` a turn.

    Args:
        turns: Where the samples lie; places may be missing.
        delta_arcsec: The samples.
        per_turn: Places of the grid in a turn.
    """
    fit = refit(turns, delta_arcsec, np.empty(0))
    for _ in range(ROUNDS):
        more = _peaks(turns, residual(fit, turns, delta_arcsec), per_turn)
        if not len(more):
            break
        orders = np.append(fit.orders, more)[:MOST_ORDERS]
        better = _significant(turns, delta_arcsec, _refined(turns, delta_arcsec, orders))
        if better.noise_arcsec >= fit.noise_arcsec:
            break
        fit = better
    return fit


def _significant(turns: FloatArray, delta: FloatArray, orders: FloatArray) -> Fit:
    """Fit, without what noise of that size would show as well: side lobes mostly."""
    fit = refit(turns, delta, orders)
    least = 2.0 * fit.noise_arcsec * np.sqrt(np.log(len(turns) / FALSE_ALARM) / len(turns))
    stands = np.abs(fit.waves) > least
    return fit if stands.all() else refit(turns, delta, orders[stands])


def refit(turns: FloatArray, delta_arcsec: FloatArray, orders: FloatArray) -> Fit:
    """Fit amplitudes, phases, mean and drift at orders that are known."""
    solved = _solve(turns, delta_arcsec, orders, None)
    k = len(orders)
    drift = float(solved[2 * k + 1]) if len(solved) > 2 * k + 1 else 0.0
    fit = Fit(orders, solved[:k] + 1j * solved[k : 2 * k], float(solved[2 * k]), drift, 0.0)
    left = residual(fit, turns, delta_arcsec)
    return Fit(orders, fit.waves, fit.mean_arcsec, drift, float(np.sqrt(np.mean(left**2))))


def residual(fit: Fit, turns: FloatArray, delta_arcsec: FloatArray) -> FloatArray:
    """Give what a fit leaves of samples; shape (n,)."""
    left = np.empty(len(turns))
    for rows in _chunks(len(turns)):
        sine, cosine = _sines(turns[rows], fit.orders)
        line = fit.mean_arcsec + fit.drift_arcsec_per_turn * turns[rows]
        left[rows] = delta_arcsec[rows] - line - sine @ fit.waves.real - cosine @ fit.waves.imag
    return left


def _refined(turns: FloatArray, delta: FloatArray, orders: FloatArray) -> FloatArray:
    """Fit the orders along with the rest; what leaves its bin, or is but a drift, is dropped."""
    bin_width = 1.0 / float(np.ptp(turns))
    start = orders
    k = len(orders)
    waves = refit(turns, delta, orders).waves
    for _ in range(ITERATIONS):
        solved = _solve(turns, delta, orders, waves)
        waves = solved[:k] + 1j * solved[k : 2 * k]
        step = np.clip(solved[-k:], -0.5 * bin_width, 0.5 * bin_width)
        orders = orders + step
        if np.max(np.abs(step)) < CONVERGED_BINS * bin_width:
            break
    stays = (np.abs(orders - start) <= bin_width) & (orders >= SLOWEST_BINS * bin_width)
    return _distinct(orders[stays], 0.5 * bin_width)


def _distinct(orders: FloatArray, apart: float) -> FloatArray:
    """Drop what has run into a neighbour: the fit cannot tell them apart."""
    ordered = np.sort(orders)
    return ordered[np.diff(ordered, prepend=-np.inf) > apart]


def _solve(
    turns: FloatArray,
    delta: FloatArray,
    orders: FloatArray,
    waves: NDArray[np.complex128] | None,
) -> FloatArray:
    """Solve the normal equations: sines, cosines, mean, drift, and steps of the orders if asked."""
    with_drift = bool(np.ptp(turns) >= DRIFT_TURNS)
    size = 2 * len(orders) + 1 + int(with_drift) + (len(orders) if waves is not None else 0)
    square, right = np.zeros((size, size)), np.zeros(size)
    half = max(0.5 * float(np.ptp(turns)), 1e-12)
    middle = float(np.min(turns)) + half
    for rows in _chunks(len(turns)):
        columns = _columns(turns[rows], orders, waves, (middle, half), with_drift=with_drift)
        square += columns.T @ columns
        right += columns.T @ delta[rows]
    solved = np.asarray(np.linalg.lstsq(square, right, rcond=1e-13)[0])
    return _unscaled(solved, len(orders), middle, half, with_drift=with_drift)


def _unscaled(
    solved: FloatArray, k: int, middle: float, half: float, *, with_drift: bool
) -> FloatArray:
    """Take back that the columns of the drift and of the orders were scaled to one."""
    if with_drift:
        solved[2 * k + 1] /= half
        solved[2 * k] -= solved[2 * k + 1] * middle
    solved[2 * k + 1 + int(with_drift) :] /= 2.0 * np.pi * half
    return solved


def _columns(
    turns: FloatArray,
    orders: FloatArray,
    waves: NDArray[np.complex128] | None,
    scale: tuple[float, float],
    *,
    with_drift: bool,
) -> FloatArray:
    sine, cosine = _sines(turns, orders)
    place = (turns - scale[0]) / scale[1]
    parts = [sine, cosine, np.ones((len(turns), 1))]
    if with_drift:
        parts.append(place[:, None])
    if waves is not None:
        # The phase is held at the middle, so that order and phase hardly depend on each other.
        parts.append(place[:, None] * (cosine * waves.real - sine * waves.imag))
    return np.hstack(parts)


def _sines(turns: FloatArray, orders: FloatArray) -> tuple[FloatArray, FloatArray]:
    angle = 2.0 * np.pi * np.outer(turns, orders)
    return np.sin(angle), np.cos(angle)


def _peaks(turns: FloatArray, left: FloatArray, per_turn: float) -> FloatArray:
    """Give the orders at which the spectrum stands out of its noise, the highest first."""
    places = np.rint((turns - np.min(turns)) * per_turn).astype(np.int64)
    grid = np.zeros(int(places.max()) + 1)
    grid[places] = left
    window = signal.windows.hann(len(grid), sym=False)
    length = fft.next_fast_len(2 * len(grid), real=True)
    power = np.abs(fft.rfft(grid * window, length)) ** 2
    fold = length / len(grid)  # the grid is padded to about twice its length
    floor = _floor(power)
    floor_least = (1e-12 * float(np.max(np.abs(left), initial=0.0)) * len(grid)) ** 2
    stands_out = np.log(len(grid) / FALSE_ALARM) * np.maximum(floor, floor_least)
    tops, _ = signal.find_peaks(power, distance=max(round(APART_BINS * fold), 1))
    tops = tops[(power[tops] > stands_out[tops]) & (tops >= SLOWEST_BINS * fold)]
    tops = tops[power[tops] > SMALLEST_SHARE**2 * np.max(power[tops], initial=0.0)]
    highest = tops[np.argsort(-power[tops])]
    return np.asarray(_vertex(power, highest) / length * per_turn)


def _floor(power: FloatArray) -> FloatArray:
    """Mean power of the noise about each line, from the median, which lines do not move."""
    bands = np.array_split(power, max(min(BANDS, len(power) // 64), 1))
    levels = [np.full(len(band), np.median(band) / np.log(2.0)) for band in bands]
    return np.concatenate(levels)


def _vertex(power: FloatArray, tops: NDArray[np.intp]) -> FloatArray:
    """Place each peak between lines, by a parabola through the logarithms."""
    at = np.clip(tops, 1, len(power) - 2)
    low, top, high = (np.log(power[at + k] + 1e-300) for k in (-1, 0, 1))
    bend = low - 2.0 * top + high
    shift = np.divide(0.5 * (low - high), bend, out=np.zeros(len(at)), where=bend < 0.0)
    return np.asarray(at + np.clip(shift, -0.5, 0.5))


def _chunks(n: int) -> Iterator[slice]:
    for start in range(0, n, CHUNK):
        yield slice(start, min(start + CHUNK, n))


def _degrees(wave: np.complex128) -> float:
    return float(np.rad2deg(np.angle(wave)))
