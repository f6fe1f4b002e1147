"""Which parameter of which effect has changed, from the intervals of the diagnoses."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from skiplatch.fleet.history import Entry, Parameter
from skiplatch.statistics import CONFIDENCE, Interval

QUANTILE = float(scipy.special.ndtri((1.0 + CONFIDENCE) / 2.0))
CLEAR = 4.0
"""Standard errors from which on a parameter has changed: one in 16,000 by chance, of some fifty."""


@dataclass(frozen=True, slots=True)
class Growth:
    """A parameter before and after a change, with 95 % intervals, in the parameter's unit.

    An effect that a diagnosis does not name counts as 0 there. `turned` is as `Parameter` has it.
    """

    effect: str
    stage: str
    parameter: str
    before: Interval
    after: Interval
    turned: str = ""


def grown(before: Sequence[Entry], after: Sequence[Entry]) -> Growth | None:
    """Give the parameter that has changed most, in standard errors; None if none has clearly."""
    known = {found.key: found for entry in (*before, *after) for found in entry.parameters}
    best, largest = None, CLEAR
    for found in known.values():
        old, new = (_mean(found, entries) for entries in (before, after))
        error = math.hypot(_error(old), _error(new))
        ratio = abs(new.value - old.value) / error if error else 0.0
        if ratio > largest:
            best = Growth(found.effect, found.stage, found.name, old, new, found.turned)
            largest = ratio
    return best


def _mean(parameter: Parameter, entries: Sequence[Entry]) -> Interval:
    """Give the mean over campaigns, with the scatter between them and the error of each."""
    found = [_of(parameter, entry) for entry in entries]
    values = np.array([one.value if one else 0.0 for one in found])
    errors = np.array([(one.high - one.low) / (2.0 * QUANTILE) if one else 0.0 for one in found])
    scatter = float(np.var(values, ddof=1)) if len(values) > 1 else 0.0
    half = QUANTILE * math.sqrt(max(scatter, float(np.mean(errors**2))) / len(values))
    middle = float(np.mean(values))
    return Interval(middle, middle - half, middle + half)


def _of(parameter: Parameter, entry: Entry) -> Parameter | None:
    return next((one for one in entry.parameters if one.key == parameter.key), None)


def _error(interval: Interval) -> float:
    return (interval.high - interval.low) / (2.0 * QUANTILE)
