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
    (tmp_path / "d.txt").write_text("F100. X25.0064\nX25.0263 F500.\nF500. X25.0265\n")

    said = refused("import", "csv", str(tmp_path / "d.txt"), *MAPPED, "-o", str(tmp_path / "c"))

    assert 'd.txt:2: expected F, X as in line 1, got "X25.0263 F500."' in said


@pytest.mark.parametrize(
    ("text", "before"),
    [
        ("PROBING TS460\nDATE: 27.11.2023\n------\nX = 25.0064 F = 100\nX = 25.0263 F = 500\n", 2),
        ('; data "probe.txt"\nX25.0064 F100.\n\n; again\nX25.0263 F500.\n', 0),
        ("%\n(PROBE LOG)\nG54 X25.0064 F100.\nG54 X25.0263 F500.\n%\n", 0),
        ("O1234\nX25.0064 F100.\n(next)\nX25.0200 F50.\nX25.0263 F500.\n", 1),
    ],
    ids=["title", "comments", "tape", "program"],
)
def test_lines_beside_those_of_words_are_passed_over(
    tmp_path: Path, text: str, before: int
) -> None:
    (tmp_path / "d.txt").write_text(text)

    run = Run(tmp_path, "csv", str(tmp_path / "d.txt"), *MAPPED)

    coordinates = run.coordinates()
    assert (coordinates[0], coordinates[-1]) == (25.0064, 25.0263)
    told = [line for line in run.said["could_not_be_read"] if "before the head" in line]
    assert told == ([f"lines before the head of the table: {before}"] if before else [])


def test_lines_below_those_of_words_are_counted(tmp_path: Path) -> None:
    (tmp_path / "d.txt").write_text("X25.0064 F100.\nX25.0263 F500.\nM30\nend of probing\n")

    run = Run(tmp_path, "csv", str(tmp_path / "d.txt"), *MAPPED)

    assert run.coordinates() == [25.0064, 25.0263]
    assert 'lines below the table: 2, "M30", "end of probing"' in run.said["could_not_be_read"]


@pytest.mark.parametrize("between", ["; ", "  "])
def test_numbers_of_words_may_have_decimal_commas(tmp_path: Path, between: str) -> None:
    rows = ("X=25,0064", "F=100"), ("X=25,026", "F=500")
    (tmp_path / "d.txt").write_text("".join(f"{between.join(row)}\n" for row in rows))

    run = Run(tmp_path, "csv", str(tmp_path / "d.txt"), *MAPPED)

    assert run.coordinates() == [25.0064, 25.026]
    assert run.campaign.touches.feed_mm_min.tolist() == [100.0, 500.0]


def test_comma_of_a_word_that_may_part_thousands_is_refused(
    tmp_path: Path, refused: Program
) -> None:
    (tmp_path / "d.txt").write_text("X1,250 F100\nX250 F100\n")

    said = refused("import", "csv", str(tmp_path / "d.txt"), *MAPPED, "-o", str(tmp_path / "c"))

    assert 'd.txt:1: "1,250" may be 1250 or 1.250' in said


@pytest.mark.parametrize("between", ["; ", ", ", "  "])
@pytest.mark.parametrize("title", ["", "MESSUNG STIRNFLÄCHE  Größe in mm\nDATUM: 12.03.2024\n"])
def test_time_of_day_is_a_word(tmp_path: Path, between: str, title: str) -> None:
    rows = [
        ("NR =   1", "X =   25,0064", "F = 100", "ZEIT = 23:59:31"),
        ("NR =   2", "X =   25,0263", "F = 500", "ZEIT = 00:00:01,5"),
    ]
    text = title + "".join(f"{between.join(row)}\r\n" for row in rows)
    (tmp_path / "d.a").write_bytes(text.encode("cp1252"))

    run = Run(tmp_path, "csv", str(tmp_path / "d.a"), *MAPPED, "--map", "time=ZEIT")

    assert run.coordinates() == [25.0064, 25.0263]
    assert run.campaign.touches.time_s.tolist() == [0.0, 30.5]


def test_date_is_a_word_beside_a_time_of_day(tmp_path: Path) -> None:
    rows = (
        f"X = 25,0{digit} F = 100 TAG = {day}.03.2024 ZEIT = 08:00:00\n"
        for digit, day in ((1, 12), (2, 14))
    )
    (tmp_path / "d.a").write_text("".join(rows))

    maps = ("--map", "time=ZEIT", "--map", "date=TAG")
    run = Run(tmp_path, "csv", str(tmp_path / "d.a"), *MAPPED, *maps)

    assert run.campaign.touches.time_s.tolist() == [0.0, 2 * 86_400.0]


def test_codes_of_a_punch_are_passed_over_wherever_they_stand(tmp_path: Path) -> None:
    lines = ("\x12%", "X 25.0064 F 100.", "%\x14\x12%", "X 25.0263 F 500.", "%\x14", "\x7f")
    (tmp_path / "d.txt").write_text("\r\n".join(lines))

    run = Run(tmp_path, "csv", str(tmp_path / "d.txt"), *MAPPED)

    assert run.coordinates() == [25.0064, 25.0263]
    assert not any("lines b" in line for line in run.said["could_not_be_read"])
