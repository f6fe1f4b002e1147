"""Recorded touches made fit to be played: stand-ins for conditions that were not recorded.

A stand-in is put only where what is left to look at does not depend on it; what does depend on it
is emptied. Of a rotary axis a degree counts as a millimetre.
"""

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import (
    COLUMNS,
    NOMINAL_FILE,
    TOUCHES_FILE,
    Axis,
    Campaign,
    Kind,
    Nominal,
    Touches,
    fingerprint,
)
from skiplatch.campaign.missing import warn_missing
from skiplatch.campaign.nominal import InputNominal, ProbeNominal, SkipNominal
from skiplatch.campaign.touches import last_known
from skiplatch.errors import CampaignWarning, InputError, quoted
from skiplatch.motion import expected_contact
from skiplatch.simulator.effects import Effect, effects
from skiplatch.simulator.rig import MOST_EFFECTS, Controller, with_believed
from skiplatch.units import ARCSEC_PER_MILLIDEGREE, S_PER_MIN, US_PER_S

FEED_MM_MIN = 60.0
BEYOND_THE_RAMP_MM = {Kind.MACHINE: 1.0, Kind.BENCH: 0.01}  # a bench may begin with an edge
NEAREST_MM = 1.0
"""From which any touch of a machine begins: a longer ramp may not be over, nobody knows."""
BETWEEN_TOUCHES_S = 1.0
DURATION_US = (0.0, 1e9)
LENGTH = (0.0, 10_000.0)  # mm or µm
PLACE = (-LENGTH[1], LENGTH[1])
PLAYED = {
    ("plc", "scan_us"): (100.0, 20_000.0),  # the firmware's scans
    ("skip", "tick_us"): (0.001, 1000.0),
    ("probe", "pretravel_um"): PLACE,
    ("probe", "lobe_um"): PLACE,
    ("probe", "repeatability_um"): LENGTH,
    ("probe", "delay_us"): DURATION_US,
    ("input", "filter_us"): DURATION_US,
    ("skip", "latency_us"): DURATION_US,
    ("skip", "jitter_us"): DURATION_US,
    ("axis", "resolution_um"): (1e-4, 1e4),
    ("axis", "accel_mm_s2"): (1e-3, 1e6),
    ("report", "latency_us"): DURATION_US,
    ("report", "jitter_us"): DURATION_US,
    ("bench", "reference_jitter_us"): DURATION_US,
}
"""What the simulator takes of nominal.toml: is_chain() of host_sim/api/batch.c."""
OF_A_READING = {("probe", "repeatability_um"), ("axis", "resolution_um")}
"""What is uncertain where an instrument reads an axis at rest."""
STAMPS = ("edge_us", "latch_us", "report_us")
PLAYED_TOUCHES = {"time_s": (0.0, 8.64e6), "feed_mm_min": (1e-3, 1e6), "approach_mm": (1e-6, 1e4)}
"""And of a touch: is_touch() there."""
STAMPED_US = (-8.64e12, 8.64e12)
"""What a stamp may be beside such times: on a clock 100 days away, nothing is told by it."""


def refuse_unplayable(path: Path, nominal: Nominal, besides: Sequence[Effect] = ()) -> None:
    """Raise InputError for all that was read from `path` and cannot be simulated.

    Args:
        path: Of nominal.toml, or of a diagnosis.
        nominal: The rig, with the effects that it is believed to have.
        besides: Effects that act, too.
    """
    errors: list[InputError] = []
    for (section, name), limits in PLAYED.items():
        errors += _beyond(path, f"{section}.{name}", nominal.number(section, name), limits)
    switched_on = with_believed(nominal, besides)
    if len(switched_on) > MOST_EFFECTS:
        message = f"expected at most {MOST_EFFECTS}, got {len(switched_on)}"
        errors.append(InputError(path, None, "effect", message))
    for effect in switched_on:
        errors += _unknown(path, effect)
    if errors:
        raise InputError.together(errors)


def refuse_unplayable_touches(path: Path, touches: Touches) -> None:
    """Raise InputError for conditions of touches, read from `path`, that cannot be simulated.

    Of each column the first one is told.
    """
    errors: list[InputError] = []
    for name, (least, most) in {**PLAYED_TOUCHES, **dict.fromkeys(STAMPS, STAMPED_US)}.items():
        values = getattr(touches, name)
        beyond = np.flatnonzero((values < least) | (values > most))
        if len(beyond):
            first = int(beyond[0])
            where = f"{name} of touch {touches.touch[first]}"
            errors += _beyond(path, where, float(values[first]), (least, most))
    if errors:
        raise InputError.together(errors)


