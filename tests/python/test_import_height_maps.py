"""``skiplatch import``: height maps, whose head is no touch, and bare rows of three numbers."""

from pathlib import Path

import pytest

from refusals import Program
from skiplatch.importing.kinds import kind_of
from test_import_logs import Run

HEAD = "-5 45 3\n-5 25 2\n-10 5 20\n\n\n"
POINTS = (
    "-5 -5 0.0477\n20 -5 0.0428\n45 -5 0.0746\n\n-5 25 -0.0851\n20 25 -0.0177\n45 25 -0.017\n\n"
)
SAID = "a height map of bCNC, with one touch of each place"


@pytest.mark.parametrize(
    "words",
    [
        ("import", "linuxcnc"),
        ("import", "grbl"),
        ("import", "csv", "--map", "coordinate_mm=Z"),
        ("import", "csv", "--map", "coordinate_mm=3"),
        ("repeat",),
    ],
)
def test_height_map_is_called_one_whoever_reads_it(
    tmp_path: Path, refused: Program, words: tuple[str, ...]
) -> None:
    (tmp_path / "bed.probe").write_text(HEAD + POINTS)
    out = ("-o", tmp_path / "out") if words[0] == "import" else ()

    said = refused(*words, tmp_path / "bed.probe", *out)

    assert SAID in said
    assert not (tmp_path / "out").exists()


def test_points_of_a_map_without_its_head_are_a_table_by_number(tmp_path: Path) -> None:
    (tmp_path / "points.txt").write_text(POINTS)
    words = ("--map", "coordinate_mm=3", "--map", "position_mm=1", "--axis", "Z", "--sign", "-1")

    run = Run(tmp_path, "csv", str(tmp_path / "points.txt"), *words)

    assert len(run.campaign.touches) == 6


def test_thousands_that_a_space_parts_are_no_columns(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.txt").write_text("1 200.5\n1 200.6\n")
    words = ("--map", "coordinate_mm=1", "-o", tmp_path / "out")

    refused("import", "csv", tmp_path / "t.txt", *words)


def test_three_numbers_of_linuxcnc_are_told_by_their_six_decimals(tmp_path: Path) -> None:
    (tmp_path / "probe.txt").write_text("1.000000 2.000000 -3.012500\n" * 2)
    (tmp_path / "points.txt").write_text(POINTS.replace("-5 -5 ", "-5.0 -5.0 "))

    assert kind_of(tmp_path / "probe.txt") == "linuxcnc"
    assert not kind_of(tmp_path / "points.txt")
