"""From ten logs to reports, by the commands of docs/TUTORIAL.md and no file edited."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from machine_logs import (
    LOGS,
    MachineLog,
    fluidnc_warming,
    klipper_speeds,
    linuxcnc_inches,
    marlin_heating,
)
from skiplatch.campaign import read_campaign
from skiplatch.cli import group

every_log = pytest.mark.parametrize("make", LOGS, ids=lambda make: make.__name__)
LIKE_ANOTHER = (fluidnc_warming, klipper_speeds, linuxcnc_inches, marlin_heating)
"""Logs of a controller of which another log is diagnosed by `make long`."""


def run(*words: object) -> str:
    result = CliRunner().invoke(group, [str(word) for word in words], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


@every_log
def test_log_is_imported_whole_and_repeat_tells_its_drift(
    make: Callable[[], MachineLog], tmp_path: Path
) -> None:
    log = make()

    said = run("import", *log.written(tmp_path), "-o", tmp_path / "made")

    assert len(read_campaign(tmp_path / "made").touches) == log.touches
    assert "Could not be read" not in said
    assert "Not recorded" in run("check", tmp_path / "made")
    run("repeat", tmp_path / "made", "--json", tmp_path / "r.json")
    told = json.loads((tmp_path / "r.json").read_text())
    low, high = next(v for k, v in told.items() if re.fullmatch(r"drift_.*touch_interval", k))
    drift = 0 if low <= 0.0 <= high else 1 if low > 0.0 else -1
    assert drift == np.sign(log.drift_um)


@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")  # of what no log tells
@pytest.mark.parametrize(
    "make",
    [
        pytest.param(make, marks=pytest.mark.nightly if make in LIKE_ANOTHER else pytest.mark.long)
        for make in LOGS
    ],
    ids=lambda make: make.__name__,
)
def test_diagnosis_is_right_or_says_that_it_does_not_know(
    make: Callable[[], MachineLog], tmp_path: Path
) -> None:
    log = make()
    run("import", *log.written(tmp_path), "-o", tmp_path / "made")

    run("diagnose", tmp_path / "made", "--json", tmp_path / "d.json", "--html", tmp_path / "d.html")

    found = json.loads((tmp_path / "d.json").read_text())
    assert found["verdict"] in log.verdicts
    said = [{effect["id"], *effect["alternatives"]} for effect in found["effects"]]
    assert all(names & set(log.effects) for names in said)
    assert (tmp_path / "d.html").stat().st_size > 0
