"""Numbers and tables as they stand on the terminal."""

import pytest

from skiplatch.statistics import Interval
from skiplatch.tables import beside, compact, listing, number, prose, table, whole, with_interval


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (3.14159, "3.142"),
        (-0.000123456, "-0.0001235"),
        (123456.0, "123 500"),
        (1154.7, "1 155"),
        (20.0, "20.00"),
        (-1.41e-16, "0"),
    ],
)
def test_number_has_four_significant_digits_and_no_power_of_ten(value: float, text: str) -> None:
    assert number(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (200.0, "200"),
        (0.05, "0.05"),
        (1.0994, "1.099"),
        (123456.0, "123500"),
        (3.66e-08, "0"),
        (-2.5e-05, "-0.000025"),
        (1e13, "10000000000000"),
    ],
)
def test_compact_number_has_no_zeros_at_its_end(value: float, text: str) -> None:
    assert compact(value) == text


def test_whole_number_is_grouped() -> None:
    assert whole(1_000_000) == "1 000 000"


@pytest.mark.parametrize(
    ("interval", "texts"),
    [
        (Interval(2007.315, 2005.053, 2009.577), ("2007.3", "2005.1 … 2009.6")),
        (Interval(0.3750171, 0.3749877, 0.3750465), ("0.375017", "0.374988 … 0.375047")),
        (Interval(1234.5, 1000.0, 1500.0), ("1234", "1000 … 1500")),
        (Interval(0.254, 0.254, 0.254), ("0.25400", "—")),
        (Interval(-0.00001, -0.01, 0.01), ("0.000", "-0.010 … 0.010")),
        (Interval(0.0, 0.0, 1e-9), ("0.000000", "0.000000 … 0.000000")),
    ],
)
def test_interval_has_two_digits_of_its_width(interval: Interval, texts: tuple[str, str]) -> None:
    assert with_interval(interval) == texts


def test_table_aligns_names_to_the_left_and_numbers_to_the_right() -> None:
    rows = [("a", "1.0", ""), ("bcd", "10.0", "x")]

    assert table(("", "µm", ""), rows) == "       µm\na     1.0\nbcd  10.0  x"


ROWS = [("skip input", "11.0 ± 1.6", "goes with the sense"), ("PLC", "87 ± 29", "")]
HEADER = ("path", "mean, µm", "how")


def on_a_terminal(monkeypatch: pytest.MonkeyPatch, columns: int) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", str(columns))


@pytest.mark.parametrize("columns", [41, 40, 30, 24])
def test_table_wraps_to_the_terminal_between_words(
    columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = table(HEADER, ROWS)
    on_a_terminal(monkeypatch, columns)

    text = table(HEADER, ROWS)

    assert max(map(len, text.splitlines())) <= columns
    assert sorted(text.split()) == sorted(plain.split())
    assert (text == plain) == (columns >= len(plain.splitlines()[1]))


def test_table_with_no_room_becomes_a_list_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    on_a_terminal(monkeypatch, 20)
    wide = [("skip", *(f"{i}.123456" for i in range(3)))]

    text = table(("path", "a", "b", "c"), wide)

    assert text == "path  skip\na     0.123456\nb     1.123456\nc     2.123456"


def test_prose_breaks_between_words_on_a_terminal_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "one two three four\n\n  a = 1 (0 … 2) mm, far-away\nshort"

    assert prose(text) == text
    on_a_terminal(monkeypatch, 14)
    assert prose(text).splitlines() == [
        *("one two three", "four", ""),
        *("  a = 1 (0 …", "    2) mm,", "    far-away", "short"),
    ]


def test_table_in_a_pipe_heeds_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "10")
    monkeypatch.setenv("FORCE_COLOR", "1")

    text = table(HEADER, [("[red]x[/red]", "1 :smile:", "3" * 300)])

    assert text.splitlines()[1].split("  ") == ["[red]x[/red]", "1 :smile:", "3" * 300]


def test_listing_keeps_names_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    on_a_terminal(monkeypatch, 30)

    text = listing([("probe:", ""), ("  pretravel_lobing", "three lobes of pretravel")])

    lines = text.splitlines()
    assert lines[:2] == ["probe:", "  pretravel_lobing  three"]
    assert [line.strip() for line in lines[2:]] == ["lobes of", "pretravel"]


def test_number_beside_a_width_has_its_digits() -> None:
    assert beside(2.34567, 0.0123) == "2.346"
    assert beside(-0.0001, 2.3) == "0.0"
    assert beside(25103.7, 459.0) == "25104"
