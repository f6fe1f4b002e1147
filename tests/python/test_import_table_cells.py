"""``skiplatch import csv``: rows whose cells are not those of the head."""

from pathlib import Path

import pytest

from refusals import Program
from skiplatch.campaign import Kind
from test_import_logs import Run

MAPPED = ("--map", "deviation_um=Error [mm]", "--map", "feed_mm_min=F")


def test_row_with_more_cells_than_heads_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("Error,F\n0,100\n0,001,100\n0,003,100\n")

    said = refused("import", "csv", tmp_path / "t.csv", *MAPPED, "-o", tmp_path / "x")

    assert "t.csv:3: expected 2 cells, got 3: are there decimal commas?" in said


def test_empty_cells_behind_a_row_and_lacking_ones_are_no_matter(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("Error,F,Note\n0.001,100,,,\n0.003,100\n0.002,200,late\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED)

    assert run.campaign.touches.deviation_um.tolist() == [1.0, 3.0, 2.0]
    assert run.campaign.touches.feed_mm_min.tolist() == [100.0, 100.0, 200.0]


def test_kind_may_be_written_in_any_case(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("E,L\n0,42\n1000,1042\n")
    maps = ("--map", "edge_us=E", "--map", "latch_us=L")

    for kind in ("bench", "BENCH"):
        (tmp_path / kind).mkdir()
        run = Run(tmp_path / kind, "csv", str(tmp_path / "t.csv"), "--kind", kind, *maps)
        assert run.campaign.nominal.kind is Kind.BENCH


def test_words_that_count_as_empty_are_said(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("Error,F,Note\n0.001,100,n/a\nNaN,100,\n0.002,n/a,\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED)

    said = 'cells that count as empty: 2, the first "NaN" in line 3'
    assert said in run.said["assumed"]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("1,0.1,ok\n2,0.2,ok\n2,0.3,ok\n", "t.csv:4: touch: serial number 2 stands twice"),
        ("1,0.1,ok\n2,0.2,missed\n", "t.csv:3: deviation_um: expected an empty cell in a missed"),
    ],
)
def test_what_no_campaign_may_hold_is_told_of_the_table(
    tmp_path: Path, refused: Program, rows: str, message: str
) -> None:
    (tmp_path / "t.csv").write_text(f"n,e,s\n{rows}")
    maps = ("--map", "touch=n", "--map", "deviation_um=e", "--map", "status=s")

    said = refused("import", "csv", tmp_path / "t.csv", *maps, "-o", tmp_path / "x")

    assert message in said
    assert not (tmp_path / "x").exists()


ALIGNED = """Probe at the vice, X+
  Nr      Error [mm]     F
----------------------------
   1          0.001    100
   2         -0.003   1000
"""


def test_columns_may_be_aligned_by_spaces(tmp_path: Path) -> None:
    (tmp_path / "t.txt").write_text(f"{ALIGNED}  2 touches\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.txt"), *MAPPED)

    assert run.campaign.touches.deviation_um.tolist() == [1.0, -3.0]
    assert run.campaign.touches.feed_mm_min.tolist() == [100.0, 1000.0]
    assert run.said["could_not_be_read"][:2] == [
        "lines before the head of the table: 1",
        'lines below the table: 1, "2 touches"',
    ]


def test_aligned_row_with_an_empty_cell_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.txt").write_text(f"{ALIGNED}   3                  100\n   4      0.001   100\n")

    said = refused("import", "csv", tmp_path / "t.txt", *MAPPED, "-o", tmp_path / "x")

    assert "t.txt:6: expected 3 cells, two spaces or more apart, got 2" in said


def test_columns_without_a_head_go_by_their_numbers(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("3,20.0,-0.200,0\n4,20.0,-0.201,0\n5,20.0,-0.203,0\n")
    maps = ("--map", "coordinate_mm=3 [in]", "--axis", "Z", "--sign", "-1")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *maps)

    assert run.coordinates() == pytest.approx([-5.08, -5.1054, -5.1562])
    assert any(line.startswith("columns go by their numbers") for line in run.said["assumed"])


def test_number_of_no_column_names_those_there_are(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("1,20.0,-0.200\n2,20.0,-0.201\n")

    said = refused("import", "csv", tmp_path / "t.csv", "--map", "coordinate_mm=4", "-o", "x")

    assert "expected a column by its number, 1 to 3, got 4" in said


def test_sense_beside_an_axis_and_feed_as_a_word_are_read(tmp_path: Path) -> None:
    rows = "Y+,F60,0.001", "Y-,f 300,0.002", "+Y,F60.,0.003", "\u2212,60,0.004"
    (tmp_path / "t.csv").write_text("\n".join(["dir,F,Error", *rows]) + "\n", encoding="utf-8")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED, "--map", "sign=dir")

    assert run.campaign.touches.sign.tolist() == [1.0, -1.0, 1.0, -1.0]
    assert run.campaign.touches.feed_mm_min.tolist() == [60.0, 300.0, 60.0, 60.0]


def test_cell_that_only_begins_with_an_axis_is_no_sense(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("dir,F,Error\nY,F60,0.001\n")

    said = refused(
        *("import", "csv", tmp_path / "t.csv", *MAPPED, "--map", "sign=dir", "-o", tmp_path / "x")
    )

    assert "t.csv:2: dir: expected" in said
