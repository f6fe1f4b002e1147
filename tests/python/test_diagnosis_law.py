"""The density of a residual's law, against integrals and closed forms computed elsewhere."""

from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate, special, stats

from law_densities import law_log_density
from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.law import SMALLEST, Extra, Law

CONTAMINATION = 1e-3
REACH = 7.0
LAWS = [
    (1.0, 5.0, 3.0),
    (0.01, 5.0, 3.0),
    (1.0, 0.01, 3.0),
    (0.2, 4.0, 4.0),
    (1.0, 0.0, 0.05),
    (0.5, 0.0, 0.0),
    (0.0, 2.0, 0.5),
    (0.0, 0.0, 1.0),
    (1e-3, 2000.0, 0.5),
]


def log_density(x: FloatArray, law: tuple[float, float, float], *extras: Extra) -> FloatArray:
    sigma, box_a, box_b = law
    one = np.ones_like(x)
    return law_log_density(Law(0.3 * one, sigma * one, box_a * one, box_b * one, extras), x, REACH)


def contaminated(x: FloatArray, density: FloatArray) -> FloatArray:
    wide = stats.cauchy.pdf(x, scale=REACH)
    return np.asarray(np.log((1.0 - CONTAMINATION) * density + CONTAMINATION * wide))


def trapezoid(t: float, box_a: float, box_b: float) -> float:
    """Density of the sum of two boxes."""
    overlap = min(box_a, t) - max(0.0, t - box_b)
    return max(0.0, overlap) / (box_a * box_b)


def integrated(x: float, sigma: float, box_a: float, box_b: float) -> float:
    """Density of two boxes and a Gaussian, by numbers alone; sigma > 0."""
    if box_a == 0.0 and box_b == 0.0:
        return float(stats.norm.pdf(x, scale=sigma))
    if box_a == 0.0 or box_b == 0.0:
        box = max(box_a, box_b)
        return float(special.ndtr(x / sigma) - special.ndtr((x - box) / sigma)) / box
    ends = np.array([0.0, box_a, box_b, box_a + box_b, x - 9.0 * sigma, x, x + 9.0 * sigma])
    ends = np.unique(np.clip(ends, max(0.0, x - 9.0 * sigma), min(box_a + box_b, x + 9.0 * sigma)))
    pieces = [
        integrate.quad(
            lambda t: trapezoid(t, box_a, box_b) * np.exp(-0.5 * ((x - t) / sigma) ** 2),
            low,
            high,
            epsrel=1e-11,
            epsabs=0.0,
        )[0]
        for low, high in pairwise(ends)
    ]
    return float(sum(pieces) / (sigma * np.sqrt(2.0 * np.pi)))


def integrated_exponential(
    x: float, sigma: float, box_a: float, box_b: float, mean: float
) -> float:
    """Density of at least one box, a Gaussian and an exponential, by numbers alone; sigma > 0."""
    boxes = sorted(box for box in (box_a, box_b) if box > 0.0)
    whole = sum(boxes)

    def density(t: float) -> float:
        over_boxes = trapezoid(t, *boxes) if len(boxes) == 2 else 1.0 / whole
        return over_boxes * float(exponential_gauss(np.array(x - t), sigma, mean))

    ends = np.array([0.0, *boxes, whole, *(x + np.linspace(-9.0, 9.0, 7) * sigma)])
    ends = np.unique(np.clip(ends, 0.0, whole))
    return sum(
        integrate.quad(density, low, high, epsrel=1e-10, epsabs=1e-13)[0]
        for low, high in pairwise(ends)
    )


def places(law: tuple[float, float, float]) -> FloatArray:
    """Some residuals below, about and above the law."""
    sigma, box_a, box_b = law
    inside = np.linspace(0.01, 0.99, 9) * (box_a + box_b)
    edges = np.array([0.0, box_a, box_b, box_a + box_b])
    around = np.linspace(-4.0, 4.0, 7) * np.hypot(sigma, SMALLEST)
    return np.asarray(0.3 + np.concatenate([inside, (edges[:, None] + around).ravel()]))


def exponential_gauss(x: FloatArray, sigma: float, mean: float) -> FloatArray:
    """Density of a Gaussian plus an exponential, without factors that overflow or cancel."""
    below = (sigma / mean - x / sigma) / np.sqrt(2.0)
    ordinary = stats.norm.pdf(x / sigma) * np.sqrt(np.pi / 2.0) * special.erfcx(np.abs(below))
    exponent = np.where(below > 0.0, 0.0, 0.5 * (sigma / mean) ** 2 - x / mean)
    straight = 0.5 * np.exp(exponent) * special.erfc(below)
    return np.asarray(np.where(below > 0.0, ordinary, straight) / mean)


@pytest.mark.parametrize("law", LAWS)
def test_two_boxes_and_a_gaussian_agree_with_an_integral(law: tuple[float, float, float]) -> None:
    """A box that counts by its variance alone is not exact, so that 1e-4 is allowed."""
    x = places(law)
    sigma = float(np.hypot(law[0], SMALLEST))
    expected = np.array([integrated(value - 0.3, sigma, *law[1:]) for value in x])

    np.testing.assert_allclose(log_density(x, law), contaminated(x, expected), atol=1e-4)