def refuse_endless_move(path: Path, nominal: Nominal, touches: Touches) -> None:
    """Raise InputError for a rig, read from `path`, that comes to no stop within what is played."""
    beyond_mm = Controller.for_campaign(nominal, touches).overtravel_mm
    if beyond_mm > LENGTH[1]:
        fastest = (
            f"from {np.max(touches.feed_mm_min):g} mm/min it may stop after {beyond_mm:.3g} mm"
        )
        expected = f"expected so much that a move ends within {LENGTH[1]:g} mm of the surface"
        raise InputError(path, None, "axis.accel_mm_s2", f"{expected}; {fastest}")


def _beyond(
    path: Path, where: str, value: float, limits: tuple[float, float]
) -> Iterator[InputError]:
    least, most = limits
    if not least <= value <= most:
        expected = f"expected {least:g} to {most:g}, which is what can be simulated"
        yield InputError(path, None, where, f"{expected}, got {value:g}")


def _unknown(path: Path, effect: Effect) -> Iterator[InputError]:
    """Give what the simulator does not have: an effect, parameters or values."""
    if effect.id not in effects():
        yield InputError(path, None, "effect.id", f"no effect is called {quoted(effect.id)}")
        return
    parameters = {parameter.name: parameter for parameter in effects()[effect.id].parameters}
    for name, value in effect.parameters.items():
        column = f"effect.{effect.id}.{name}"
        if name not in parameters:
            known = ", ".join(parameters)
            yield InputError(path, None, column, f"no such parameter; there are {known}")
            continue
        known_as = parameters[name]
        if not known_as.low <= value <= known_as.high:
            expected = f"expected {known_as.low:g} to {known_as.high:g}, got {value:g}"
            yield InputError(path, None, column, expected)


def playable(campaign: Campaign) -> Campaign:
    """Give the campaign with stand-ins; warns of each column that has one.

    Raises:
        InputError: The feed is missing on a machine: every outcome depends on it. Or a figure
            cannot be simulated.
    """
    refuse_unplayable(campaign.path / NOMINAL_FILE, campaign.nominal)
    refuse_unplayable_touches(campaign.path / TOUCHES_FILE, campaign.touches)
    touches = _as_linear(campaign.touches)
    no_feed, no_way = np.isnan(touches.feed_mm_min), np.isnan(touches.approach_mm)
    no_time, at_rest = np.isnan(touches.time_s), campaign.nominal.datum.is_at_rest
    if campaign.nominal.kind is Kind.MACHINE and no_feed.any() and not at_rest:
        how_often = f"not recorded in {no_feed.sum()} of {len(touches)} touches"
        why = "without it nobody can tell a delay from a length; import has --feed"
        raise InputError(campaign.path / TOUCHES_FILE, None, "feed_mm_min", f"{how_often}; {why}")
    # Where every edge is known, it tells when the touch was made.
    no_moment = no_time & np.isnan(touches.edge_us).any()
    missing = {"feed_mm_min": no_feed, "approach_mm": no_way, "time_s": no_moment}
    for name, rows in missing.items():
        lost = f"what cannot be told without it: {COLUMNS[name].lost}"
        if not at_rest or name == "time_s":
            warn_missing(campaign.path / TOUCHES_FILE, name, rows, lost)
    _warn_of_ramps(campaign, touches)
    lacking = frozenset(name for name, rows in missing.items() if rows.any())
    if lacking or no_time.any():
        touches = stood_in(campaign.nominal, touches)
    refuse_endless_move(campaign.path / NOMINAL_FILE, campaign.nominal, touches)
    known_as = fingerprint(campaign.touches)
    nominal = _rested(campaign.nominal) if at_rest else campaign.nominal
    return replace(
        campaign, nominal=nominal, touches=touches, stood_in=lacking, fingerprint=known_as
    )


def _warn_of_ramps(campaign: Campaign, touches: Touches) -> None:
    left_out = _may_accelerate(campaign.nominal, touches) & ~np.isnan(touches.deviation_um)
    if left_out.any():
        feed = np.min(touches.feed_mm_min[left_out])
        what = (
            f"deviations of {left_out.sum()} touches are left out, from {feed:g} mm/min on: "
            f"the ramp is longer than {NEAREST_MM:g} mm there, and may not have been over"
        )
        warnings.warn(
            CampaignWarning(campaign.path / TOUCHES_FILE, None, "approach_mm", what), stacklevel=3
        )


def _may_accelerate(nominal: Nominal, touches: Touches) -> BoolArray:
    """Tell which touches may have met the surface below their feed, for all that was recorded."""
    if nominal.kind is Kind.BENCH or nominal.datum.is_at_rest:
        return np.zeros(len(touches), dtype=np.bool_)
    return np.isnan(touches.approach_mm) & (_ramps_mm(nominal, touches.feed_mm_min) > NEAREST_MM)


