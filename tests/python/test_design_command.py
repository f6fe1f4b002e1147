"""``skiplatch design`` as the user meets it."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch import cli
from skiplatch.campaign import format_touches, read_conditions
from skiplatch.errors import InputError

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
BENCH = SAMPLES / "bench_isr_latency"


def run(*arguments: str) -> str:
    result = CliRunner().invoke(cli.group, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_help_has_an_example() -> None:
    assert "Example:\n    skiplatch design " in run("design", "--help")


def test_the_conditions_are_read_again_and_played(tmp_path: Path) -> None:
    conditions, document = tmp_path / "next.csv", tmp_path / "next.json"
    options = ("--out", str(conditions), "--touches", "25", "--json", str(document))
    text = run("design", str(BENCH), *options)

    again = read_conditions(conditions)
    names = conditions.read_text().splitlines()[0].split(",")
    assert format_touches(again, names) == conditions.read_text()
    assert not {"latch_us", "report_us", "deviation_um", "status"} & set(names)
    assert len(again) == 25
    assert np.array_equal(again.touch, np.arange(25))
    experiment = json.loads(document.read_text())
    assert sum(touch["count"] for touch in experiment["touches"]) == 25
    assert experiment["why"] in text
    assert f"{conditions}: 25 touches" in text

    predicted = tmp_path / "predicted.csv"
    play = ("--conditions", str(conditions), "--out", str(predicted), "--replicates", "3")
    run("predict", str(BENCH), *play)
    rows = list(csv.DictReader(predicted.read_text().splitlines()))
    assert len(rows) == 75
    assert all(row["status"] == "ok" for row in rows)


def test_a_campaign_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        run("design", str(tmp_path / "none"), "--out", str(tmp_path / "next.csv"))

    assert not (tmp_path / "next.csv").exists()
