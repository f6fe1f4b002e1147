"""What the baselines hold residuals against, and figures that sum a campaign up."""

from collections.abc import Mapping

import numpy as np

from skiplatch.campaign import Campaign, Touches
from tests.withheld.chain import BoolArray, FloatArray
from tests.withheld.simulated import recorded_residuals
from tests.withheld.streams import Expected

STREAMS = ("latch", "position", "deviation", "report")
PATHS = ("skip", "plc")
QUANTILES = (0.01, 0.1, 0.5, 0.9, 0.99)
FEWEST = 8  # touches that a figure needs
FAR = 5.0  # spreads
COARSER = (2, 3, 5, 8, 20)  # grids to look for, in units of the believed one
CALIBRATION_C = 20.0


def covariates(campaign: Campaign) -> Mapping[str, FloatArray]:
    """Give what an effect may depend on, by name, each of shape (n,)."""
    touches = campaign.touches
    speed = Expected.of(campaign.nominal, touches).speed_um_us
    alpha, rotary = np.radians(touches.alpha_deg), np.radians(touches.rotary_deg)
    across = np.cos(np.radians(touches.beta_deg))
    return {
        "speed": speed,
        "slowness": 1.0 / speed,
        "time": touches.time_s,
        "travel": touches.approach_mm / speed,
        "approach": touches.approach_mm,
        "sense": touches.sign,
        "place": touches.sign * touches.position_mm,
        "warmth": touches.sign * (touches.temp_c - CALIBRATION_C),
        "cos 3α": across * np.cos(3 * alpha),
        "sin 3α": across * np.sin(3 * alpha),
        "table along": across * np.cos(alpha) * np.cos(rotary),
        "table across": across * np.cos(alpha) * np.sin(rotary),
    }


def on_path(touches: Touches, path: str) -> BoolArray:
    """Tell which touches were latched on a path, shape (n,)."""
    return touches.on_plc if path == "plc" else touches.on_skip


def features(campaign: Campaign) -> FloatArray:
    """Sum a campaign up in figures, shape (features,); NaN where something was not recorded."""
    touches, nominal = campaign.touches, campaign.nominal
    found = recorded_residuals(nominal, touches)
    given = covariates(campaign)
    parts: list[float] = []
    for path in PATHS:
        rows = on_path(touches, path)
        for stream in STREAMS:
            known = rows & ~np.isnan(found[stream])
            parts += _shape(found[stream][known])
            parts += [_correlation(found[stream][known], x[known]) for x in given.values()]
        parts.append(float(touches.missed[rows].mean()) if rows.any() else np.nan)
        parts += _coarseness(touches.latch_us[rows], nominal.skip.tick_us)
    parts += _coarseness(touches.deviation_um, nominal.axis.resolution_um)
    parts.append(_off_grid(touches.latch_us[touches.on_plc], nominal.plc.scan_us))
    return np.array(parts)


def _shape(values: FloatArray) -> list[float]:
    if len(values) < FEWEST:
        return [np.nan] * (len(QUANTILES) + 3)
    far = np.mean(np.abs(values - np.median(values)) > FAR)
    return [*np.quantile(values, QUANTILES), values.mean(), values.std(), float(far)]


def _correlation(values: FloatArray, given: FloatArray) -> float:
    known = ~np.isnan(given)
    values, given = values[known], given[known]
    if len(values) < FEWEST or values.std() <= 1e-9 or given.std() <= 1e-9 * abs(given).max():
        return np.nan
    return float(np.corrcoef(values, given)[0, 1])


def _coarseness(values: FloatArray, unit: float) -> list[float]:
    """Give the shares of values that lie on coarser grids."""
    steps = np.rint(values[~np.isnan(values)] / unit)
    if len(steps) < FEWEST:
        return [np.nan] * len(COARSER)
    return [float(np.mean(steps % k == 0)) for k in COARSER]


def _off_grid(stamps_us: FloatArray, period_us: float) -> float:
    """Tell how well stamps keep to a grid: 1 if all lie on it, 0 if they lie anywhere."""
    stamps = stamps_us[~np.isnan(stamps_us)]
    if len(stamps) < FEWEST:
        return np.nan
    return float(abs(np.mean(np.exp(2j * np.pi * stamps / period_us))))
