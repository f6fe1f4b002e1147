"""``skiplatch import iso230``: runs in columns, runs in rows, or a touch a line."""

from pathlib import Path

import numpy as np
import pytest

from refusals import Program
from skiplatch.campaign import Touches
from skiplatch.importing.iso230_heads import unit_in_title
from skiplatch.importing.iso230_list import columns_of_list
from test_import_logs import Run, log

WIDE = "mm,1 up [µm],1 down [µm],2 up [µm],2 down [µm]\n0,0.1,-3,0.2,-3.1\n100,2,-1,2.1,-1.2\n"
IN_ROWS = Path(log("iso230_rows.csv")).read_text(encoding="utf-8")
UNIT_IN_CORNER = "Error [µm];0;100\n1 ↑;0,1;2\n1 ↓;-3;-1\n2 ↑;0,2;2,1\n2 ↓;-3,1;-1,2\n"
LIST = Path(log("iso230_list.csv")).read_text(encoding="utf-8")
WITHOUT_RUNS = (
    "Soll [mm];Richtung;Ist [mm]\n0;hin;0,0001\n100;hin;100,002\n100;zurück;99,999\n"
    "0;zurück;-0,003\n0;hin;0,0002\n100;hin;100,0021\n100;zurück;99,9988\n0;zurück;-0,0031\n"
)


def read(folder: Path, text: str) -> Run:
    """Import a table."""
    folder.mkdir()
    (folder / "x.csv").write_text(text)
    return Run(folder, "iso230", str(folder / "x.csv"), "--axis", "X")


def told(touches: Touches) -> np.ndarray:
    """Give what touches are told by."""
    return np.column_stack([touches.position_mm, touches.sign, touches.deviation_um])


@pytest.mark.parametrize("text", [IN_ROWS, UNIT_IN_CORNER, LIST, WITHOUT_RUNS])
def test_layouts_of_the_same_runs_make_the_same_campaign(tmp_path: Path, text: str) -> None:
    wide, other = read(tmp_path / "wide", WIDE), read(tmp_path / "other", text)

    digit_um = 1e-3  # to which the zero of the instrument is told
    found, expected = told(other.campaign.touches), told(wide.campaign.touches)
    assert found == pytest.approx(expected, abs=1.01 * digit_um)


RUNS_NUMBERED = """Run No,Target No,Target,Error (microns)
1,1,0,1.5
1,2,50,-2.3
1,3,100,1.1
2,1,0,1.2
2,2,50,-2.4
2,3,100,1.0
"""
BARE = "Target [mm],Error [um]\n0,1.5\n50,-2.3\n100,1.1\n0,1.2\n50,-2.4\n100,1\n"


@pytest.mark.parametrize(
    "text",
    [
        RUNS_NUMBERED,
        RUNS_NUMBERED.replace("Run No", "Run").replace("Target No", "Target #"),
        RUNS_NUMBERED.replace("Run No,Target No,Target", "Zyklus,Messpunkt Nr.,Sollposition [mm]"),
        BARE,
    ],
)
def test_list_without_senses_is_a_list(tmp_path: Path, text: str) -> None:
    run = read(tmp_path / "list", text)

    touches = run.campaign.touches
    assert touches.position_mm.tolist() == [0.0, 50.0, 100.0] * 2
    assert touches.deviation_um.tolist() == [1.5, -2.3, 1.1, 1.2, -2.4, 1.0]
    assert touches.sign.tolist() == [1.0] * 6
    expected = "3 positions, 2 runs in the positive sense, 0 in the negative"
    assert expected in run.said["known"]


def test_table_of_runs_whose_places_repeat_is_no_list(tmp_path: Path) -> None:
    table = "Target,1 up [um],1 down [um],Fehler\n0,1,2,0\n50,1,2,0\n50,1.1,2.1,0\n"

    run = read(tmp_path / "wide", table)

    assert "3 positions, 2 runs in the positive sense, 1 in the negative" in run.said["known"]


