"""The wait of an edge for the scan, as a part of the law of its latch."""

from functools import lru_cache

import numpy as np
import scipy

from skiplatch.diagnosis.density.change import Change, Wait, together
from skiplatch.diagnosis.density.law import Extra
from skiplatch.diagnosis.scene.scene import Scene

SHORTEST_PERIOD = 0.1
"""Of the believed one."""
TURNS = np.array([-1.0, 0.0, 1.0])
LEAST_PART = 1e-3
"""Of a law folded onto a turn, that counts."""
INSIDE = 3.0
"""Standard deviations from both ends of the turn that leave nothing to fold."""


def scan_period_us(scene: Scene, change: Change) -> float:
    """Give the changed scan period, within what is a scan period still."""
    believed = scene.nominal.plc.scan_us
    return max(believed + change.period_us, SHORTEST_PERIOD * believed)


def other_waits(scene: Scene, change: Change) -> tuple[Extra, ...]:
    """Touches that do not fall evenly into a period before their scan, as extras without its box.

    They wait about a value, if they are locked to the scans, or fall into a longer or shorter gap.
    """
    wait, period = change.wait, scan_period_us(scene, change)
    anywhere = 1.0 if wait is None else wait.unlocked
    gaps = tuple(
        Extra(anywhere * share, width=length * period, boxless=1.0) for share, length in change.gaps
    )
    if wait is None:
        return gaps
    # The edges are locked to the grid, on which a scan may be late.
    locked, late = _locked(wait, period), change.lattice_extra
    in_time = 1.0 - sum(extra.share for extra in late)
    punctual = (extra.with_share(extra.share * in_time) for extra in locked if in_time > 0.0)
    return (*punctual, *together(locked, late), *gaps)


def _locked(wait: Wait, period: float) -> tuple[Extra, ...]:
    return tuple(
        Extra(
            (1.0 - wait.unlocked) * there * share,
            offset=mean * period,
            sigma=sigma * period,
            boxless=1.0,
        )
        for centre, there in wait.points
        for share, mean, sigma in _wrapped(centre, wait.spread)
    )


@lru_cache(maxsize=64)
def _wrapped(centre: float, spread: float) -> list[tuple[float, float, float]]:
    """Fold a normal law onto one turn: shares, means and standard deviations of its parts."""
    if INSIDE * spread <= centre <= 1.0 - INSIDE * spread:
        return [(1.0, centre, spread)]
    low, high = ((end - centre - TURNS) / spread for end in (0.0, 1.0))
    shares = scipy.special.ndtr(high) - scipy.special.ndtr(low)
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
