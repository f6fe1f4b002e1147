"""``skiplatch import grbl``: what is no probing move, units, overrides, and broken replies."""

from pathlib import Path

import numpy as np
import pytest

from refusals import Program
from skiplatch.campaign import Axis
from skiplatch.importing.grbl_commands import Commands
from skiplatch.importing.log_lines import Line
from test_import_logs import Run

LINE = Line(1, "", "", None)


def read(folder: Path, text: str, *options: str) -> Run:
    (folder / "s.log").write_text(text)
    return Run(folder, "grbl", str(folder / "s.log"), *options)


def probing(z: str, feed: str = "F100") -> str:
    return f"G38.2 Z-9 {feed}\n[PRB:{z}:1]\nok\n"


@pytest.mark.parametrize(
    "between",
    [
        "$J=G91 X3 F1000\nok\n",
        "> $Jog=G91 G20 X0.1 F40\nok\n",
        "[14:05:11] [ $J=G91 X3 F1000 ] ok\n",
        "[14:05:11] [ $J=G91G20X0.1F40 ] ok\n",
        "[14:05:11] [ $N0=G20 G1 X3 F30 ] ok\n",
        "$N0=G20 G1 X3 F30\nok\n",
        "G43.1 Z3.2\nok\n",
        "G91 G28 X0\nok\n",
        "G30 X0\nok\n",
    ],
)
def test_line_with_an_axis_that_does_not_probe_leaves_the_modes(
    tmp_path: Path, between: str
) -> None:
    first, second = probing("-1.000,-1.000,-5.000"), probing("2.000,-1.000,-5.005", feed="")

    touches = read(tmp_path, f"G21 G91\nok\n{first}{between}{second}").campaign.touches

    assert touches.axis.tolist() == [Axis.Z, Axis.Z]
    assert touches.sign.tolist() == [-1, -1]
    assert touches.feed_mm_min.tolist() == [100.0, 100.0]


@pytest.mark.parametrize("moved", ["$J=G91 Z2 F1000\nok\n", "$H\nok\n"])
def test_start_is_not_known_after_a_jog_or_homing(tmp_path: Path, moved: str) -> None:
    touch = probing("0.000,0.000,-5.000")

    touches = read(tmp_path, f"G21 G91\n{touch}G0 Z1\nok\n{moved}{touch}").campaign.touches

    assert np.isnan(touches.approach_mm[1])


def test_place_in_machine_coordinates_tells_no_sense_without_a_space_either(
    tmp_path: Path,
) -> None:
    text = "G90\nG0X10\nG53G0X-60\nG38.2X20F60\n[PRB:-50.000,0.000,0.000:1]\nok\n"

    assert np.isnan(read(tmp_path, text).campaign.touches.sign).all()


def test_last_touch_in_a_list_of_smoothie_is_no_further_one(tmp_path: Path) -> None:
    listed = "[G92:0.0000,0.0000,0.0000]\n[TL0:0.0000]\n[PRB:0.0000,0.0000,-5.0000:1]\nok\n"

    run = read(tmp_path, f"G21 G91\n{probing('0.000,0.000,-5.000')}$#\n{listed}")

    assert run.coordinates() == [-5.0]


IN_INCHES = probing("-3.2500,-4.1250,-1.2349", "F4") + probing("-3.2500,-4.1250,-1.2346", "F1")
IN_MM = probing("-82.550,-104.775,-31.364", "F4")


def test_four_decimals_are_inches(tmp_path: Path) -> None:
    run = read(tmp_path, "G20 G91\nok\n" + IN_INCHES)

    assert run.coordinates() == [round(-1.2349 * 25.4, 6), round(-1.2346 * 25.4, 6)]
    assert run.campaign.touches.feed_mm_min.tolist() == [101.6, 25.4]
    assert run.campaign.nominal.axis.resolution_um == pytest.approx(2.54)
    assert "replies in inches, as they have four decimals and no $13" in run.text
    assert "commands in mm" not in run.text