@pytest.mark.parametrize(
    ("places", "senses"),
    [
        ([0, 50, 100, 100, 50, 0], [1, 1, 1, -1, -1, -1]),
        ([0, 50, 100, 50, 0, 50], [1, 1, 1, -1, -1, 1]),
        ([100, 50, 0, 100, 50, 0], [-1] * 6),
    ],
)
def test_senses_of_a_list_are_those_of_its_ways(
    tmp_path: Path, places: list[int], senses: list[int]
) -> None:
    lines = [f"{place},0.{i}" for i, place in enumerate(places, 1)]
    run = read(tmp_path / "list", "\n".join(["Target,Error (um)", *lines]) + "\n")

    assert run.campaign.touches.position_mm.tolist() == places
    assert run.campaign.touches.sign.tolist() == senses
    assert any("the way from the line before" in line for line in run.said["assumed"])


def test_run_that_meets_a_target_twice_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "x.csv").write_text(RUNS_NUMBERED.replace("\n2,", "\n1,"))

    said = refused("import", "iso230", tmp_path / "x.csv", "-o", tmp_path / "made")

    assert "x.csv:5: run 1 meets 0 in this sense twice" in said


def test_means_among_runs_in_rows_are_left_out(tmp_path: Path) -> None:
    said = read(tmp_path / "rows", IN_ROWS).said

    assert "columns that are no runs: Mean up [µm]" in said["could_not_be_read"]
    assert "runs are in rows, positions in the head" in said["assumed"]


def test_list_keeps_the_order_of_its_touches(tmp_path: Path) -> None:
    lines = LIST.splitlines()
    turned = "\n".join([lines[0], *lines[:0:-1]]) + "\n"

    touches = read(tmp_path / "list", turned).campaign.touches

    assert touches.position_mm.tolist() == [0.0, 100.0, 100.0, 0.0] * 2
    assert touches.sign.tolist() == [-1.0, -1.0, 1.0, 1.0] * 2


def test_list_says_what_it_does_not_need(tmp_path: Path) -> None:
    said = read(tmp_path / "list", LIST).said

    assert "columns that are not needed: Air" in said["could_not_be_read"]
    assert "a touch in each line, in the order in which they were made" in said["known"]


def test_touch_that_is_missing_from_a_list_is_none(tmp_path: Path) -> None:
    text = "".join(line for line in LIST.splitlines(keepends=True) if not line.startswith("2,0,-"))

    assert len(read(tmp_path / "list", text).campaign.touches) == 7


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (LIST.replace("1,100,-", "1,100,both"), 'x.csv:4: expected a sense of motion, got "both"'),
        (LIST.replace("2,0,+", "1,0,+"), "x.csv:6: run 1 meets 0 in this sense twice"),
        (LIST.replace("2,0,+", "2,here,+"), 'x.csv:6: Target [mm]: expected a number, got "here"'),
        (WITHOUT_RUNS.replace("-0,003\n", "here\n"), "x.csv:5: Ist [mm]: expected a number"),
        (LIST.replace("0.2,20", "word,20"), 'x.csv:6: run 2 + [µm]: expected a number, got "word"'),
        (IN_ROWS.replace("-3.1,-1.2", "-3.1"), "x.csv:6: expected 3 cells, got 2"),
        (IN_ROWS.replace("-3.1", "word"), 'x.csv:6: 2 down [µm]: expected a number, got "word"'),
        ("Target,Direction,Deviation\n", "expected positions in the first column and a run"),
    ],
)
def test_wrong_cell_is_refused_with_its_line(
    tmp_path: Path, refused: Program, text: str, message: str
) -> None:
    (tmp_path / "x.csv").write_text(text)

    assert message in refused("import", "iso230", tmp_path / "x.csv", "-o", tmp_path / "made")


