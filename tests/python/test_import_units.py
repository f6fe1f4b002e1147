"""``skiplatch import linuxcnc``: the unit of a log, by what tells it, or asked for."""

from collections.abc import Iterable
from pathlib import Path

import pytest
from click.testing import CliRunner

from refusals import Program
from skiplatch.cli import group
from test_import_logs import LOGS, Run

SCATTER = (0.0, 1.0, -1.0, 2.0, -2.0, 0.5, -0.5, 1.5)
"""Of touches of one surface, about in σ."""
INI = "[EMCMOT]\nSERVO_PERIOD = 500000\n[TRAJ]\nLINEAR_UNITS = {}\n"
NOT_TOLD = "expected --units mm or --units inch: no G20 or G21 tells the unit, and the touches "
IN_MM = "coordinates in mm: no G20, G21 or .ini tells another unit; else give --units"


def rows(values: Iterable[float], x: float = 1.25) -> str:
    return "".join(f"{x:f} 0.750000 {z:f}" + " 0.000000" * 6 + "\n" for z in values)


def touched(sigma: float, x: float = 1.25, shift: float = 0.0) -> str:
    """Touches of a surface that scatter by `sigma` in the unit of the log."""
    return rows((-0.412713 + shift + sigma * off for off in SCATTER), x)


def read(folder: Path, log: str, *words: str, program: str | None = None) -> Run:
    (folder / "p.txt").write_text(log)
    if program is not None:
        (folder / "p.ngc").write_text(program)
        words = (*words, "--program", str(folder / "p.ngc"))
    return Run(folder, "linuxcnc", str(folder / "p.txt"), *words)


def range_um(run: Run) -> float:
    deviations = run.campaign.touches.deviation_um
    return float(deviations.max() - deviations.min())


def said_of(run: Run) -> list[str]:
    told = [*run.said["known"], *run.said["assumed"]]
    return [line for line in told if "unit" in line or "coordinates in" in line]


IN_INCHES = touched(0.00005)
"""1.3 µm if in inches."""


@pytest.mark.parametrize("log", [touched(0.0005), rows([-3.2, -3.21, -3.2])])
def test_unit_that_nothing_tells_is_assumed_to_be_mm_and_said(tmp_path: Path, log: str) -> None:
    run = read(tmp_path, log)

    assert said_of(run) == [IN_MM]
    assert range_um(run) == pytest.approx(2.0 if log == touched(0.0005) else 10.0, rel=0.01)


@pytest.mark.parametrize(
    ("words", "factor"),
    [(("--units", "mm"), 1.0), (("--units", "inch"), 25.4), (("--inch",), 25.4)],
)
def test_unit_that_is_given_is_known(tmp_path: Path, words: tuple[str, ...], factor: float) -> None:
    run = read(tmp_path, touched(0.0005), *words)

    assert range_um(run) == pytest.approx(2.0 * factor, rel=0.01)
    assert len(said_of(run)) == 1
    assert "else give" not in said_of(run)[0]


@pytest.mark.parametrize(
    ("said", "factor"),
    [("(G21 at the begin)", 1.0), ("G20", 25.4), ("; units: inch", 25.4), ("all in mm", 1.0)],
)
def test_word_in_the_log_tells_the_unit(tmp_path: Path, said: str, factor: float) -> None:
    run = read(tmp_path, f"{said}\n{touched(0.0005)}")

    assert range_um(run) == pytest.approx(2.0 * factor, rel=0.01)
    assert "a line of the log says" in said_of(run)[0]


def test_two_units_in_the_log_tell_none(tmp_path: Path) -> None:
    assert said_of(read(tmp_path, f"G20\n{touched(0.0005)}G21\n")) == [IN_MM]


@pytest.mark.parametrize(
    ("log", "factor", "why"),
    [
        (touched(0.00005), 25.4, "inch: in mm the touches would scatter by 0.074 µm alone"),
        (touched(0.006), 1.0, "mm: in inches the touches would scatter by 226 µm"),
        (touched(0.0005, x=812.0), 1.0, "mm: in inches the log would reach 21 m"),
    ],
)
def test_unit_of_no_machine_speaks_for_the_other(
    tmp_path: Path, log: str, factor: float, why: str
) -> None:
    run = read(tmp_path, log)

    sigma = {25.4: 0.00005, 1.0: 0.0005 if "812" in log else 0.006}[factor]
    assert range_um(run) == pytest.approx(4000.0 * sigma * factor, rel=0.01)
    assert said_of(run) == [f"coordinates in {why}; else give --units"]


def test_two_surfaces_at_one_place_do_not_scatter(tmp_path: Path) -> None:
    run = read(tmp_path, touched(0.00005) + touched(0.00005, shift=1.5))

    assert said_of(run)[0].startswith("coordinates in inch: in mm the touches would scatter")


def test_outlier_speaks_for_no_unit(tmp_path: Path) -> None:
    run = read(tmp_path, touched(0.00005) + rows([-0.4]))

    assert said_of(run)[0].startswith("coordinates in inch: in mm the touches would scatter")


