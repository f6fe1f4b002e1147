"""What the parameters of an effect make of the scans: surrogates, as those beside them."""

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.surrogates import (
    HALF_WAY,
    LOOSEST,
    Parameters,
    as_part,
    as_share,
)
from skiplatch.diagnosis.density.change import MOST_GAPS, Change, Gaps, Wait
from skiplatch.diagnosis.density.law import Extra
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import parameter_of

MOST_SCANS_OLD = 7.0
MOST_PUNCTUAL = 0.95
TIGHTEST = 1e-3
"""Spread of edges about a point of the scan, as a share of the period."""
SPAN_PARTS = 5
"""Boxes that stand for late scans of lengths that differ by more than a period."""
FEW_TICKS = 4.0
"""By which stamps of scans on time may be off their grid."""
LENGTHS = 5
"""Boxes that stand for gaps between scans of lengths that differ."""
CHANCE, EVEN, FALLING = (np.random.default_rng(1).random((3, 1024)).argsort(axis=1) + 0.5) / 1024
"""Scans in a row, as late as by chance: evenly spread numbers from 0 to 1, mixed."""


def image_delay(scene: Scene, p: Parameters) -> Change:
    """The image is whole scans old, or one more for a share of the touches."""
    period_us = scene.nominal.plc.scan_us
    whole, part = divmod(min(abs(p[0]), MOST_SCANS_OLD), 1.0)
    older = (Extra(part, offset=period_us),) if part else ()
    return Change(plc_us=float(whole) * period_us, scan_extra=older)


def overrun(scene: Scene, p: Parameters) -> Change:
    """The grid shows a late scan by its lateness; an edge waits for it from the scan before on.

    Where scans are left out until then, it is on the grid as any other.
    """
    share, late, span = as_part(p[0]), _admitted("overrun_us", p[1]), _admitted("span_us", p[2])
    period = scene.nominal.plc.scan_us
    if p[3] > HALF_WAY:
        ratios, weights = _whole_gaps(late / period, span / period)
        begins, width = np.zeros(0), 0.0
    else:
        parts = SPAN_PARTS if span > period else 1  # the later of such scans, the more edges meet
        begins, width = late + span * np.arange(parts) / parts, span / parts
        ratios, weights = (begins + width / 2.0) / period, np.full(parts, 1.0 / parts)
    ratio = float(weights @ ratios)
    # The gap before a late scan is longer and the one behind it shorter, unless that is late too.
    alone = share * (1.0 - share)
    is_apart = ratio < 1.0
    met = share + alone * ratio if is_apart else 1.0 - (1.0 - share) ** (1.0 + ratio)
    longer = alone * (1.0 + ratio) if is_apart else met
    parts_met = weights * (1.0 + ratios) / (1.0 + ratio)
    return Change(
        lattice_extra=tuple(
            Extra(met * part, offset=_left_out(scene, begin), width=width)
            for part, begin in zip(parts_met.tolist(), begins.tolist(), strict=False)
        ),
        gaps=_shown(
            *zip((longer * parts_met).tolist(), (1.0 + ratios).tolist(), strict=True),
            (alone * max(0.0, 1.0 - ratio), 1.0 - ratio),
        ),
    )


def _admitted(name: str, value: float) -> float:
    """Keep a lateness of scans within its range, for its scans are counted one by one."""
    return min(abs(value), parameter_of("scan_overrun", name).high)


def _whole_gaps(late: float, span: float) -> tuple[FloatArray, FloatArray]:
    """Give by how many whole periods scans are late, from so many on, and with what shares."""
    span = max(span, TIGHTEST)
    number = np.arange(np.floor(late), np.ceil(late + span)) + 1.0
    shares = np.minimum(number, late + span) - np.maximum(number - 1.0, late)
    parts = list(zip(*(np.array_split(v, MOST_GAPS) for v in (number, shares)), strict=True))
    means = [(float(n @ s / s.sum()), float(s.sum() / span)) for n, s in parts if s.any()]
    ratios, weights = np.array(means).T
    return ratios, weights


def _left_out(scene: Scene, late_us: float) -> float:
    """Give the lateness of a scan on the grid: none where it is late by whole periods.

    A few ticks less would be the same as early, which no late scan is.
    """
    period = scene.nominal.plc.scan_us
    whole = np.rint(late_us / period) * period
    is_left_out = whole > 0.0 and abs(late_us - whole) < FEW_TICKS * scene.nominal.skip.tick_us
    return float(whole) if is_left_out else late_us


def _shown(*gaps: tuple[float, float]) -> Gaps:
    return tuple((share, length) for share, length in gaps if share > 0.0)


def jitter(scene: Scene, p: Parameters) -> Change:
    """Scans begin late, each by a time of its own, and so the gaps between them differ."""
    span, tail, punctual = abs(p[0]), abs(p[1]), min(as_share(p[2]), MOST_PUNCTUAL)
    late_us = np.where(punctual > CHANCE, 0.0, span * EVEN - tail * np.log1p(-FALLING))
    return Change(
        lattice_extra=(Extra(1.0 - punctual, width=span, mean=tail),),
        gaps=_lengths(scene, late_us),
    )


def _lengths(scene: Scene, late_us: FloatArray) -> Gaps:
    """Give what shares of edges meet gaps of what length, in periods, between scans so late.

    The lengths are means of a few parts, each of which meets about as many edges as any other.
    """
    period = scene.nominal.plc.scan_us
    begins = np.maximum.accumulate(np.arange(len(late_us)) * period + late_us)  # held up, too
    lengths = np.sort(np.diff(begins)) / period
    met = np.cumsum(lengths) - lengths / 2.0
    parts = (LENGTHS * met / lengths.sum()).astype(np.intp)
    totals, counts = np.bincount(parts, lengths), np.bincount(parts)
    return tuple(
        (float(total / lengths.sum()), float(total / count))
        for total, count in zip(totals, counts, strict=True)
        if total > 0.0
    )


def locked(_: Scene, p: Parameters) -> Change:
    """Edges fall about a point of the scan, some of them about a second one."""
    second = as_share(p[4])
    first = -p[0] % 1.0
    points = ((first, 1.0 - second), ((first - p[3]) % 1.0, second))
    spread = float(np.clip(abs(p[1]), TIGHTEST, LOOSEST))
    there = tuple((wait, share) for wait, share in points if share > 0.0)
    return Change(wait=Wait(there, spread, as_share(p[2])))