@pytest.mark.parametrize(
    ("heads", "kinds"),
    [
        (["Position", "Sense", "Position error"], {"position", "sense", "deviation"}),
        (["Zyklus", "Soll", "Richtung", "Abweichung"], {"run", "position", "sense", "deviation"}),
        (["Position", "Run 1 forward", "Run 1 reverse"], set()),
        (["Target", "Direction + dev", "Direction - dev"], set()),
        (["Position", "Run", "Deviation"], {"position", "run", "deviation"}),
        (["Run-Nr.", "Ziel Nr.", "Ziel", "Fehler"], {"position", "run", "deviation"}),
        (["Position", "Run 1", "Deviation"], set()),
        (["No.", "Position", "Deviation"], set()),
    ],
)
def test_list_is_told_by_its_heads(heads: list[str], kinds: set[str]) -> None:
    assert set(columns_of_list(heads)) == kinds


FORM = (
    "Test report\n"
    "i,1,,2,\n"
    "Target position Pi (mm),0,,100,\n"
    "Approach direction,↑,↓,↑,↓\n"
    "j = 1,0.1,-3,2,-1\n"
    "j = 2,0.2,-3.1,2.1,-1.2\n"
    "Mean deviation,0.15,-3.05,2.05,-1.1\n"
)
MERGED = "Target;Forward;;Backward;\nmm;1;2;1;2\n0;0,1;0,2;-3;-3,1\n100;2;2,1;-1;-1,2\n"
NUMBERED = (
    WIDE.replace("mm,", "No.,Position [mm],")
    .replace("\n0,", "\n1,0,")
    .replace("\n100,", "\n2,100,")
)
IN_MM = (
    "X axis; all values in mm\n\nPosition;1 up;1 down;2 up;2 down\n"
    "0;0.0001;-0.003;0.0002;-0.0031\n100;0.002;-0.001;0.0021;-0.0012\n"
)
MEASURED = (
    "Target [mm],1 up,1 down,2 up,2 down\n"
    "0,0.0001,-0.003,0.0002,-0.0031\n100,100.002,99.999,100.0021,99.9988\n"
)
CORNER_IN_MM = (
    "Error [mm],0,100\n1 up,0.0001,0.002\n1 down,-0.003,-0.001\n"
    "2 up,0.0002,0.0021\n2 down,-0.0031,-0.0012\n"
)


@pytest.mark.parametrize("text", [FORM, MERGED, NUMBERED, IN_MM, MEASURED, CORNER_IN_MM])
def test_forms_of_protocols_make_the_same_campaign(tmp_path: Path, text: str) -> None:
    wide, other = read(tmp_path / "wide", WIDE), read(tmp_path / "other", text)

    digit_um = 1e-3
    found, expected = (
        np.array(sorted(told(run.campaign.touches).tolist())) for run in (other, wide)
    )
    assert found == pytest.approx(expected, abs=1.01 * digit_um)


@pytest.mark.parametrize(
    ("title", "unit"),
    [
        ("ALL VALUES IN MM", "mm"),
        ("Deviations in micrometres", "µm"),
        ("Einheit: \u03bcm", "µm"),
        ("Unit [mm]; Temperature in C", "mm"),
        ("mm in x, in mm or in µm", None),
        ("Machine 12", None),
    ],
)
def test_unit_may_stand_in_the_title(title: str, unit: str | None) -> None:
    assert unit_in_title(["ISO 230-2", title], turns=False) == unit


def test_lines_of_a_form_that_are_no_runs_are_named(tmp_path: Path) -> None:
    said = read(tmp_path / "form", FORM).said

    assert "lines that are no runs: Mean deviation" in said["could_not_be_read"]


def test_positions_in_place_of_deviations_are_told(tmp_path: Path) -> None:
    said = read(tmp_path / "measured", MEASURED).said

    assert "positions in place of deviations: the targets were taken off" in said["known"]


