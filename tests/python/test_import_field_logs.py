"""``skiplatch import``: what logs of grbl and LinuxCNC hold beside touches.

The wording is that of the programs: Universal G-code Sender (its issues 742 and 2673), Candle (its
issues 505 and 616) and bCNC (issue 999).
"""

from pathlib import Path

import numpy as np
import pytest

from refusals import Program
from skiplatch.campaign import Axis
from skiplatch.importing.gcode_program import run as run_program
from skiplatch.repeatability import repeatability
from test_import_logs import Run

UGS_FAILED = """>>> G38.2 Z-5 F250
ALARM:5
[PRB:-150.000,-90.000,-6.000:0]
An error was detected while sending 'G38.2 Z-5 F250': (ALARM:5) Probe fail. Probe did not contact.
ok
"""
UGS_LOCKED = """>>> G38.2 Z-5 F250
error:9
An error was detected while sending 'G38.2 Z-5 F250': (error:9) G-code locked out during alarm.
"""
UGS_OPEN = """>>> G38.2 Z-5 F250
ALARM:4
An error was detected while sending 'G38.2 Z-5 F250': (ALARM:4) Probe fail. Not in initial state.
ok
"""
STREAMED = """>>> G0 Z1
>>> G38.2 Z-5 F250
>>> G0 Z2
ok
error:9
ok
"""
RESET = """>>> G38.2 Z-5 F250
>>> G0 Z2
Grbl 1.1h ['$' for help]
"""
CANDLE_LOCKED = "G91G38.2Z-5F250 < error:9\n"


def two_feeds(times: int) -> str:
    """Touches at 25 and 250 mm/min, later by 3 ms times the feed."""
    lines = ["$$", "$13=0", "$102=400.000", "ok"]
    for feed, z in [(25, -21.00125), (250, -21.0125)] * times:
        lines += [">>> G91 G21", "ok", f">>> G38.2 Z-25 F{feed}"]
        lines += [f"[PRB:-150.000,-90.000,{z:.3f}:1]", "ok", ">>> G0 Z4", "ok"]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    "before",
    [UGS_FAILED, UGS_LOCKED, UGS_OPEN, STREAMED, RESET, CANDLE_LOCKED, UGS_FAILED + UGS_LOCKED],
)
def test_probing_that_failed_leaves_the_feeds_of_others(tmp_path: Path, before: str) -> None:
    (tmp_path / "s.log").write_text(">>> G0 Z0\nok\n" + before + two_feeds(4))

    touches = Run(tmp_path, "grbl", str(tmp_path / "s.log")).campaign.touches

    assert touches.feed_mm_min[touches.ok].tolist() == [25, 250] * 4


def test_delay_after_a_failed_probing_keeps_its_sign(tmp_path: Path) -> None:
    (tmp_path / "s.log").write_text(UGS_FAILED + two_feeds(6))

    slope = repeatability(Run(tmp_path, "grbl", str(tmp_path / "s.log")).campaign).slope

    assert slope is not None
    assert slope.value == pytest.approx(3.0, abs=0.4)


def test_where_the_probe_lets_go_is_no_touch_of_grbl(tmp_path: Path) -> None:
    touch = "g91G38.3f100z-5\n[PRB:0.000,0.000,0.{}:1]\nok\n"
    release = "g91G38.5f20z5\n[PRB:0.000,0.000,0.095:1]\nok\n"
    (tmp_path / "b.log").write_text("".join(touch.format(88 + i) + release for i in range(3)))

    run = Run(tmp_path, "grbl", str(tmp_path / "b.log"))

    assert run.coordinates() == [0.88, 0.89, 0.9]
    assert "3 moves away from the surface (G38.4, G38.5)" in run.text


def test_probe_that_is_wired_the_other_way_round_touches_by_g38_4(tmp_path: Path) -> None:
    (tmp_path / "b.log").write_text("G91G38.4F100Z-5\n[PRB:0.000,0.000,0.088:1]\nok\n" * 3)

    assert Run(tmp_path, "grbl", str(tmp_path / "b.log")).coordinates() == [0.088] * 3


RELEASING = """G21 G90
#1 = 2
(PROBEOPEN p.txt)
o100 while [#1 GT 0]
  G0 Z5
  G38.2 Z-5 F60
  o110 if [#5070 EQ 0]
    G38.2 Z-9 F10
  o110 elseif [#1 EQ 7]
    G38.2 Z-8 F20
  o110 else
    G38.5 Z5 F30
  o110 endif
  #1 = [#1 - 1]
o100 endwhile
"""


