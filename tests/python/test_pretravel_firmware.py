"""The firmware's mathematics of pretravel, against a second writing of it in numpy and scipy."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.stats import linregress

from skiplatch.compensation import firmware
from skiplatch.compensation.firmware import Plan, PretravelError, Shape, Side, Target
from skiplatch.compensation.radius_map import Map

AZIMUTHS = np.arange(0.0, 360.0, 10.0)
ALPHA = np.concatenate([np.tile(AZIMUTHS, 3), [0.0]])
BETA = np.concatenate([np.repeat([0.0, 30.0, 60.0], len(AZIMUTHS)), [90.0]])
TAU_MS = 12.68
SPEED = 50.0


def lobes_um(turned_deg: float = 0.0) -> np.ndarray:
    """The seat of three contacts of an OMP40-2, 50 mm, with its sharp edges; shape (109,)."""
    psi = np.radians((ALPHA + turned_deg + 60.0) % 120.0 - 60.0)
    beta = np.radians(BETA)
    lever, c = 0.0855, 0.121
    across = np.cos(beta) * ((1.0 - c) * np.cos(psi) + 0.827 * c)
    force = 5.85 * lever / (across + lever * np.sin(beta))
    return np.asarray(force * (20.67 * np.cos(beta) ** 2 + 2.17 * np.sin(beta) ** 2))


def sphere(radius_um: np.ndarray, centre_um: tuple[float, float, float]) -> np.ndarray:
    """Points in the directions of the map; shape (109, 3)."""
    alpha, beta = np.radians(ALPHA), np.radians(BETA)
    unit = [np.cos(alpha) * np.cos(beta), np.sin(alpha) * np.cos(beta), np.sin(beta)]
    points: np.ndarray = radius_um[:, None] * np.stack(unit, axis=1) + centre_um
    return points


def test_the_delay_is_that_of_scipys_regression() -> None:
    rng = np.random.default_rng(1)
    speeds = np.repeat([50.0, 100.0, 150.0], 5)
    radii = 26_000.0 + speeds * 14.5 / 60.0 + rng.normal(0.0, 0.3, 15)

    ours = firmware.estimate_tau(speeds, radii)
    theirs = linregress(speeds, radii)
    assert ours.tau_ms == pytest.approx(60.0 * theirs.slope, rel=1e-10)
    assert ours.tau_uncertainty_ms == pytest.approx(60.0 * theirs.stderr, rel=1e-7)
    assert ours.offset_um == pytest.approx(theirs.intercept, rel=1e-12)
    mirrored = firmware.estimate_tau(speeds, -radii, Side.OUTSIDE)
    assert mirrored.tau_ms == pytest.approx(ours.tau_ms, rel=1e-12)


def test_the_interval_of_the_delay_holds_the_truth_as_often_as_it_says() -> None:
    """Two standard uncertainties at 13 degrees of freedom: 93.3 %; 4 σ of 1000 draws is 3.2 %."""
    rng = np.random.default_rng(2)
    speeds = np.repeat([50.0, 100.0, 150.0], 5)
    held = 0
    for _ in range(1000):
        tau = firmware.estimate_tau(speeds, speeds * 14.5 / 60.0 + rng.normal(0.0, 0.3, 15))
        held += abs(tau.tau_ms - 14.5) <= 2.0 * tau.tau_uncertainty_ms

    assert 0.90 < held / 1000 < 0.966


def test_the_sphere_is_that_of_a_general_optimiser() -> None:
    rng = np.random.default_rng(3)
    points = sphere(12_500.0 + lobes_um() + rng.normal(0.0, 1.0, 109), (40.0, -25.0, 8.0))

    def residuals(guess: np.ndarray) -> np.ndarray:
        return np.asarray(np.linalg.norm(points - guess[:3], axis=1) - guess[3])

    ours = firmware.fit(points, Shape.SPHERE)
    theirs = least_squares(
        residuals,
        [*points.mean(axis=0), 12_000.0],
        x_scale="jac",
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
    )
    assert ours.centre_um == pytest.approx(theirs.x[:3], abs=1e-4)
    assert ours.radius_um == pytest.approx(theirs.x[3], abs=1e-4)
    radii = firmware.radii_um(points, ours)
    assert radii == pytest.approx(np.linalg.norm(points - ours.centre_um, axis=1), rel=1e-12)
    assert ours.scatter_um == pytest.approx(np.sqrt(np.mean((radii - ours.radius_um) ** 2)))


def test_a_map_is_the_mean_of_each_direction_in_any_order() -> None:
    rng = np.random.default_rng(4)
    runs = lobes_um() + rng.normal(0.0, 0.5, (10, 109))
    order = rng.permutation(1090)

    found = Map.from_readings(
        np.tile(ALPHA, 10)[order], np.tile(BETA, 10)[order], runs.ravel()[order]
    )
    found.check()
    assert np.array_equal(found.alpha_deg, ALPHA)
    assert np.array_equal(found.beta_deg, BETA)
    assert found.radius_um == pytest.approx(runs.mean(axis=0), rel=1e-12)
    assert found.scatter_um == pytest.approx(runs.std(axis=0, ddof=1), rel=1e-9)
    assert np.all(found.runs == 10)


def test_speeds_of_a_perfect_map_make_up_for_its_range_to_a_thousandth() -> None:
    radii = lobes_um()

    table = firmware.speed_table(radii, SPEED, Plan(tau_ms=TAU_MS))
    made_up_um = np.ptp(table.speed_mm_min) * TAU_MS / 60.0
    assert made_up_um == pytest.approx(firmware.range_um(radii), rel=1e-3)
    assert table.speed_mm_min == pytest.approx(
        SPEED + (radii.mean() - radii) / TAU_MS * 60.0, rel=1e-12
    )
    predicted = firmware.predict_um(radii, SPEED, table.speed_mm_min, TAU_MS)
    assert predicted == pytest.approx(radii.mean(), rel=1e-12)
    increase = np.mean(SPEED / table.speed_mm_min) - 1.0
    assert firmware.time_increase(SPEED, table.speed_mm_min) == pytest.approx(increase, rel=1e-9)


def test_iterating_takes_out_what_the_centre_has_hidden() -> None:
    """The probe is off its centre and the fit moves with the lobes: one pass leaves something."""
    transducer = lobes_um() + 3.0 * np.sin(np.radians(BETA))
    speeds = np.full(109, SPEED)
    spans = []
    target_um = 0.0
    for trial in range(4):
        way = transducer + speeds * TAU_MS / 60.0
        points = sphere(12_500.0 - way, (40.0, -25.0, 8.0))
        fitted = firmware.fit(points, Shape.SPHERE)
        radii = -firmware.radii_um(points, fitted)
        spans.append(firmware.range_um(radii))
        plan = Plan(
            tau_ms=TAU_MS,
            target=Target.GIVEN if trial else Target.MEAN,
            target_um=target_um,
        )
        table = firmware.speed_table(radii, speeds, plan)
        speeds, target_um = table.speed_mm_min, table.target_um

    assert spans[0] > 5.0
    assert spans[1] < spans[0] / 10.0
    assert spans[-1] < 0.01


def test_limits_reach_the_firmware_under_their_names() -> None:
    radii = lobes_um()
    fastest = firmware.speed_table(radii, SPEED, Plan(tau_ms=TAU_MS)).speed_mm_min
    index = int(np.argmax(fastest))
    safe = firmware.safe_speed_mm_min(10.0, reaction_us=10_000.0, accel_mm_s2=1000.0)
    assert safe < fastest[index]
    refused = {
        "TOO_FAST": Plan(tau_ms=TAU_MS, speed_max_mm_min=fastest[index] - 1e-6),
        "OVERTRAVEL": Plan(tau_ms=TAU_MS, overtravel_speed_mm_min=fastest[index] - 1e-6),
        "RAMP": Plan(tau_ms=TAU_MS, accel_mm_s2=1.0, approach_mm=fastest[index] ** 2 / 7201.0),
        "TAU": Plan(tau_ms=0.0),
        "LIMIT": Plan(tau_ms=TAU_MS, accel_mm_s2=-1.0),
    }

    for name, plan in refused.items():
        with pytest.raises(PretravelError) as raised:
            firmware.speed_table(radii, SPEED, plan)
        assert raised.value.name == name
        assert raised.value.index == (index if name in {"TOO_FAST", "OVERTRAVEL", "RAMP"} else 0)
        assert "\n" not in str(raised.value)


def test_a_gap_says_where_it_is() -> None:
    kept = np.arange(109) != 40

    with pytest.raises(PretravelError, match="gap") as raised:
        Map.from_readings(ALPHA[kept], BETA[kept], lobes_um()[kept]).check()
    assert raised.value.name == "GAP"
    assert raised.value.gap == firmware.Gap(alpha_deg=30.0, beta_deg=30.0, width_deg=20.0)


def test_a_reading_that_is_no_number_says_which() -> None:
    radii = lobes_um()
    radii[17] = np.nan

    with pytest.raises(PretravelError) as raised:
        Map.from_readings(ALPHA, BETA, radii)
    assert (raised.value.name, raised.value.index) == ("NOT_FINITE", 17)


def directions(n: int) -> np.ndarray:
    """Evenly over the upper half, as long as 16 bits hold; shape (n, 3)."""
    rng = np.random.default_rng(5)
    vectors = rng.normal(size=(n, 3))
    vectors[:, 2] = np.abs(vectors[:, 2])
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    return np.asarray(np.round(32_767.0 * vectors), dtype=np.int16)


@pytest.mark.parametrize("turned_deg", [0.0, 4.0, 14.0, 65.0, 102.0])
@pytest.mark.parametrize(
    ("divisions", "most", "typical"), [(8, 19.0, 2.5), (16, 10.0, 1.0), (32, 5.0, 0.5)]
)
def test_what_the_controller_finds_is_the_map_within_what_is_stated(
    divisions: int, most: float, typical: float, turned_deg: float
) -> None:
    """In percent of V_r, the greatest error and the root of the mean square."""
    perfect = Map.from_readings(ALPHA, BETA, lobes_um(turned_deg))
    speeds = firmware.speed_table(perfect.radius_um, SPEED, Plan(tau_ms=TAU_MS)).speed_mm_min
    lookup = perfect.lookup(speeds, divisions=divisions)
    vectors = directions(20_000)
    x, y, z = vectors.T.astype(float)
    alpha, beta = np.degrees(np.arctan2(y, x)), np.degrees(np.arctan2(z, np.hypot(x, y)))

    off = lookup.speed_mm_min(vectors) - perfect.at(speeds, alpha, beta)
    percent = 100.0 * off / np.ptp(speeds)
    measured = np.round(sphere(np.full(109, 32_767.0), (0.0, 0.0, 0.0)))
    at_cells = 100.0 * (lookup.speed_mm_min(measured) - speeds) / np.ptp(speeds)
    assert max(np.max(np.abs(percent)), np.max(np.abs(at_cells))) < most
    assert np.sqrt(np.mean(percent**2)) < typical
    assert abs(np.mean(percent)) < 0.5


def test_the_map_between_directions_is_bilinear() -> None:
    perfect = Map.from_readings(ALPHA, BETA, lobes_um())
    rng = np.random.default_rng(6)
    alpha, beta = rng.uniform(-360.0, 360.0, 500), rng.uniform(0.0, 60.0, 500)
    rows = lobes_um()[:108].reshape(3, 36)
    closed = np.hstack([rows, rows[:, :1]])
    i, j = np.floor(beta / 30.0).astype(int), np.floor(alpha % 360.0 / 10.0).astype(int)
    s, t = beta / 30.0 - i, alpha % 360.0 / 10.0 - j
    low = closed[i, j] * (1 - t) + closed[i, j + 1] * t
    high = closed[i + 1, j] * (1 - t) + closed[i + 1, j + 1] * t

    assert perfect.at(perfect.radius_um, alpha, beta) == pytest.approx(
        low * (1 - s) + high * s, rel=1e-9
    )
