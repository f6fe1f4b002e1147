"""Logs that the real LinuxCNC wrote of two faces, from import to what is found.

They were recorded by ``python -m tests.linuxcnc.campaigns --faces nothing servo_period``, and hold
the touches too around which the machine stalled: 29 and 61 of 140.
"""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from skiplatch.cli import group
from test_import_logs import Run

DATA = Path(__file__).parent / "data" / "linuxcnc_faces"
Json = Any

pytestmark = pytest.mark.filterwarnings("ignore:.*time_s. not recorded")  # a log has no times


def diagnosed(folder: Path, name: str) -> Json:
    log, program = str(DATA / name / "probe.log"), str(DATA / name / "program.ngc")
    run = Run(folder, "linuxcnc", log, "--program", program)
    assert "140 touches of 2 surfaces" in run.said["known"]
    words = ["diagnose", str(folder / "campaign"), "--json", str(folder / "found.json")]
    result = CliRunner().invoke(group, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return json.loads((folder / "found.json").read_text())


def test_the_log_of_a_sound_machine_shows_no_gap(tmp_path: Path) -> None:
    found = diagnosed(tmp_path, "nothing")

    assert (found["verdict"], found["effects"]) == ("no_gap", [])


@pytest.mark.long
def test_the_log_of_another_servo_period_has_it_among_the_tied(tmp_path: Path) -> None:
    """2 ms, where 1 ms is believed; the faces may be anywhere, so late scans look the same."""
    found = diagnosed(tmp_path, "servo_period")

    (named,) = found["effects"]
    tied = {effect["id"]: effect["params"] for model in found["models"] for effect in model}
    assert "scan_period" in {named["id"], *named["alternatives"]}
    assert tied["scan_period"]["period_us"] == pytest.approx(1000.0, abs=100.0)