@pytest.mark.parametrize(
    ("text", "options", "z", "said"),
    [
        ("G20 G91\nok\n" + IN_MM, (), -31.364, "replies in mm, as they have fewer than four"),
        ("G21 G91\nok\n" + IN_MM, (), -31.364, ""),
        ("$13=0\nG20\nok\n" + IN_INCHES, (), -1.2349, ""),
        (IN_INCHES, (), -1.2349 * 25.4, "commands in mm, as the log has neither G20 nor G21"),
        (IN_INCHES, ("--inch",), -1.2349 * 25.4, ""),
        (IN_MM.replace("364", "3640"), (), -31.364, ""),  # typed by hand
    ],
)
def test_unit_of_the_replies_is_said_where_nothing_tells_it(
    tmp_path: Path, text: str, options: tuple[str, ...], z: float, said: str
) -> None:
    run = read(tmp_path, text, *options)

    assert run.coordinates()[0] == pytest.approx(z, abs=1e-6)
    about = [line for line in run.said["assumed"] if line.startswith(("replies", "commands"))]
    assert said in " ".join(about)
    assert bool(about) == bool(said)


BROKEN = ["[PRB:0.000,0.000,-5.", "[PRB:0.000,0.000,-5.0l2:1]", "[PRB:", "[PRB:0.000,0.0.0,-5:1]"]


@pytest.mark.parametrize("broken", BROKEN)
@pytest.mark.parametrize("form", ["G38.2 Z-9 F30\n{}\nok\n", "[08:00:00] [ G38.2 Z-9 F30 ] {}\n"])
def test_broken_reply_is_said_and_answers_its_own_move(
    tmp_path: Path, broken: str, form: str
) -> None:
    rest = probing("0.000,0.000,-5.010", "F60") + probing("0.000,0.000,-5.015", "F90")

    run = read(tmp_path, "G21 G91\nok\n" + form.format(broken) + rest)

    assert run.campaign.touches.feed_mm_min.tolist() == [60.0, 90.0]
    assert run.said["could_not_be_read"] == ["replies ([PRB:…]) that are cut or garbled: 1"]


def test_log_of_nothing_but_broken_replies_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "s.log").write_text("\n".join(BROKEN))

    said = refused("import", "grbl", tmp_path / "s.log", "-o", tmp_path / "made")

    assert "-5.123:1], got 4 cut or garbled" in said


def with_status(status: str) -> str:
    return f"G38.2 Z-9 F100\n<{status}>\n[PRB:0.000,0.000,-5.000:1]\nok\n"


def test_feed_is_that_of_the_override_where_the_speed_shows_it(tmp_path: Path) -> None:
    statuses = (
        "Run|MPos:0.0,0.0,-2.0|FS:50,0|Ov:50,100,100",
        "Run|FS:50,0",
        "Run|F:100|Ov:100,1,1",
    )

    run = read(tmp_path, "G21 G91\nok\n" + "".join(map(with_status, statuses)))

    assert run.campaign.touches.feed_mm_min.tolist() == [50.0, 50.0, 100.0]
    assert "feeds with the override (Ov:), as the speed shows (FS:): 2" in run.text


@pytest.mark.parametrize("speed", ["|FS:100,0", "|FS:23,0", ""])
def test_feed_is_as_programmed_where_no_speed_shows_the_override(
    tmp_path: Path, speed: str
) -> None:
    run = read(tmp_path, f"G21 G91\nok\n{with_status(f'Run{speed}|Ov:50,100,100')}")

    assert run.campaign.touches.feed_mm_min.tolist() == [100.0]
    is_assumed = "feeds as programmed in spite of an override (Ov:): 1; grbl leaves" in run.text
    assert is_assumed == ("100" not in speed)


def test_controller_that_starts_anew_takes_its_override_back(tmp_path: Path) -> None:
    text = f"{with_status('Run|FS:50,0|Ov:50,100,100')}Grbl 1.1h ['$' for help]\n"

    run = read(tmp_path, f"G21 G91\nok\n{text}{with_status('Run|FS:50,0')}")

    assert run.campaign.touches.feed_mm_min.tolist() == [50.0, 100.0]


