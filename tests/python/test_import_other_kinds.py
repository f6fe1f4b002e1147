"""``skiplatch import csv``, ``can`` of what is no such thing: which importer reads it."""

from pathlib import Path

import pytest

from refusals import Program

GRBL = "Grbl 1.1h ['$' for help]\nG38.2 Z-10 F100\n[PRB:0.000,0.000,-1.230:1]\nok\n"
KLIPPER = 'Starting "Klippy" now\n"// probe at 10.000,10.000 is z=1.320000\n'
MARLIN = "G28 X0\nG28 Y0\nBed X: 10.0 Y: 10.0 Z: 0.013\n"


@pytest.mark.parametrize(
    ("kind", "text"), [("grbl", GRBL), ("klipper", KLIPPER), ("marlin", MARLIN)]
)
def test_log_that_is_no_table_names_its_importer(
    tmp_path: Path, refused: Program, kind: str, text: str
) -> None:
    (tmp_path / "t.log").write_text(text)

    said = refused("import", "csv", tmp_path / "t.log", "--map", "coordinate_mm=Z", "-o", "x")

    assert f"no touches of a table, but of {kind}: skiplatch import {kind} reads them" in said


def test_table_without_a_column_still_names_those_there_are(
    tmp_path: Path, refused: Program
) -> None:
    (tmp_path / "t.csv").write_text("X,F\n1.5,100\n")

    said = refused("import", "csv", tmp_path / "t.csv", "--map", "coordinate_mm=Z", "-o", "x")

    assert 't.csv:1: no column "Z"; there are: X, F' in said


@pytest.mark.parametrize("name", ["t.csv", "t.log"])
def test_table_that_is_no_log_of_a_bus_is_told_so(
    tmp_path: Path, refused: Program, name: str
) -> None:
    (tmp_path / name).write_text("Side,X\n+,1.5\n-,1.6\n")

    said = refused("import", "can", tmp_path / name, "-o", tmp_path / "x")

    assert f"{name}: expected frames of a CAN bus, as candump and python-can write them" in said
