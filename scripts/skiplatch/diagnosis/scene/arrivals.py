"""Arrivals of reports as stamps, where the latch has none of its own.

A stamp is what its clock read at the latch, rounded down to a tick. Moved back by the longest that
a report is believed to take, its arrival is the same: a time of no more than the latch, by the
jitter of the report at most. What is wrong with the clock does not show in it, and what is wrong
with the report shows as a late stamp.
"""

from dataclasses import replace

import numpy as np

from skiplatch.campaign import Campaign, Nominal
from skiplatch.simulator.playing import Outcomes

WAY = {("report", "latency_us"), ("report", "jitter_us")}


def with_arrivals(campaign: Campaign) -> Campaign:
    """Take arrivals as stamps, if nobody stamped, and it is known how long reports take."""
    nominal, touches = campaign.nominal, campaign.touches
    is_stamped = not np.isnan(touches.latch_us).all()
    if is_stamped or np.isnan(touches.report_us).all() or WAY & nominal.unknown:
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
