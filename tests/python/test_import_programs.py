"""``skiplatch import linuxcnc --program``: what a program tells of the lines of its log."""

from pathlib import Path

import numpy as np
import pytest

from refusals import Program
from skiplatch.importing.gcode_program import run
from skiplatch.importing.nc_text import read_program
from test_import_logs import Run

BOTH_WORDS = """G21 G90
G0 X0 Y0
o<touch> sub
  G38.2 X#1 Y#2 F300
  G0 X[#5061 - #1 * 0.05] Y[#5062 - #2 * 0.05]
  G38.2 X#1 Y#2 F60
  G0 X0 Y0
o<touch> endsub
o<touch> call [20] [0]
o<touch> call [-20] [0]
o<touch> call [0] [20]
"""


def row(x: float, y: float = 0.0, z: float = 0.0) -> str:
    return f"{x:.6f} {y:.6f} {z:.6f}" + " 0.0" * 6 + "\n"


def read(folder: Path, program: str, log: str, *words: str) -> Run:
    (folder / "p.ngc").write_text(program)
    (folder / "p.txt").write_text(log)
    return Run(
        folder, "linuxcnc", str(folder / "p.txt"), "--program", str(folder / "p.ngc"), *words
    )


def told(run: Run) -> list[tuple[str, float, float]]:
    """Axis, sense and feed of each touch."""
    touches = run.campaign.touches
    senses = np.nan_to_num(touches.sign)  # 0 where it is not known
    columns = zip(touches.axis, senses, touches.feed_mm_min, strict=True)
    return [("XYZ"[int(axis)], sign, round(feed, 6)) for axis, sign, feed in columns]


def test_moves_from_where_the_probe_was_latched_are_followed_by_the_log(tmp_path: Path) -> None:
    ways = [(1, 0), (-1, 0), (0, 1)]
    log = "".join(row(x * c, y * c) for x, y in ways for c in (12.506, 12.5012))

    run = read(tmp_path, BOTH_WORDS, log)

    senses = [("X", 1), ("X", 1), ("X", -1), ("X", -1), ("Y", 1), ("Y", 1)]
    feeds = [300, 60] * 3
    assert told(run) == [(*sense, feed) for sense, feed in zip(senses, feeds, strict=True)]
    assert run.campaign.touches.approach_mm[1] == pytest.approx(0.9976)  # from 12.506 - 1
    assert "look touched" not in run.text


@pytest.mark.parametrize("words", ["Z-10", "X1 Y2 Z-10", "X[#<_x>] Y2 Z-10"])
def test_start_that_is_not_known_leaves_the_direction_to_the_touch(
    tmp_path: Path, words: str
) -> None:
    log = row(1, 2, -3.001) + row(1, 2, -3.002)

    run = read(tmp_path, f"G38.2 {words} F50\nG0 Z[#<_above>]\n" * 2, log)

    unknown = "_x" in words
    assert told(run)[0][:2] == ("Z", 0 if unknown else -1)
    assert ("does not tell the axis of 2 touches: axis Z, whose" in run.text) is unknown
    assert ("direction that is not known: the axis measured had" in run.text) is unknown


def test_end_of_a_move_that_missed_tells_no_direction(tmp_path: Path) -> None:
    run = read(tmp_path, "G90\nG38.3 X5 F50\nG38.3 Y5 F50\n", row(5.000001) + row(5.000001, 2))

    assert told(run)[0][:2] == ("X", 0)


@pytest.mark.parametrize("before", ["", "G38.2 Z-10 F500\nG0 Z[#5063 + 1]\n"])
@pytest.mark.parametrize("after", ["", "G38.2 Z-10 F700\n"])
def test_moves_outside_of_probeopen_and_probeclose_are_not_logged(
    tmp_path: Path, before: str, after: str
) -> None:
    logged = "(PROBEOPEN p.txt)\nG38.2 Z-10 F60\nG0 Z5\nG38.2 Z-10 F30\n(PROBECLOSE)\n"

    run = read(tmp_path, "G90\nG0 Z5\n" + before + logged + after, row(0, 0, -3) + row(0, 0, -2.99))

    assert told(run) == [("Z", -1, 60), ("Z", -1, 30)]


