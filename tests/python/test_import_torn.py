"""``skiplatch import``: logs of which a piece is lost, and what is said of it.

Shortened from logs that people posted: of LinuxCNC on its forum, of Marlin and Klipper in issues.
"""

from pathlib import Path

from test_import_logs import Run

ZEROS = " 0.000000" * 6
OVERWRITTEN = f"""-0.000000 -0.000000 -0.012167{ZEROS}
-0.000000 -0.000000 0.020750{ZEROS}
000000 -0.000000 0.006167{ZEROS}
0.000000 -0.000000 0.021583{ZEROS}
00 0.000000
300.000000 -0.000000 -0.027167{ZEROS}
"""
"""A file of LinuxCNC that was begun anew over an older one, twice."""
THREE_COLUMNS = """19.999999 19.999995 1.015218
429.999989 167.999998 30
101.999997 19.999990 0.940998
"""


def read(folder: Path, kind: str, text: str, *words: str) -> Run:
    (folder / "torn.log").write_text(text)
    return Run(folder, kind, str(folder / "torn.log"), *words)


def test_stump_of_a_row_of_linuxcnc_is_no_touch(tmp_path: Path) -> None:
    run = read(tmp_path, "linuxcnc", OVERWRITTEN)

    assert run.coordinates() == [-0.012167, 0.02075, 0.021583, -0.027167]
    lost, stump = run.said["could_not_be_read"]
    assert lost == "1 lines that do not hold 9 numbers: line 5"
    assert stump.startswith("1 rows with a number that is not written with six decimals")
    assert stump.endswith("LinuxCNC writes them: line 3")


def test_number_typed_into_three_columns_is_no_touch(tmp_path: Path) -> None:
    run = read(tmp_path, "linuxcnc", THREE_COLUMNS)

    assert run.coordinates() == [1.015218, 0.940998]
    assert "LinuxCNC writes them: line 2" in run.text


def test_stump_with_three_numbers_is_no_row_among_those_of_nine(tmp_path: Path) -> None:
    run = read(tmp_path, "linuxcnc", f"{OVERWRITTEN}0.000000 0.000000 0.000000\n")

    assert len(run.campaign.touches) == 4
    assert "2 lines that do not hold 9 numbers: line 5, 7" in run.said["could_not_be_read"]


def test_table_in_digits_of_its_own_is_read_whole(tmp_path: Path) -> None:
    run = read(tmp_path, "linuxcnc", "0 0 -2.501\n0 0 -2.511\n0 0 -2.5\n")

    assert len(run.campaign.touches) == 3
    assert run.said["could_not_be_read"] == []


def test_of_many_lines_a_few_are_named(tmp_path: Path) -> None:
    rows = OVERWRITTEN.splitlines(keepends=True)
    run = read(tmp_path, "linuxcnc", rows[0] * 9 + rows[2] * 7)

    assert "LinuxCNC writes them: line 10, 11, 12, 13, 14 and 2 more" in run.text
