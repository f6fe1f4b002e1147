"""``skiplatch import`` of a log of another kind: which importer reads it."""

import zipfile
from pathlib import Path

import pytest
from click.testing import CliRunner

from refusals import Program
from skiplatch.cli import group
from skiplatch.commands.import_log import command
from skiplatch.errors import InputError
from skiplatch.importing.kinds import kind_of
from test_import_logs import LOGS

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

    assert f"{name}: no frames of a CAN bus, but a table: skiplatch import csv" in said


def test_text_of_no_kind_is_told_what_a_log_of_a_bus_is(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.log").write_text("hello\nworld\n")

    said = refused("import", "can", tmp_path / "t.log", "-o", tmp_path / "x")

    assert "t.log: expected frames of a CAN bus, as candump and python-can write them" in said


BUS = "(1700000000.0000) can0 181#0000000000000000\n"
ASC = "date Mon Nov 6 10:00:00.000 2023\nbase hex  timestamps absolute\ninternal events logged\n"
SCOPE = "Time,CH1,CH2\ns,V,V\n0.000001,0.01,3.31\n"
MADE = {"bus.log": ("can", BUS), "bus.asc": ("can", ASC), "scope.csv": ("edges", SCOPE)}
TABLES = ("csv", "iso230")
KIND_OF = {
    **{path.name: path.name.split("_")[0] for path in LOGS.iterdir()},
    "klippy.log": "klipper",
    "fluidnc_answered.log": "grbl",
    "table.csv": "csv",
    "trace.mdf": "mdf",
    **dict.fromkeys(("capture.vcd", "session.zip"), "edges"),
    **dict.fromkeys(("saleae.csv", "saleae_dates.csv", "saleae_latches.csv"), "edges"),
    **{name: kind for name, (kind, _) in MADE.items()},
}
SAMPLES = sorted(name for name in KIND_OF if not name.endswith((".md", ".ngc")))
WORDS = {"csv": ("--map", "coordinate_mm=No such column")}


def sample(name: str, folder: Path) -> Path:
    """A log of the samples, or one that is made here."""
    path = folder / name
    if name in MADE:
        path.write_text(MADE[name][1])
    elif name == "session.zip":
        with zipfile.ZipFile(path, "w") as archive:
            for member in ("version", "metadata"):
                archive.writestr(member, "2")
    elif name == "trace.mdf":
        path.write_bytes(b"MDF     4.10    ".ljust(200, b"\0"))
    else:
        return LOGS / name
    return path


def is_read(by: str, name: str) -> bool:
    """Whether an importer reads a log, or one that cannot be told from those that it reads."""
    kind = KIND_OF[name]
    alike = (*TABLES, "edges") if kind in TABLES else TABLES
    return by == kind or (by, kind) == ("can", "mdf") or (by in alike and kind in TABLES)


@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.parametrize("by", sorted(command.commands))
def test_every_importer_names_the_one_that_reads_a_log_of_another_kind(
    tmp_path: Path, by: str, name: str
) -> None:
    if is_read(by, name):
        return
    path, out = sample(name, tmp_path), tmp_path / "out"

    result = CliRunner().invoke(
        group, ["import", by, str(path), *WORDS.get(by, ()), "-o", str(out)]
    )

    assert isinstance(result.exception, InputError), result.output
    said, kind = str(result.exception), KIND_OF[name]
    assert said.startswith(f"{path}: no ")
    readers = [f"skiplatch import {kind} reads them"]
    if kind in TABLES:
        readers.append("skiplatch import csv or iso230 reads it")
    assert said.endswith(tuple(readers))
    assert not result.output
    assert not out.exists()


def test_every_importer_has_a_log_among_the_samples() -> None:
    assert {KIND_OF[name] for name in SAMPLES} == set(command.commands)


@pytest.mark.parametrize("name", SAMPLES)
def test_the_kind_of_a_log_is_told_by_what_stands_in_it(tmp_path: Path, name: str) -> None:
    plain = tmp_path / "plain"
    plain.write_bytes(sample(name, tmp_path).read_bytes())

    kind = kind_of(plain)

    assert kind == KIND_OF[name] or (kind == "a table" and KIND_OF[name] in TABLES)


def test_what_is_wrong_with_a_log_of_the_right_kind_is_still_said(
    tmp_path: Path, refused: Program
) -> None:
    said = refused("import", "edges", LOGS / "saleae.csv", "--probe", "D9", "-o", tmp_path / "x")

    assert 'saleae.csv: no channel "D9"; there are: Channel 0, Channel 1' in said


def test_table_with_times_is_no_capture(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("Time [s],Z\n0.5,1.513\n1.5,1.514\n")

    said = refused("import", "csv", tmp_path / "t.csv", "--map", "coordinate_mm=Q", "-o", "x")

    assert 't.csv:1: no column "Q"; there are: Time [s], Z' in said