def test_comment_that_is_commented_out_logs_nothing(tmp_path: Path) -> None:
    run = read(tmp_path, ";(PROBEOPEN p.txt)\nG38.2 Z-1 F60\n", row(0, 0, -0.3))

    assert told(run) == [("Z", -1, 60)]


CALL = "(PROBEOPEN p.txt)\no<probe_z> call [10]\n"


def test_subroutine_in_another_file_is_named(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "p.ngc").write_text(CALL)
    (tmp_path / "p.txt").write_text(row(0, 0, -3))

    said = refused(
        *("import", "linuxcnc", tmp_path / "p.txt"),
        *("--program", tmp_path / "p.ngc", "-o", tmp_path / "out"),
    )

    assert (
        "between (PROBEOPEN …) and (PROBECLOSE), found none; the program calls o<probe_z>" in said
    )
    assert "give --axis and --feed instead" in said


def test_subroutine_in_another_file_beside_moves_is_said(tmp_path: Path) -> None:
    run = read(tmp_path, CALL * 2 + "G38.2 Z-9 F20\n", row(0, 0, -3))

    assert told(run) == [("Z", -1, 20)]
    assert "the program calls o<probe_z>, not in its own file: taken for without" in run.text


@pytest.mark.parametrize("lines", [2, 3])
def test_axis_of_a_diagonal_move_has_its_share_of_the_feed(tmp_path: Path, lines: int) -> None:
    move = "G91\nG38.2 X-8 Y-6 F100\nG0 X2 Y1.5\n"

    run = read(tmp_path, move * 2, "".join(row(5.8 + i / 1e3, 9.8) for i in range(lines)))

    assert told(run) == [("X", -1, 80.0)] * lines
    assert f"{lines} touches by moves of several axes: deviation and feed are those" in run.text


def test_axis_of_a_diagonal_move_of_grbl_has_its_share_of_the_feed(tmp_path: Path) -> None:
    touch = "G91 G38.2 X-8 Y-6 F100\n[PRB:5.80{},9.800,0.000:1]\nok\nG0 X2 Y1.5\nok\n"
    (tmp_path / "s.log").write_text("".join(touch.format(i) for i in range(3)))

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    assert told(run) == [("X", -1, 80.0)] * 3
    assert "3 touches by moves of several axes" in run.text


def test_absolute_moves_of_grbl_with_a_word_that_stays_are_along_the_other_axis(
    tmp_path: Path,
) -> None:
    touch = "G38.2 X20 Y0 F{}\n[PRB:-87.4{},-90.000,-5.000:1]\nok\nG0 X10\nok\n"
    text = "G90\nok\nG0 X0 Y0\nok\n" + "".join(touch.format(f, i) for i, f in enumerate((300, 60)))
    (tmp_path / "s.log").write_text(text)

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    assert told(run) == [("X", 1, 300), ("X", 1, 60)]
    assert "no command before them" not in run.text


def test_program_without_g20_is_in_inches_where_that_is_given(tmp_path: Path) -> None:
    run = read(tmp_path, "G90\nG0 X0\nG38.2 X2 F4\n", row(1.5), "--inch")

    assert told(run) == [("X", 1, 101.6)]
    assert run.campaign.touches.approach_mm[0] == pytest.approx(38.1)


