"""Touches round a bore, a ring or a boss: the axes that moved, and the centre, which nobody knows.

A centre that lies elsewhere than the directions start from adds one wave a turn to the deviations,
which is no property of the probe.
"""

from collections.abc import Mapping

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Axis
from skiplatch.importing.model import Imported

Columns = Mapping[str, FloatArray]
LOBES = 3  # of a probe whose stylus rests on three supports
LEAST_OWN = 0.5
"""Of one wave a turn: what has to be left of it beside the mean and the probe's lobes."""
STEEPEST_DEG = 45.0  # of a direction, above which the probe's own axis moves more
DECIMALS = 3  # of a deviation in a campaign
_OTHER_PLACES = {"position_mm", "position_deg", "rotary_deg", "axis"}
"""Columns by which touches may be of other surfaces than those round one ring."""


def axes_round(columns: Columns) -> tuple[FloatArray, FloatArray] | None:
    """Give the axis that mostly moved, and in which sense, by azimuths in the plane of X and Y.

    None where a direction is not known or is steep.
    """
    if "alpha_deg" not in columns:
        return None
    alpha = np.radians(columns["alpha_deg"])
    steep = np.abs(np.nan_to_num(_beta_deg(columns))) > STEEPEST_DEG
    if np.isnan(alpha).any() or steep.any():
        return None
    x, y = np.round(np.cos(alpha), DECIMALS), np.round(np.sin(alpha), DECIMALS)
    is_x = np.abs(x) >= np.abs(y)
    axis = np.where(is_x, float(Axis.X), float(Axis.Y))
    return axis, np.sign(np.where(is_x, x, y))


def centred(found: Imported, columns: Columns, rows: int) -> FloatArray | None:
    """Give the deviations, shape (rows,), without the centre of the ring of each session.

    None where nothing is taken out: touches may be of several surfaces, or their azimuths do not
    tell a centre from a mean and three lobes.
    """
    if not {"alpha_deg", "deviation_um"} <= columns.keys() or _OTHER_PLACES & columns.keys():
        return None
    deviations = columns["deviation_um"]
    session = columns.get("session", np.zeros(rows))
    without = deviations.copy()
    for name in np.unique(session):
        ring = (session == name) & ~np.isnan(deviations) & ~np.isnan(columns["alpha_deg"])
        centre = _centre(columns, ring)
        if centre is not None:
            without[session == name] -= _wave(columns, session == name) @ centre
            found.assumed.append(_said(centre))
    return np.where(np.isnan(without), deviations, np.round(without, DECIMALS))


def _centre(columns: Columns, ring: BoolArray) -> FloatArray | None:
    """Give what the centre adds along X and Y in µm by least squares; None if it cannot be told."""
    wave, others = _wave(columns, ring), _others(columns, ring)
    if len(wave) <= others.shape[1] + wave.shape[1]:
        return None
    own = wave - others @ np.linalg.lstsq(others, wave, rcond=None)[0]
    if np.linalg.svd(own, compute_uv=False)[-1] < LEAST_OWN * np.linalg.norm(wave, axis=0).min():
        return None
    design = np.column_stack([wave, others])
    fit = np.linalg.lstsq(design, columns["deviation_um"][ring], rcond=None)[0]
    return np.asarray(fit[: wave.shape[1]], dtype=float)


def _wave(columns: Columns, rows: BoolArray) -> FloatArray:
    """Give what a centre that lies 1 µm off along X, and along Y, adds; shape (n, 2)."""
    alpha = np.radians(columns["alpha_deg"][rows])
    flat = np.cos(np.radians(np.nan_to_num(_beta_deg(columns)[rows])))
    return np.asarray(np.column_stack([np.cos(alpha), np.sin(alpha)]) * flat[:, None])


def _others(columns: Columns, rows: BoolArray) -> FloatArray:
    """Give the mean at each feed and height, and the lobes of a probe; shape (n, k)."""
    alpha = np.radians(LOBES * columns["alpha_deg"][rows])
    feed = columns.get("feed_mm_min", np.zeros(len(rows)))[rows]
    kinds = np.nan_to_num(np.column_stack([feed, _beta_deg(columns)[rows]]), nan=-1.0)
    _, kind = np.unique(kinds, axis=0, return_inverse=True)
    means = (kind.ravel()[:, None] == np.arange(kind.max() + 1)).astype(float)
    return np.column_stack([means, np.cos(alpha), np.sin(alpha)])


def _beta_deg(columns: Columns) -> FloatArray:
    return columns.get("beta_deg", np.zeros(len(columns["alpha_deg"])))


def _said(centre: FloatArray) -> str:
    size_um, azimuth_deg = float(np.hypot(*centre)), float(np.degrees(np.arctan2(*centre[::-1])))
    return (
        f"the centre of the ring tells nothing: one wave a turn of {size_um:.3g} µm, highest at "
        f"azimuth {round(azimuth_deg) % 360}°, was fitted by least squares (two figures) and taken "
        "off every deviation, and with it what else goes so"
    )
