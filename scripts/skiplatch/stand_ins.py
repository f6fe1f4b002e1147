"""Recorded touches made fit to be played: stand-ins for conditions that were not recorded.

A stand-in is put only where what is left to look at does not depend on it; what does depend on it
is emptied. Of a rotary axis a degree counts as a millimetre.
"""

import os
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import (
    COLUMNS,
    NOMINAL_FILE,
    TOUCHES_FILE,
    Axis,
    BelievedEffect,
    Campaign,
    Kind,
    Nominal,
    Touches,
    read_campaign,
)
from skiplatch.errors import CampaignWarning, InputError
from skiplatch.motion import S_PER_MIN, US_PER_S, expected_contact
from skiplatch.simulator import effects

ARCSEC_PER_MILLIDEGREE = 3.6
FEED_MM_MIN = 60.0
BEYOND_THE_RAMP_MM = {Kind.MACHINE: 1.0, Kind.BENCH: 0.01}  # a bench may begin with an edge
BETWEEN_TOUCHES_S = 1.0
PLAYED = {("plc", "scan_us"): (100.0, 20_000.0), ("skip", "tick_us"): (0.001, 1000.0)}
"""What the firmware's scans, in µs, and the simulator's clock can do."""


def refuse_unplayable(path: Path, nominal: Nominal) -> None:
    """Raise InputError for a figure of nominal.toml, at `path`, that cannot be simulated."""
    for (section, name), (least, most) in PLAYED.items():
        value = nominal.number(section, name)
        if not least <= value <= most:
            expected = f"expected {least:g} to {most:g}, which is what can be simulated"
            raise InputError(path, None, f"{section}.{name}", f"{expected}, got {value:g}")
    for effect in nominal.believed_effects:
        _refuse_unknown(path, effect)


def _refuse_unknown(path: Path, effect: BelievedEffect) -> None:
    """Raise InputError for an effect, a parameter or a value that the simulator does not have."""
    if effect.id not in effects():
        raise InputError(path, None, "effect.id", f'no effect is called "{effect.id}"')
    parameters = {parameter.name: parameter for parameter in effects()[effect.id].parameters}
    for name, value in effect.values.items():
        column = f"effect.{effect.id}.{name}"
        if name not in parameters:
            known = ", ".join(parameters)
            raise InputError(path, None, column, f"no such parameter; there are {known}")
        known_as = parameters[name]
        if not known_as.low <= value <= known_as.high:
            expected = f"expected {known_as.low:g} to {known_as.high:g}, got {value:g}"
            raise InputError(path, None, column, expected)


def read_playable(path: str | os.PathLike[str]) -> Campaign:
    """Read a campaign and make it playable.

    Raises:
        InputError: It cannot be read, or something is missing for which nothing can stand in.
    """
    return playable(read_campaign(path))


def playable(campaign: Campaign) -> Campaign:
    """Give the campaign with stand-ins; warns of each column that has one.

    Raises:
        InputError: The feed is missing on a machine: every outcome depends on it. Or a figure
            cannot be simulated.
    """
    refuse_unplayable(campaign.path / NOMINAL_FILE, campaign.nominal)
    touches = _as_linear(campaign.touches)
    no_feed, no_way = np.isnan(touches.feed_mm_min), np.isnan(touches.approach_mm)
    no_time = np.isnan(touches.time_s)
    if campaign.nominal.kind is Kind.MACHINE and no_feed.any():
        missing = f"not recorded in {no_feed.sum()} of {len(touches)} touches"
        why = "without it nobody can tell a delay from a length; import has --feed"
        raise InputError(campaign.path / TOUCHES_FILE, None, "feed_mm_min", f"{missing}; {why}")
    for name, missing_rows in (
        ("feed_mm_min", no_feed),
        ("approach_mm", no_way),
        ("time_s", no_time),
    ):
        _warn(campaign.path, name, missing_rows)
    if (no_feed | no_way | no_time).any():
        touches = _stood_in(campaign, touches)
    return replace(campaign, touches=touches)


def _stood_in(campaign: Campaign, touches: Touches) -> Touches:
    no_feed, no_time = np.isnan(touches.feed_mm_min), np.isnan(touches.time_s)
    contact_unknown = no_feed | no_time | np.isnan(touches.approach_mm)
    stamps_hang = contact_unknown & np.isnan(touches.edge_us)
    feed_mm_min = np.where(no_feed, FEED_MM_MIN, touches.feed_mm_min)
    ramp_mm = (feed_mm_min / S_PER_MIN) ** 2 / (2.0 * campaign.nominal.axis.accel_mm_s2)
    beyond_mm = BEYOND_THE_RAMP_MM[campaign.nominal.kind]
    touches = replace(
        touches,
        feed_mm_min=feed_mm_min,
        approach_mm=_or_else(touches.approach_mm, ramp_mm + beyond_mm),
        deviation_um=_empty(touches.deviation_um, no_feed),
        latch_us=_empty(touches.latch_us, stamps_hang),
        report_us=_empty(touches.report_us, stamps_hang),
    )
    at_once = replace(touches, time_s=np.zeros(len(touches)))
    travel_s = expected_contact(campaign.nominal, at_once).time_us / US_PER_S
    return replace(touches, time_s=_or_else(touches.time_s, _times(touches, travel_s)))


def _times(touches: Touches, travel_s: FloatArray) -> FloatArray:
    """Give starts by which the surface is met at the edge, or one after the other."""
    if np.isnan(touches.edge_us).any():
        return np.cumsum(travel_s + BETWEEN_TOUCHES_S)
    starts = touches.edge_us / US_PER_S - travel_s
    return np.asarray(np.maximum(starts, 0.0))


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


def _warn(path: Path, name: str, missing: BoolArray) -> None:
    if missing.any():
        how_often = "not recorded" if missing.all() else f"not recorded in {missing.sum()} touches"
        message = f"{how_often}; what cannot be told without it: {COLUMNS[name].lost}"
        warning = CampaignWarning(path / TOUCHES_FILE, None, name, message)
        warnings.warn(warning, stacklevel=4)