def test_g29_of_old_marlin_is_read_in_lower_case(tmp_path: Path) -> None:
    log = "G29 V4\nBed x: 40.00 y: 40.00 z: 8.41\nBed x: 190.00 y: 40.00 z: 9.05\n"
    (tmp_path / "m.log").write_text(log)

    run = Run(tmp_path, "marlin", str(tmp_path / "m.log"), "--feed", "240")

    assert run.coordinates() == [8.41, 9.05]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("G20 G90 G55 G43 H7", "G55, G43"),
        ("g90 g59.3\nG43.1 Z0.2\nG55 (G57)\n;G58", "G59.3, G43.1, G55"),
        ("G10 L20 P1 Z0 G92 X0", "G92"),
    ],
)
def test_coordinates_that_the_program_selects_are_assumed(
    tmp_path: Path, words: str, said: str
) -> None:
    run = read(tmp_path, f"{words}\nG38.2 Z-1 F60\n", row(0, 0, -0.3))

    assert f"coordinates by the program's {said}: a program for the same" in run.text


def test_a_program_that_selects_no_coordinates_is_assumed_nothing_of(tmp_path: Path) -> None:
    assert "coordinates by" not in read(tmp_path, "G21 G38.2 Z-1 F60\n", row(0, 0, -0.3)).text


def test_several_logs_are_one_campaign(tmp_path: Path) -> None:
    words, programs = [], []
    for name, feed in (("a", 60), ("b", 90)):
        (tmp_path / f"{name}.ngc").write_text(f"G0 Z5\nG38.2 Z-9 F{feed}\n" * 2)
        (tmp_path / f"{name}.txt").write_text(row(feed, 0, -3) + row(feed, 0, -3.01))
        words.append(str(tmp_path / f"{name}.txt"))
        programs += ["--program", str(tmp_path / f"{name}.ngc")]

    run = Run(tmp_path, "linuxcnc", *words, *programs)

    assert told(run) == [("Z", -1, 60)] * 2 + [("Z", -1, 90)] * 2
    assert run.said["known"].count("4 touches of 2 surfaces") == 1
    assert 'made_from = "a.txt, b.txt, a.ngc, b.ngc"' in run.toml


def test_a_program_too_few_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "p.ngc").write_text("G38.2 Z-1 F60\n")
    logs = [tmp_path / "a.txt", tmp_path / "b.txt"]
    for log in logs:
        log.write_text(row(0, 0, -0.3))

    said = refused(
        *("import", "linuxcnc", *logs), *("--program", tmp_path / "p.ngc", "-o", tmp_path / "out")
    )

    assert "expected a program for each of 2 logs, got 1" in said


@pytest.mark.parametrize(
    ("moves", "said"),
    [
        ("G0 Z5\nG38.2 Z-10 F60\nG38.2 Z-10\nG38.2 Z-10\nG38.2 Z-10", "3 moves whose sense"),
        ("G38.2 Z-10 F60\nG38.2 Z-10\nG38.2 Z-10\nG38.2 Z-10", "Z was touched from above"),
    ],
)
def test_sense_that_a_program_with_other_count_does_not_tell(
    tmp_path: Path, moves: str, said: str
) -> None:
    (tmp_path / "p.ngc").write_text(f"G21 G90\n{moves}\nM2\n")
    (tmp_path / "p.txt").write_text("0 0 -2.501\n0 0 -2.511\n0 0 -2.521\ntorn\n")

    run = Run(
        *(tmp_path, "linuxcnc", str(tmp_path / "p.txt"), "--program", str(tmp_path / "p.ngc"))
    )

    assert run.campaign.touches.sign.tolist() == [-1.0, -1.0, -1.0]
    assert run.campaign.touches.deviation_um.tolist() == [-10.0, 0.0, 10.0]
    assert any(line.startswith(said) for line in run.said["assumed"])


