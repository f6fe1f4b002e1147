"""By which path touches were latched that do not say."""

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign.columns import InputPath
from skiplatch.campaign.nominal import Nominal

CHANCE = 1e-6
"""Of stamps that know nothing of scans to lie on their grid so well, by Rayleigh's test."""
OF_AN_INTERRUPT = {("skip", "latency_us"), ("skip", "jitter_us")}


def unsaid_path(nominal: Nominal, latch_us: FloatArray) -> tuple[InputPath, str]:
    """Give the path of touches that say none, and why it is that one; skip for no reason.

    A machine that records no path has one. Its input is scanned if nominal.toml has a scan and
    nothing of an interrupt, or if the stamps lie on the grid of the scans.

    Args:
        nominal: What is believed of the rig.
        latch_us: Stamps of those touches, NaN where there is none; shape (n,).
    """
    has_scan = ("plc", "scan_us") not in nominal.unknown
    if has_scan and nominal.unknown >= OF_AN_INTERRUPT:
        return InputPath.PLC, "nominal.toml has a scan and no interrupt"
    if has_scan and lie_on_grid(latch_us[~np.isnan(latch_us)], nominal.plc.scan_us):
        return InputPath.PLC, "stamps lie on the grid of the scans"
    return InputPath.SKIP, ""


def lie_on_grid(stamps: FloatArray, period: float) -> bool:
    """Tell whether stamps, shape (n,), lie on a grid by no accident."""
    turn = np.abs(np.exp(2j * np.pi * stamps / period).sum())
    return bool(len(stamps) and turn**2 / len(stamps) > -np.log(CHANCE))
