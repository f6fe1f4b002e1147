"""All that is wrong with files of what is to be played, told in one go."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from skiplatch.cli import BAD_INPUT, main

Told = Callable[..., list[str]]
NOMINAL = """format = "skiplatch-campaign/2"
kind = "machine"
[plc]
scan_us = 2
[axis]
accel_mm_s2 = "x"
[[effect]]
id = "backlash"
backlash_um = "q"
[[effect]]
id = "no_such"
"""
SCAN = "nominal.toml: plc.scan_us: expected 100 to 20000, which is what can be simulated, got 2"
ACCEL = 'nominal.toml:6:15: axis.accel_mm_s2: expected a number > 0 in mm/s², got "x"'
FEED = "touches.csv: feed_mm_min of touch 1: expected 0.001 to 1e+06"
WAY = "touches.csv: approach_mm of touch 0: expected 1e-06 to 10000"


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Told:
    """The lines that the program says of bad input."""

    def lines(*arguments: object) -> list[str]:
        monkeypatch.setattr(sys, "argv", ["skiplatch", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == BAD_INPUT
        return capsys.readouterr().err.splitlines()

    return lines


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "nominal.toml").write_text(NOMINAL)
    (tmp_path / "touches.csv").write_text(
        "touch,feed_mm_min,approach_mm,deviation_um\n0,60,1e6,3\n1,1e9,3,2\n"
    )
    return tmp_path


@pytest.mark.parametrize("command", ["check", "compare", "diagnose"])
def test_what_cannot_be_read_hides_nothing_that_cannot_be_played(
    folder: Path, told: Told, command: str
) -> None:
    said = told(command, folder)

    assert [line.removeprefix(f"skiplatch: {folder}/") for line in said if ACCEL in line] == [ACCEL]
    for expected in (SCAN, FEED, WAY, 'effect.id: no effect is called "no_such"'):
        assert sum(expected in line for line in said) == 1
    assert len(said) == 6  # the wrong parameter is told once


@pytest.mark.parametrize("is_folder", [True, False])
def test_what_is_no_campaign_is_told_once(tmp_path: Path, told: Told, is_folder: bool) -> None:
    path = tmp_path / "none"
    path.mkdir() if is_folder else path.write_text("a log\n")

    assert len(told("compare", path)) == 1


def test_what_cannot_be_read_in_touches_hides_no_belief(folder: Path, told: Told) -> None:
    (folder / "nominal.toml").write_text(NOMINAL.replace('"x"', "9").replace('"q"', "3"))
    (folder / "touches.csv").write_text("touch,feed_mm_min\n0,quick\n")

    said = "\n".join(told("compare", folder))

    assert 'touches.csv:2: feed_mm_min: expected a number > 0 in mm/min, got "quick"' in said
    assert SCAN in said


def test_beliefs_and_conditions_of_a_simulation_are_told_together(folder: Path, told: Told) -> None:
    rig = ("--nominal", folder / "nominal.toml", "--conditions", folder / "touches.csv")

    said = "\n".join(told("simulate", *rig, "-o", folder / "made"))

    assert all(expected in said for expected in (ACCEL, SCAN, FEED, WAY))


def test_a_probe_that_a_bench_does_not_play_is_not_told(folder: Path, told: Told) -> None:
    (folder / "nominal.toml").write_text(NOMINAL + "[probe]\ndelay_us = 1e12\n")

    said = "\n".join(told("latch", "--nominal", folder / "nominal.toml"))

    assert ACCEL in said
    assert SCAN in said
    assert "probe.delay_us" not in said
