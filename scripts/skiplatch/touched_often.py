"""Which touches are of one surface, and whether there are enough to tell how they repeat."""

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Campaign, InputPath, Touches
from skiplatch.drifts import FEWEST_FREE

FEWEST = 2
"""Touches of a surface from which on it tells a scatter."""
FINEST_WAIT = 6  # decimals of a µs; stamps far from 0 hold no more, and the rest looks like a step


def touches_repeat(campaign: Campaign) -> bool:
    """Tell whether a surface was touched often enough by any input path, before all is fitted."""
    for path in InputPath:
        own = campaign.touches.select(campaign.touches.path == path)
        known = ~np.isnan(what_repeats(own)[1]) & ~own.false
        if beyond_firsts(surfaces_of(own.select(known))) >= FEWEST_FREE:
            return True
    return False


def what_repeats(touches: Touches) -> tuple[str, FloatArray]:
    """Give the deviations, or else those of rotary axes, or the times from edge to latch."""
    if not np.isnan(touches.deviation_um).all():
        return "µm", touches.deviation_um
    if not np.isnan(touches.deviation_arcsec).all():
        return "arcsec", touches.deviation_arcsec
    return "µs", np.round(touches.latch_us - touches.edge_us, FINEST_WAIT)


def surfaces_of(touches: Touches) -> np.typing.NDArray[np.intp]:
    """Number the surfaces: what was touched alike but for the feed."""
    names = ("path", "axis", "sign", "alpha_deg", "beta_deg", "session")
    columns = [np.asarray(getattr(touches, name), dtype=float) for name in names]
    columns += [np.round(places, 2) for places in (touches.position_mm, touches.position_deg)]
    if not len(touches):
        return np.zeros(0, dtype=np.intp)
    table = np.nan_to_num(np.column_stack(columns), nan=1e300)
    return np.asarray(np.unique(table, axis=0, return_inverse=True)[1].ravel())


def often(surface: np.typing.NDArray[np.intp]) -> BoolArray:
    """Tell which touches are of a surface that was touched often enough."""
    return np.asarray(np.bincount(surface, minlength=1)[surface] >= FEWEST)


def beyond_firsts(surface: np.typing.NDArray[np.intp]) -> int:
    """Count the touches beyond the first of each surface that was touched often enough."""
    rows = often(surface)
    return int(rows.sum()) - len(np.unique(surface[rows]))
