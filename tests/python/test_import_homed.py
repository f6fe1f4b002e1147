"""``skiplatch import`` and ``repeat`` of logs in which homing parts the touches."""

from pathlib import Path

import pytest

from refusals import Program
from test_import_logs import Run

MARLIN = "G28\nBed X: 20.0 Y: 20.0 Z: 0.013\nBed X: 90.0 Y: 20.0 Z: 0.096\n"
KLIPPER = "$ G28\nprobe at 20.000,20.000 is z=1.320000\n"


@pytest.mark.parametrize(("kind", "text"), [("marlin", MARLIN), ("klipper", KLIPPER)])
@pytest.mark.parametrize("times", [1, 4])
def test_sessions_that_homing_begins_are_said(
    tmp_path: Path, kind: str, text: str, times: int
) -> None:
    (tmp_path / "g.log").write_text(text * times)

    run = Run(tmp_path, kind, str(tmp_path / "g.log"))

    told = [line for line in run.said["assumed"] if "homing (G28)" in line]
    assert [line.rsplit(": ")[-1] for line in told] == (["3"] if times == 4 else [])


def test_repeat_says_that_homing_parts_the_touches(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "g.log").write_text(MARLIN * 2)

    said = refused("repeat", tmp_path / "g.log")

    assert "homing began 1 session, and touches are compared within one" in said


def test_repeat_names_no_homing_where_none_was(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "g.log").write_text(MARLIN)

    said = refused("repeat", tmp_path / "g.log")

    assert said.rstrip().endswith("got none that was")
