"""``skiplatch import csv``: rows whose cells are not those of the head."""

from pathlib import Path

from refusals import Program
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