def nine(*coordinates: float) -> str:
    return "".join(f"10.0 20.0 {z:.6f}" + " 0.0" * 6 + "\n" for z in coordinates)


def test_branches_of_a_program_are_taken_as_if_the_probe_had_touched() -> None:
    moves = run_program(RELEASING, []).moves

    assert [(move.feed, move.is_release) for move in moves] == [(60, False), (30, True)] * 2


def test_branch_whose_condition_is_not_known_is_taken() -> None:
    text = "o1 if [#<_there> EQ 1]\nG38.2 Z-1 F5\no1 else\nG38.2 Z-1 F6\no1 endif\nG38.2 Z-1 F7\n"

    assert [move.feed for move in run_program(text, []).moves] == [5, 7]


def test_where_the_probe_lets_go_is_no_touch_of_linuxcnc(tmp_path: Path) -> None:
    (tmp_path / "p.ngc").write_text(RELEASING)
    (tmp_path / "p.txt").write_text(nine(-1.001, -0.996, -1.002, -0.997))

    run = Run(tmp_path, "linuxcnc", str(tmp_path / "p.txt"), "--program", str(tmp_path / "p.ngc"))

    assert run.coordinates() == [-1.001, -1.002]


def test_touches_that_cannot_be_told_from_releases_are_refused(
    tmp_path: Path, refused: Program
) -> None:
    (tmp_path / "p.ngc").write_text(RELEASING)
    (tmp_path / "p.txt").write_text(nine(-1.001, -0.996, -1.002))

    said = refused(
        *("import", "linuxcnc", tmp_path / "p.txt"),
        *("--program", tmp_path / "p.ngc", "-o", tmp_path / "out"),
    )

    assert "3 lines and the program 4 probing moves, 2 of them away" in said


def test_probing_in_inches_of_grblhal_counts_its_misses(tmp_path: Path) -> None:
    """G20, $13=1: commands and replies in inches, four decimals; G38.3 ends without an alarm."""
    lines = ["GrblHAL 1.1f ['$' or '$HELP' for help]", "$13=1", "$102=800.000", "G20 G90", "ok"]
    for i in range(12):
        feed_inch = (2.0, 10.0)[i // 6]
        late_inch = feed_inch / 60.0 * 0.006  # by 6 ms
        place = f"-0.6000:{0}" if i == 8 else f"{-0.4724 - late_inch:.4f}:1"
        lines += [
            f"G0 Z-0.42\nok\nG38.3 Z-0.6 F{feed_inch:g}",
            f"[PRB:1.0000,0.5000,{place}]",
            "ok",
        ]
    (tmp_path / "s.log").write_text("\n".join(lines) + "\n")

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    touches = run.campaign.touches
    assert np.flatnonzero(touches.missed).tolist() == [8]
    assert touches.feed_mm_min.tolist() == [50.8] * 6 + [254.0] * 6
    later_um = np.nanmean(touches.deviation_um[6:]) - np.nanmean(touches.deviation_um[:6])
    assert later_um == pytest.approx(6.0 * (254.0 - 50.8) / 60.0, abs=2.0)
    assert run.campaign.nominal.axis.resolution_um == pytest.approx(2.54)  # and not the step


def test_probe_that_was_triggered_before_its_move_is_a_false_touch(tmp_path: Path) -> None:
    touch = "G38.2 Z-5 F100\n[PRB:0.000,0.000,-1.00{}:1]\nok\nG0 Z0\nok\n"
    (tmp_path / "s.log").write_text(
        "".join(touch.format(i) for i in range(4)) + "G38.2 Z-5 F100\nALARM:4\n$X\nok\n"
    )

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    assert run.campaign.touches.false.tolist() == [False] * 4 + [True]
    assert "false triggers, before the axis moved (ALARM:4): 1" in run.text
    assert "4 touches of one surface" in run.text


def test_log_of_nothing_but_misses_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "s.log").write_text("G38.3 Z-5 F100\n[PRB:0.000,0.000,-5.000:0]\nok\n" * 3)

    said = refused("import", "grbl", tmp_path / "s.log", "-o", tmp_path / "made")

    assert "expected a touch, got 3 probing moves that ended without one" in said


def test_list_of_a_rotary_axis_is_told_without_its_program(tmp_path: Path) -> None:
    rows = (f"100.0 50.0 -20.0 {45.0 + 0.00137 * i:.6f} 0 0 0 0 0\n" for i in range(5))
    (tmp_path / "p.txt").write_text("".join(rows))

    run = Run(tmp_path, "linuxcnc", str(tmp_path / "p.txt"))

    assert set(run.campaign.touches.axis.tolist()) == {Axis.A}
    assert "axis A, whose coordinates look touched; else give --axis" in run.text