@pytest.mark.parametrize(
    ("text", "lines", "feeds"),
    [
        ("G91\nG38.2 Z-5 F100\nG38.2 Z-5\nM30\nG38.2 Z-5 F7\n", 2, [100.0] * 2),
        ("G91\nG38.2 Z-5 F100\nM2 (over)\nG38.2 Z-5 F7\n", 1, [100.0]),
        ("%\nG91\nG38.2 Z-5 F100\n%\nG38.2 Z-5 F7\n", 1, [100.0]),
        ("G91\n/G38.2 Z-9 F1\nG38.2 Z-5 F100\nG38.2 Z-5\n", 2, [100.0] * 2),
        ("G91\n/G38.2 Z-9 F1\nG38.2 Z-5 F100\nG38.2 Z-5\n", 3, [1.0, 100.0, 100.0]),
        ("G91\nM3\nG38.2 Z-5 F100\nM20\nG38.2 Z-5\n", 2, [100.0] * 2),
    ],
)
def test_moves_behind_the_end_and_skipped_ones_are_none(
    text: str, lines: int, feeds: list[float]
) -> None:
    done = run(text, [(0.0, 0.0, -2.5 - 0.001 * i) for i in range(lines)])

    assert [move.feed for move in done.moves] == feeds


def test_parameter_that_was_never_set_is_0(tmp_path: Path) -> None:
    program = (
        "G90 G0 Z0\no1 while [#1 LT 2]\nG0 Z0\nG38.2 Z-9 F[60+240*#1]\n#1=[#1+1]\no1 endwhile\n"
    )

    run = read(tmp_path, program, row(0, z=-5.002) + row(0, z=-5.013))

    assert told(run) == [("Z", -1, 60), ("Z", -1, 300)]


@pytest.mark.parametrize("value", ["#5221", "#<_of_the_machine>"])
def test_parameter_that_was_set_to_what_is_not_known_is_not_0(tmp_path: Path, value: str) -> None:
    program = f"#1={value}\nG90 G38.2 Z-9 F[60+#1]\n"

    run = read(tmp_path, program, row(0, z=-5.002), "--feed", "100")

    assert told(run) == [("Z", -1, 100)]


@pytest.mark.parametrize(("opened", "feeds"), [("logs/p.txt", [300]), ("q.txt", [60, 300])])
def test_moves_of_a_log_of_another_name_do_not_count(
    tmp_path: Path, opened: str, feeds: list[float]
) -> None:
    part = "(PROBEOPEN {})\nG0 Z0\nG38.2 Z-9 F{}\n(PROBECLOSE)\n"
    program = f"G90\n{part.format('other.txt', 60)}{part.format(opened, 300)}"

    run = read(tmp_path, program, row(0, z=-5.0023) * len(feeds))

    assert told(run) == [("Z", -1, feed) for feed in feeds]


TWO_FACES = """G21 G90
(PROBEOPEN p.txt)
o1 repeat [2]
G0 X0 Y0
G38.2 X5 F100
G0 X0
G38.2 X5 F400
G0 X0
G38.2 X-5 F100
G0 X0
G38.2 X-5 F400
o1 endrepeat
M2
"""
WITHOUT_REPEATS = {
    "lines that tell": ([4.01, 4.02, -4.0, 4.02, 4.01, -4.0, -4.01], [100, 400, 100, 400] * 2),
    "two lines": ([4.01, -4.0, -4.01, 4.02, 4.01, -4.0], [100, 400, 100, 400] * 2),
}


@pytest.mark.parametrize("log", WITHOUT_REPEATS)
def test_touch_without_a_line_is_where_the_one_before_was(tmp_path: Path, log: str) -> None:
    places, feeds = WITHOUT_REPEATS[log]

    run = read(tmp_path, TWO_FACES, "".join(map(row, places)))

    senses = [1, 1, -1, -1] * 2
    assert told(run) == [("X", *both) for both in zip(senses, feeds, strict=True)]
    without = 8 - len(places)
    assert f"; {without} touches without a line are where the one before is" in run.text


def test_of_alike_moves_the_repeat_that_cannot_be_told_is_left_out(tmp_path: Path) -> None:
    """Of three moves at 100 and three at 400 mm/min one wrote no line: the third may be of both."""
    program = "G21 G90\nG0 X0\n" + "".join(f"G38.2 X5 F{f}\nG0 X0\n" for f in [100] * 3 + [400] * 3)

    run = read(tmp_path, program, "".join(map(row, [4.01, 4.02, 4.03, 4.01, 4.02])))

    assert told(run) == [("X", 1, 100)] * 2 + [("X", 1, 400)] * 2
    left_out = "; 1 are left out, as it cannot be told which they repeat, so the rest may scatter"
    assert left_out in run.text
    assert "; 1 lines fit moves that differ" in run.text
    assert "1 touches of unknown feed are left out" in run.text