@pytest.mark.parametrize(
    ("heads", "values", "words"),
    [
        ("Position (deg),1 cw (deg),1 ccw (deg)", ("0.001", "0.002"), []),
        ("Position (deg),1 +,1 -", ("3.6", "7.2"), []),
        ("Position [°],1 + [″],1 - [″]", ("3.6", "7.2"), []),
        ("Position,1 +,1 -", ("0.001", "0.002"), ["--unit", "deg"]),
    ],
)
def test_deviations_of_a_rotary_axis_are_angles(
    tmp_path: Path, heads: str, values: tuple[str, str], words: list[str]
) -> None:
    (tmp_path / "c.csv").write_text(f"{heads}\n0,{values[0]},{values[1]}\n90,0,0\n")

    touches = Run(
        tmp_path, "iso230", str(tmp_path / "c.csv"), "--axis", "C", *words
    ).campaign.touches

    level = touches.deviation_arcsec[touches.position_deg == 0.0]
    assert np.ptp(level * touches.sign[touches.position_deg == 0.0]) == pytest.approx(3.6)
    assert sorted(touches.sign.tolist()) == [-1.0, -1.0, 1.0, 1.0]


@pytest.mark.parametrize(
    ("axis", "unit", "heads", "message"),
    [
        ("X", "deg", "mm,1+,1-", "--unit deg: expected one of µm, um, mm"),
        ("C", "mm", "deg,1+,1-", "--unit mm: expected one of arcsec"),
        ("C", "deg", "deg,1+ [arcsec],1- [arcsec]", "the heads of the runs say arcsec"),
        ("C", "deg", "mm,1+,1-", 'expected positions in deg, got "mm"'),
    ],
)
def test_units_of_another_kind_of_axis_are_refused(
    tmp_path: Path, refused: Program, axis: str, unit: str, heads: str, message: str
) -> None:
    (tmp_path / "x.csv").write_text(f"{heads}\n0,0,-3\n100,2,-1\n")

    words = ("--axis", axis, "--unit", unit, "-o", tmp_path / "made")
    assert message in refused("import", "iso230", tmp_path / "x.csv", *words)


@pytest.mark.parametrize(
    "heads",
    [
        *("1F,1R,2F,2R", "F1,R1,F2,R2", "P1,N1,P2,N2", "1U,1D,2U,2D", "1F [mm],1R [mm],2F,2R"),
        *("1 fwd,1 bwd,2 fwd,2 bwd", "fwd1,rev1,fwd2,rev2", "R1+,R1-,R2+,R2-"),
    ],
)
def test_runs_in_pairs_have_two_senses(tmp_path: Path, heads: str) -> None:
    rows = "0,0.1,1.2,0.2,1.1\n100,0.3,1.5,0.4,1.4\n"
    (tmp_path / "x.csv").write_text(f"Target,{heads}\n{rows}")

    touches = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--axis", "X").campaign.touches

    assert touches.sign.tolist() == [1, 1, -1, -1, 1, 1, -1, -1]


def test_negative_runs_may_stand_first(tmp_path: Path) -> None:
    rows = "0,0.1,1.2\n100,0.3,1.5\n"
    (tmp_path / "x.csv").write_text(f"Target,1 bwd,1 fwd\n{rows}")

    touches = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--axis", "X").campaign.touches

    assert touches.sign.tolist() == [-1, -1, 1, 1]


@pytest.mark.parametrize("heads", ["A1,B1", "1 left,1 right", "Run 1,Temp 1", "1L,1R"])
def test_pairs_that_nothing_tells_apart_are_refused(
    tmp_path: Path, refused: Program, heads: str
) -> None:
    (tmp_path / "x.csv").write_text(f"Target,{heads}\n0,0.1,1.2\n100,0.3,1.5\n")

    said = refused("import", "iso230", tmp_path / "x.csv", "--axis", "X", "-o", tmp_path / "x")

    one, other = heads.split(",")
    assert f'x.csv:1: expected senses such as + and - or fwd and rev, got pairs as "{one}"' in said
    assert f'and "{other}"' in said


