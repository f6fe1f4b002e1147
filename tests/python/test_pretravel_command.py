"""``skiplatch pretravel`` as the user meets it."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from skiplatch import cli
from skiplatch.campaign import read_campaign

THE_RING = "ignore:.*touches are no part of the map:skiplatch.errors.CampaignWarning"
"""The recorded campaign holds the ring's touches, too, and is said to."""


def run(*arguments: str) -> Result:
    return CliRunner().invoke(cli.group, ["pretravel", "--jobs", "2", *arguments])


def test_help_has_an_example_with_known_options() -> None:
    text = run("--help").output

    assert "Example:\n    skiplatch pretravel --rig haas" in text
    for option in ("--json", "--seed", "--record", "--path", "--iterations", "--trials"):
        assert option in text


def test_the_table_has_document_ours_difference_and_what_was_set() -> None:
    text = run("--rig", "haas").output

    assert "2720 touches through the firmware's latch" in text
    for words in ("document", "difference", "delay tau", "time increase", "no\nevidence"):
        assert words in text
    assert "delay_us: the document's tau" in text


def test_json_has_every_figure_and_the_goals(tmp_path: Path) -> None:
    assert run("--rig", "omp60", "--json", str(tmp_path / "o.json")).exit_code == 0

    found = json.loads((tmp_path / "o.json").read_text())
    assert (found["format"], found["rig"], found["seed"]) == ("skiplatch-pretravel/1", "omp60", 1)
    assert abs(found["tau_error"]) < 0.02
    assert found["vr_after_um"] < found["vr_before_um"]
    names = [figure["name"] for figure in found["figures"]]
    assert len(set(names)) == len(names)
    assert "repeatability_um" in found["origins"]


def test_the_same_seed_gives_the_same_table() -> None:
    assert run("--rig", "haas", "--seed", "5").output == run("--rig", "haas", "--seed", "5").output
    assert run("--rig", "haas", "--seed", "5").output != run("--rig", "haas", "--seed", "6").output


def test_campaigns_are_recorded_that_can_be_read_again(tmp_path: Path) -> None:
    assert run("--rig", "haas", "--record", str(tmp_path / "rec")).exit_code == 0

    before, after = read_campaign(tmp_path / "rec/before"), read_campaign(tmp_path / "rec/after")
    assert len(before.touches) == 3 * 5 * 36 + 109 * 10
    assert len(after.touches) == 109 * 10
    assert after.nominal.probe.delay_us == 0.0


def test_what_stands_in_the_way_of_the_campaigns_is_named_at_once(tmp_path: Path) -> None:
    (tmp_path / "before").mkdir()
    (tmp_path / "before" / "mine").write_text("")

    result = run("--rig", "haas", "--record", str(tmp_path))

    assert "exists already" in str(result.exception)
    assert not (tmp_path / "after").exists()


def test_an_unknown_rig_is_refused_with_the_known_ones() -> None:
    result = run("--rig", "omp400")

    assert result.exit_code == 2
    assert "omp40-2" in result.output


@pytest.mark.filterwarnings(THE_RING)
def test_a_table_from_the_recorded_campaign_closes_the_loop(tmp_path: Path) -> None:
    """Recorded, compensated, and measured again with other random numbers."""
    recorded, table = str(tmp_path / "rec"), str(tmp_path / "table.csv")
    assert run("--rig", "haas", "--record", recorded).exit_code == 0
    arguments = ["compensate", "--from-campaign", f"{recorded}/before", "--v0", "100"]
    assert CliRunner().invoke(cli.group, [*arguments, "--out", table]).exit_code == 0

    closed = str(tmp_path / "closed.json")
    assert run("--rig", "haas", "--seed", "2", "--table", table, "--json", closed).exit_code == 0

    found = json.loads(Path(closed).read_text())
    assert found["vr_before_um"] > 19.0
    assert found["vr_after_um"] < 2.7
    assert abs(found["time_increase"] - 0.046) < 0.005


@pytest.mark.filterwarnings(THE_RING)
def test_the_radii_and_speeds_recorded_give_the_table_of_the_campaign(tmp_path: Path) -> None:
    assert run("--rig", "haas", "--record", str(tmp_path)).exit_code == 0
    common = ["compensate", "--v0", "100"]
    radii = [f"{tmp_path}/radii_before.csv", "--tau-from", f"{tmp_path}/speeds.csv"]
    one, two = tmp_path / "one.csv", tmp_path / "two.csv"

    CliRunner().invoke(cli.group, [*common, *radii, "--out", str(one)])
    campaign = ["--from-campaign", f"{tmp_path}/before"]
    CliRunner().invoke(cli.group, [*common, *campaign, "--out", str(two)])

    tables = [np.loadtxt(path, delimiter=",", skiprows=1) for path in (one, two)]
    (beta_deg, feeds), (_, campaign_feeds) = (table.T[1:] for table in tables)
    above = beta_deg > 0.0
    assert feeds[above] == pytest.approx(campaign_feeds[above], rel=0.002)
    # In the campaign half of the repeats at the equator are those of the ring: 0.28 µm, 1.2 mm/min.
    assert feeds[~above] == pytest.approx(campaign_feeds[~above], abs=5.0)


def test_a_table_of_another_rig_is_refused(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    table.write_text("alpha_deg,beta_deg,feed_mm_min\n0,0,50\n")

    result = run("--rig", "haas", "--table", str(table))

    assert "table.csv: no feed for alpha 10, beta 0" in str(result.exception)


def test_a_table_and_iterations_exclude_each_other(tmp_path: Path) -> None:
    table = str(tmp_path / "table.csv")

    result = run("--rig", "haas", "--table", table, "--iterations", "2")

    assert result.exit_code == 2
    assert "no --iterations with it" in result.output
