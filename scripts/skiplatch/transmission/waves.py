"""Ranges of a transmission error: of the whole train, and its waves by the tooth pitch."""

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray

IntArray = NDArray[np.int64]


def grid_step(places: IntArray) -> int:
    """Give the distance of the places that points can have: 1, or more where trains are divided."""
    return int(np.gcd.reduce(np.diff(places))) or 1 if len(places) > 1 else 1


class Range:
    """Least and greatest value so far."""

    def __init__(self) -> None:
        self._low, self._high = np.inf, -np.inf

    def add(self, values: FloatArray | IntArray) -> None:
        """Take in values, shape (n,)."""
        if len(values):
            self._low = min(self._low, float(values.min()))
            self._high = max(self._high, float(values.max()))

    @property
    def size(self) -> float:
        """Greatest less least; 0 of none."""
        return max(self._high - self._low, 0.0)


class Waves:
    """Ranges over the train and over any one tooth pitch; the seam between blocks counts too."""

    def __init__(self, pitch_places: float) -> None:
        self._pitch_places = pitch_places
        self._pitch = 0  # in points
        self._tail = np.empty(0)
        self.total, self.long_wave = Range(), Range()
        self.tooth_to_tooth = self.short_wave = 0.0

    def add(self, places: IntArray, delta: FloatArray) -> None:
        """Take in the next block: places and errors, shape (n,)."""
        self._pitch = self._pitch or max(round(self._pitch_places / grid_step(places)), 2)
        self.total.add(delta)
        joined = np.concatenate([self._tail, delta])
        self._tail = joined[-3 * self._pitch :]
        self.tooth_to_tooth = max(self.tooth_to_tooth, _within(joined, self._pitch))
        if len(joined) >= 3 * self._pitch:
            mean = scipy.ndimage.uniform_filter1d(joined, self._pitch)
            inner = slice(self._pitch, len(joined) - self._pitch)  # where the mean has all points
            self.long_wave.add(mean[inner])
            self.short_wave = max(self.short_wave, _within((joined - mean)[inner], self._pitch))


def _within(values: FloatArray, width: int) -> float:
    """Give the largest range of so many neighbours."""
    highest = scipy.ndimage.maximum_filter1d(values, width)
    lowest = scipy.ndimage.minimum_filter1d(values, width)
    return float((highest - lowest).max(initial=0.0))
