"""Arrivals of reports, where the latch has no stamps of its own.

The position tells when it was latched: by then the axis had gone so far at its feed. How much later
than that the report came is how long it took. So an arrival counts as a stamp, moved back by the
longest that a report is believed to take, beside which only the position is looked at: what chain
and latch have done is in that position, and more sharply. Nothing shows of the latch's clock.
"""

from dataclasses import replace

import numpy as np

from skiplatch.campaign import Campaign, Nominal
from skiplatch.simulator.playing import Outcomes

WAY = {("report", "latency_us"), ("report", "jitter_us")}


def with_arrivals(campaign: Campaign) -> Campaign:
    """Take arrivals as stamps, if nobody stamped, and it is believed how long reports take."""
    nominal, touches = campaign.nominal, campaign.touches
    is_stamped = not np.isnan(touches.latch_us).all()
    is_told = not np.isnan(touches.report_us + touches.deviation_um).all()
    if is_stamped or not is_told or WAY & nominal.unknown:
        return campaign
    longest_us = nominal.report.latency_us + nominal.report.jitter_us
    stamps, none = touches.report_us - longest_us, np.full(len(touches), np.nan)
    return replace(
        campaign,
        nominal=replace(nominal, arrival_us=longest_us),
        touches=replace(touches, latch_us=stamps, report_us=none),
    )


def as_stamped(nominal: Nominal, outcomes: Outcomes) -> Outcomes:
    """Give plays the stamps that the record has."""
    if nominal.arrival_us is None:
        return outcomes
    return replace(outcomes, latch_us=outcomes.report_us - nominal.arrival_us)