def test_reasons_for_both_units_are_no_reason(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "p.txt").write_text(touched(0.00005, x=812.0))

    said = refused("import", "linuxcnc", tmp_path / "p.txt", "-o", tmp_path / "c")

    assert f"{NOT_TOLD}could be in neither" in said


@pytest.mark.parametrize(("begin", "factor"), [("G20", 25.4), ("G21", 1.0)])
def test_program_tells_the_unit(tmp_path: Path, begin: str, factor: float) -> None:
    program = f"{begin}\n" + "G0 Z1\nG38.2 Z-1 F5\n" * len(SCATTER)

    run = read(tmp_path, touched(0.0005), program=program)

    assert range_um(run) == pytest.approx(2.0 * factor, rel=0.01)
    assert set(run.campaign.touches.feed_mm_min) == {5.0 * factor}


@pytest.mark.parametrize(
    ("feed", "factor", "why"),
    [
        (0.5, 25.4, "coordinates in inch: F0.5 is too slow in mm/min; else give --units"),
        (200, 1.0, "coordinates in mm: in inches F200 would be 5080 mm/min; else give --units"),
    ],
)
def test_feed_of_no_probe_speaks_for_the_other_unit(
    tmp_path: Path, feed: float, factor: float, why: str
) -> None:
    program = f"G0 Z1\nG38.2 Z-1 F{feed}\n" * len(SCATTER)

    run = read(tmp_path, touched(0.0005), program=program)

    assert said_of(run) == [why]
    assert set(run.campaign.touches.feed_mm_min) == {feed * factor}


def test_program_without_a_unit_is_assumed_to_be_in_mm(tmp_path: Path) -> None:
    program = "G0 Z1\nG38.2 Z-1 F20\n" * len(SCATTER)

    assert said_of(read(tmp_path, touched(0.0005), program=program)) == [IN_MM]


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("inch", 25.4), ("IN", 25.4), ("mm  # metric", 1.0), ("0.03937007874", 25.4), ("1", 1.0)],
)
def test_machine_tells_the_unit_and_the_servo_period(
    tmp_path: Path, unit: str, factor: float
) -> None:
    (tmp_path / "mill.ini").write_text(INI.format(unit))

    run = read(tmp_path, touched(0.0005), "--ini", str(tmp_path / "mill.ini"))

    assert range_um(run) == pytest.approx(2.0 * factor, rel=0.01)
    assert "LINEAR_UNITS of the .ini" in said_of(run)[0]
    assert "scan_us = 500.0" in run.toml
    assert "servo period of 1 ms" not in run.text


def test_program_counts_more_than_the_machine(tmp_path: Path) -> None:
    (tmp_path / "mill.ini").write_text(INI.format("inch"))
    program = "G21\n" + "G0 Z1\nG38.2 Z-1 F5\n" * len(SCATTER)

    run = read(tmp_path, touched(0.0005), "--ini", str(tmp_path / "mill.ini"), program=program)

    assert range_um(run) == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[TRAJ]\nCOORDINATES = XYZ\n", "mill.ini: expected LINEAR_UNITS in [TRAJ], found none"),
        (INI.format("ell"), 'mill.ini:4: expected LINEAR_UNITS = mm or inch, got "ell"'),
        (
            INI.format("mm").replace("500000", "1e300"),
            'mill.ini:2: expected SERVO_PERIOD in ns, 10000 to 100000000, got "1e300"',
        ),
    ],
)
def test_ini_that_tells_nothing_is_refused(
    tmp_path: Path, refused: Program, text: str, said: str
) -> None:
    (tmp_path / "p.txt").write_text(IN_INCHES)
    (tmp_path / "mill.ini").write_text(text)
    words = ("--ini", tmp_path / "mill.ini", "-o", tmp_path / "c")

    assert said in refused("import", "linuxcnc", tmp_path / "p.txt", *words)


def test_units_that_contradict_are_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "p.txt").write_text(IN_INCHES)
    words = ("--inch", "--units", "mm", "-o", tmp_path / "c")

    said = refused("import", "linuxcnc", tmp_path / "p.txt", *words)

    assert "--inch and --units mm contradict each other" in said


def test_repeat_takes_the_unit_of_a_log_and_of_no_campaign(
    tmp_path: Path, refused: Program, machine_sample: Path
) -> None:
    (tmp_path / "p.txt").write_text(touched(0.0005))

    words = ["repeat", str(tmp_path / "p.txt"), "--units", "inch"]
    result = CliRunner().invoke(group, words)

    assert "coordinates in" not in result.output
    assert "widest range, µm            50.8" in result.output
    assert "leave out --units" in refused("repeat", machine_sample, "--units", "inch")


@pytest.mark.parametrize(
    ("log", "said"),
    [
        ("klipper_octoprint.log", "touches of klipper, which tell their unit themselves: leave"),
        ("saleae.csv", "edges of a capture, which tell their unit themselves: leave out --units"),
        ("grbl_serial.log", "touches of grbl: skiplatch import grbl has --inch for them, not"),
    ],
)
def test_unit_makes_no_log_one_of_linuxcnc(log: str, said: str, refused: Program) -> None:
    assert said in refused("repeat", LOGS / log, "--units", "mm")
