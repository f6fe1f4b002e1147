"""Figures of a probe in the style of ISO 230-10: repeatability, form error on ring and sphere.

They are ranges and a standard deviation of trigger radii about the best-fit centre of each run.
The standard's own procedures, with its points, feeds and approach lengths, are not claimed.
"""

import math
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.compensation import firmware
from skiplatch.compensation.lobes import Lobes, three_lobes
from skiplatch.compensation.probe_map import ProbeMap
from skiplatch.errors import CampaignWarning

BASE_UM = 1e4
"""Laid under the radii for the fit of a centre, where only their differences were given."""


@dataclass(frozen=True, slots=True)
class Form:
    """How far trigger points are from a circle or a sphere.

    Attributes:
        beta_deg: Of the ring; None for the sphere.
        points: In one run.
        mean_um: Range of the mean radii.
        worst_run_um: Largest range of the radii of a single run.
        fitted_um: Range of the mean radii about the centre that fits them best.
        all_um: Range of all single radii of all runs.
    """

    beta_deg: float | None
    points: int
    mean_um: float
    worst_run_um: float
    fitted_um: float
    all_um: float


@dataclass(frozen=True, slots=True)
class ProbeFigures:
    """All figures of one map.

    Attributes:
        repeatability_um: Standard deviation of one touch, pooled; None of a single run.
        worst_range_um: Largest range of the repeats of one direction; None of a single run.
        rings: Of each ring with enough points for a circle.
        sphere: Of all directions; None of a single ring.
        lobes: Three of them, with the centre and the datum of the artefact fitted as well; None
            where the directions do not tell them.
    """

    repeatability_um: float | None
    worst_range_um: float | None
    rings: list[Form]
    sphere: Form | None
    lobes: Lobes | None


def probe_figures(probe_map: ProbeMap) -> ProbeFigures:
    """Work the figures out."""
    several = probe_map.runs > 1
    rings = [
        _form(probe_map, ring, float(probe_map.cells.beta_deg[ring[0]]))
        for ring in _rings(probe_map)
    ]
    everything = np.arange(len(probe_map))
    is_sphere = np.ptp(probe_map.cells.beta_deg) > 0.0
    return ProbeFigures(
        repeatability_um=probe_map.repeatability_um,
        worst_range_um=float(np.ptp(probe_map.radius_um, axis=1).max()) if several else None,
        rings=rings,
        sphere=_form(probe_map, everything, None) if is_sphere else None,
        lobes=three_lobes(probe_map),
    )


def warn_off_centre(figures: ProbeFigures, expanded_um: float, path: Path) -> None:
    """Tell of radii about a centre beside the probe's axis: the feeds would make up for that too.

    Along the axis a probe's own pretravel looks like a centre that is off, and nothing is said.

    Args:
        figures: Of the map that feeds were made of; of a single run nobody knows the scatter.
        expanded_um: U of its range, k = 2, which the centre has to be off by.
        path: Where the map came from.
    """
    if figures.lobes is None or figures.repeatability_um is None:
        return
    x_um, y_um, _ = figures.lobes.off_centre_um
    if math.hypot(x_um, y_um) > expanded_um:
        message = (
            f"the best-fit centre is off by X {x_um:+.2f}, Y {y_um:+.2f} um: the feeds make up for "
            "where the artefact stood as well; give radii about that centre"
        )
        warnings.warn(CampaignWarning(path, None, "radius_um", message), stacklevel=2)


def _rings(probe_map: ProbeMap) -> list[NDArray[np.intp]]:
    betas = probe_map.cells.beta_deg
    rings = [np.flatnonzero(betas == beta) for beta in np.unique(betas)]
    return [ring for ring in rings if len(ring) > 1]


def _form(probe_map: ProbeMap, chosen: NDArray[np.intp], beta_deg: float | None) -> Form:
    by_run = probe_map.radius_um[chosen]
    mean_um = probe_map.mean_um[chosen]
    fitted_um = fitted_radii(
        probe_map.cells.alpha_deg[chosen],
        probe_map.cells.beta_deg[chosen],
        mean_um,
        is_circle=beta_deg is not None,
    )
    return Form(
        beta_deg=beta_deg,
        points=len(chosen),
        mean_um=firmware.range_um(mean_um),
        worst_run_um=max(firmware.range_um(run) for run in by_run.T),
        fitted_um=firmware.range_um(fitted_um),
        all_um=firmware.range_um(by_run.ravel()),
    )


def about_centre(probe_map: ProbeMap) -> FloatArray:
    """Give the mean radii about their best-fit centre, less their mean; shape (n,)."""
    cells = probe_map.cells
    is_circle = float(np.ptp(cells.beta_deg)) <= 0.0
    return fitted_radii(cells.alpha_deg, cells.beta_deg, probe_map.mean_um, is_circle=is_circle)


def fitted_radii(
    alpha_deg: FloatArray, beta_deg: FloatArray, radius_um: FloatArray, *, is_circle: bool
) -> FloatArray:
    """Give radii about the best-fit centre of their points, less their mean; shape (n,).

    Args:
        alpha_deg: Shape (n,).
        beta_deg: Shape (n,).
        radius_um: About another centre, as long as that is near; shape (n,). Their mean does not
            matter.
        is_circle: Whether the centre is sought in the plane across the probe axis only.
    """
    alpha, beta = np.radians(alpha_deg), np.radians(beta_deg)
    length = BASE_UM + radius_um - radius_um.mean()
    height = np.zeros_like(beta) if is_circle else np.sin(beta)
    flat = np.ones_like(beta) if is_circle else np.cos(beta)
    points = np.column_stack([np.cos(alpha) * flat, np.sin(alpha) * flat, height])
    shape = firmware.Shape.CIRCLE if is_circle else firmware.Shape.SPHERE
    points *= length[:, None]
    found = firmware.radii_um(points, firmware.fit(points, shape))
    return np.asarray(found - found.mean())