def test_moves_from_where_the_last_touch_was_keep_their_way_beside_a_dropped_line(
    tmp_path: Path,
) -> None:
    places = [(12.506, 0), (-12.506, 0), (-12.5012, 0), (0, 12.506), (0, 12.5012)]

    run = read(tmp_path, BOTH_WORDS, "".join(row(*place) for place in places))

    assert [feed for _, _, feed in told(run)] == [300, 60] * 3
    assert run.campaign.touches.approach_mm[1] == pytest.approx(1.0)  # from 12.506 - 1


def test_lines_that_lie_on_no_way_of_their_moves_give_what_all_moves_share(tmp_path: Path) -> None:
    run = read(tmp_path, TWO_FACES, "".join(map(row, [4.01, -7.0, 4.02])))

    assert "only what is the same in all of them was taken from it" in run.text


BORE = (
    "G21 G90\nG0 X0 Y0\no1 repeat [3]\n"
    + "".join(f"G38.2 {to} F100\nG0 {to[0]}0\n" for to in ("X9", "X-9", "Y9", "Y-9"))
    + "o1 endrepeat\nM2\n"
)
FIRST_SIX = [(5.01, 0.0), (-5.02, 0.0), (0.0, 5.03), (0.0, -5.04), (5.011, 0.0), (-5.021, 0.0)]


def test_log_of_a_program_that_was_stopped_has_its_first_moves(tmp_path: Path) -> None:
    run = read(tmp_path, BORE, "".join(row(*place) for place in FIRST_SIX))

    faces = [("X", 1, 100.0), ("X", -1, 100.0), ("Y", 1, 100.0), ("Y", -1, 100.0)]
    assert told(run) == [*faces, *faces[:2]]
    assert "the log ends with move 6 of 12 of the program" in run.text


def test_what_a_program_does_where_nothing_was_met_is_followed(tmp_path: Path) -> None:
    program = """G21 G90
o1 repeat [3]
G0 Z-2
G38.3 Z-30 F100
o2 if [#5070 EQ 1]
G38.5 Z-2 F25
o2 endif
o1 endrepeat
M2
"""

    run = read(tmp_path, program, "".join(row(0, z=z) for z in (-8.001, -7.99, -30, -8.002, -7.99)))

    assert run.campaign.touches.missed.tolist() == [False, True, False]
    assert "2 moves away from the surface" in run.text


def test_lines_of_several_axes_that_lie_on_no_way_are_refused(
    tmp_path: Path, refused: Program
) -> None:
    (tmp_path / "p.ngc").write_text(BORE)
    (tmp_path / "p.txt").write_text("".join(row(*place) for place in FIRST_SIX[:2] + FIRST_SIX[3:]))
    words = [str(tmp_path / "p.txt"), "--program", str(tmp_path / "p.ngc")]

    said = refused("import", "linuxcnc", *words, "-o", str(tmp_path / "c"))

    assert "5 lines and the program 12 probing moves along X, Y: which line is of which" in said


def test_a_line_that_cannot_be_read_is_not_taken_for_a_repeat(tmp_path: Path) -> None:
    lines = [row(x) for x in [4.01, 4.02, -4.0, -4.01] * 2]
    lines[3] = "torn\n"

    run = read(tmp_path, TWO_FACES, "".join(lines))

    assert "only what is the same in all of them was taken from it" in run.text


def test_unit_of_the_log_is_that_of_the_probing_moves(tmp_path: Path) -> None:
    """Many preambles name both units, and the last one counts."""
    run = read(tmp_path, "G17 G20 G90\nG21\nG0 X0\nG38.2 X20 F60\n", row(10.5))

    assert run.coordinates() == [10.5]
    assert told(run) == [("X", 1, 60.0)]
    assert not any("inch" in line for line in run.said["known"])


