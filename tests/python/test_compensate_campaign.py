"""Map and delay from a recorded campaign, played through the firmware's latch."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from skiplatch import cli
from skiplatch.campaign import (
    AxisNominal,
    BenchNominal,
    InputNominal,
    InputPath,
    Kind,
    Nominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
    Status,
    Touches,
    write_campaign,
)
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller

DELAY_US, FILTER_US, LATENCY_US, JITTER_US = 12_000.0, 600.0, 70.0, 20.0
TAU_MS = (DELAY_US + FILTER_US + LATENCY_US + JITTER_US / 2.0) / 1000.0
LOBE_UM = 4.0
RIG = Nominal(
    kind=Kind.MACHINE,
    probe=ProbeNominal(8.0, LOBE_UM, 15.0, 0.2, DELAY_US),
    input=InputNominal(FILTER_US),
    skip=SkipNominal(LATENCY_US, JITTER_US, 1.0),
    plc=PlcNominal(4000.0),
    axis=AxisNominal(0.01, 3000.0),
    report=ReportNominal(200.0, 50.0),
    bench=BenchNominal(0.0),
)
RINGS, AZIMUTHS, RUNS = (0.0, 30.0, 60.0), np.arange(0.0, 360.0, 20.0), 5


def conditions(feeds: tuple[float, ...]) -> Touches:
    """Every direction at every feed, five times, in an order of chance."""
    beta, alpha, feed, _ = (
        grid.ravel() for grid in np.meshgrid(RINGS, AZIMUTHS, feeds, np.arange(RUNS))
    )
    pole = len(feeds) * RUNS
    alpha, beta = np.append(alpha, np.zeros(pole)), np.append(beta, np.full(pole, 90.0))
    feed = np.append(feed, np.tile(feeds, RUNS))
    order = np.random.default_rng(5).permutation(len(feed))
    return Touches.from_columns(
        touch=np.arange(len(feed)),
        time_s=10.0 * np.arange(len(feed)),
        path=np.full(len(feed), InputPath.SKIP),
        alpha_deg=alpha[order],
        beta_deg=beta[order],
        feed_mm_min=feed[order],
        approach_mm=np.full(len(feed), 2.0),
    )


def record(folder: Path, touches: Touches, seed: int = 1) -> Path:
    outcomes = play(RIG, Controller.for_campaign(RIG, touches), touches, seed=seed)
    status = np.full(len(touches), Status.OK, dtype=np.int8)
    deviation_um = outcomes.deviation_um[0]
    write_campaign(folder, RIG, replace(touches, deviation_um=deviation_um, status=status))
    return folder


def run(folder: Path, campaign: Path, *arguments: str) -> Result:
    out = ["--out", str(folder / "t.csv"), "--json", str(folder / "o.json")]
    base = ["compensate", "--from-campaign", str(campaign), "--v0", "100", *out]
    return CliRunner().invoke(cli.group, [*base, *arguments])


def document(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "o.json").read_text())
    return found


@pytest.fixture
def several(tmp_path: Path) -> Path:
    return record(tmp_path / "several", conditions((50.0, 100.0, 150.0)))


def test_delay_is_all_that_lies_between_contact_and_latch(several: Path, tmp_path: Path) -> None:
    assert run(tmp_path, several).exit_code == 0

    found = document(tmp_path)
    assert found["tau_ms"] == pytest.approx(TAU_MS, rel=0.005)
    assert abs(found["tau_ms"] - TAU_MS) < 3.0 * found["tau_uncertainty_ms"]
    assert (found["directions"], found["runs"]) == (55, 3 * RUNS)


def test_lobes_of_the_probe_become_feeds(several: Path, tmp_path: Path) -> None:
    """w = 8 + 4·cos β·cos 3(α − 15°): its range is 8 µm, and feeds mirror it."""
    assert run(tmp_path, several).exit_code == 0

    rows = np.loadtxt(tmp_path / "t.csv", delimiter=",", skiprows=1)
    alpha, beta = np.radians(rows[:, 0] - 15.0), np.radians(rows[:, 1])
    lobe_um = LOBE_UM * np.cos(beta) * np.cos(3.0 * alpha)
    expected = 100.0 - (lobe_um - lobe_um.mean()) * 60.0 / TAU_MS
    np.testing.assert_allclose(rows[:, 2], expected, atol=5.0 * 0.2 / np.sqrt(15.0) * 60 / TAU_MS)


def test_measured_again_with_the_table_the_lobes_are_gone(several: Path, tmp_path: Path) -> None:
    run(tmp_path, several)
    rows = np.loadtxt(tmp_path / "t.csv", delimiter=",", skiprows=1)
    old = conditions((100.0,))
    feed_of = {(a, b): feed for a, b, feed in rows.tolist()}
    keys = zip(old.alpha_deg.tolist(), old.beta_deg.tolist(), strict=True)
    touches = replace(old, feed_mm_min=np.array([feed_of[key] for key in keys]))

    after = record(tmp_path / "after", touches, seed=9)
    assert run(tmp_path, several, "--after", str(after)).exit_code == 0

    found = document(tmp_path)
    assert found["vr_before_um"] > 7.0
    assert found["after"]["sphere"]["mean_um"] < 0.1 * found["vr_before_um"]
    # Brought back to one feed by the delay, the same touches show the lobes.
    assert run(tmp_path, after, "--tau", f"{TAU_MS:g}").exit_code == 0
    again = document(tmp_path)
    assert again["vr_before_um"] == pytest.approx(found["vr_before_um"], rel=0.1)


def test_centre_that_was_believed_wrongly_is_fitted(tmp_path: Path) -> None:
    touches = conditions((50.0, 100.0, 150.0))
    alpha, beta = np.radians(touches.alpha_deg), np.radians(touches.beta_deg)
    off_um = 6.0 * np.cos(beta) * np.cos(alpha)
    folder = record(tmp_path / "off", touches)
    outcomes = play(RIG, Controller.for_campaign(RIG, touches), touches, seed=1)
    moved = replace(touches, deviation_um=outcomes.deviation_um[0] + off_um)
    shifted = tmp_path / "shifted"
    write_campaign(shifted, RIG, moved)

    def feeds(campaign: Path, *arguments: str) -> np.ndarray:
        assert run(tmp_path, campaign, *arguments).exit_code == 0
        return np.loadtxt(tmp_path / "t.csv", delimiter=",", skiprows=1)[:, 2]

    np.testing.assert_allclose(feeds(shifted), feeds(folder), atol=0.02)
    assert np.abs(feeds(shifted, "--centre", "nominal") - feeds(folder)).max() > 20.0


def test_missed_touches_leave_the_others_balanced(several: Path, tmp_path: Path) -> None:
    table = several / "touches.csv"
    lines = table.read_text().splitlines()
    header = lines[0].split(",")
    cells = lines[1].split(",")
    for name in ("latch_us", "report_us", "deviation_um"):
        cells[header.index(name)] = ""
    cells[header.index("status")] = "missed"
    table.write_text("\n".join([lines[0], ",".join(cells), *lines[2:]]) + "\n")

    with pytest.warns(UserWarning, match="54 touches are no part of the map"):
        assert run(tmp_path, several).exit_code == 0

    found = document(tmp_path)
    assert (found["directions"], found["runs"]) == (55, 3 * RUNS - 1)
    assert found["tau_ms"] == pytest.approx(TAU_MS, rel=0.005)


def test_one_feed_wants_a_delay_and_takes_it(tmp_path: Path) -> None:
    campaign = record(tmp_path / "one", conditions((100.0,)))

    refused = run(tmp_path, campaign)
    taken = run(tmp_path, campaign, "--tau", "12.68")

    assert "feed_mm_min: expected several feeds, got only 100 mm/min" in str(refused.exception)
    assert taken.exit_code == 0
    assert document(tmp_path)["runs"] == RUNS


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"alpha_deg": np.nan}, "alpha_deg: expected skip touches with a direction, got none"),
        ({"deviation_um": np.nan}, "deviation_um: expected recorded deviations, got none"),
        ({"approach_mm": 1e-4}, "approach_mm: touch 0: the ramp to "),
        ({"beta_deg": -10.0}, "beta_deg: touch 0: expected a number from 0 to 90"),
    ],
)
def test_campaign_without_what_is_needed_is_told(
    tmp_path: Path, change: dict[str, float], message: str
) -> None:
    touches = conditions((50.0, 100.0))
    touches = replace(touches, deviation_um=np.ones(len(touches)))
    wrong = {name: np.full(len(touches), value) for name, value in change.items()}
    write_campaign(tmp_path / "wrong", RIG, replace(touches, **wrong))

    result = run(tmp_path, tmp_path / "wrong")

    assert message in str(result.exception)
    assert not (tmp_path / "t.csv").exists()


def test_ring_at_several_feeds_and_map_at_one_go_together(tmp_path: Path) -> None:
    """As in the document's experiment on a machine."""
    record_into = ["pretravel", "--rig", "haas", "--record", str(tmp_path / "haas")]
    assert CliRunner().invoke(cli.group, record_into).exit_code == 0

    with pytest.warns(UserWarning, match="180 touches are no part of the map"):
        result = run(tmp_path, tmp_path / "haas/before", "--after", str(tmp_path / "haas/after"))

    assert result.exit_code == 0, result.output
    found = document(tmp_path)
    assert (found["directions"], found["runs"]) == (109, 10)
    assert found["tau_ms"] == pytest.approx(14.5, rel=0.02)
    low, high = found["vr_predicted_interval_um"]
    assert low < found["after"]["sphere"]["mean_um"] < high
