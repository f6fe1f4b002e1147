"""Middles of surfaces and straight lines by least squares, and what lies far off them."""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign.steps import common_step
from skiplatch.statistics import CONFIDENCE, Interval

NORMAL_PER_MAD = 1.4826
OUTLYING_SIGMAS = 5.0  # one in a million of a normal scatter
OUTLYING_STEPS = 2.5
MOST_OUTLYING = 0.1  # of the touches, where more than half are the same
FINEST = 6  # decimals of a µm or µs
NOTHING = 1e-9  # µm or µs; less is what floating-point sums leave


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceFit:
    """Middles of surfaces and straight lines, by least squares.

    Attributes:
        residuals: Of all touches, those left out too; shape (n,).
        lines: Slope and its standard error, by name.
        freedom: Degrees of freedom.
        sigma: Of the residuals.
        design: Surfaces and lines, scaled; shape (n, k).
        inverse: Of its normal matrix over the touches that were fitted; shape (k, k).
    """

    residuals: FloatArray
    lines: dict[str, tuple[float, float]]
    freedom: int
    sigma: Interval
    design: FloatArray
    inverse: FloatArray

    def interval(self, name: str, share: float = 1.0) -> Interval | None:
        """Give a slope with its interval, where a share of the touches counts as independent."""
        if name not in self.lines:
            return None
        slope, error = self.lines[name]
        return by_t(slope, error / float(np.sqrt(share)), self.freedom)

    def part(self, name: str, values: FloatArray) -> FloatArray:
        """Give what a line adds, less its mean; shape (n,)."""
        slope = self.lines.get(name, (0.0, 0.0))[0]
        return np.asarray(slope * (values - values.mean()))

    def errors(self) -> FloatArray:
        """Give the standard error of each touch against the fit, if it is none of those fitted."""
        leverage = np.einsum("ij,jk,ik->i", self.design, self.inverse, self.design)
        return np.asarray(self.sigma.value * np.sqrt(1.0 + np.maximum(leverage, 0.0)))

    def error_of_mean(self, rows: BoolArray, variance: float) -> float:
        """Give that of the mean of touches that were not fitted, where they scatter so much."""
        row = self.design[rows].mean(axis=0)
        return float(np.sqrt(variance * (1.0 / rows.sum() + row @ self.inverse @ row)))


@dataclass(frozen=True, slots=True)
class Grid:
    """What figures are rounded to.

    Attributes:
        step: That they are multiples of, as they show; None where they show none.
        resolution: As it is believed: where all but a few are the same, they show no step.
        own: The step of the axis of each touch, where several axes were touched; shape (n,).
    """

    step: float | None
    resolution: float
    own: FloatArray | None = None

    def finest(self, values: FloatArray) -> float:
        """Give what nothing smaller is told than: the step, if these fall on one.

        Where they are too few to show it, it is that of those that come again, or else as believed.
        """
        if self.step is not None:
            return self.step
        known, counts = np.unique(np.round(values, FINEST), return_counts=True)
        if counts[counts > 1].sum() <= len(values) / 2.0:
            return NOTHING
        often = known[counts > 1]
        return float(np.diff(often).min()) if len(often) > 1 else self.resolution


def grid_of(values: FloatArray, axis: np.typing.NDArray[np.integer], resolution: float) -> Grid:
    """Tell what values are rounded to, and those of each axis where there are several."""
    whole = Grid(common_step(values), resolution)
    axes = np.unique(axis)
    if len(axes) == 1:
        return whole
    own = np.zeros(len(values))
    for each in axes:
        rows = axis == each
        own[rows] = Grid(common_step(values[rows]), resolution).finest(values[rows])
    return replace(whole, own=own)


def by_t(value: float, error: float, freedom: int) -> Interval:
    """Give a value with its interval by Student's t."""
    reach = float(scipy.stats.t.ppf(0.5 + CONFIDENCE / 2.0, max(freedom, 1))) * error
    return Interval(value, value - reach, value + reach)


def fit_surfaces(
    y: FloatArray,
    dummies: FloatArray,
    lines: dict[str, FloatArray],
    rows: BoolArray,
    step: float = 0.0,
) -> SurfaceFit:
    """Fit the middle of each surface, and lines to all of them together.

    Args:
        y: Shape (n,).
        dummies: 1 where a touch is of a surface, else 0; shape (n, s).
        lines: What there is a line in, by name; shape (n,) each.
        rows: The touches that are fitted; shape (n,).
        step: What readings are rounded to: no slope is known better than that lets it be.
    """
    used = {name: x for name, x in lines.items() if rows.sum() > dummies.shape[1] + len(lines)}
    design = np.column_stack([dummies, *used.values()])
    scale = np.maximum(np.abs(design).max(axis=0), 1e-300)
    scaled = design / scale
    beta, _, rank, _ = np.linalg.lstsq(scaled[rows], y[rows], rcond=None)
    beta[np.abs(beta) < NOTHING] = 0.0
    residuals = y - scaled @ beta
    residuals[np.abs(residuals) < NOTHING] = 0.0
    freedom = max(int(rows.sum() - rank), 1)
    variance = float(np.sum(residuals[rows] ** 2) / freedom)
    inverse = np.linalg.pinv(scaled[rows].T @ scaled[rows])
    covariance = max(variance, step**2 / 12.0) * inverse
    first = dummies.shape[1]
    slopes = {
        name: (
            float(beta[first + i] / scale[first + i]),
            float(np.sqrt(max(covariance[first + i, first + i], 0.0)) / scale[first + i]),
        )
        for i, name in enumerate(used)
    }
    return SurfaceFit(residuals, slopes, freedom, _sigma(variance, freedom), scaled, inverse)


def _sigma(variance: float, freedom: int) -> Interval:
    low = float(scipy.stats.chi2.ppf(0.5 + CONFIDENCE / 2.0, freedom))
    high = float(scipy.stats.chi2.ppf(0.5 - CONFIDENCE / 2.0, freedom))
    return Interval(
        float(np.sqrt(variance)),
        float(np.sqrt(variance * freedom / low)),
        float(np.sqrt(variance * freedom / high)),
    )


def outlying(
    residuals: FloatArray, rows: BoolArray, grid: Grid, sigmas: float = OUTLYING_SIGMAS
) -> BoolArray:
    """Tell what lies far off by the middle size of the others."""
    centre = float(np.median(residuals[rows]))
    scatter = NORMAL_PER_MAD * float(np.median(np.abs(residuals[rows] - centre)))
    step = grid.step or (0.0 if scatter else grid.resolution)
    steps = np.maximum(step, 0.0 if grid.own is None else grid.own)
    limit = np.maximum(OUTLYING_STEPS * steps, max(sigmas * scatter, NOTHING))
    far = np.abs(residuals - centre) > limit
    if scatter == 0.0 and far[rows].mean() > MOST_OUTLYING:  # a coarse step hides what scatters
        far = np.abs(residuals - centre) > sigmas * float(np.std(residuals[rows]))
    return np.asarray(far)