@pytest.mark.parametrize("law", [law for law in LAWS if min(law[1:]) > 0.1 * law[0]])
def test_boxes_that_are_wide_enough_are_exact(law: tuple[float, float, float]) -> None:
    x = places(law)
    sigma = float(np.hypot(law[0], SMALLEST))
    expected = np.array([integrated(value - 0.3, sigma, *law[1:]) for value in x])

    np.testing.assert_allclose(log_density(x, law), contaminated(x, expected), atol=2e-9)


@pytest.mark.parametrize("law", LAWS)
def test_a_law_is_as_exact_on_its_right_as_on_its_left(law: tuple[float, float, float]) -> None:
    middle = 0.3 + (law[1] + law[2]) / 2.0
    away = np.concatenate([np.linspace(0.0, 20.0, 101), [1e3, 1e6]])
    left, right = (
        np.exp(log_density(x, law)) - CONTAMINATION * stats.cauchy.pdf(x, scale=REACH)
        for x in (middle - away, middle + away)
    )

    np.testing.assert_allclose(left, right, rtol=1e-6, atol=1e-15)


@pytest.mark.parametrize("x", [-1e6, 1e6])
@pytest.mark.parametrize("extra", [(), (Extra(0.4, mean=5.0),), (Extra(0.4, width=50.0),)])
@pytest.mark.parametrize("law", LAWS)
def test_far_off_there_is_nothing_but_contamination(
    law: tuple[float, float, float], extra: tuple[Extra, ...], x: float
) -> None:
    far = np.array([x])

    np.testing.assert_allclose(
        log_density(far, law, *extra), contaminated(far, np.zeros(1)), rtol=1e-12
    )


@pytest.mark.parametrize("ratio", [0.11, 1.0, 30.0, 1e6])
@pytest.mark.parametrize("sigma", [1e-3, 1.0, 1e3])
def test_an_exponential_beside_a_gaussian_agrees_with_its_closed_form(
    sigma: float, ratio: float
) -> None:
    mean = ratio * sigma
    x = np.linspace(-8.0, 8.0, 33) * sigma + np.linspace(0.0, 3.0, 33) * mean
    width = float(np.hypot(sigma, SMALLEST))
    expected = exponential_gauss(x, width, mean)
    found = log_density(x + 0.3, (sigma, 0.0, 0.0), Extra(1.0, mean=mean))

    np.testing.assert_allclose(found, contaminated(x + 0.3, expected), atol=1e-9)


@pytest.mark.parametrize("mean", [1e-9, 1e-3, 0.02])
def test_a_tiny_exponential_is_an_offset(mean: float) -> None:
    """Far in the tail of the normal distribution, whose logarithm must not lose its digits."""
    x = np.linspace(-30.0, 30.0, 121)
    expected = stats.norm.pdf(x - mean, scale=np.sqrt(100.0 + SMALLEST**2 + mean**2))
    found = log_density(x + 0.3, (10.0, 0.0, 0.0), Extra(1.0, mean=mean))

    np.testing.assert_allclose(found, contaminated(x + 0.3, expected), atol=1e-7)


def test_the_exponential_agrees_with_scipy() -> None:
    x = np.linspace(-3.0, 30.0, 67)
    expected = stats.exponnorm.pdf(x, 4.0, scale=np.hypot(1.0, SMALLEST))
    found = log_density(x + 0.3, (1.0, 0.0, 0.0), Extra(1.0, mean=4.0))

    np.testing.assert_allclose(found, contaminated(x + 0.3, expected), atol=1e-7)


