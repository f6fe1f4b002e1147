"""How plain a gap is: by how many nats the truth beats the unchanged chain, from sealed plays.

An estimate to sort campaigns by, not a likelihood. The residuals are taken apart first, so that
nothing counts twice: contact to latch, stamps off the grid of the scans, latch to position, latch
to report; without time stamps all there is is the deviation. In every cell of path and feed the
plays of a residual are pooled into a histogram, on a scale that is linear near zero and logarithmic
in the tails, about the mean of their touch. A touch gains the logarithm of the
ratio of both densities. Lost touches count by their shares.
"""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from tests.withheld.chain import BoolArray, FloatArray
from tests.withheld.sealed import HeldBack
from tests.withheld.streams import cells

STEP = 0.1  # of the histogram, on its scale
WIDEST = 20.0
SMOOTHED = 1.5  # steps
LINEAR = 0.3  # of a spread: up to there the histogram's scale is linear
ANYWHERE = 1e-3  # share of touches that may lie anywhere, so that none costs too much
WAITING = ("latch", "deviation")  # residuals with the PLC's wait for its scan in them
PLAIN, FAINT = 30.0, 10.0
"""Above the one an effect is well above the noise; between both it is faint. By chance a campaign
without any effect comes to some nats, seldom to 20."""


def nats(held_back: HeldBack, touches: int, rng: np.random.Generator) -> float:
    """Estimate what the truth gains in a campaign of so many touches as were recorded."""
    truth, spreads = held_back.truth, held_back.expected.spreads
    sealed = (
        (held_back.oracle, held_back.unchanged)
        if "latch" in held_back.recorded
        else (held_back.oracle_any_phase, held_back.unchanged_any_phase)
    )
    oracle, unchanged = (held_back.of(plays, rng) for plays in sealed)
    gain = 0.0
    for rows in cells(held_back.touches):
        plc = bool(held_back.expected.plc[rows].all())
        gain += _lost(held_back, rows)
        for stream in _apart(held_back, plc=plc):
            unit = spreads[stream][rows]
            gain += _gain(
                truth[stream][rows] / unit,
                oracle[stream][:, rows] / unit,
                unchanged[stream][:, rows] / unit,
                in_cells=plc and stream in WAITING,
            )
    return gain * touches / len(held_back.touches)


def _apart(held_back: HeldBack, *, plc: bool) -> tuple[str, ...]:
    """Name the residuals that were recorded and do not follow on each other."""
    if "latch" not in held_back.recorded:
        return ("deviation",)
    on_grid = ("grid",) if plc else ()
    return tuple(s for s in held_back.recorded if s != "deviation") + on_grid


def _gain(truth: FloatArray, oracle: FloatArray, unchanged: FloatArray, *, in_cells: bool) -> float:
    """Gain of touches, shape (n,), given plays, shape (replicates, n), in units of the spread.

    Args:
        truth: What came true.
        oracle: Plays of the truth.
        unchanged: Plays of the unchanged chain.
        in_cells: The plays know the phase of the scans and nobody else does, so that the mean of a
            touch must not be used, only the distribution over the touches.
    """
    seen = ~np.isnan(truth) & (~np.isnan(oracle)).any(axis=0)
    if not seen.any():
        return 0.0
    truth, oracle, unchanged = truth[seen], oracle[:, seen], unchanged[:, seen]
    logs = []
    for plays in (oracle, unchanged):
        middle = 0.0 if in_cells else _middles(plays)
        logs.append(_log_density(truth - middle, plays - middle))
    return float(np.sum(logs[0] - logs[1]))


def _middles(plays: FloatArray) -> FloatArray:
    """Estimate the mean of each touch without its tails, shape (n,).

    What the few plays leave uncertain is drawn towards the mean of the cell (James and Stein).
    """
    limited = np.clip(plays, *np.nanquantile(plays, [0.2, 0.8], axis=0))
    means = np.nanmean(limited, axis=0)
    error = float(np.mean(np.nanvar(plays, axis=0))) / len(plays)
    own = float(np.mean((means - means.mean()) ** 2))
    keep = max(0.0, 1.0 - error / own) if own > 0.0 else 0.0
    return np.asarray(means.mean() + keep * (means - means.mean()))


def _log_density(truth: FloatArray, plays: FloatArray) -> FloatArray:
    """Log density of each touch, shape (n,), in the distribution of all plays."""
    at, jacobian = _bin(truth)
    counts = np.bincount(_bin(plays[~np.isnan(plays)])[0], minlength=2 * round(WIDEST / STEP) + 1)
    share = gaussian_filter1d(counts.astype(float), SMOOTHED) / max(counts.sum(), 1)
    share = (1 - ANYWHERE) * share + ANYWHERE / len(share)
    return np.asarray(np.log(share[at]) + jacobian)


def _bin(off: FloatArray) -> tuple[np.typing.NDArray[np.intp], FloatArray]:
    """Place distances, shape (n,), in the histogram; with the log of what its scale stretches."""
    place = np.clip(np.arcsinh(off / LINEAR), -WIDEST, WIDEST)
    return np.rint((place + WIDEST) / STEP).astype(np.intp), -0.5 * np.log(LINEAR**2 + off**2)


def _lost(held_back: HeldBack, rows: BoolArray) -> float:
    """Gain by knowing how many touches are lost."""
    lost = np.isnan(held_back.touches.deviation_um[rows])
    log_ratio = np.log(_shares_lost(held_back.oracle.deviation_um[:, rows], len(lost)))
    log_ratio -= np.log(_shares_lost(held_back.unchanged.deviation_um[:, rows], len(lost)))
    return float(log_ratio @ np.array([np.sum(lost), np.sum(~lost)]))


def _shares_lost(plays: FloatArray, touches: int) -> FloatArray:
    """Give the shares of touches that are lost and that are not; neither is ever 0."""
    share = np.clip(np.isnan(plays).mean(), 0.01 / (touches + 1), 1 - 0.01 / (touches + 1))
    return np.array([share, 1 - share])