def test_alarm_that_names_homing_homes_nothing(tmp_path: Path) -> None:
    """After a probe that met nothing grbl still knows where it is."""
    locked = "ALARM:5\n[MSG:'$H'|'$X' to unlock]\n>>> $X\n[MSG:Caution: Unlocked]\nok\n"
    (tmp_path / "p.log").write_text(two_feeds(3) + UGS_FAILED + locked + two_feeds(3))

    run = Run(tmp_path, "grbl", str(tmp_path / "p.log"))

    assert "12 touches of one surface" in run.said["known"]
    assert len(np.unique(run.campaign.touches.session)) == 1


@pytest.mark.parametrize("start", ["$H", "Grbl 1.1h ['$' for help]", "GrblHAL 1.1f ['$' for help]"])
def test_what_homes_or_starts_begins_a_session(tmp_path: Path, start: str) -> None:
    (tmp_path / "p.log").write_text(f"{two_feeds(3)}{start}\nok\n{two_feeds(3)}")

    run = Run(tmp_path, "grbl", str(tmp_path / "p.log"))

    assert len(np.unique(run.campaign.touches.session)) == 2


@pytest.mark.parametrize("stamp", ["Apr 02 20:11:{:02}", "Thu, Apr  2, 2026, 20:11:{:02}"])
def test_stamps_of_syslog_are_times(tmp_path: Path, stamp: str) -> None:
    lines = two_feeds(2).splitlines()
    text = "".join(f"{stamp.format(i)} {line}\n" for i, line in enumerate(lines))
    (tmp_path / "p.log").write_text(text)

    run = Run(tmp_path, "grbl", str(tmp_path / "p.log"))

    fast_s = 4 / 250 * 60
    assert run.campaign.touches.time_s == pytest.approx([0, 7 - fast_s, 7, 21 - fast_s], abs=0.1)


SCAN = "G21 G90\n(PROBEOPEN p.txt)\no1 repeat [{n}]\nG0 X0\nG38.3 X10 F80\no1 endrepeat\nM2\n"


def test_probing_move_of_linuxcnc_that_met_nothing_is_missed(tmp_path: Path) -> None:
    places = [7.2476, 10.0, 7.2513, 10.00003, 7.2454]
    (tmp_path / "p.ngc").write_text(SCAN.format(n=len(places)))
    (tmp_path / "p.txt").write_text("".join(f"{x:.6f} 0 0 0 0 0 0 0 0\n" for x in places))

    run = Run(tmp_path, "linuxcnc", str(tmp_path / "p.txt"), "--program", str(tmp_path / "p.ngc"))

    assert run.campaign.touches.missed.tolist() == [False, True, False, True, False]
    assert "missed touches, as the move ended at its target: 2" in run.said["known"]
    assert "3 touches of one surface" in run.said["known"]


def test_miss_of_linuxcnc_is_told_where_repeats_are_left_out(tmp_path: Path) -> None:
    """Of five moves to one target four wrote a line."""
    (tmp_path / "p.ngc").write_text(SCAN.format(n=5))
    places = [7.2476, 7.2513, 10.0, 7.2454]
    (tmp_path / "p.txt").write_text("".join(f"{x:.6f} 0 0 0 0 0 0 0 0\n" for x in places))

    run = Run(tmp_path, "linuxcnc", str(tmp_path / "p.txt"), "--program", str(tmp_path / "p.ngc"))

    assert run.campaign.touches.missed.tolist() == [False, False, True, False]


def test_log_of_linuxcnc_without_a_touch_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "p.ngc").write_text(SCAN.format(n=2))
    (tmp_path / "p.txt").write_text(2 * "10.000000 0 0 0 0 0 0 0 0\n")
    words = ("--program", tmp_path / "p.ngc", "-o", tmp_path / "made")

    said = refused("import", "linuxcnc", tmp_path / "p.txt", *words)

    assert "expected a touch, got 2 probing moves that ended without one" in said


def test_settings_that_candle_puts_in_one_line_are_all_read(tmp_path: Path) -> None:
    (tmp_path / "c.log").write_text(
        "$$ < $0=10; $13=0; $102=800.000; $122=50.000 ($120=7 of X); ok\n"
        "G38.2Z-20F50 < [PRB:-200.000,-150.000,-12.300:1]; ok\n"
    )

    run = Run(tmp_path, "grbl", str(tmp_path / "c.log"))

    axis = run.campaign.nominal.axis
    assert (axis.resolution_um, axis.accel_mm_s2) == (1.25, 50.0)
    assert not any("$122" in line for line in run.said["assumed"])