@pytest.mark.parametrize("mean", [0.01, 0.3, 4.0, 500.0])
@pytest.mark.parametrize("law", [(1.0, 0.0, 0.0), (0.2, 0.0, 5.0), (1.0, 5.0, 3.0)])
def test_an_exponential_that_takes_away_is_the_same_from_the_other_side(
    law: tuple[float, float, float], mean: float
) -> None:
    x = np.concatenate([np.linspace(-3.0, 12.0, 31), mean * np.array([0.1, 1.0, 5.0])])
    more, less = Extra(0.6, offset=2.0, mean=mean), Extra(0.6, offset=-2.0, mean=-mean)
    far = 0.6 + sum(law[1:]) - x

    found, same = log_density(far, law, less), log_density(x, law, more)

    wide = [CONTAMINATION * stats.cauchy.pdf(at, scale=REACH) for at in (far, x)]
    np.testing.assert_allclose(np.exp(found) - wide[0], np.exp(same) - wide[1], atol=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("mean", [0.3, 4.0, 500.0])
@pytest.mark.parametrize(
    "law",
    [
        (1.0, 5.0, 3.0),
        (0.01, 5.0, 3.0),
        (1e-4, 0.0, 50.0),
        (0.2, 4.0, 4.0),
        (0.0, 2.0, 0.5),
        (1e-3, 2000.0, 0.5),
        (0.05, 0.25, 50.0),
        (2.0, 0.25, 0.5),
    ],
)
def test_boxes_beside_an_exponential_agree_with_an_integral(
    law: tuple[float, float, float], mean: float
) -> None:
    """From an exponential that is short for the boxes to one that is long; no shape is lost."""
    sigma = float(np.hypot(law[0], SMALLEST))
    x = np.concatenate([places(law), 0.3 + sum(law[1:]) + mean * np.array([0.1, 1.0, 5.0])])
    expected = np.array([integrated_exponential(at - 0.3, sigma, *law[1:], mean) for at in x])
    found = log_density(x, law, Extra(1.0, mean=mean))

    is_exact = min(b for b in law[1:] if b > 0.0) > 0.1 * sigma and mean > 0.1 * sigma
    tolerance = 2e-7 if is_exact else 3e-4
    np.testing.assert_allclose(found, contaminated(x, expected), atol=tolerance)


@pytest.mark.parametrize("mean", [1e4, 1e6, 1e8])
def test_an_exponential_that_is_long_beyond_measure_keeps_its_density(mean: float) -> None:
    """Where the closed form would cancel, a box counts as a shift: beyond its edges that is so."""
    x = np.array([20.0, 100.0, 0.5 * mean])
    expected = np.exp(-(x - 2.5) / mean) / mean
    found = log_density(x + 0.3, (0.01, 2.0, 3.0), Extra(1.0, mean=mean))

    np.testing.assert_allclose(found, contaminated(x + 0.3, expected), rtol=1e-6)


@pytest.mark.parametrize("law", [(0.2, 2.0, 5.0), (0.2, 5.0, 2.0), (0.2, 5.0, 3.0)])
def test_of_three_boxes_the_narrowest_counts_by_mean_and_variance(
    law: tuple[float, float, float],
) -> None:
    x = np.linspace(-2.0, 12.0, 57)
    narrow, *wide = sorted([*law[1:], 3.0])
    sigma = float(np.sqrt(0.2**2 + SMALLEST**2 + narrow**2 / 12.0 + 0.01**2))
    at = x - narrow / 2.0 - 0.01
    expected = np.array([integrated(value, sigma, *wide) for value in at])
    found = log_density(x + 0.3, law, Extra(1.0, width=3.0, mean=0.01))

    np.testing.assert_allclose(found, contaminated(x + 0.3, expected), atol=2e-9)


def test_an_extra_takes_its_share_from_the_others() -> None:
    x = np.linspace(-5.0, 15.0, 81)
    both = [Extra(0.3, offset=4.0, sigma=2.0), Extra(0.2, width=3.0)]
    plain = np.exp(log_density(x, (0.5, 1.0, 2.0)))
    alone = [
        np.exp(log_density(x, (0.5, 1.0, 2.0), Extra(1.0, e.offset, e.width, sigma=e.sigma)))
        for e in both
    ]
    mixed = np.log(0.5 * plain + 0.3 * alone[0] + 0.2 * alone[1])

    np.testing.assert_allclose(log_density(x, (0.5, 1.0, 2.0), *both), mixed, atol=1e-12)


def test_touches_without_their_box_lack_box_a() -> None:
    x = np.linspace(-1.0, 6.0, 57)
    without = log_density(x, (0.5, 0.0, 0.4), Extra(1.0, width=3.0))

    found = log_density(x, (0.5, 2.0, 0.4), Extra(1.0, width=3.0, boxless=1.0))

    np.testing.assert_allclose(found, without, atol=1e-12)


@pytest.mark.parametrize(
    "extra",
    [
        Extra(0.3, width=2.0),
        Extra(0.2, offset=1.0, mean=3.0),
        Extra(1.0, offset=0.5),
        Extra(0.5, offset=-1.0, sigma=0.7),
        Extra(0.5, width=3.0, boxless=1.0),
        Extra(0.9, mean=0.05),
    ],
)
@pytest.mark.parametrize("law", LAWS[:-1])
def test_a_law_holds_all_probability(law: tuple[float, float, float], extra: Extra) -> None:
    grid = np.union1d(np.linspace(-3.0, 12.0, 200_001), np.linspace(-200.0, 400.0, 20_001))
    total = np.trapezoid(np.exp(log_density(grid, law, extra)), grid)

    assert total == pytest.approx(1.0, abs=1e-4)


def test_a_law_of_each_touch_is_that_of_the_touch_alone() -> None:
    rng = np.random.default_rng(1)
    n = 50
    x, *parts = rng.uniform(0.0, 2.0, (5, n))
    offset, width, mean, sigma = rng.uniform(1.0, 2.0, (4, n))
    boxless = rng.integers(0, 2, n).astype(float)
    extras = (Extra(0.3, offset, width, mean, sigma, boxless), Extra(0.2, mean=1.0))
    law = Law(parts[0], parts[1], parts[2], parts[3], extras)
    apart = [law_log_density(law.select(row), x[row], REACH)[0] for row in np.eye(n, dtype=bool)]

    np.testing.assert_allclose(law_log_density(law, x, REACH), apart, atol=1e-12)


def test_no_residuals_have_no_densities() -> None:
    assert log_density(np.zeros(0), (1.0, 1.0, 1.0), Extra(0.5)).shape == (0,)
