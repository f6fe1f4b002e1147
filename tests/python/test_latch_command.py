"""``skiplatch latch`` as the user meets it."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from refusals import Program
from skiplatch import cli

QUICK = ["latch", "--touches", "2000", "--jobs", "2"]


def run(*arguments: str) -> Result:
    return CliRunner().invoke(cli.group, [*QUICK, *arguments])


def document(folder: Path, *arguments: str) -> dict[str, Any]:
    result = run("--json", str(folder / "latch.json"), *arguments)
    assert result.exit_code == 0, result.output
    loaded: dict[str, Any] = json.loads((folder / "latch.json").read_text())
    return loaded


def test_help_has_an_example_with_known_options() -> None:
    text = CliRunner().invoke(cli.group, ["latch", "--help"]).output

    assert "Example:\n    skiplatch latch --" in text
    for option in ("--json", "--seed", "--jobs", "--pictures", "--nominal", "--scan-us"):
        assert option in text


def test_bias_and_spread_stand_apart_with_intervals_for_both_paths() -> None:
    text = run().output

    for words in ("skip input, 2 000 touches", "PLC task, 2 000 touches", "bias    mean"):
        assert words in text
    for words in ("spread  range", "v·T/√12", "99.9 %", "95 % interval", "shortest pulse"):
        assert words in text


def test_json_has_the_rig_and_every_figure(tmp_path: Path) -> None:
    found = document(tmp_path)

    assert found["format"] == "skiplatch-latch/1"
    assert (found["touches"], found["feed_mm_min"], found["seed"]) == (2000, 3000.0, 1)
    assert found["rig"]["scan_us"] == 4000.0
    assert set(found["paths"]) == {"skip", "plc"}
    for path in found["paths"].values():
        for quantity in ("latency_us", "position_um"):
            summary = path[quantity]
            assert summary["count"] == 2000
            assert set(summary["quantiles"]) == {"0.5", "0.95", "0.99", "0.999"}
            for figure in ("mean", "standard_deviation", "range", "minimum", "maximum"):
                interval = summary[figure]
                assert interval["low"] <= interval["value"] <= interval["high"], figure
            assert sum(summary["histogram"]["counts"]) == 2000
        assert path["pulses"]["shortest"]["pulses"] == 2000


@pytest.mark.parametrize("jobs", ["1", "3"])
def test_threads_change_nothing_and_the_seed_does(tmp_path: Path, jobs: str) -> None:
    reference = document(tmp_path)

    assert document(tmp_path, "--jobs", jobs) == reference
    assert document(tmp_path, "--seed", "2")["paths"] != reference["paths"]


@pytest.mark.parametrize(("path", "title"), [("skip", "skip input"), ("plc", "PLC task")])
def test_one_path_can_be_picked(tmp_path: Path, path: str, title: str) -> None:
    assert set(document(tmp_path, "--path", path)["paths"]) == {path}
    assert run("--path", path).output.count(", 2 000 touches") == 1
    assert f"{title}, 2 000 touches" in run("--path", path).output


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--filter-us", 12.0),
        ("--latency-us", 3.0),
        ("--jitter-us", 7.0),
        ("--tick-us", 0.5),
        ("--scan-us", 1000.0),
        ("--resolution-um", 0.5),
        ("--accel", 500.0),
    ],
)
def test_every_option_of_the_rig_arrives(tmp_path: Path, option: str, value: float) -> None:
    rig = document(tmp_path, option, str(value))["rig"]
    default = document(tmp_path)["rig"]

    changed = {key for key in rig if rig[key] != default[key]}
    assert [rig[key] for key in changed] == [value]


def test_rig_comes_from_a_campaign_and_options_overrule_it(
    tmp_path: Path, machine_sample: Path
) -> None:
    nominal = str(machine_sample / "nominal.toml")

    rig = document(tmp_path, "--nominal", nominal, "--jitter-us", "9")["rig"]

    assert rig["scan_us"] == 1000.0  # the sample's
    assert rig["resolution_um"] == 0.5
    assert rig["jitter_us"] == 9.0


def test_probe_of_that_campaign_plays_no_part(tmp_path: Path, machine_sample: Path) -> None:
    found = document(tmp_path, "--nominal", str(machine_sample / "nominal.toml"))

    latest_us = 5.0 + 4.0 + 1.0  # filter, latency, jitter; not the probe's 500 µs
    assert found["paths"]["skip"]["latency_us"]["maximum"]["value"] <= latest_us


def test_picture_is_drawn_where_it_is_wanted(tmp_path: Path) -> None:
    result = run("--pictures", str(tmp_path / "new" / "folder"))

    picture = tmp_path / "new" / "folder" / "latch_errors.svg"
    assert f"wrote {picture}" in result.output
    assert picture.read_text().count("<title") >= 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--feed", "0"], "'--feed': expected a number from 1 to 100000, got \"0\""),
        (["--feed", "nan"], "'--feed': expected a number from 1 to 100000, got \"nan\""),
        (["--scan-us", "fast"], "'--scan-us': expected a number from 100 to 20000, got \"fast\""),
        (["--tick-us", "0"], "'--tick-us': expected a number from 0.001 to 1000, got \"0\""),
        (["--touches", "3"], "'--touches': 3 is not in the range"),
        (["--path", "can"], "'--path': 'can' is not one of 'skip', 'plc', 'both'"),
        (["--jobs", "0"], "'--jobs': 0 is not in the range"),
    ],
)
def test_bad_option_is_told_and_ends_with_2(arguments: list[str], message: str) -> None:
    result = run(*arguments)

    assert result.exit_code == 2
    assert message in result.output
    assert "Traceback" not in result.output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--nominal", "nowhere.toml"], "nowhere.toml: cannot read: No such file or directory"),
        (["--feed", "1e5", "--accel", "1"], "are too many counts of 0.01 µm each"),
        (["--json", "no/such/folder.json"], "no/such/folder.json: cannot write: No such file"),
    ],
)
def test_bad_input_is_one_line_and_ends_with_2(
    arguments: list[str],
    message: str,
    refused: Program,
) -> None:
    assert message in refused(*QUICK, *arguments)


def test_no_bar_is_shown_where_stderr_is_no_terminal() -> None:
    assert run().stderr == ""
