"""The budget of a compensated probe, the Monte Carlo beside it, and the figures of the probe."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seat_probe import OMP40, directions, radii, write_radii, write_speeds
from skiplatch.compensation.budget import Inputs, interpolation_um
from skiplatch.compensation.compensate import Compensation, Limits, Target, compensate
from skiplatch.compensation.delay import Delay, estimate_delay
from skiplatch.compensation.firmware import Target as Rule
from skiplatch.compensation.probe_figures import probe_figures
from skiplatch.compensation.probe_map import read_map
from skiplatch.compensation.speeds import read_speeds
from skiplatch.compensation.uncertainty import assess

V0, TAU = 100.0, 12.68
SIGMA_UM, RUNS = 0.4, 10


def compensated(
    folder: Path, delay: Delay, *, sigma_um: float = SIGMA_UM, runs: int = RUNS
) -> Compensation:
    path = write_radii(folder / "radii.csv", radii(OMP40, V0, TAU, runs=runs, sigma_um=sigma_um))
    return compensate(
        read_map(path, outside=False),
        delay,
        base_mm_min=V0,
        before_mm_min=np.full(109, V0),
        target=Target(Rule.MEAN),
        limits=Limits(),
    )


def measured_delay(folder: Path) -> Delay:
    path = write_speeds(folder / "speeds.csv", TAU, sigma_um=1.0)
    return estimate_delay(read_speeds(path, outside=False))


def test_budget_sums_its_parts_as_squares(tmp_path: Path) -> None:
    done = compensated(tmp_path, Delay(TAU, 0.1))
    budget = assess(done, Inputs(resolution_um=1.0, feed_error=0.01), seed=1).budget

    parts = {part.name: part.contribution_um for part in budget.parts}
    assert parts["repeatability of one touch"] == pytest.approx(SIGMA_UM, rel=0.1)
    assert parts["resolution of the position"] == pytest.approx(1.0 / math.sqrt(12.0))
    change = np.sqrt(np.mean((done.feed_mm_min - V0) ** 2))
    assert parts["delay tau"] == pytest.approx(0.1 * change / 60.0)
    travel_um = np.sqrt(np.mean(done.feed_mm_min**2)) * TAU / 60.0
    assert parts["feed of the machine"] == pytest.approx(0.01 * travel_um / math.sqrt(3.0))
    assert budget.combined_um == pytest.approx(math.hypot(*parts.values()))
    assert budget.expanded_um == pytest.approx(2.0 * budget.combined_um)


@pytest.mark.parametrize(
    "inputs",
    [
        Inputs(),
        Inputs(resolution_um=1.0),
        Inputs(feed_error=0.05),
        Inputs(repeatability_um=1.5, resolution_um=2.0, feed_error=0.02),
    ],
)
def test_monte_carlo_agrees_with_the_budget(tmp_path: Path, inputs: Inputs) -> None:
    """2000 draws: their standard deviation scatters by 1.6 %; 6 % is beyond chance."""
    known = assess(compensated(tmp_path, measured_delay(tmp_path)), inputs, seed=3)

    assert known.monte_carlo.failed == 0
    assert known.monte_carlo.touch_deviation_um == pytest.approx(known.budget.combined_um, rel=0.06)


def test_delay_scatters_as_its_uncertainty_says(tmp_path: Path) -> None:
    delay = measured_delay(tmp_path)
    drawn = assess(compensated(tmp_path, delay), Inputs(), seed=4).monte_carlo.tau_ms

    assert drawn is not None
    assert drawn.value == pytest.approx(delay.tau_ms, abs=0.1 * delay.uncertainty_ms)
    assert (drawn.high - drawn.low) / 2.0 == pytest.approx(1.96 * delay.uncertainty_ms, rel=0.08)


def test_expanded_uncertainty_of_the_range_holds_the_truth(tmp_path: Path) -> None:
    """To first order, that is for the same two directions: k = 2 holds 95 in 100 of them.

    Two hundred maps; fewer than 178 hits come by chance once in ten thousand.
    """
    true_um = OMP40.pretravel_um(*directions())
    most, least = int(np.argmax(true_um)), int(np.argmin(true_um))
    expanded_um = assess(compensated(tmp_path, Delay(TAU, 0.0)), Inputs(), seed=1)
    hits = 0
    for seed in range(200):
        mean_um = radii(OMP40, V0, TAU, runs=RUNS, sigma_um=SIGMA_UM, seed=seed).mean(axis=1)
        off_um = (mean_um[most] - mean_um[least]) - np.ptp(true_um)
        hits += bool(abs(off_um) <= expanded_um.vr_before_expanded_um)

    assert 178 <= hits <= 200


def test_more_repeats_leave_less(tmp_path: Path) -> None:
    left = [
        assess(compensated(tmp_path, Delay(TAU, 0.0), runs=runs), Inputs(), seed=1)
        .monte_carlo.vr_after_um.value
        for runs in (3, 12, 48)
    ]  # fmt: skip

    np.testing.assert_allclose(np.array(left[1:]) / left[:-1], 0.5, atol=0.06)


def test_wrong_delay_leaves_a_share_of_the_range(tmp_path: Path) -> None:
    """Without random error a delay that is 10 % uncertain leaves about 10 % of V_r."""
    done = compensated(tmp_path, Delay(TAU, 0.1 * TAU), sigma_um=0.0, runs=1)
    after = assess(done, Inputs(), seed=1).monte_carlo.vr_after_um

    assert after.value == pytest.approx(0.1 * done.vr_before_um * math.sqrt(2.0 / math.pi), rel=0.1)


def test_tables_that_cannot_be_made_are_counted(tmp_path: Path) -> None:
    done = compensated(tmp_path, Delay(TAU, 0.3 * TAU), sigma_um=0.0, runs=1)

    drawn = assess(done, Inputs(), seed=1).monte_carlo

    assert drawn.failed > 0
    assert drawn.failed + drawn.draws == 2000


def test_interpolation_is_what_lies_between_the_directions(tmp_path: Path) -> None:
    done = compensated(tmp_path, Delay(TAU, 0.0), sigma_um=0.0, runs=1)
    smooth = replace(done.probe_map, cells=done.probe_map.cells)
    cells = smooth.cells
    cells.radius_um[:] = 5.0 * np.cos(np.radians(cells.alpha_deg)) * (cells.beta_deg < 90.0)

    found = interpolation_um(smooth, 0.0)

    between = np.radians(np.arange(0.0, 360.0, 0.1))
    straight = np.interp(np.degrees(between) % 30.0, [0.0, 30.0], [0.0, 1.0])
    low = np.radians(np.floor(np.degrees(between) / 30.0) * 30.0)
    line = 5.0 * ((1.0 - straight) * np.cos(low) + straight * np.cos(low + np.radians(30.0)))
    rms = np.sqrt(np.mean((5.0 * np.cos(between) - line) ** 2))
    assert found == pytest.approx(rms, rel=0.05)


def test_figures_of_the_probe_are_ranges_about_ring_and_sphere(tmp_path: Path) -> None:
    done = compensated(tmp_path, Delay(TAU, 0.0))
    found = probe_figures(done.probe_map)
    by_run = radii(OMP40, V0, TAU, runs=RUNS, sigma_um=SIGMA_UM)

    assert found.worst_range_um == pytest.approx(np.ptp(by_run, axis=1).max(), abs=1e-5)
    assert [form.beta_deg for form in found.rings] == list(np.arange(0.0, 90.0, 10.0))
    first = found.rings[0]
    assert first.mean_um == pytest.approx(np.ptp(by_run[:12].mean(axis=1)), abs=1e-5)
    assert first.worst_run_um == pytest.approx(np.ptp(by_run[:12], axis=0).max(), abs=1e-5)
    assert first.all_um == pytest.approx(np.ptp(by_run[:12]), abs=1e-5)
    assert found.sphere is not None
    assert found.sphere.points == 109
    assert found.sphere.fitted_um < found.sphere.mean_um  # a centre takes the cosine away


def test_eccentric_circle_has_no_form_error_about_its_own_centre(tmp_path: Path) -> None:
    alpha, beta = directions()
    off_um = 20.0 * np.cos(np.radians(alpha - 40.0)) * np.cos(np.radians(beta))
    path = write_radii(tmp_path / "radii.csv", (1000.0 + off_um)[:, None])

    found = probe_figures(read_map(path, outside=False))

    assert found.rings[0].mean_um == pytest.approx(40.0, rel=0.02)
    for form in [*found.rings, found.sphere]:
        assert form is not None
        assert form.fitted_um < 0.1  # what is left of the second order, e²/r
