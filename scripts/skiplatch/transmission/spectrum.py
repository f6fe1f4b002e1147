"""The orders of a transmission error: sines over the output turn, fitted to uneven samples.

Peaks of the windowed spectrum are where the fit begins; orders, amplitudes and phases are then
fitted together (Gauss and Newton), so that neighbours do not pull at one another and an order is
found to far less than one over the number of turns.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

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
SHORT_TURNS = 1.0
SHORT_DEGREE = 3
"""Of less than a turn the slow orders are out of reach: a cubic takes what they leave."""
ROUNDS = 8
SMALLEST_SHARE = 0.02
"""Of the highest peak of a round: what is lower waits until the higher ones are fitted."""
ITERATIONS = 5
CONVERGED_BINS = 1e-5
DRIFT_TURNS = 3.0
"""From so many turns on a drift is told from the slowest order."""
CURVE_POINTS = 101
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
    trend: Polynomial
    """Of turns, in arcsec: a mean, of three turns and more a drift, of less than one a cubic."""
    noise_arcsec: float
    """Root mean square of what the fit leaves."""

    @property
    def drift_arcsec_per_turn(self) -> float:
        """Mean slope of the trend."""
        low, high = map(float, self.trend.domain)
        return float(self.trend(high) - self.trend(low)) / (high - low)

    @property
    def bend_arcsec(self) -> float:
        """Peak to peak of the trend where it stands for orders out of reach, else 0."""
        if self.trend.degree() < SHORT_DEGREE:
            return 0.0
        return float(np.ptp(self.trend.linspace(CURVE_POINTS)[1]))

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
    middle, half = _scale(turns)
    trend = Polynomial(solved[2 * k :], domain=[middle - half, middle + half])
    fit = Fit(orders, solved[:k] + 1j * solved[k : 2 * k], trend, 0.0)
    left = residual(fit, turns, delta_arcsec)
    return replace(fit, noise_arcsec=float(np.sqrt(np.mean(left**2))))


def residual(fit: Fit, turns: FloatArray, delta_arcsec: FloatArray) -> FloatArray:
    """Give what a fit leaves of samples; shape (n,)."""
    left = np.empty(len(turns))
    for rows in _chunks(len(turns)):
        sine, cosine = _sines(turns[rows], fit.orders)
        left[rows] = (
            delta_arcsec[rows]
            - fit.trend(turns[rows])
            - sine @ fit.waves.real
            - cosine @ fit.waves.imag
        )
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
        step = np.clip(solved[-k:] / (np.pi / bin_width), -0.5 * bin_width, 0.5 * bin_width)
        orders = orders + step
        if np.max(np.abs(step)) < CONVERGED_BINS * bin_width:
            break
    stays = (np.abs(orders - start) <= bin_width) & (orders >= _slowest_bins(turns) * bin_width)
    return _distinct(orders[stays], 0.5 * bin_width)


def _slowest_bins(turns: FloatArray) -> float:
    return SLOWEST_BINS if float(np.ptp(turns)) >= SHORT_TURNS else 1.0


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
    """Solve the normal equations: sines, cosines, trend, and steps of the orders if asked.

    Trend and steps are those of the place within the samples, from -1 to 1.
    """
    size = 2 * len(orders) + 1 + _degree(turns) + (len(orders) if waves is not None else 0)
    square, right = np.zeros((size, size)), np.zeros(size)
    middle, half = _scale(turns)
    for rows in _chunks(len(turns)):
        place = (turns[rows] - middle) / half
        columns = _columns(turns[rows], orders, waves, place, _degree(turns))
        square += columns.T @ columns
        right += columns.T @ delta[rows]
    return np.asarray(np.linalg.lstsq(square, right, rcond=1e-13)[0])


def _scale(turns: FloatArray) -> tuple[float, float]:
    half = max(0.5 * float(np.ptp(turns)), 1e-12)
    return float(np.min(turns)) + half, half


def _degree(turns: FloatArray) -> int:
    length = float(np.ptp(turns))
    if length < SHORT_TURNS:
        return min(SHORT_DEGREE, len(turns) - 1)
    return int(length >= DRIFT_TURNS)


def _columns(
    turns: FloatArray,
    orders: FloatArray,
    waves: NDArray[np.complex128] | None,
    place: FloatArray,
    degree: int,
) -> FloatArray:
    sine, cosine = _sines(turns, orders)
    parts = [sine, cosine, np.vander(place, degree + 1, increasing=True)]
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
    window = scipy.signal.windows.hann(len(grid), sym=False)
    length = scipy.fft.next_fast_len(2 * len(grid), real=True)
    power = np.abs(scipy.fft.rfft(grid * window, length)) ** 2
    fold = length / len(grid)  # the grid is padded to about twice its length
    floor = _floor(power)
    floor_least = (1e-12 * float(np.max(np.abs(left), initial=0.0)) * len(grid)) ** 2
    stands_out = np.log(len(grid) / FALSE_ALARM) * np.maximum(floor, floor_least)
    tops, _ = scipy.signal.find_peaks(power, distance=max(round(APART_BINS * fold), 1))
    tops = tops[(power[tops] > stands_out[tops]) & (tops >= _slowest_bins(turns) * fold)]
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
