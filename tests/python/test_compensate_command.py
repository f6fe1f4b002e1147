"""``skiplatch compensate`` as the user meets it: figures, tables, limits and iteration."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from seat_probe import HAAS, OMP40, directions, radii, write_radii, write_speeds
from skiplatch import cli

V0, TAU = 50.0, 12.68


def run(*arguments: object) -> Result:
    return CliRunner().invoke(cli.group, ["compensate", *map(str, arguments)])


@pytest.fixture
def perfect(tmp_path: Path) -> Path:
    """A map without random error."""
    return write_radii(tmp_path / "radii.csv", radii(OMP40, V0, TAU, runs=1, sigma_um=0.0))


def table(path: Path) -> np.ndarray:
    """Read TABLE.csv by the eyes of somebody else; shape (n, 3)."""
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["alpha_deg", "beta_deg", "feed_mm_min"]
    return np.array(rows[1:], dtype=float)


def document(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text())
    return found


def compensated(folder: Path, *arguments: object) -> tuple[np.ndarray, dict[str, Any]]:
    out, found = folder / "table.csv", folder / "out.json"
    result = run(*arguments, "--out", out, "--json", found)
    assert result.exit_code == 0, result.output
    return table(out), document(found)


def test_help_has_an_example_with_known_options() -> None:
    text = run("--help").output

    assert "Example:\n    skiplatch compensate build/radii.csv --v0 50 --tau 12.68" in text
    for option in ("--tau-from", "--from-campaign", "--inside / --outside", "--header", "--nc"):
        assert option in text


def test_contract_of_the_json(perfect: Path, tmp_path: Path) -> None:
    _, found = compensated(tmp_path, perfect, "--v0", V0, "--tau", TAU)

    for key in (
        "tau_ms",
        "tau_uncertainty_ms",
        "vr_before_um",
        "vr_predicted_um",
        "feed_min_mm_min",
        "feed_max_mm_min",
        "time_increase",
    ):
        assert isinstance(found[key], float), key


def test_feeds_of_a_perfect_map_give_back_its_range(perfect: Path, tmp_path: Path) -> None:
    _, found = compensated(tmp_path, perfect, "--v0", V0, "--tau", TAU)

    span_um = (found["feed_max_mm_min"] - found["feed_min_mm_min"]) * TAU / 60.0
    assert span_um == pytest.approx(found["vr_before_um"], rel=1e-3)
    assert found["vr_before_um"] == pytest.approx(
        np.ptp(OMP40.pretravel_um(*directions())), abs=2e-6
    )


def test_table_is_that_of_the_equation_for_every_direction(perfect: Path, tmp_path: Path) -> None:
    rows, found = compensated(tmp_path, perfect, "--v0", V0, "--tau", TAU)

    radius_um = radii(OMP40, V0, TAU, runs=1, sigma_um=0.0)[:, 0]
    expected = V0 + (radius_um.mean() - radius_um) * 60.0 / TAU
    assert rows[:, :2].tolist() == np.column_stack(directions()).tolist()
    np.testing.assert_allclose(rows[:, 2], expected, atol=1e-4)
    assert found["time_increase"] == pytest.approx(V0 * np.mean(1.0 / expected) - 1.0, abs=1e-5)


def test_times_are_way_over_feed_in_seconds(perfect: Path, tmp_path: Path) -> None:
    approach = ("--approach", 4, "--accel", 3000)
    rows, found = compensated(tmp_path, perfect, "--v0", V0, "--tau", TAU, *approach)
    _, unknown = compensated(tmp_path, perfect, "--v0", V0, "--tau", TAU)

    each_s = 60.0 * 4.0 / rows[:, 2]
    assert found["times"] == pytest.approx(
        {
            "touch_before_s": 60.0 * 4.0 / V0,
            "touch_least_s": each_s.min(),
            "touch_greatest_s": each_s.max(),
            "total_before_s": len(rows) * 60.0 * 4.0 / V0,
            "total_s": each_s.sum(),
        }
    )
    assert unknown["times"] is None


@pytest.mark.parametrize("target", ["max", "min", "21.5"])
def test_targets_are_reached_in_all_directions(perfect: Path, tmp_path: Path, target: str) -> None:
    rows, found = compensated(tmp_path, perfect, "--v0", 2 * V0, "--tau", TAU, "--target", target)

    before_um = radii(OMP40, V0, TAU, runs=1, sigma_um=0.0)[:, 0]
    reached_um = before_um + (rows[:, 2] - 2 * V0) * TAU / 60.0
    wanted_um = {"max": before_um.max(), "min": before_um.min(), "21.5": 21.5}[target]
    np.testing.assert_allclose(reached_um, wanted_um, atol=1e-4)
    assert found["target_um"] == pytest.approx(wanted_um, abs=1e-5)


def test_random_error_is_what_is_left(tmp_path: Path) -> None:
    """What is predicted is also what comes of measuring the probe again with the table."""
    sigma_um, runs = 0.3, 10
    before = radii(OMP40, V0, TAU, runs=runs, sigma_um=sigma_um)
    path = write_radii(tmp_path / "radii.csv", before)

    rows, found = compensated(tmp_path, path, "--v0", V0, "--tau", TAU)

    after = radii(OMP40, rows[:, 2], TAU, runs=runs, sigma_um=sigma_um, seed=77)
    low, high = found["vr_predicted_interval_um"]
    assert low < np.ptp(after.mean(axis=1)) < high
    assert found["vr_before_um"] / found["vr_predicted_um"] > 10.0
    assert found["probe"]["repeatability_um"] == pytest.approx(sigma_um, rel=0.1)


@pytest.mark.long
def test_the_prediction_holds_as_often_as_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Forty probes; 95 % intervals: fewer than 34 hits come by chance once in a thousand."""
    monkeypatch.setattr("skiplatch.compensation.monte_carlo.DRAWS", 300)
    hits = 0
    for seed in range(40):
        before = radii(OMP40, V0, TAU, runs=5, sigma_um=0.3, seed=seed)
        path = write_radii(tmp_path / "radii.csv", before)
        rows, found = compensated(tmp_path, path, "--v0", V0, "--tau", TAU, "--seed", seed)
        after = radii(OMP40, rows[:, 2], TAU, runs=5, sigma_um=0.3, seed=1000 + seed)
        low, high = found["vr_predicted_interval_um"]
        hits += bool(low <= np.ptp(after.mean(axis=1)) <= high)

    assert hits >= 34