def test_runs_by_number_alone_are_in_one_sense(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("Target,R1,R2,B\n0,0.1,1.2,1\n100,0.3,1.5,1\n")

    touches = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--axis", "X").campaign.touches

    assert touches.sign.tolist() == [1, 1, 1, 1]


@pytest.mark.parametrize("senses", ["up,down", "forward,reverse", "+,-", "1,-1"])
@pytest.mark.parametrize("title", ["", "Machine M1\n"])
def test_senses_of_runs_in_rows_may_have_a_column(tmp_path: Path, senses: str, title: str) -> None:
    up, down = senses.split(",")
    rows = [f"1,{up},0.1,0.2,0.3", f"1,{down},-1,-2,-3", f"2,{up},0.3,0.2,0.1"]
    text = "\n".join(["Run,Direction,0,50,101", *rows])
    (tmp_path / "x.csv").write_text(f"{title}{text}\n")

    run = Run(tmp_path, "iso230", str(tmp_path / "x.csv"))

    assert run.campaign.touches.sign.tolist() == [1.0] * 3 + [-1.0] * 3 + [1.0] * 3
    assert run.campaign.touches.position_mm.tolist() == [0, 50, 101, 101, 50, 0, 0, 50, 101]


def test_row_without_a_sense_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "x.csv").write_text("Run,Direction,0,50,101\n1,up,1,2,3\n2,here,1,2,3\n")

    said = refused("import", "iso230", tmp_path / "x.csv", "-o", tmp_path / "made")

    assert 'x.csv:3: Direction: expected a sense of motion, got "here"' in said


def test_runs_in_rows_may_have_a_sign_for_their_sense(tmp_path: Path) -> None:
    runs = "Lauf 1 +;3,0;5,0\nLauf 1 -;-3,0;-1,0\nLauf 2 +;3,1;5,1\nLauf 2 -;-3,1;-1,1\n"
    (tmp_path / "t.csv").write_text(f"Achse X;0;100\n{runs}")

    run = Run(tmp_path, "iso230", str(tmp_path / "t.csv"), "--axis", "X")

    signs = run.campaign.touches.sign
    assert (signs == 1).sum() == (signs == -1).sum() == 4
    assert "runs are in rows, positions in the head" in run.said["assumed"]


def test_runs_aligned_by_spaces_are_read(tmp_path: Path) -> None:
    text = "mm      1 up   1 down\n0       0.1    -5.9\n100     1.1    -4.9\n"
    (tmp_path / "x.txt").write_text(text)

    run = Run(tmp_path, "iso230", str(tmp_path / "x.txt"), "--axis", "X")

    assert run.campaign.touches.position_mm.tolist() == [0.0, 100.0, 100.0, 0.0]
    assert run.campaign.touches.sign.tolist() == [1.0, 1.0, -1.0, -1.0]


UNNAMED_MM = (
    "Position,1 up,1 down,2 up,2 down\n0,0.0001,-0.003,0.0012,-0.0031\n100,0.002,0,0.003,0\n"
)


def test_deviations_in_mm_are_not_taken_for_um(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "x.csv").write_text(UNNAMED_MM)

    said = refused("import", "iso230", tmp_path / "x.csv", "-o", tmp_path / "made")

    expected = "in µm they would repeat to 0.00053 µm, closer than an axis does; give --unit mm"
    assert expected in said


@pytest.mark.parametrize(("unit", "um"), [("mm", 1.0), ("um", 1e-3)])
def test_unit_that_is_given_is_not_doubted(tmp_path: Path, unit: str, um: float) -> None:
    (tmp_path / "x.csv").write_text(UNNAMED_MM)

    run = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--unit", unit)

    deviations = run.campaign.touches.deviation_um
    assert float(np.ptp(deviations)) == pytest.approx(4.0 * um, abs=2.0 * um)
