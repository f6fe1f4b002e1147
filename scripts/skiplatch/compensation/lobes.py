"""Three lobes of a probe, told apart from where the artefact stands.

An artefact off its believed centre changes the radii by a cosine of the azimuth, and a datum by the
same everywhere. On an even ring neither looks like three lobes; elsewhere they do. So all are
fitted together.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from skiplatch.arrays import FloatArray
from skiplatch.compensation.probe_map import ProbeMap

LOBES = 3
CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class Lobes:
    """Three lobes: `amplitude_um`·cos β·cos 3(α − `azimuth_deg`).

    Attributes:
        amplitude_um: Half of what they change the radius by, around the equator.
        low_um: 95 % of repeats lie between this
        high_um: and this, as far as scatter about the lobes goes.
        azimuth_deg: Of a crest, 0 to 120.
        off_centre_um: By how much the radii are not about the best-fit centre, in X, Y, Z.
    """

    amplitude_um: float
    low_um: float
    high_um: float
    azimuth_deg: float
    off_centre_um: tuple[float, float, float]


def three_lobes(probe_map: ProbeMap) -> Lobes | None:
    """Fit lobes, centre and datum to the mean radii; None if the directions do not tell them."""
    alpha = np.radians(probe_map.cells.alpha_deg)
    beta = np.radians(probe_map.cells.beta_deg)
    rows = _rows(alpha, beta)
    used = np.ptp(rows, axis=0) > 0.0
    used[0] = True
    freedom = len(rows) - int(used.sum())
    if freedom <= 0 or np.linalg.matrix_rank(rows[:, used]) < used.sum() or not used[-2:].all():
        return None
    found = np.zeros(rows.shape[1])
    found[used], squares, _, _ = np.linalg.lstsq(rows[:, used], probe_map.mean_um, rcond=None)
    spread = np.linalg.inv(rows[:, used].T @ rows[:, used])[-2:, -2:] * float(squares[0]) / freedom
    return _told(found, spread, freedom, probe_map.sign)


def _rows(alpha: FloatArray, beta: FloatArray) -> FloatArray:
    """Give what the radii are a sum of, shape (n, 6): datum, centre, lobes."""
    flat = np.cos(beta)
    return np.column_stack(
        [
            np.ones_like(alpha),
            np.cos(alpha) * flat,
            np.sin(alpha) * flat,
            np.sin(beta),
            np.cos(LOBES * alpha) * flat,
            np.sin(LOBES * alpha) * flat,
        ]
    )


def _told(found: FloatArray, spread: FloatArray, freedom: int, sign: float) -> Lobes:
    amplitude = float(np.hypot(*found[-2:]))
    along = found[-2:] / max(amplitude, np.finfo(float).tiny)
    half = float(
        np.sqrt(along @ spread @ along) * scipy.stats.t.isf((1.0 - CONFIDENCE) / 2.0, freedom)
    )
    azimuth_deg = float(np.degrees(np.arctan2(found[-1], found[-2]))) / LOBES
    x, y, z = (sign * found[1:4]).tolist()
    return Lobes(
        amplitude, max(0.0, amplitude - half), amplitude + half, azimuth_deg % 120.0, (x, y, z)
    )
