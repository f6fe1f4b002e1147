"""What is told of a transmission error: its size, its waves, its orders and its noise.

The values are those of single-flank testing (DIN 3960, VDI/VDE 2608): total error F'i, tooth-to-
tooth error f'i, long-wave part f'l, short-wave part f'k. They are built up block by block, so that
memory does not grow with the train.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from skiplatch.arrays import FloatArray
from skiplatch.transmission.spectrum import Fit, Order, fit_orders, refit
from skiplatch.transmission.waves import IntArray, Range, Waves, grid_step

BLOCK_POINTS = 1 << 17
LEAST_SHARE = 0.25
"""A last block with less than that of a block's points does not move the orders."""
MOST_BINS = 3600


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Over the output turn: the range of all turns, shape (bins,), and the first one, (m,)."""

    turn: FloatArray
    mean_arcsec: FloatArray
    low_arcsec: FloatArray
    high_arcsec: FloatArray
    first_turn: FloatArray
    first_arcsec: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Values:
    """What is told of n points; lengths of time and way are those of the whole train."""

    points: int
    turns: float
    total_arcsec: float
    """F'i: peak to peak."""
    tooth_to_tooth_arcsec: float
    """f'i: the largest peak to peak within one tooth pitch."""
    long_wave_arcsec: float
    """f'l: peak to peak of the mean over a tooth pitch."""
    short_wave_arcsec: float
    """f'k: the largest peak to peak, within one tooth pitch, of what that mean leaves."""
    tooth_pitch_turns: float
    drift_arcsec_per_turn: float
    trend_arcsec: float
    """Of less than a turn: peak to peak of the trend that stands for orders out of reach."""
    orders: Sequence[Order]
    noise_arcsec: float
    curve: Curve


@dataclass(frozen=True, slots=True)
class Backlash:
    """How far the output stays behind when the input turns back, at the places of a turn."""

    mean_arcsec: float
    least_arcsec: float
    greatest_arcsec: float

    def shifted(self, more_arcsec: float) -> "Backlash":
        """Give the backlash with so much more at each place."""
        return Backlash(
            self.mean_arcsec + more_arcsec,
            self.least_arcsec + more_arcsec,
            self.greatest_arcsec + more_arcsec,
        )


class Evaluation:
    """Takes points in blocks of any size, and gives the values at the end."""

    def __init__(self, lines: float, pitch_turns: float) -> None:
        """Begin.

        Args:
            lines: Lines of the gating encoder in an output turn: places of points.
            pitch_turns: One tooth pitch in output turns.
        """
        self._lines = lines
        self._waves = Waves(lines * pitch_turns)
        self._pitch_turns = pitch_turns
        self._fold, self._fold_back = _Fold(lines), _Fold(lines)
        self._spectrum = _Spectrum(lines)
        self._sense = 0
        self._points = 0
        self._way = Range()

    def take(self, blocks: Iterable[tuple[IntArray, FloatArray, IntArray]]) -> None:
        """Take all points: number of the gating line, error in arcsec, sense of the motion.

        The values are those of the sense in which the motion began.
        """
        for places, delta in _regrouped(self._with_the_first(blocks)):
            self._points += len(places)
            self._way.add(places)
            self._waves.add(places, delta)
            self._fold.add(places, delta)
            self._spectrum.add(places, delta)

    def _with_the_first(
        self, blocks: Iterable[tuple[IntArray, FloatArray, IntArray]]
    ) -> Iterator[tuple[IntArray, FloatArray]]:
        for places, delta, sense in blocks:
            if not self._sense and len(sense):
                self._sense = int(sense[0])
            same = sense == self._sense
            yield places[same], delta[same]
            self._fold_back.add(places[sense == -self._sense], delta[sense == -self._sense])

    def values(self) -> Values | None:
        """Give what is told of the points so far; None where there are none."""
        if self._points == 0:
            return None
        return Values(
            points=self._points,
            turns=self._way.size / self._lines,
            total_arcsec=self._waves.total.size,
            tooth_to_tooth_arcsec=self._waves.tooth_to_tooth,
            long_wave_arcsec=self._waves.long_wave.size,
            short_wave_arcsec=self._waves.short_wave,
            tooth_pitch_turns=self._pitch_turns,
            drift_arcsec_per_turn=self._spectrum.drift(),
            trend_arcsec=self._spectrum.bend(),
            orders=self._spectrum.orders(),
            noise_arcsec=self._spectrum.noise(),
            curve=self._fold.curve(),
        )

    def backlash(self) -> Backlash | None:
        """Give what the error of the other sense has more; None where the motion had but one."""
        more = self._sense * (self._fold_back.mean() - self._fold.mean())
        more = more[np.isfinite(more)]
        if not len(more):
            return None
        return Backlash(float(more.mean()), float(more.min()), float(more.max()))