def _ramps_mm(nominal: Nominal, feed_mm_min: FloatArray) -> FloatArray:
    return (feed_mm_min / S_PER_MIN) ** 2 / (2.0 * nominal.axis.accel_mm_s2)


def _rested(nominal: Nominal) -> Nominal:
    """Take what only a touch can have out of what is believed; what was read scatters as before."""
    scatter = ProbeNominal(repeatability_um=nominal.probe.repeatability_um)
    u = {key: value for key, value in nominal.uncertainty.items() if key in OF_A_READING}
    return replace(nominal, probe=scatter, input=InputNominal(), skip=SkipNominal(), uncertainty=u)


def stood_in(nominal: Nominal, touches: Touches) -> Touches:
    """Put stand-ins for what was not recorded; what depends on them is emptied."""
    no_feed, no_way = np.isnan(touches.feed_mm_min), np.isnan(touches.approach_mm)
    # A start tells nothing of an edge if nobody knows the move between them.
    no_move = (no_feed | no_way) & ~np.isnan(touches.edge_us)
    touches = replace(touches, time_s=_empty(touches.time_s, no_move))
    no_time = np.isnan(touches.time_s)
    contact_unknown = no_feed | no_time | no_way
    stamps_hang = contact_unknown & np.isnan(touches.edge_us)
    feed_mm_min = np.where(no_feed, FEED_MM_MIN, touches.feed_mm_min)
    ramp_mm = _ramps_mm(nominal, feed_mm_min)
    beyond_mm = BEYOND_THE_RAMP_MM[nominal.kind]
    length_unknown = no_feed & (not nominal.datum.is_at_rest) | _may_accelerate(nominal, touches)
    touches = replace(
        touches,
        feed_mm_min=feed_mm_min,
        approach_mm=_or_else(touches.approach_mm, ramp_mm + beyond_mm),
        deviation_um=_empty(touches.deviation_um, length_unknown),
        latch_us=_empty(touches.latch_us, stamps_hang),
        report_us=_empty(touches.report_us, stamps_hang),
    )
    at_once = replace(touches, time_s=np.zeros(len(touches)))
    travel_s = expected_contact(nominal, at_once).time_us / US_PER_S
    if no_time.all():
        touches = _with_time_to_move(touches, travel_s)
    # By a start the surface is met at the edge, or else one comes after the other.
    met_s = np.maximum(touches.edge_us / US_PER_S - travel_s, 0.0)
    time_s = _or_else(touches.time_s, met_s)
    pace_s = np.cumsum(travel_s + BETWEEN_TOUCHES_S) - travel_s
    return replace(touches, time_s=_or_else(time_s, _paced(time_s, pace_s)))


def _with_time_to_move(touches: Touches, travel_s: FloatArray) -> Touches:
    """Count stamps from a zero before the first move: a capture begins with an edge."""
    early_s = float(np.max(travel_s - touches.edge_us / US_PER_S, initial=0.0))
    if not early_s > 0.0:  # nor if an edge is missing
        return touches
    # Whole seconds, which every clock ticks.
    later_us = np.ceil(early_s) * US_PER_S
    stamps = {name: getattr(touches, name) + later_us for name in STAMPS}
    return replace(touches, **stamps)


def _paced(time_s: FloatArray, pace_s: FloatArray) -> FloatArray:
    """Go on from each known time at a pace, no further than to the next one in the file."""
    before = last_known(time_s)
    after = len(time_s) - 1 - last_known(time_s[::-1])[::-1]
    begun_s = np.where(before < 0, 0.0, time_s[before])
    since_s = pace_s - np.where(before < 0, 0.0, pace_s[before])
    ends_s = np.append(time_s, np.nan)[after]
    return np.asarray(np.fmax(np.fmin(begun_s + since_s, ends_s), begun_s))


def _as_linear(touches: Touches) -> Touches:
    """Let degrees stand for millimetres where a rotary axis moves."""
    turns = touches.axis >= Axis.A
    if not turns.any():
        return touches
    turned_um = touches.deviation_arcsec / ARCSEC_PER_MILLIDEGREE
    return replace(
        touches,
        position_mm=np.where(turns, touches.position_deg, touches.position_mm),
        deviation_um=np.where(turns, turned_um, touches.deviation_um),
    )


def _or_else(values: FloatArray, others: FloatArray) -> FloatArray:
    return np.where(np.isnan(values), others, values)


def _empty(values: FloatArray, rows: BoolArray) -> FloatArray:
    return np.where(rows, np.nan, values)
