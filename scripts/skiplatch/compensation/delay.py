"""The delay tau: given, or from mean trigger radii at several feeds."""

import warnings
from dataclasses import dataclass

from skiplatch.compensation import firmware
from skiplatch.compensation.speeds import Speeds
from skiplatch.errors import CampaignWarning, InputError

CLEAR = 3.0
"""Standard uncertainties from which on a delay is more than scatter."""


@dataclass(frozen=True, slots=True)
class Delay:
    """The delay between the transducer's trigger and the latch.

    Attributes:
        tau_ms: The delay.
        uncertainty_ms: Its standard uncertainty; 0 of one that is taken as exact.
        freedom: Degrees of freedom of that; None where it was given.
        fit: What the line through the speeds came to, if there was one.
        speeds: What it was estimated from, if it was.
    """

    tau_ms: float
    uncertainty_ms: float
    freedom: int | None = None
    fit: firmware.Tau | None = None
    speeds: Speeds | None = None


def estimate_delay(speeds: Speeds) -> Delay:
    """Fit a line to the mean radii; its slope is tau.

    Raises:
        InputError: The radius does not change with the feed as a delay makes it.
    """
    try:
        fit = firmware.estimate_tau(speeds.feed_mm_min, speeds.radius_um, speeds.side)
    except firmware.PretravelError as error:
        raise InputError(speeds.path, None, "mean_radius_um", _complaint(speeds, error)) from error
    if fit.tau_ms < CLEAR * fit.tau_uncertainty_ms:
        message = f"tau of {fit.tau_ms:.3g} ms is less than three times its standard uncertainty"
        warnings.warn(CampaignWarning(speeds.path, None, "mean_radius_um", message), stacklevel=2)
    freedom = len(speeds.feed_mm_min) - 2
    return Delay(fit.tau_ms, fit.tau_uncertainty_ms, freedom, fit, speeds)


def _complaint(speeds: Speeds, error: firmware.PretravelError) -> str:
    if error.name != "TAU":
        return str(error)
    if speeds.outside:
        return (
            "tau <= 0: outside a sphere the mean radius must fall as the feed grows; or --inside?"
        )
    return "tau <= 0: inside a ring the mean radius must grow with the feed; or --outside?"