def test_inches_of_a_move_in_machine_coordinates_are_those_of_linear_axes() -> None:
    commands = Commands(inch=True)

    commands.execute("G53 G0 Z1 A90", LINE)
    move = commands.execute("G91 G38.2 A-10 F100", LINE)

    assert move is not None
    assert move.start == {"Z": pytest.approx(25.4), "A": 90.0}


def test_list_of_parameters_ends_with_the_last_touch(tmp_path: Path) -> None:
    """A console may hide each ``ok``."""
    listed = "[G92:0.000,0.000,0.000]\n[TLO:0.000]\n[PRB:0.000,0.000,-5.000:1]\n[GC:G0 G21]\n"
    run = read(tmp_path, listed + "[PRB:0.000,0.000,-5.1:1]\n[PRB:0.000,0.000,-5.2:1]\n")

    assert run.coordinates() == [-5.1, -5.2]


def test_log_that_only_lists_its_last_touch_is_told(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "s.log").write_text("$#\n[TLO:0.000]\n[PRB:0.000,0.000,-5.000:1]\nok\n")

    said = refused("import", "grbl", tmp_path / "s.log", "-o", tmp_path / "out")

    assert "got only the last one again, as $# lists it" in said


def test_first_touch_without_a_command_is_of_the_axis_that_then_moves(tmp_path: Path) -> None:
    rows = [f"[PRB:1.000,{y:.3f},-10.000:1]\n" for y in (52.383, 52.387, 52.386)]

    touches = read(tmp_path, "".join(rows), "--feed", "100").campaign.touches

    assert touches.axis.tolist() == [Axis.Y] * 3
    assert np.isnan(touches.sign).all()
    assert touches.deviation_um.tolist() == pytest.approx([-3.0, 1.0, 0.0])


def test_approach_longer_than_its_move_is_not_known(tmp_path: Path) -> None:
    """The operator jogged in between, which the log does not show."""
    (tmp_path / "jog.log").write_text(
        "G21 G91\nok\nG38.2 X5 F100\n[PRB:-50.000,0.000,-5.000:1]\nok\nG0 X-2\nok\n"
        "G38.2 X5 F100\n[PRB:-49.995,0.000,-5.000:1]\nok\nG0 X-2\nok\n"
        "G38.2 X-5 F100\n[PRB:-30.000,0.000,-5.000:1]\nok\nG0 X2\nok\n"
        "G38.2 X-5 F100\n[PRB:-30.005,0.000,-5.000:1]\nok\nG0 X2\nok\n"
        "G38.2 X-5 F100\n[PRB:-36.005,0.000,-5.000:1]\nok\n"
    )

    touches = Run(tmp_path, "grbl", str(tmp_path / "jog.log")).campaign.touches

    unknown = np.isnan(touches.approach_mm).tolist()
    assert unknown == [True, False, True, False, True]
    assert touches.approach_mm[[1, 3]] == pytest.approx([2.0, 2.0], abs=0.01)


@pytest.mark.parametrize(
    "start",
    ["Grbl 1.1h ['$' for help]", "GrblHAL 1.1f ['$' for help]", "Grbl 3.7 [FluidNC v3.7.8]"],
)
def test_reset_takes_back_units_and_feed(tmp_path: Path, start: str) -> None:
    touch = "{}\n[PRB:0.000,0.000,-5.123:1]\nok\n"
    moves = ["G20 G91 G38.2 Z-1 F10", "G91 G38.2 Z-9 F60", "G38.2 Z-9"]
    before, after, last = map(touch.format, moves)

    run = read(tmp_path, f"{before}{start}\n{after}{start}\n{last}", "--feed", "7")

    assert run.campaign.touches.feed_mm_min.tolist() == [254, 60, 7]


def test_maximum_rate_of_the_axis_limits_its_feed(tmp_path: Path) -> None:
    text = probing("0.000,0.000,-5.123", "F50") + probing("0.000,0.000,-5.124", "F300")

    run = read(tmp_path, f"$110=10\n$112=100.000\n{text}")

    assert run.campaign.touches.feed_mm_min.tolist() == [50, 100]
    assert "1 touch slower than asked for, as $112 is 100 mm/min" in run.said["known"]


