"""What nobody stated of the positions, and only the touches tell: how they scatter, in which steps.

Without either, all scatter would be a gap, and the steps of the positions a coarse encoder.
"""

from dataclasses import replace
from math import sqrt

from skiplatch.campaign import Campaign, InputPath, Kind
from skiplatch.campaign.steps import common_step
from skiplatch.diagnosis.fit.beliefs import REPEATABILITY, believing
from skiplatch.errors import InputError
from skiplatch.repeatability import repeatability
from skiplatch.units import ARCSEC_PER_MILLIDEGREE

RESOLUTION = ("axis", "resolution_um")


def with_unstated(campaign: Campaign) -> Campaign:
    """Give a machine's campaign the step and the scatter of its touches, where it states none.

    Touches of a PLC scatter by its scans, and tell neither.
    """
    nominal = campaign.nominal
    latched = campaign.touches.select(campaign.touches.path == InputPath.SKIP)
    if nominal.kind is not Kind.MACHINE or not len(latched):
        return campaign
    step_um = common_step(latched.deviation_um) if RESOLUTION in nominal.unknown else None
    if step_um is not None:
        nominal = believing(nominal, {RESOLUTION: step_um})
    if REPEATABILITY in nominal.unknown:
        scatter_um = _scatter_um(replace(campaign, nominal=nominal, touches=latched))
        nominal = believing(nominal, {REPEATABILITY: scatter_um})
    return replace(campaign, nominal=nominal)


def _scatter_um(campaign: Campaign) -> float:
    """Give the standard deviation of touches of one surface, less their rounding; 0 if unknown."""
    try:
        found = repeatability(campaign)
    except InputError:
        return 0.0
    sigma = found.in_a_row.sigma if found.in_a_row else found.sigma
    sigma_um = sigma.value / (ARCSEC_PER_MILLIDEGREE if found.unit == "arcsec" else 1.0)
    rounding_um = campaign.nominal.axis.resolution_um / sqrt(12.0)
    return sqrt(max(sigma_um**2 - rounding_um**2, 0.0))
