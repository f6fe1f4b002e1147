"""Readings so far off that a probe, an axis or the surface must have changed between them."""

import re
from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign.columns import InputPath
from skiplatch.campaign.folder import Campaign
from skiplatch.campaign.impossible import before_the_move
from skiplatch.campaign.kind import Kind
from skiplatch.campaign.oddity import Oddity, serials
from skiplatch.campaign.touches import Touches
from skiplatch.units import S_PER_MIN, UM_PER_MM, US_PER_S

FAR_MM = 0.5
"""Farther from the others no probe latches that works: it slipped, or the axis lost steps."""
A_PAIR = 2
FEWEST = 3  # touches that make a surface of what was met elsewhere
MOST_TOLD = 10  # surfaces at one place; more are no slips of a probe, but what was touched
_PART = re.compile(r"^(?P<place>.* at .*?)(?: #\d+)?$")
"""How an importer names surfaces at one place: the first by the place, others by a number too."""


def far_from_the_others(campaign: Campaign) -> Iterator[Oddity]:
    """Touches of one surface are near to their middle, but for the way that a late latch takes.

    Those before the start of their move are told by that.
    """
    touches = campaign.touches
    if campaign.nominal.kind is Kind.BENCH:
        return
    far = np.zeros(len(touches), dtype=bool)
    near_um = (FAR_MM + _late_mm(campaign)) * UM_PER_MM
    sign = np.nan_to_num(touches.sign)
    known = np.isfinite(touches.deviation_um) & ~before_the_move(touches)
    kinds = np.column_stack([touches.session, touches.axis, sign, touches.path])
    for kind in np.unique(kinds, axis=0):
        rows = (kinds == kind).all(axis=1) & known
        if rows.any():
            middle = np.quantile(touches.deviation_um[rows], 0.5, method="lower")
            here = rows & (np.abs(touches.deviation_um - middle) > near_um)
            far |= rows if here.any() and rows.sum() == A_PAIR else here  # nobody knows which
    if far.any():
        what = f"deviation_um lies more than {FAR_MM:g} mm from the others of its surface"
        yield Oddity(f"{what}: lost steps, a loose probe?", serials(touches, far))


def _late_mm(campaign: Campaign) -> FloatArray:
    """Give the way that touches, shape (n,), go at most until they are latched, as believed."""
    nominal, touches = campaign.nominal, campaign.touches
    scans_us = np.where(touches.path == InputPath.PLC, nominal.plc.scan_us, 0.0)
    late_s = (nominal.probe.delay_us + nominal.input.filter_us + scans_us) / US_PER_S
    return np.asarray(np.nan_to_num(touches.feed_mm_min) / S_PER_MIN * late_s)


def surfaces_apart(touches: Touches) -> Iterator[Oddity]:
    """What was met far from the surface at its place may be a fault rather than a surface."""
    places: dict[str, dict[int, int]] = defaultdict(dict)
    for number, name in enumerate(touches.session_names):
        if match := _PART.match(name):
            places[match["place"]][number] = int((touches.session == number).sum())
    for place, parts in places.items():
        most = max(parts, key=lambda number: parts[number])
        odd = [n for n in parts if n != most and parts[n] < FEWEST]
        if len(odd) > MOST_TOLD:
            what = f"met {len(odd)} other surfaces at the same place ({place}), each fewer than "
            what += f"{FEWEST} times: it moved, or nothing tells these places apart"
            yield Oddity(what, serials(touches, np.isin(touches.session, odd)))
            continue
        for number in odd:
            way = _position_mm(touches, number) - _position_mm(touches, most)
            what = f"met something {abs(way):.3g} mm away at the same place ({place})"
            rows = touches.session == number
            yield Oddity(f"{what}: taken for another surface", serials(touches, rows))


def _position_mm(touches: Touches, session: int) -> float:
    return float(touches.position_mm[touches.session == session][0])
