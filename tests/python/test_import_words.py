"""``skiplatch import csv``: lines whose cells name themselves, as DPRNT of a controller prints."""

from pathlib import Path

import pytest

from refusals import Program
from test_import_logs import Run

MAPPED = ["--map", "coordinate_mm=X", "--map", "feed_mm_min=F", "--axis", "X", "--sign", "1"]


@pytest.mark.parametrize(
    "text",
    [
        "N1 F100. X25.0064 Z-5.\nN2 F500. X25.0263 Z-5.\n",
        "%\nN1 F100. X 25.0064 Z-   5.\nN2 F500. X 25.0263 Z-   5.\n%\n",
        "N1,F100.,X25.0064,Z-5.\r\n\r\nN2,F500.,X25.0263,Z-5.\r\n",
        "N = 1 F = 100 X = 25.0064 Z = -5\nN = 2 F = 500 X = 25.0263 Z = -5\n",
    ],
    ids=["words", "tape", "commas", "equals"],
)
def test_letters_of_words_are_the_heads(tmp_path: Path, text: str) -> None:
    (tmp_path / "d.txt").write_text(text)

    run = Run(tmp_path, "csv", str(tmp_path / "d.txt"), *MAPPED)

    assert run.coordinates() == [25.0064, 25.0263]
    assert run.campaign.touches.feed_mm_min.tolist() == [100.0, 500.0]
    assert "columns that no --map names: N, Z" in run.text


def test_line_with_other_letters_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "d.txt").write_text("F100. X25.0064\nX25.0263 F500.\n")

    said = refused("import", "csv", str(tmp_path / "d.txt"), *MAPPED, "-o", str(tmp_path / "c"))

    assert 'd.txt:2: expected F, X as in line 1, got "X25.0263 F500."' in said
