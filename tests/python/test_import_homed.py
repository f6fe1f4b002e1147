"""``skiplatch import`` and ``repeat`` of logs in which homing parts the touches."""

from pathlib import Path

import pytest

from refusals import Program
from skiplatch.campaign.session_names import begun_by, session_after
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


@pytest.mark.parametrize("first", ["$H", "$H\n>>> M6 T2"])
def test_repeat_says_of_a_router_that_homing_parts_the_touches(
    tmp_path: Path, refused: Program, first: str
) -> None:
    touch = ">>> G38.2 Z-9 F60\n[PRB:0.000,0.000,-1.000:1]\nok\n"
    (tmp_path / "g.log").write_text(f"{touch}>>> {first}\nok\n{touch}")

    said = refused("repeat", tmp_path / "g.log")

    assert "homing began 1 session, and touches are compared within one" in said


def test_what_began_a_session_is_told_from_its_name() -> None:
    name = session_after({"homing": 2, "tool change": 1})

    assert name == "after homing 2 and tool change 1"
    assert begun_by(f"{name} Z- at 3 4", "homing") == 2
    assert begun_by(name, "tool change") == 1
    assert begun_by(name, "adjusting Z") is None
    assert session_after({"homing": 0}) == ""
