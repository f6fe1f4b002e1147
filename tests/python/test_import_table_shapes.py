"""``skiplatch import csv`` and ``iso230``: which numbers, units, touches and runs a table has."""

from pathlib import Path

import numpy as np
import pytest

from refusals import Program
from skiplatch.errors import InputError
from skiplatch.importing.decimal_marks import Marks
from skiplatch.importing.iso230_heads import is_negative, no_runs
from skiplatch.importing.units_in_heads import split_unit
from test_import_logs import Run


def numbers(*rows: str) -> list[list[str]]:
    """Rows of cells between bars, with decimal points."""
    marks = Marks()
    written = ((line, row.split("|")) for line, row in enumerate(rows, 1))
    found = [row for _, row in marks.with_points(written)]
    marks.refuse_doubtful(Path("t.csv"), range(9))
    return found


@pytest.mark.parametrize(
    ("rows", "found"),
    [
        (["-1.233,9680|1.200"], [["-1233.9680", "1200"]]),  # its own thousands tell
        (["3,2|300", "12,25|1.200"], [["3.2", "300"], ["12.25", "1200"]]),
        (["3,2|1.200.300"], [["3.2", "1200300"]]),
        (["20.5|1.200"], [["20.5", "1.200"]]),
        (["1.200|7"], [["1.200", "7"]]),
        (["1.200|7", "0|8"], [["1.200", "7"], ["0", "8"]]),
        (["-99,998|7"], [["-99.998", "7"]]),
        (["20,5|-99.998", "20,6|-99.98"], [["20.5", "-99.998"], ["20.6", "-99.98"]]),
        (["20,5|0.123"], [["20.5", "0.123"]]),
        (["3.25|300", "1.5|1,200"], [["3.25", "300"], ["1.5", "1200"]]),  # tabs, in English
        (["1,5e-3|07.10.2025"], [["1.5e-3", "07.10.2025"]]),
    ],
)
def test_numbers_show_the_decimal_mark(rows: list[str], found: list[list[str]]) -> None:
    assert numbers(*rows) == found


@pytest.mark.parametrize(
    "rows",
    [
        ["20,5|-99.998", "20,6|-99.997"],  # of a controller, or as much as 99 m
        ["1,5|1.200", "2.5|1.300"],
        ["-12.003|600", "-12.025|1.200"],
        ["-99.998|1,200"],
    ],
)
def test_number_that_nothing_tells_is_refused(rows: list[str]) -> None:
    with pytest.raises(InputError, match=r"t\.csv:1: .* may be -?\d+ or -?\d+\.\d+"):
        numbers(*rows)


