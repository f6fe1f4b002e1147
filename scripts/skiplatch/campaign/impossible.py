"""What no rig can have done: a move that has no time, a shop that no one could work in."""

import re
from collections.abc import Iterator

import numpy as np

from skiplatch.arrays import BoolArray
from skiplatch.campaign.folder import Campaign
from skiplatch.campaign.kind import Kind
from skiplatch.campaign.oddity import Oddity, serials
from skiplatch.campaign.steps import common_step
from skiplatch.campaign.touches import Touches
from skiplatch.units import ARCSEC_PER_DEG, S_PER_MIN, UM_PER_MM

SHOP_C = (-20.0, 60.0)
"""Temperatures of a machine that people stand beside; greases and probes are made for no others."""
_HEATED = re.compile(r"bed|extruder|nozzle|hot_?end|heater", re.IGNORECASE)
"""In the name of a thermometer: a part of a printer that is hotter than any shop."""
KELVIN = 273.15
SPARE = 0.1  # share by which a surface may be nearer, or a feed faster, than it is told
SPARE_OF_ONE = 0.05  # the same of a single move, after which the axis comes back as well
MOST_OVERLAP = 0.5  # share of moves from which on all of them are odd
_OF_A_MOVE = {"feed_mm_min", "approach_mm", "time_s"}
FEWEST = 5
COMES_BACK = 3.0  # touches for each different number, on average


def moves_without_time(campaign: Campaign) -> Iterator[Oddity]:
    """A move is over before the next one begins, so all moves take less than the campaign did.

    On a bench nothing moves. Times and ways that only stand in for others tell nothing.
    """
    touches = campaign.touches
    if campaign.nominal.kind is Kind.BENCH or campaign.stood_in & _OF_A_MOVE:
        return
    takes_s = touches.approach_mm / (touches.feed_mm_min / S_PER_MIN)
    known = np.isfinite(takes_s) & np.isfinite(touches.time_s)
    moves_s = had_s = 0.0
    for session in np.unique(touches.session[known]):
        rows = known & (touches.session == session)
        begins_s, first = np.unique(touches.time_s[rows], return_index=True)  # one edge, two paths
        moves_s += float(takes_s[rows][first][:-1].sum())
        had_s += float(np.ptp(begins_s))
    if moves_s * (1.0 - SPARE) > had_s > 0.0:
        yield Oddity(
            f"the moves take {moves_s:.3g} s by feed_mm_min and approach_mm, and time_s leaves "
            f"{had_s:.3g} s for them: another unit?"
        )


def moves_that_overlap(campaign: Campaign) -> Iterator[Oddity]:
    """A move begins when the one before it is over; of most moves `moves_without_time` tells."""
    if campaign.nominal.kind is Kind.BENCH or campaign.stood_in & _OF_A_MOVE:
        return
    touches = campaign.touches.in_order_of_time()
    takes_s = touches.approach_mm / (touches.feed_mm_min / S_PER_MIN)
    had_s = np.diff(touches.time_s)
    early = (had_s > 0.0) & (had_s < (1.0 - SPARE_OF_ONE) * takes_s[:-1])
    early &= np.diff(touches.session) == 0
    if early.any() and early.mean() <= MOST_OVERLAP:
        what = "time_s lies before the end of the move before, by feed_mm_min and approach_mm"
        yield Oddity(what, serials(touches, np.append(False, early)))


def temperatures(campaign: Campaign) -> Iterator[Oddity]:
    """Of the machine, unless a heated part stands for it; one elsewhere may be such a part."""
    temp_c, (low, high) = campaign.touches.temp_c, SHOP_C
    odd = (temp_c < low) | (temp_c > high)
    if not odd.any() or _is_of_a_heated_part(campaign.touches):
        return
    is_kelvin = bool(((temp_c[odd] >= low + KELVIN) & (temp_c[odd] <= high + KELVIN)).all())
    unit = ": kelvin?" if is_kelvin else ""
    what = f"temp_c is not from {low:g} to {high:g} °C, as in a shop{unit}"
    yield Oddity(what, serials(campaign.touches, odd))


def _is_of_a_heated_part(touches: Touches) -> bool:
    """Tell whether temp_c is one of the named thermometers, by its name that of a bed or nozzle."""
    return any(
        bool(_HEATED.search(name)) and np.array_equal(touches.temp_c, values, equal_nan=True)
        for name, values in touches.thermometers.items()
    )


def places_beyond_reach(campaign: Campaign) -> Iterator[Oddity]:
    """A surface was touched, so the axis did get there."""
    axis, touches = campaign.nominal.axis, campaign.touches
    beyond = (touches.position_mm < axis.min_mm) | (touches.position_mm > axis.max_mm)
    if beyond.any():
        what = "position_mm is not from axis.min_mm to axis.max_mm"
        yield Oddity(what, serials(touches, beyond))


def latches_before_the_move(campaign: Campaign) -> Iterator[Oddity]:
    """A touch cannot be latched farther from the surface than where it began."""
    early = before_the_move(campaign.touches)
    if early.any():
        what = "deviation_um lies before the start of the move, approach_mm from the surface"
        yield Oddity(what, serials(campaign.touches, early))


def before_the_move(touches: Touches) -> BoolArray:
    """Tell which touches, shape (n,), are latched before the start of their move."""
    return np.asarray(-touches.deviation_um > touches.approach_mm * UM_PER_MM)


def ways_of_axes(campaign: Campaign) -> Iterator[Oddity]:
    """An axis either moves or turns; of one that turns a µm is 0.001°, where both are given."""
    touches = campaign.touches
    um, arcsec = touches.deviation_um, touches.deviation_arcsec
    moves = ~touches.turns & np.isfinite(arcsec)
    if moves.any():
        yield Oddity("deviation_arcsec of an axis that does not turn", serials(touches, moves))
    in_arcsec = um / UM_PER_MM * ARCSEC_PER_DEG
    step_arcsec = campaign.nominal.axis.resolution_um / UM_PER_MM * ARCSEC_PER_DEG
    differ = np.abs(in_arcsec - arcsec) > np.maximum(step_arcsec, SPARE * np.abs(arcsec))
    if (touches.turns & differ).any():
        what = "deviation_arcsec is not deviation_um at 0.001° for 1 µm: of which is it?"
        yield Oddity(what, serials(touches, touches.turns & differ))


def swapped_columns(campaign: Campaign) -> Iterator[Oddity]:
    """A place is chosen and comes back to the digit; what is measured there scatters, by less.

    What a coarse encoder measures comes back as well.
    """
    touches, resolution_um = campaign.touches, campaign.nominal.axis.resolution_um
    known = np.isfinite(touches.position_mm) & np.isfinite(touches.deviation_um)
    if known.sum() < FEWEST or not _comes_back(touches, "deviation_um", known):
        return
    step = common_step(touches.deviation_um)
    is_encoder = step is not None and step <= resolution_um * (1.0 + SPARE)
    places_mm, off_um = touches.position_mm[known], touches.deviation_um[known]
    is_finer = np.ptp(places_mm) < np.ptp(off_um)
    if not is_encoder and is_finer and len(np.unique(places_mm)) > known.sum() / 2.0:
        what = "deviation_um comes back to the digit, and position_mm scatters: swapped columns?"
        yield Oddity(what)


def _comes_back(touches: Touches, name: str, known: BoolArray) -> bool:
    """Tell whether there are several different numbers, each of them several times."""
    _, counts = np.unique(getattr(touches, name)[known], return_counts=True)
    return len(counts) > 1 and bool(known.sum() >= COMES_BACK * len(counts) and counts.min() > 1)
