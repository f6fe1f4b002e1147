"""Where in the scan touches fall, beside plays of them."""

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.plays.scores import shares_among, way_from_normal
from skiplatch.diagnosis.scene.observed import before_wait
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.statistics import errors_of


def off_in_scan(
    scene: Scene, unit: str, rows: BoolArray, recorded: FloatArray, played: FloatArray
) -> tuple[float, float]:
    """Tell how far touches are off plays in the scan, in deviations, and the errors of that.

    By Cramér and von Mises' test. A wait that is bound to one point of the scan may scatter no more
    than any, about the same middle. Of noise the shape is not known so well. All touches of a play
    share the phase of its scans, as those recorded do: where these fall is held against touches of
    any plays.

    Args:
        scene: All touches, n.
        unit: Of the observable.
        rows: Which of them these are; shape (n,).
        recorded: Shape (m,).
        played: Shape (r, m).
    """
    is_from_contact = np.isnan(scene.touches.edge_us)
    expected = before_wait(scene, unit, is_from_contact=is_from_contact)
    before, per_us = (values[rows] for values in expected)
    waits = (played - before) / per_us
    shares = shares_among(np.sort(waits[~np.isnan(waits)]), (recorded - before) / per_us)
    z = errors_of(float(scipy.stats.cramervonmises(shares, "uniform").pvalue))
    return way_from_normal(scipy.stats.norm.ppf(shares)), z
