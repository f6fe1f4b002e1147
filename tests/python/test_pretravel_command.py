"""``skiplatch pretravel`` as the user meets it."""

import json
from pathlib import Path

from click.testing import CliRunner, Result

from skiplatch import cli
from skiplatch.campaign import read_campaign


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
