"""Touches whose direction nobody recorded.

It is that of the axis that mostly moves, near enough for what turns with it once a turn; which way
the calibrated lobes are off is not known.
"""

from dataclasses import replace

import numpy as np

from skiplatch.campaign import Axis, Campaign, Kind, Nominal, Touches
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis.fit.beliefs import LOBES, NOISE_U, REPEATABILITY

MOST_UNKNOWN = 0.5
"""Share of touches without an azimuth from which on lobes are not played."""
UNDIRECTED = (
    "The directions were not recorded: the probe's lobes count as scatter, and as a datum of each "
    "sense."
)
REACH = 4.0
"""Standard uncertainties from the least scatter that may be to the largest."""


def with_directions(campaign: Campaign) -> Campaign:
    """Fill in the directions that were not recorded by axis and sense, and let lobes be unknown."""
    known = _without_unknown_lobes(campaign)
    filled = {"alpha_deg"} if np.isnan(campaign.touches.alpha_deg).all() else set()
    return replace(known, touches=_directed(known.touches), stood_in=known.stood_in | filled)


def _directed(touches: Touches) -> Touches:
    """Give X+ the azimuth 0°, Y+ 90°, and Z the elevation 90°, where none was recorded."""
    first = np.select([touches.axis == Axis.X, touches.axis == Axis.Y], [0.0, 90.0], np.nan)
    azimuth = np.where(touches.sign < 0.0, first + 180.0, first)
    azimuth = np.where(np.isnan(touches.sign), np.nan, azimuth)
    is_up = (touches.axis == Axis.Z) & np.isnan(touches.alpha_deg)
    return replace(
        touches,
        alpha_deg=np.where(np.isnan(touches.alpha_deg), azimuth, touches.alpha_deg),
        beta_deg=np.where(np.isnan(touches.beta_deg) & is_up, 90.0, touches.beta_deg),
    )


def _without_unknown_lobes(campaign: Campaign) -> Campaign:
    """Let lobes be unknown where the azimuths are: they scatter, or shift each axis and sense.

    A probe that touches from few directions has a lobe for each of them, as constant as the place
    of the surface. From many directions the lobes scatter by their root mean square.
    """
    nominal, touches = campaign.nominal, campaign.touches
    is_unknown = float(np.mean(np.isnan(touches.alpha_deg))) > MOST_UNKNOWN
    if nominal.kind is not Kind.MACHINE or nominal.probe.lobe_um == 0.0 or not is_unknown:
        return campaign
    return replace(campaign, nominal=_scattering(nominal))


def _scattering(nominal: Nominal) -> Nominal:
    """Let the scatter be anything from that of the probe alone to that of the lobes as well."""
    least_um = max(nominal.probe.repeatability_um, nominal.axis.resolution_um)
    most_um = float(np.hypot(least_um, nominal.probe.lobe_um / np.sqrt(2.0)))
    middle_um = float(np.sqrt(least_um * most_um))
    own_u = nominal.uncertainty.get(REPEATABILITY, NOISE_U * middle_um)
    u_um = float(np.hypot(own_u, middle_um * np.expm1(np.log(most_um / least_um) / REACH)))
    known = {key: u for key, u in nominal.uncertainty.items() if key != LOBES}
    return replace(
        nominal,
        probe=replace(nominal.probe, lobe_um=0.0, repeatability_um=middle_um),
        uncertainty={**known, REPEATABILITY: u_um},
        datum=_of_each_sense(nominal.datum, nominal.probe.lobe_um / float(np.sqrt(2.0))),
    )


def _of_each_sense(datum: Datum, lobe_um: float) -> Datum:
    """Give a datum that lobes of unknown directions shift by so much (root mean square)."""
    shared = (DatumFreedom.AXIS, DatumFreedom.CAMPAIGN, DatumFreedom.NONE)
    if datum.free not in shared:
        return datum
    is_known = datum.free is DatumFreedom.NONE or datum.u_um is not None
    u_um = float(np.hypot(datum.u_um or 0.0, lobe_um)) if is_known else None
    return Datum(DatumFreedom.AXIS_SENSE, u_um)
