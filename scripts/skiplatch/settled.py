"""What touches show for certain: lines, first touches that are off, and outliers.

A line is taken out only where touches show it, else it stays in the scatter. What is told is told
at a level of 1 %: of each line and of first touches, several of which are looked at in any log; of
an outlier for all touches, which the choice of lines and touches raises, to less than 5 %. Nothing
below a step of the readings is told.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.statistics import CONFIDENCE, Interval
from skiplatch.succession import independent_share
from skiplatch.surface_fit import (
    NOTHING,
    OUTLYING_SIGMAS,
    Grid,
    SurfaceFit,
    by_t,
    fit_surfaces,
    outlying,
)

CONDITION = "speed"
"""The line in the feed, which readings differ by as they do by their surface."""
DRIFTS = ("order", "axis")
"""Lines in the order of the touches: what these keep of those before is no drift."""
TOLD_BY_CHANCE = 0.01
"""Chance with which a figure that is 0 is told; its interval, of 95 %, leaves 0 out more often."""
OUTLIER_BY_CHANCE = 0.01
"""Chance with which any touch of a campaign is called an outlier, by a fit chosen beforehand."""
FEWEST_SAME = 20
"""Touches from which on one is an outlier where all others are the same, be it off by one step."""
COARSEST = 20.0
"""Times the resolution that is believed; where fewer are the same, a step may be so coarse."""
MOST_APART = 0.25
"""Of the touches; where more lie apart, there are two conditions, and first touches of neither."""
BY_ACCIDENT = 0.05
"""Chance of as many touches being off at which being first is no reason."""
FEWEST_FREE = 3
"""Degrees of freedom from which on first touches are told from others."""
MOST_LEFT = 0.4
"""Of a scatter, beside a line that is one: of a step half is left."""
TURNS = 5  # of leaving outliers out until they stay the same
REWEIGHTINGS = 30  # of a fit of least absolute values
NEGLIGIBLE = 1e-6  # of the range; a smaller residual counts as this


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """What touches show once lines and outliers are told.

    Attributes:
        fit: With the lines that are shown.
        regular: The touches that were fitted; shape (n,).
        intervals: Of all lines, by name; of one that is not shown as it was before it was dropped.
    """

    fit: SurfaceFit
    regular: BoolArray
    intervals: dict[str, Interval]


def is_shown(figure: Interval | None, freedom: int) -> bool:
    """Tell whether a figure is not 0, by an interval about it of so many degrees of freedom."""
    if figure is None or figure.low <= 0.0 <= figure.high:
        return False
    near = figure.low if figure.low > 0.0 else figure.high
    told, usual = (
        float(scipy.stats.t.isf(chance / 2.0, max(freedom, 1)))
        for chance in (TOLD_BY_CHANCE, 1.0 - CONFIDENCE)
    )
    return abs(figure.value - near) * told < abs(figure.value) * usual


def fit_shown(
    y: FloatArray, dummies: FloatArray, lines: dict[str, FloatArray], rows: BoolArray, least: float
) -> Settled:
    """Fit the lines that are shown, the others dropped one after the other, the weakest first.

    Args:
        y: Shape (n,).
        dummies: 1 where a touch is of a surface, else 0; shape (n, s).
        lines: What there may be a line in, by name; shape (n,) each.
        rows: The touches that are fitted; shape (n,).
        least: What a line changes readings by at least, from one end to the other.
    """
    kept = dict(lines)
    dropped: dict[str, Interval] = {}
    while True:
        fit = fit_surfaces(y, dummies, kept, rows, least)
        share = independent_share(fit.residuals[rows])
        found = {
            name: each
            for name in kept
            if (each := fit.interval(name, share if name in DRIFTS else 1.0)) is not None
        }
        weak = {
            name: abs(each.value) / max(each.high - each.low, NOTHING)
            for name, each in found.items()
            if not is_shown(each, fit.freedom)
            or abs(each.value) * np.ptp(kept[name][rows]) <= least
        }
        if not weak:
            return Settled(fit, rows, found | dropped)
        weakest = min(weak, key=lambda name: weak[name])
        dropped[weakest] = found[weakest]
        del kept[weakest]


def settle(
    y: FloatArray,
    dummies: FloatArray,
    lines: dict[str, FloatArray],
    rows: BoolArray,
    usual: BoolArray,
    grid: Grid,
) -> Settled:
    """Tell outliers and lines: what lies far off by its looks has to do so by a test as well.

    Args:
        y: Shape (n,).
        dummies: 1 where a touch is of a surface, else 0; shape (n, s).
        lines: What there may be a line in, by name; shape (n,) each.
        rows: The touches that are fitted; shape (n,).
        usual: Those that others are looked at by: no first touches; shape (n,).
        grid: What readings are rounded to.
    """
    least = grid.finest(y[rows])
    regular, looks = _regular(y, dummies, lines, usual, grid)
    far = rows & ~regular & (usual | outlying(looks.residuals, regular, grid))
    whole = fit_shown(y, dummies, lines, rows, least).fit
    while True:
        found = fit_shown(y, dummies, lines, rows & ~far, least)
        is_own = [name for name in lines if name == CONDITION or name in whole.lines]
        level = y - sum(found.fit.part(name, lines[name]) for name in is_own)
        outside = _outside(np.asarray(level), dummies, far, found.regular, least)
        again = far & outside & _is_no_chance(found, int(rows.sum()), grid)
        if (again == far).all():
            return found
        far = again


def _is_no_chance(found: Settled, touches: int, grid: Grid) -> BoolArray:
    """Tell which touches lie further off a fit without them than any of so many does by chance."""
    if found.fit.sigma.value == 0.0 and touches < FEWEST_SAME:
        return np.asarray(np.abs(found.fit.residuals) > COARSEST * grid.resolution)
    limit = float(scipy.stats.t.isf(OUTLIER_BY_CHANCE / (2.0 * touches), found.fit.freedom))
    return np.asarray(np.abs(found.fit.residuals) > limit * found.fit.errors())


def _outside(
    y: FloatArray, dummies: FloatArray, far: BoolArray, regular: BoolArray, step: float
) -> BoolArray:
    """Tell which of those far off lie outside the range of their surface, by more than a step."""
    outside = np.zeros(len(y), dtype=bool)
    for i in np.flatnonzero(far):
        others = y[regular & (dummies[:, dummies[i].argmax()] > 0.0)]
        outside[i] = not len(others) or not (
            others.min() - step <= y[i] <= others.max() + step + NOTHING
        )
    return outside


def first_off(
    y: FloatArray,
    dummies: FloatArray,
    lines: dict[str, FloatArray],
    is_first: BoolArray,
    grid: Grid,
) -> Interval | None:
    """Give how far first touches are off what the others let expect, each a new draw.

    Worked out with the line in the order, which is then extrapolated to them, and without it; where
    that line is most of the scatter, with it and with one that is bent, as a drift may be. Where
    both do not say the same, that is given which says less.
    """
    others = settle(y, dummies, lines, ~is_first, ~is_first, grid)
    if others.regular.sum() < (1.0 - MOST_APART) * (~is_first).sum():
        return None
    # Where others are off as often, so are first touches by accident.
    off = 1.0 - others.regular.sum() / max((~is_first).sum(), 1)
    if off ** is_first.sum() > BY_ACCIDENT:
        return None
    kept = {name: x for name, x in lines.items() if name in others.fit.lines}
    found = []
    straight = kept | {"order": lines["order"]}
    flat = fit_surfaces(y, dummies, _without(kept, "order"), others.regular)
    is_line = "order" in kept and others.fit.sigma.value < MOST_LEFT * flat.sigma.value
    for some in (straight, _bent(straight) if is_line else _without(kept, "order")):
        fit = fit_surfaces(y, dummies, some, others.regular)
        if not is_first.any() or fit.freedom < FEWEST_FREE:
            return None
        found.append(_first(fit, is_first))
    if all(each.low > 0.0 for each in found) or all(each.high < 0.0 for each in found):
        return found[0] if "order" in kept else found[1]
    if not any(each.low <= 0.0 <= each.high for each in found):  # to either side
        low, high = min(each.low for each in found), max(each.high for each in found)
        return Interval(found[0].value, low, high)
    return min(found, key=lambda each: abs(each.value) / max(each.high - each.low, NOTHING))


def _first(fit: SurfaceFit, is_first: BoolArray) -> Interval:
    residuals, variance = fit.residuals[is_first], fit.sigma.value**2
    if len(residuals) > 1:
        variance = max(variance, float(np.var(residuals, ddof=1)))
    return by_t(float(residuals.mean()), fit.error_of_mean(is_first, variance), fit.freedom)


def _without(lines: dict[str, FloatArray], name: str) -> dict[str, FloatArray]:
    return {each: x for each, x in lines.items() if each != name}


def _bent(lines: dict[str, FloatArray]) -> dict[str, FloatArray]:
    order = lines["order"]
    return lines | {"bend": (order - order.mean()) ** 2}


def _regular(
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
