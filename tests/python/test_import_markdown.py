"""``skiplatch import``: tables of Markdown, maps of a bed, and rows that are too short."""

from pathlib import Path

import pytest

from refusals import Program
from test_import_logs import Run

RUNS = """# Report

| Position [mm] | 1 ↑ [mm] | 1 ↓ [mm] |
|:---|---:|---:|
| 0.0 | **0.001** | 0.004 |
| 50.0 | 0.002 | 0.006 |
| 100.0 | 0.004 | 0.007 |

Made by hand.
"""
TOUCHES = """Z [mm] | Feed [mm/min]
--- | ---
-5.001 | 100
-5.003 | 300
"""
HEIGHT_MAP = """{title}
axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1
X,Y,30.00,270.00,30.00,270.00,-1.00,59.99,59.99,5,5
 -0.037, -0.073, -0.070, -0.079, -0.141
  0.048,  0.006, -0.012, -0.040, -0.108
"""
MAPPED = ("--map", "coordinate_mm=Z", "--map", "feed_mm_min=F")


def test_table_of_iso_230_in_markdown_is_read(tmp_path: Path) -> None:
    (tmp_path / "r.md").write_text(RUNS, encoding="utf-8")

    run = Run(tmp_path, "iso230", str(tmp_path / "r.md"), "--axis", "X")

    touches = run.campaign.touches
    assert touches.position_mm.tolist() == [0.0, 50.0, 100.0, 100.0, 50.0, 0.0]
    assert touches.sign.tolist() == [1, 1, 1, -1, -1, -1]
    assert "lines before the head of the table: 2" in run.said["could_not_be_read"]


def test_table_of_touches_in_markdown_is_read(tmp_path: Path) -> None:
    (tmp_path / "t.md").write_text(TOUCHES)

    run = Run(
        *(tmp_path, "csv", str(tmp_path / "t.md")),
        *("--map", "coordinate_mm=Z", "--map", "feed_mm_min=Feed"),
    )

    assert run.coordinates() == [-5.001, -5.003]
    assert run.campaign.touches.feed_mm_min.tolist() == [100.0, 300.0]


def test_report_with_several_tables_says_what_to_do(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "r.md").write_text(f"{RUNS}\n{RUNS}", encoding="utf-8")

    said = refused("import", "iso230", tmp_path / "r.md", "-o", tmp_path / "x")

    assert "r.md: expected one table, got 2 of Markdown, line 3, 13: copy the one" in said


@pytest.mark.parametrize(
    ("title", "expected"),
    [
        ("RepRapFirmware height map file v2", "a map of the bed by RepRapFirmware (Duet), with"),
        ("heights", "t.csv:3: expected a line of heads above the numbers, such as"),
    ],
)
def test_height_map_is_no_table_of_touches(
    tmp_path: Path, refused: Program, title: str, expected: str
) -> None:
    (tmp_path / "t.csv").write_text(HEIGHT_MAP.format(title=title))

    said = refused(
        *("import", "csv", tmp_path / "t.csv", "--map", "coordinate_mm=X", "-o", tmp_path / "x")
    )

    assert expected in said


def test_columns_may_be_numbered(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("Z,1,2\n-5.001,7,8\n-5.003,7,9\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), "--map", "coordinate_mm=Z")

    assert run.coordinates() == [-5.001, -5.003]


def test_rows_that_lack_a_mapped_cell_are_named(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("Z,F,Note\n-5.001,100\n-5.003\n-5.002,100,late\n-5.004\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED)

    said = "rows shorter than the head, whose last cells count as empty: 2, line 3, 5"
    assert said in run.said["assumed"]
