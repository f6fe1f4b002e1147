"""``skiplatch plan`` as the user meets it."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from skiplatch import cli


def run(*arguments: str) -> Result:
    return CliRunner().invoke(cli.group, ["plan", "--jobs", "2", *arguments])


def document(folder: Path, *arguments: str) -> tuple[int, dict[str, Any]]:
    result = run("--json", str(folder / "plan.json"), *arguments)
    loaded: dict[str, Any] = json.loads((folder / "plan.json").read_text())
    return result.exit_code, loaded


def test_help_has_an_example() -> None:
    text = run("--help").output

    assert "Example:\n    skiplatch plan --" in text
    for option in ("--uncertainty-um", "--overtravel-mm", "--json", "--seed", "--jobs"):
        assert option in text


def test_example_of_the_help_runs() -> None:
    text = run("--path", "plc", "--scan-us", "4000", "--uncertainty-um", "2").output

    assert "two touches: fast feed" in text
    assert "standard uncertainty of 0.577 µm" in text
    assert "confirmed by simulation" in text


def test_json_of_a_plan_has_model_and_simulation(tmp_path: Path) -> None:
    code, found = document(tmp_path, "--path", "plc", "--uncertainty-um", "2")

    assert code == 0
    assert found["format"] == "skiplatch-plan/1"
    assert found["feasible"] is True
    assert found["best"] == found["two_touches"]
    assert found["one_touch"]["allowed"] is True
    assert found["one_touch"]["model"]["cycle_s"] == pytest.approx(20.1, abs=0.1)
    assert found["simulated"]["confirmed"] is True
    assert found["simulated"]["cycle_s"]["value"] == pytest.approx(
        found["best"]["model"]["cycle_s"], abs=0.006
    )


def test_wish_that_cannot_be_met_ends_with_1_and_says_so_in_json(tmp_path: Path) -> None:
    code, found = document(tmp_path, "--path", "plc", "--uncertainty-um", "0.1")

    assert code == 1
    assert found["feasible"] is False
    assert found["best"] is None
    assert found["simulated"] is None
    assert found["one_touch"]["limit"] == "least feed"
    assert found["one_touch"]["remedy"]


def test_json_does_not_depend_on_the_number_of_threads(tmp_path: Path) -> None:
    wish = ("--path", "plc", "--uncertainty-um", "5")

    assert document(tmp_path, *wish, "--jobs", "1") == document(tmp_path, *wish, "--jobs", "3")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "Missing option '--path'"),
        (["--path", "plc"], "Missing option '--uncertainty-um'"),
        (
            ["--path", "plc", "--uncertainty-um", "-1"],
            "'--uncertainty-um': expected a number from 0.001 to 1000000, got \"-1\"",
        ),
        (
            ["--path", "plc", "--uncertainty-um", "2", "--min-feed", "50", "--max-feed", "40"],
            "'--min-feed': more than --max-feed",
        ),
    ],
)
def test_bad_option_is_told_and_ends_with_2(arguments: list[str], message: str) -> None:
    result = run(*arguments)

    assert result.exit_code == 2
    assert message in result.output


def test_the_overtravel_of_the_fast_touch_is_shown_and_limited(tmp_path: Path) -> None:
    _, found = document(tmp_path, "--path", "plc", "--uncertainty-um", "2")

    best, played = found["best"], found["simulated"]
    v_mm_s = best["fast_feed_mm_min"] / 60.0
    latest_s = 0.004 + 0.002  # a whole scan, then the reaction
    expected_mm = v_mm_s * latest_s + v_mm_s**2 / (2.0 * 3000.0)
    assert best["model"]["fast_overtravel_mm"] == pytest.approx(expected_mm, rel=0.01)
    assert best["model"]["overtravel_mm"] < 0.01 * best["model"]["fast_overtravel_mm"]
    assert played["fast_overtravel_mm"] == pytest.approx(expected_mm, rel=0.02)
    assert (
        "overtravel of the fast touch, mm" in run("--path", "plc", "--uncertainty-um", "2").output
    )
    _, tight = document(
        tmp_path, "--path", "plc", "--uncertainty-um", "2", "--overtravel-mm", "0.3"
    )
    assert tight["best"]["fast_feed_mm_min"] < best["fast_feed_mm_min"]
    assert tight["simulated"]["fast_overtravel_mm"] <= 0.3
    assert found["one_touch"]["model"]["fast_overtravel_mm"] is None
