"""Numbers of logs and tables: read whole or not at all, and within what can be."""

import re
from pathlib import Path

import pytest

from refusals import Program
from skiplatch.errors import InputError
from skiplatch.importing.detect import read_any
from skiplatch.importing.gcode import Machine
from skiplatch.importing.model import Imported
from skiplatch.numbers import NUMBER, PLAIN, number
from test_import_logs import LOGS

TOUCHES = {
    "marlin": ("marlin_m48.log", r"(?<=z: )-?\d+\.\d+"),
    "klipper": ("klipper_octoprint.log", r"(?<=z=)-?\d+\.\d+"),
    "grbl": ("grbl_serial.log", r"-?\d+\.\d+(?=:1])"),
    "linuxcnc": ("linuxcnc_probe.txt", r"-?\d+\.\d+"),
}
"""A log of each kind and what stands for a number of a touch in it."""
NO_NUMBERS = ["1_0", "\u0661\u0662", "1\u0662", "1.2.3", "0x10", "1e", "nan", "inf", "- 1"]


def with_number(path: Path, kind: str, text: str) -> int:
    """Put a text in place of the second number of a touch, and give its line."""
    name, pattern = TOUCHES[kind]
    log = (LOGS / name).read_text(encoding="utf-8")
    place = list(re.finditer(pattern, log))[1]
    path.write_text(log[: place.start()] + text + log[place.end() :], encoding="utf-8")
    return log[: place.start()].count("\n") + 1


def coordinates(found: Imported) -> list[float | None]:
    return [touch.coordinate for touch in found.touches]


@pytest.mark.parametrize("text", ["1", "-1.5", "+.5", "5.", "1e300", "2.5E-3", " 7 "])
def test_number_is_read_whole(text: str) -> None:
    assert number(text) == float(text)


@pytest.mark.parametrize("text", NO_NUMBERS)
def test_what_is_no_number_is_not_read(text: str) -> None:
    with pytest.raises(ValueError, match=re.escape(text)):
        number(text)
    assert not re.match(f"(?:{NUMBER})", text)


@pytest.mark.parametrize("text", ["1_0", "1\u0662", "1.2.3", "\u0661"])
def test_word_of_g_code_is_not_cut_off(text: str) -> None:
    assert not re.match(PLAIN, text)
    assert ("Z", None) not in Machine().words(f"G1 Z{text}")
    assert "Z" not in dict(Machine().words(f"G1 Z{text}"))


@pytest.mark.parametrize("text", ["1_0", "1_0 + 2", "1E3", "0X10"])
def test_number_of_python_is_none_of_g_code(text: str) -> None:
    assert Machine().value(text) is None
    assert Machine(parameters={"<a_1_b>": 2.0}).value("#<a_1_b> * 3") == 6.0


@pytest.mark.parametrize("kind", TOUCHES)
def test_number_beyond_any_machine_is_refused_by_its_line(
    tmp_path: Path, refused: Program, kind: str
) -> None:
    as_printed = f"{1e300:.6f}" if kind == "linuxcnc" else "1e300"
    line = with_number(tmp_path / "a.log", kind, as_printed)

    said = refused("import", kind, tmp_path / "a.log", "-o", tmp_path / "x")

    told = re.escape("1e+07 in mm, got ")
    assert re.search(rf"a\.log:{line}: (?:position_mm|approach_mm|place .*): .*{told}", said)
    assert not (tmp_path / "x").exists()


@pytest.mark.parametrize("kind", TOUCHES)
@pytest.mark.parametrize("text", ["1_0", "\u0661.\u0662", "1\u0662"])
def test_what_python_alone_takes_for_a_number_is_no_touch(
    tmp_path: Path, kind: str, text: str
) -> None:
    with_number(tmp_path / "a.log", kind, "987654.500000")
    whole = coordinates(read_any(tmp_path / "a.log")[1])
    with_number(tmp_path / "a.log", kind, text)

    left = coordinates(read_any(tmp_path / "a.log")[1])

    assert not {1.0, 1.2, 10.0, 12.0}.intersection(left)
    assert len(left) == len(whole) - 1


def test_figure_of_a_log_that_no_rig_has_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "a.log").write_text("$102=1e300\nG38.2 Z-5 F100\n[PRB:0.000,0.000,-5.123:1]\n")

    said = refused("import", "grbl", tmp_path / "a.log", "-o", tmp_path / "x")

    assert "a.log: axis.resolution_um: expected a number >= 1e-06, got 1e-297 ($102 of" in said
    assert not (tmp_path / "x").exists()


ISO = "Position;1 ↑;1 ↓\n0;0,5;-2,5\n100;1,5;{}\n200;2,5;-0,5\n"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("{}", "inf", ':3: 1 ↓: expected a number, got "inf"'),
        ("{}", "1e300", ':3: 1 ↓: expected a number <= 1e+15, got "1e300"'),
        ("{}", "1e9", ":3: deviation_um: expected a number >= -1e+07 in µm, got "),
        ("{}", "1_0", ':3: 1 ↓: expected a number, got "1_0"'),
        ("{}", "١", ':3: 1 ↓: expected a number, got "١"'),
        ("100", "nan", ':3: Position: expected a number, got "nan"'),
        ("200", "1e9", ":4: position_mm: expected a number <= 1e+07 in mm, got "),
        ("Position", "in", ':1: expected positions in mm, got "in"'),
        ("Position", "Position inch", ':1: expected positions in mm, got "Pos'),
    ],
)
def test_cell_of_an_iso_table_that_cannot_be_is_refused(
    tmp_path: Path, refused: Program, old: str, new: str, told: str
) -> None:
    text = ISO.replace(old, new).replace("{}", "-1,5")
    (tmp_path / "x.csv").write_text(text, encoding="utf-8")

    said = refused("import", "iso230", tmp_path / "x.csv", "-o", tmp_path / "x")

    assert f"x.csv{told}" in said
    assert said.count("\n") == 1


@pytest.mark.parametrize("column", ["deviation_um=Z", "deviation_um=Error"])
def test_column_that_is_mapped_twice_is_refused(
    tmp_path: Path, refused: Program, column: str
) -> None:
    (tmp_path / "t.csv").write_text("Z,Error\n1,2\n")
    maps = ("--map", "deviation_um=Error", "--map", column)

    said = refused("import", "csv", tmp_path / "t.csv", *maps, "-o", tmp_path / "x")

    assert 't.csv: deviation_um: expected one head, got "Error" and "' in said


def test_impossible_cell_of_a_table_is_refused_by_its_line(
    tmp_path: Path, refused: Program
) -> None:
    (tmp_path / "t.csv").write_text("Z,Feed\n1,100\n2,-5\n")
    maps = ("--map", "coordinate_mm=Z", "--map", "feed_mm_min=Feed")

    said = refused("import", "csv", tmp_path / "t.csv", *maps, "-o", tmp_path / "x")

    assert 't.csv:3: feed_mm_min: expected a number > 0 in mm/min, got "-5"' in said


def test_log_without_any_number_that_is_one_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("1_0 0 0\n")

    with pytest.raises(InputError):
        read_any(tmp_path / "a.txt")