def test_probing_moves_in_two_units_are_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "p.ngc").write_text("G90 G21\nG0 X0\nG38.2 X20 F60\nG20\nG0 X0\nG38.2 X1 F4\n")
    (tmp_path / "p.txt").write_text(row(10.5) + row(0.4))
    words = [str(tmp_path / "p.txt"), "--program", str(tmp_path / "p.ngc")]

    said = refused("import", "linuxcnc", *words, "-o", str(tmp_path / "c"))

    assert f"{tmp_path / 'p.ngc'}:6: expected probing moves in one unit, got inches in" in said


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("p.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "no text: expected an NC program of lines"),
        (
            "p.csv",
            b"feed,move\n100,G38.2 Z-5 F100\n",
            ":1: expected an NC program of lines such as",
        ),
        ("p.toml", b'[probe]\nmove = "G38.2 Z-20 F100"\n', 'got "[probe]"'),
        (
            "p.log",
            b">>> G38.2 Z-5 F100\n[PRB:0.000,0.000,-1.230:1]\nok\n",
            "expected an NC program",
        ),
        ("p.md", b"Send `G38.2 Z-5 F100`,\nthen look at the log.\n", "expected an NC program"),
    ],
)
def test_what_is_no_program_is_none(
    tmp_path: Path, refused: Program, name: str, data: bytes, said: str
) -> None:
    (tmp_path / name).write_bytes(data)
    (tmp_path / "p.txt").write_text(row(0, 0, -3) * 2)

    words = ("--program", tmp_path / name, "-o", tmp_path / "made")
    told = refused("import", "linuxcnc", tmp_path / "p.txt", *words)

    assert told.count("\n") == 1
    assert said in told
    assert name in told
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize(
    "line",
    [
        "G38.2 Z-5 F100",
        "n10g0x1y2",
        "/G1 X#<_a> Y[#1 + [2*#<b>]] F-[3]",
        "#<_depth> = [#5063 - 2.5]",
        "#1=5 #2=6.",
        "o<probe> call [1] [2]",
        "o100 if [#5070 EQ 1]",
        "O0001",
        "N20 IF [#1 GT 3] GOTO 40",
        "%",
        "%_N_PROBE_MPF",
        "M98P1000L2",
        "G1 X1 *71",
        "G0 @5 ^30",
        "T1 M6 (a probe)",
        "S500. ; what follows is none",
    ],
)
def test_lines_of_a_program_are_known_as_such(tmp_path: Path, line: str) -> None:
    (tmp_path / "p.ngc").write_text(f"{line}\n")

    assert read_program(tmp_path / "p.ngc") == f"{line}\n"


@pytest.mark.parametrize("left", [-3, -10, -40, -79])
def test_log_that_is_cut_within_its_last_line_keeps_its_moves(tmp_path: Path, left: int) -> None:
    program = "G21 G90\n" + "".join(f"G0 X0\nG38.2 X5 F{feed}\n" for feed in [100, 400] * 3)
    log = "".join(f"{x:.6f}{' 0.000000' * 8}\n" for x in [4.01, 4.02, 4.03, 4.02, 4.01, 4.02])

    run = read(tmp_path, program, log[:left])

    assert told(run) == [("X", 1, feed) for feed in [100, 400, 100, 400, 100]]
    assert "the end of the log cuts off is that of the last move" in run.text


def test_stale_end_of_a_log_is_no_move(tmp_path: Path) -> None:
    """Which ends with a line of its own: the file was longer before."""
    program = "G21 G90\n" + "".join(f"G0 X0\nG38.2 X5 F{feed}\n" for feed in [100, 400, 100])

    run = read(tmp_path, program, row(4.01) + row(4.02) + "0.000000 0.000000\n")

    assert "that of the last move" not in run.text