def test_thousands_are_said_and_doubt_in_other_columns_is_no_matter(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("µm;F;Nr\n3,2;300;1.001\n12,25;1.200;1.002\n")

    run = Run(
        tmp_path,
        *("csv", str(tmp_path / "t.csv"), "--map", "deviation_um=µm", "--map", "feed_mm_min=F"),
    )

    assert run.campaign.touches.feed_mm_min.tolist() == [300.0, 1200.0]
    assert 'thousands are parted: "1.200" was read as 1200' in run.said["assumed"]


@pytest.mark.parametrize(
    ("head", "unit", "found"),
    [
        ("error_mm", "µm", ("error", "mm")),
        ("Error mm", "µm", ("Error", "mm")),
        ("Error_\u03bcm", "µm", ("Error", "µm")),
        ("feed_mm_s", "mm/min", ("feed", "mm/s")),
        ("feed_mm_min", "mm/min", ("feed", "mm/min")),
        ("Feed mm/min", "mm/min", ("Feed", "mm/min")),
        ("Feed IPM", "mm/min", ("Feed", "ipm")),
        ("Feed (IPM)", "mm/min", ("Feed", "ipm")),
        ("Feed [degrees per minute]", "mm/min", ("Feed", "deg/min")),
        ("Feed (°/s)", "mm/min", ("Feed", "°/s")),
        ("t ms", "s", ("t", "ms")),
        ("Err_thou", "µm", ("Err", "thou")),
        ("Z thou", "mm", ("Z", "thou")),
        ("Err (µin)", "µm", ("Err", "µin")),
        ("Z inches", "mm", ("Z", "in")),
        ('Z (")', "mm", ("Z", '"')),
        ("Dev (inches)", "µm", ("Dev", "in")),
        ("Dev microns", "µm", ("Dev", "µm")),
        ("Dev, mm", "µm", ("Dev", "mm")),
        ("Z {mm}", "mm", ("Z", "mm")),
        ("Z pos. [mm] (machine)", "mm", ("Z pos.", "mm")),
        ("Feed (mm/sec)", "mm/min", ("Feed", "mm/s")),
        ("Feed (inches/min)", "mm/min", ("Feed", "in/min")),
        ("Feed inch per minute", "mm/min", ("Feed", "in/min")),
        ("F/(mm/min)", "mm/min", ("F", "mm/min")),
        ("t (msec)", "s", ("t", "ms")),
        ("temp_c", "°C", ("temp", "C")),
        ("scale µm/m", "µm", ("scale µm/m", "")),
        ("mm", "µm", ("mm", "")),
        ("Maximum", "µm", ("Maximum", "")),
        ("error_mm", "", ("error_mm", "")),
    ],
)
def test_unit_stands_at_the_end_of_a_head(head: str, unit: str, found: tuple[str, str]) -> None:
    assert split_unit(head, unit) == found


@pytest.mark.parametrize(
    ("mapping", "um"), [("error_m", 2e6), ("error", 2e6), ("error_m [mm]", 2e3)]
)
def test_ending_is_no_unit_where_another_is_given(tmp_path: Path, mapping: str, um: float) -> None:
    (tmp_path / "t.csv").write_text("n,error_m\n1,2\n2,2\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), "--map", f"deviation_um={mapping}")

    assert run.campaign.touches.deviation_um.tolist() == [um, um]
    assert not any("as none is named" in line for line in run.said["assumed"])


@pytest.mark.parametrize("heads", ["n,Z,F,Z", "n,Z mm,F,Z [in]"])
def test_head_of_two_columns_is_refused(tmp_path: Path, refused: Program, heads: str) -> None:
    (tmp_path / "t.csv").write_text(f"{heads}\n1,-10,100,-10.002\n")

    said = refused("import", "csv", tmp_path / "t.csv", "--map", "coordinate_mm=Z", "-o", "x")

    assert 't.csv:1: "Z" may be any of columns 2, 4: rename all but one' in said


FOOTER = "Nr;err [µm]\n1;3,2\n2;-1,5\n"


@pytest.mark.parametrize("between", ["", "\n", ";\n"])
def test_lines_of_words_below_are_no_touches(tmp_path: Path, between: str) -> None:
    (tmp_path / "t.csv").write_text(FOOTER + between + "Mittelwert;0,85\nStabw.;2,4\n;\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), "--map", "deviation_um=err")

    assert run.campaign.touches.deviation_um.tolist() == [3.2, -1.5]
    assert 'lines below the table: 2, "Mittelwert", "Stabw."' in run.said["could_not_be_read"]


@pytest.mark.parametrize(("last", "touches"), [("P3", 3), ("Mean", 2)])
def test_names_of_touches_are_no_lines_below(tmp_path: Path, last: str, touches: int) -> None:
    (tmp_path / "t.csv").write_text(f"point,err [um]\nP1,3.2\nP2,-1.5\n{last},0.85\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), "--map", "deviation_um=err")

    assert len(run.campaign.touches) == touches


@pytest.mark.parametrize(("column", "left_out"), [("deviation_um", 1), ("coordinate_mm", 2)])
def test_row_that_tells_nothing_is_no_touch(tmp_path: Path, column: str, left_out: int) -> None:
    """Nor is one without a coordinate a missed one; without a deviation it is not recorded."""
    (tmp_path / "t.csv").write_text("v,F,n\n3.2,300,1\n,,\nn/a,300,3\n0.7,300,4\n")
    mapped = {column: "v", "feed_mm_min": "F", "touch": "n"}
    words = [word for name, head in mapped.items() for word in ("--map", f"{name}={head}")]

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *words)

    assert len(run.campaign.touches) == 4 - left_out
    assert not run.campaign.touches.missed.any()
    said = f"rows that tell of no touch: {left_out}, the first in line 3"
    assert said in run.said["could_not_be_read"]
    below = f"rows below an empty one are touches like those above: {3 - left_out}"
    assert below in run.said["assumed"]


def test_missed_touch_has_an_outcome(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("err,came\n3.2,ok\n,missed\n")

    run = Run(
        tmp_path,
        *("csv", str(tmp_path / "t.csv"), "--map", "deviation_um=err", "--map", "status=came"),
    )

    assert run.campaign.touches.missed.tolist() == [False, True]


def test_table_of_no_touches_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("err,F\n,300\n,300\n")

    said = refused("import", "csv", tmp_path / "t.csv", "--map", "deviation_um=err", "-o", "x")

    assert "expected touches after the header, got none" in said


@pytest.mark.parametrize(
    ("head", "negative"),
    [
        ("run1_down", True),
        ("down_1", True),
        ("1downwards", True),
        ("1rev", True),
        ("1 -", True),
        ("-1", True),
        ("run1-", True),
        ("run1_up", False),
        ("run-1", False),
        ("Lauf 1 - vorwärts", False),
        ("1 +", False),
    ],
)
def test_head_of_a_run_says_its_sense(head: str, negative: bool) -> None:
    assert is_negative(head) == negative


@pytest.mark.parametrize(
    ("heads", "dropped"),
    [
        ("mm|1 up|1 down|x\u0304↑|x\u0304↓|s↑|s_i↓|B|B\u0304|R↑ [µm]|4s|E|A↓|M", range(3, 14)),
        ("mm|run1_up|run1_down|run_mean|Max|backlash", range(3, 6)),
        ("mm|A+|A-|B+|B-|C+|C-", ()),
        ("mm|A|B", ()),
        ("mm|1|2|minus", ()),
    ],
)
def test_results_of_iso_230_are_no_runs(heads: str, dropped: range) -> None:
    assert no_runs(heads.split("|")) == set(dropped)


def test_results_do_not_shift_the_zero(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("mm,up_1,down_1,s↑,B\n0,0,-3,0.3,3\n100,2,-1,0.3,3\n")

    run = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--axis", "X")

    assert run.campaign.touches.deviation_um.tolist() == pytest.approx([0.0, 2.0, 1.0, 3.0])
    assert np.array_equal(run.campaign.touches.sign, [1, 1, -1, -1])
    assert "columns that are no runs: s↑, B" in run.said["could_not_be_read"]


def test_unit_of_the_runs_is_that_of_their_heads(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("pos_mm,1+ [mm],1- [mm]\n0,0,-0.003\n100,0.002,-0.001\n")

    run = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--axis", "X")

    assert run.campaign.touches.deviation_um.tolist() == pytest.approx([0.0, 2.0, 1.0, 3.0])
    assert "deviations in mm, as the table says" in run.said["known"]


@pytest.mark.parametrize(
    ("heads", "message"),
    [
        ("mm,1+ [mm],1- [µm]", "expected all runs in one unit"),
        ("mm,1+ [µm],1- [µm]", "the heads of the runs say µm, and --unit says mm"),
        ("pos [in],1+,1-", 'expected positions in mm, got "pos [in]"'),
        ("mm,1+,feed_mm_s", 'expected runs with deviations in µm or mm, got "feed_mm_s"'),
    ],
)
def test_units_that_cannot_be_are_refused(
    tmp_path: Path, refused: Program, heads: str, message: str
) -> None:
    (tmp_path / "x.csv").write_text(f"{heads}\n0,0,-3\n100,2,-1\n")

    assert message in refused(
        "import", "iso230", tmp_path / "x.csv", "--unit", "mm", "-o", tmp_path / "made"
    )


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"PK\x03\x04\x14\x00[Content_Types].xml", "a workbook of a spreadsheet: export the sheet"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(40), "a workbook of a spreadsheet"),
        (b"PK\x03\x04opendocument.spreadsheet", "a workb"),
        (b"PK\x03\x04\x14\x00table.csv", "a compressed file: unpack it first"),
        ("No\tErr [um]\n1\t3.2\n".encode("utf-16-le"), "UTF-16 without a byte order mark: save it"),
    ],
)
def test_what_is_no_text_is_named(
    tmp_path: Path, refused: Program, data: bytes, message: str
) -> None:
    (tmp_path / "t.csv").write_bytes(data)

    assert message in refused(
        "import", "csv", tmp_path / "t.csv", "--map", "deviation_um=Err", "-o", tmp_path / "made"
    )


def test_thousands_in_quotes_are_read_where_commas_part_columns(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text('F,Err\n"1,250.500",3.2\n300,-1.1\n')
    maps = ("--map", "deviation_um=Err", "--map", "feed_mm_min=F")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *maps)

    assert run.campaign.touches.feed_mm_min.tolist() == [1250.5, 300.0]


def test_date_with_halves_of_the_day_has_the_month_first(tmp_path: Path) -> None:
    stamps = ["03/12/2026 11:59:58 AM", "03/12/2026 12:00:08 PM", "3/12/2026, 1:00 PM"]
    rows = "".join(f'"{stamp}",{i}.5\n' for i, stamp in enumerate(stamps))
    (tmp_path / "t.csv").write_text(f"When,Err\n{rows}")
    maps = ("--map", "deviation_um=Err", "--map", "time=When")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *maps)

    assert run.campaign.touches.time_s.tolist() == [0.0, 10.0, 3602.0]


def test_what_came_of_a_touch_may_be_told_in_other_words(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(
        "Z,result\n-3.014,FOUND\n-10.000,NOT FOUND\n,no_contact\n-3.012,ok\n"
    )

    run = Run(
        tmp_path,
        *("csv", str(tmp_path / "t.csv"), "--map", "coordinate_mm=Z", "--map", "status=result"),
    )

    assert run.campaign.touches.missed.tolist() == [False, True, True, False]
    assert run.campaign.touches.deviation_um[[0, 3]] == pytest.approx([-1.0, 1.0])
    said = 'status: "FOUND" counts as ok, "NOT FOUND" counts as missed, '
    assert f'{said}"no_contact" counts as missed' in run.said["assumed"]
    ends = "coordinates of missed touches are where the move ended: 1"
    assert ends in run.said["assumed"]


@pytest.mark.parametrize(
    ("answers", "missed", "false"),
    [
        (("TRUE", "FALSE"), [False, True], [False, False]),
        (("1", "0"), [False, True], [False, False]),
        (("0", "1"), [True, False], [False, False]),
        (("ok", "false"), [False, False], [False, True]),
    ],
)
def test_false_is_no_touch_only_beside_true(
    tmp_path: Path, answers: tuple[str, str], missed: list[bool], false: list[bool]
) -> None:
    rows = "".join(f"{'' if gone else 3},{a}\n" for a, gone in zip(answers, missed, strict=True))
    (tmp_path / "t.csv").write_text(f"err,came\n{rows}")

    run = Run(
        tmp_path,
        *("csv", str(tmp_path / "t.csv"), "--map", "deviation_um=err", "--map", "status=came"),
    )

    assert run.campaign.touches.missed.tolist() == missed
    assert run.campaign.touches.false.tolist() == false


def test_a_word_that_nobody_knows_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("err,came\n3.2,perhaps\n")
    maps = ("--map", "deviation_um=err", "--map", "status=came")

    said = refused("import", "csv", tmp_path / "t.csv", *maps, "-o", tmp_path / "x")

    assert 't.csv:2: came: expected ok, missed or false, got "perhaps"' in said


@pytest.mark.parametrize(
    "rows",
    [
        "0.0,0.0,-3.014\n0.0,0.0,-3.012\n",
        "0;0;-3,014\n0;0;-3,012\n",
        "0,0,-3\n0,0,-3.01\n",  # whole numbers alone in the first row
        "  0.0   0.0   -3.014\n  0.0   0.0   -3.012\n",
    ],
)
@pytest.mark.parametrize("title", ["", "Vise jaw, 3 March\n\n", "Vise jaw\nrun 7\n"])
def test_numbers_without_a_head_may_stand_below_a_title(
    tmp_path: Path, title: str, rows: str
) -> None:
    (tmp_path / "t.csv").write_text(title + rows)

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), "--map", "coordinate_mm=3")

    touches = run.campaign.touches
    z_mm = touches.position_mm + touches.deviation_um / 1e3
    expected = [-3.0, -3.01] if ",-3\n" in rows else [-3.014, -3.012]
    assert z_mm == pytest.approx(expected)


def test_numbers_that_are_heads_stay_heads(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("Vise jaw\n1,2,3\n0,0,-3.014\n0,0,-3.012\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), "--map", "coordinate_mm=3")

    assert len(run.campaign.touches) == 2


@pytest.mark.parametrize(("unit", "feed"), [("deg/min", 12.0), ("°/s", 720.0), ("rpm", 4320.0)])
def test_feed_of_a_rotary_axis_is_in_degrees(tmp_path: Path, unit: str, feed: float) -> None:
    (tmp_path / "t.csv").write_text(f"Feed [{unit}],Off [arcsec]\n12,3.6\n12,7.2\n")
    mapped = ["--map", "feed_mm_min=Feed", "--map", "deviation_arcsec=Off"]

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *mapped, "--axis", "B")

    assert run.campaign.touches.feed_mm_min.tolist() == [feed, feed]
    assert f'feed_mm_min from "Feed [{unit}]" in {unit}' in run.said["known"]


def test_coordinates_of_a_rotary_axis_are_in_degrees(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("C [deg],Way [°]\n30.001,2\n30.003,2\n30.002,2\n")
    mapped = ["--map", "coordinate_mm=C", "--map", "approach_mm=Way"]

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *mapped, "--axis", "C", "--sign", "1")

    touches = run.campaign.touches
    assert touches.deviation_arcsec.tolist() == pytest.approx([-3.6, 3.6, 0.0])
    assert touches.approach_mm.tolist() == [2.0, 2.0, 2.0]


@pytest.mark.parametrize(
    ("column", "head"),
    [("feed_mm_min", "F [deg/min]"), ("coordinate_mm", "P [deg]"), ("approach_mm", "W [°]")],
)
@pytest.mark.parametrize(("axis", "words"), [("Y", ["--map", "axis=Ax"]), ("X", ["--axis", "X"])])
def test_degrees_of_an_axis_that_does_not_turn_are_refused(
    tmp_path: Path, refused: Program, column: str, head: str, axis: str, words: list[str]
) -> None:
    (tmp_path / "t.csv").write_text(f"{head},Ax\n12,{axis}\n12,{axis}\n")
    mapped = ["--map", f"{column}={head}", *words]

    said = refused("import", "csv", str(tmp_path / "t.csv"), *mapped, "-o", str(tmp_path / "o"))

    assert f"{head}: unit " in said
    assert f"axis {axis} does not turn; --axis names it" in said


def test_angle_of_a_linear_touch_is_none_of_its_axis(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("A [deg],Off\n90,3.6\n180,7.2\n")
    mapped = ["--map", "alpha_deg=A", "--map", "deviation_um=Off"]

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *mapped, "--axis", "X")

    assert run.campaign.touches.alpha_deg.tolist() == [90.0, 180.0]
