"""Middles of surfaces and straight lines by least squares, and what lies far off them."""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.statistics import CONFIDENCE, Interval

NORMAL_PER_MAD = 1.4826
OUTLYING_SIGMAS = 5.0  # one in a million of a normal scatter
OUTLYING_STEPS = 2.5
MOST_OUTLYING = 0.1  # of the touches, where more than half are the same
REWEIGHTINGS = 30  # of a fit of least absolute values
NEGLIGIBLE = 1e-6  # of the range; a smaller residual counts as this
TURNS = 5  # of leaving outliers out until they stay the same
NOTHING = 1e-9  # µm or µs; less is what floating-point sums leave


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceFit:
    """Middles of surfaces and straight lines, by least squares.

    Attributes:
        residuals: Of all touches, those left out too; shape (n,).
        lines: Slope and its standard error, by name.
        freedom: Degrees of freedom.
        sigma: Of the residuals.
    """

    residuals: FloatArray
    lines: dict[str, tuple[float, float]]
    freedom: int
    sigma: Interval

    def interval(self, name: str) -> Interval | None:
        """Give a slope with its interval."""
        if name not in self.lines:
            return None
        slope, error = self.lines[name]
        return by_t(slope, error, self.freedom)

    def part(self, name: str, values: FloatArray) -> FloatArray:
        """Give what a line adds, less its mean; shape (n,)."""
        slope = self.lines.get(name, (0.0, 0.0))[0]
        return np.asarray(slope * (values - values.mean()))


@dataclass(frozen=True, slots=True)
class Grid:
    """What figures are rounded to.

    Attributes:
        step: That they are multiples of, as they show; None where they show none.
        resolution: As it is believed: where all but a few are the same, they show no step.
    """

    step: float | None
    resolution: float


def by_t(value: float, error: float, freedom: int) -> Interval:
    """Give a value with its interval by Student's t."""
    reach = float(stats.t.ppf(0.5 + CONFIDENCE / 2.0, max(freedom, 1))) * error
    return Interval(value, value - reach, value + reach)


def fit_surfaces(
    y: FloatArray, dummies: FloatArray, lines: dict[str, FloatArray], rows: BoolArray
) -> SurfaceFit:
    """Fit the middle of each surface, and lines to all of them together.

    Args:
        y: Shape (n,).
        dummies: 1 where a touch is of a surface, else 0; shape (n, s).
        lines: What there is a line in, by name; shape (n,) each.
        rows: The touches that are fitted; shape (n,).
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
    covariance = variance * np.linalg.pinv(scaled[rows].T @ scaled[rows])
    first = dummies.shape[1]
    slopes = {
        name: (
            float(beta[first + i] / scale[first + i]),
            float(np.sqrt(max(covariance[first + i, first + i], 0.0)) / scale[first + i]),
        )
        for i, name in enumerate(used)
    }
    return SurfaceFit(residuals, slopes, freedom, _sigma(variance, freedom))


def _sigma(variance: float, freedom: int) -> Interval:
    low = float(stats.chi2.ppf(0.5 + CONFIDENCE / 2.0, freedom))
    high = float(stats.chi2.ppf(0.5 - CONFIDENCE / 2.0, freedom))
    return Interval(
        float(np.sqrt(variance)),
        float(np.sqrt(variance * freedom / low)),
        float(np.sqrt(variance * freedom / high)),
    )


def without_outliers(
    y: FloatArray,
    dummies: FloatArray,
    lines: dict[str, FloatArray],
    rows: BoolArray,
    grid: Grid,
) -> tuple[BoolArray, SurfaceFit]:
    """Fit, leave out what lies far off, and fit again until that stays the same."""
    off = _off_the_middle(y, np.column_stack([dummies, *lines.values()]), rows)
    regular = rows & ~outlying(off, rows, grid, OUTLYING_SIGMAS * 2.0)
    fit = fit_surfaces(y, dummies, lines, regular)
    for _ in range(TURNS):
        again = rows & ~outlying(fit.residuals, regular, grid)
        if (again == regular).all() or again.sum() <= dummies.shape[1] + len(lines):
            break
        regular = again
        fit = fit_surfaces(y, dummies, lines, regular)
    return regular, fit


def outlying(
    residuals: FloatArray, rows: BoolArray, grid: Grid, sigmas: float = OUTLYING_SIGMAS
) -> BoolArray:
    """Tell what lies far off by the middle size of the others."""
    centre = float(np.median(residuals[rows]))
    scatter = NORMAL_PER_MAD * float(np.median(np.abs(residuals[rows] - centre)))
    step = grid.step or (0.0 if scatter else grid.resolution)
    limit = max(sigmas * scatter, OUTLYING_STEPS * step, NOTHING)
    far = np.abs(residuals - centre) > limit
    if scatter == 0.0 and far[rows].mean() > MOST_OUTLYING:  # a coarse step hides what scatters
        far = np.abs(residuals - centre) > sigmas * float(np.std(residuals[rows]))
    return np.asarray(far)


def _off_the_middle(y: FloatArray, design: FloatArray, rows: BoolArray) -> FloatArray:
    """Give the residuals of a fit of least absolute values, which outliers hardly move.

    Lines are fitted along: where one surface was touched mostly slowly and another mostly fast,
    the medians of both hide what goes with the feed.

    Args:
        y: Shape (n,).
        design: Surfaces and lines; shape (n, k).
        rows: The touches that are fitted; shape (n,).
    """
    scaled = design / np.maximum(np.abs(design).max(axis=0), 1e-300)
    least = max(NEGLIGIBLE * float(np.ptp(y[rows])), NOTHING)
    root = rows.astype(float)
    residuals = y
    for _ in range(REWEIGHTINGS):
        beta = np.linalg.lstsq(scaled * root[:, None], y * root, rcond=None)[0]
        residuals = y - scaled @ beta
        root = rows / np.sqrt(np.maximum(np.abs(residuals), least))
    return np.asarray(residuals)