def _regrouped(
    blocks: Iterable[tuple[IntArray, FloatArray]],
) -> Iterator[tuple[IntArray, FloatArray]]:
    """Join small blocks and cut large ones, to `BLOCK_POINTS` each but the last."""
    held: list[tuple[IntArray, FloatArray]] = []
    count = 0
    for block in blocks:
        held.append(block)
        count += len(block[0])
        if count >= BLOCK_POINTS:
            places, delta = _joined(held)
            whole = count - count % BLOCK_POINTS
            for start in range(0, whole, BLOCK_POINTS):
                rows = slice(start, start + BLOCK_POINTS)
                yield places[rows], delta[rows]
            held, count = [(places[whole:], delta[whole:])], count - whole
    if count:
        yield _joined(held)


def _joined(held: Sequence[tuple[IntArray, FloatArray]]) -> tuple[IntArray, FloatArray]:
    return np.concatenate([p for p, _ in held]), np.concatenate([d for _, d in held])


class _Fold:
    """Mean, least and greatest error at each place of the output turn."""

    def __init__(self, lines: float) -> None:
        self._lines = lines
        self._first = (np.empty(0), np.empty(0))
        self._bins = bins = max(min(int(lines), MOST_BINS), 1)
        self._count, self._sum = np.zeros(bins), np.zeros(bins)
        self._low, self._high = np.full(bins, np.inf), np.full(bins, -np.inf)

    def add(self, places: IntArray, delta: FloatArray) -> None:
        if not len(self._first[0]):
            turns = (places - places[:1]) / self._lines
            self._first = (places[turns < 1.0] / self._lines % 1.0, delta[turns < 1.0])
        at = (places % self._lines * (self._bins / self._lines)).astype(np.int64)
        at = np.minimum(at, self._bins - 1)
        self._count += np.bincount(at, minlength=self._bins)
        self._sum += np.bincount(at, delta, minlength=self._bins)
        np.minimum.at(self._low, at, delta)
        np.maximum.at(self._high, at, delta)

    def mean(self) -> FloatArray:
        """Give the mean at each place, NaN where no point was."""
        none = np.full(self._bins, np.nan)
        return np.asarray(np.divide(self._sum, self._count, out=none, where=self._count > 0))

    def curve(self) -> Curve:
        seen = np.flatnonzero(self._count)
        mean = self._sum[seen] / self._count[seen]
        low, high = self._low[seen], self._high[seen]
        return Curve(seen / self._bins, mean, low, high, *self._first)


class _Spectrum:
    """Orders found in the first block; in the others their waves are followed."""

    def __init__(self, lines: float) -> None:
        self._lines = lines
        self._fits: list[Fit] = []
        self._middles: list[float] = []
        self._weights: list[int] = []

    def add(self, places: IntArray, delta: FloatArray) -> None:
        turns = places / self._lines
        with threadpool_limits(1):  # threads that wait for one another cost more than they bring
            if self._fits:
                fit = refit(turns, delta, self._fits[0].orders)
            else:
                fit = fit_orders(turns, delta, self._lines / grid_step(places))
        self._fits.append(fit)
        self._middles.append(float(turns.mean()))
        self._weights.append(len(places))

    def _kept(self) -> list[int]:
        least = LEAST_SHARE * self._weights[0]
        return [i for i, weight in enumerate(self._weights) if weight >= least]

    def orders(self) -> list[Order]:
        """Give the orders, refined by how their phases advance from block to block."""
        kept = self._kept()
        first = self._fits[0]
        if len(kept) < 2:
            return first.sorted_orders()
        waves = np.array([self._fits[i].waves for i in kept])
        middles = np.array([self._middles[i] for i in kept])
        phases = np.unwrap(np.angle(waves), axis=0)
        steps = np.polyfit(middles, phases, 1)[0] / (2.0 * np.pi)
        turned = waves * np.exp(-2j * np.pi * np.outer(middles, steps))
        mean = replace(first, orders=first.orders + steps, waves=turned.mean(axis=0))
        return mean.sorted_orders()

    def drift(self) -> float:
        """Give the drift over the whole train in arcsec per turn."""
        kept = self._kept()
        if len(kept) < 2:
            return self._fits[0].drift_arcsec_per_turn
        middles = np.array([self._middles[i] for i in kept])
        fits = [self._fits[i] for i in kept]
        levels = [fit.trend(middle) for fit, middle in zip(fits, middles, strict=True)]
        return float(np.polyfit(middles, levels, 1)[0])

    def bend(self) -> float:
        """Give the trend of samples of less than a turn."""
        return self._fits[0].bend_arcsec if len(self._fits) == 1 else 0.0

    def noise(self) -> float:
        """Give the root mean square of what the fits leave."""
        squares = [fit.noise_arcsec**2 for fit in self._fits]
        return float(np.sqrt(np.average(squares, weights=self._weights)))