def test_iteration_takes_the_feeds_of_the_table_before(tmp_path: Path) -> None:
    """With a wrong delay one step leaves something; each next one leaves less of it."""
    wrong_ms = 0.8 * TAU
    path = tmp_path / "radii.csv"
    feeds = np.full(109, 2 * V0)
    left = []
    previous: list[object] = []
    for step in range(4):
        write_radii(path, radii(OMP40, feeds, TAU, runs=1, sigma_um=0.0))
        base = ("--v0", 2 * V0, "--tau", wrong_ms, "--target", "31", *previous)
        rows, found = compensated(tmp_path, path, *base)
        feeds = rows[:, 2]
        left.append(found["vr_before_um"])
        kept = tmp_path / f"table{step}.csv"
        kept.write_text((tmp_path / "table.csv").read_text())
        previous = ["--previous", kept]

    ratio = np.array(left[1:]) / np.array(left[:-1])
    np.testing.assert_allclose(ratio, 0.25, atol=1e-3)  # 1 − τ/τ̂


def test_tau_comes_from_ring_and_from_sphere_with_its_uncertainty(tmp_path: Path) -> None:
    path = write_radii(tmp_path / "radii.csv", radii(HAAS, 300.0, 14.5, runs=1, sigma_um=0.0))
    for flag, outside in (("--inside", False), ("--outside", True)):
        speeds = write_speeds(tmp_path / "s.csv", 14.5, outside=outside, sigma_um=0.2)
        _, found = compensated(tmp_path, path, "--v0", 300, "--tau-from", speeds, flag)

        feeds = np.repeat([50.0, 100.0, 150.0], 5)
        spread = np.sqrt(((feeds - 100.0) ** 2).sum()) / 60.0
        assert found["tau_ms"] == pytest.approx(14.5, rel=0.02)
        assert found["tau_uncertainty_ms"] == pytest.approx(0.2 / spread, rel=0.6)


def test_map_from_outside_turns_the_sense_of_the_radii(tmp_path: Path) -> None:
    inside = radii(OMP40, V0, TAU, runs=2, sigma_um=0.1)
    first = write_radii(tmp_path / "inside.csv", inside)
    second = write_radii(tmp_path / "outside.csv", 5000.0 - inside)

    rows, found = compensated(tmp_path, first, "--v0", V0, "--tau", TAU)
    turned, same = compensated(tmp_path, second, "--v0", V0, "--tau", TAU, "--map-outside")

    np.testing.assert_allclose(turned, rows, atol=1e-3)
    assert same["vr_before_um"] == pytest.approx(found["vr_before_um"], abs=1e-5)
    assert same["target_um"] == pytest.approx(5000.0 - found["target_um"], abs=1e-4)


def test_same_seed_gives_the_same_and_another_does_not(tmp_path: Path) -> None:
    path = write_radii(tmp_path / "radii.csv", radii(OMP40, V0, TAU, runs=3, sigma_um=0.3))
    base = (path, "--v0", V0, "--tau", TAU)

    _, first = compensated(tmp_path, *base)
    _, second = compensated(tmp_path, *base)
    _, other = compensated(tmp_path, *base, "--seed", 2)

    assert first == second
    assert other["vr_predicted_um"] != first["vr_predicted_um"]
    assert other["time_increase"] == first["time_increase"]


@pytest.mark.parametrize(
    ("limit", "beyond", "said"),
    [
        (("--max-feed", "72"), ("--max-feed", "71.9"), "above the maximum"),
        (
            ("--accel", "3000", "--overtravel", "0.0155"),
            ("--accel", "3000", "--overtravel", "0.0153"),
            "overtravel",
        ),
        (
            ("--accel", "0.5", "--approach", "1.45"),
            ("--accel", "0.5", "--approach", "1.42"),
            "approach",
        ),
    ],
)
def test_limits_hold_up_to_the_fastest_feed(
    perfect: Path, tmp_path: Path, limit: tuple[str, ...], beyond: tuple[str, ...], said: str
) -> None:
    """The fastest direction goes at 71.95 mm/min: 15.4 µm with its stop, a ramp of 1.44 mm."""
    out = tmp_path / "table.csv"
    base = (perfect, "--v0", V0, "--tau", TAU, "--out", out)

    assert run(*base, *limit).exit_code == 0
    out.unlink()
    refused = run(*base, *beyond)

    assert refused.exit_code != 0
    assert said in str(refused.exception)
    assert not out.exists()