def test_change_of_the_tool_begins_a_session(tmp_path: Path) -> None:
    touch = probing("0.000,0.000,-5.123")
    changes = ("M6 T1", "T2 M6", "(M6 is next)", "M06 T3 (small)")

    run = read(tmp_path, "".join(f"{change}\nok\n{touch}" for change in changes))

    touches = run.campaign.touches
    names = [touches.session_names[i].split(" Z-")[0] for i in touches.session]
    second = "after tool change 1"
    assert names == ["Z- at 0 0", second, second, "after tool change 2"]
    assert "sessions of their own after a change of the tool (M6): 2" in run.said["assumed"]


def test_commands_that_stand_beside_their_ok_alone_are_said(tmp_path: Path) -> None:
    touch = "[ G38.2 Z-20 F50 ] ok\n[PRB:0.000,0.000,-5.123:1]\n"

    run = read(tmp_path, touch * 3, "--feed", "50")

    said = "probing commands beside an ok do not tell which reply is theirs"
    assert said in run.said["assumed"]


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ("", "no $ settings in the log: steps per mm and acceleration"),
        ("$13=0\n", "no $102 and $122 in the log: steps per mm and acceleration"),
        ("$102=400\n", "no $122 in the log: acceleration"),
        ("$122=50\n", "no $102 in the log: steps per mm"),
    ],
)
def test_settings_that_are_not_in_the_log_are_named(
    tmp_path: Path, settings: str, expected: str
) -> None:
    touch = probing("0.000,0.000,-5.000")

    assumed = read(tmp_path, f"{settings}G21\n{touch}{touch}").said["assumed"]

    by_default = [line for line in assumed if "as grbl has it by default" in line]
    assert by_default == [f"{expected} as grbl has it by default; type $$ before probing"]


ALARMED = "G38.2 Z-9 F100\nALARM:5\n[PRB:{}:0]\nok\n$X\nok\n"
"""A touch that failed: grbl tells the place of the one before, or zeros."""
TOUCHED = probing("-20.000,-30.000,-40.000") + "G0 Z2\nok\n" + probing("-20.000,-30.000,-40.005")


def test_touch_that_failed_before_any_other_has_no_place(tmp_path: Path) -> None:
    run = read(tmp_path, f"G21 G91\nok\n{ALARMED.format('0.000,0.000,0.000')}{TOUCHED}")

    touches = run.campaign.touches
    assert touches.missed.tolist() == [True, False, False]
    assert np.isnan(touches.position_mm[0])
    assert touches.position_mm[1:].tolist() == [-40.0025, -40.0025]
    assert np.isnan(touches.approach_mm[1])


def test_touch_that_failed_leaves_where_the_axis_is_unknown(tmp_path: Path) -> None:
    failed = ALARMED.format("0.000,0.000,0.000")

    run = read(tmp_path, f"G21 G91\nok\n{TOUCHED}G0 Z2\nok\n{failed}G0 Z9\nok\n{TOUCHED}")

    touches = run.campaign.touches
    assert "4 touches of one surface" in run.text
    assert touches.position_mm[2] == pytest.approx(-40.0025)
    assert np.isnan(touches.approach_mm[3])
    assert touches.approach_mm[4] == pytest.approx(2.0, abs=0.01)


def test_move_without_an_alarm_ends_at_its_target(tmp_path: Path) -> None:
    """By G38.3 nothing has to be met, and the reply says where the move ended."""
    missed = "G0 Z2\nok\nG38.3 Z-9 F100\n[PRB:-20.000,-30.000,-47.005:0]\nok\n"

    run = read(tmp_path, f"G21 G91\nok\n{TOUCHED}{missed}G0 Z9\nok\n{probing('-20,-30,-40')}")

    touches = run.campaign.touches
    assert touches.missed.tolist() == [False, False, True, False]
    assert touches.approach_mm[3] == pytest.approx(2.0, abs=0.01)
