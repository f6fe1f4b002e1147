"""``skiplatch import``: what logs of machines hold beside touches, and must not be taken for them.

The wording is that of the programs: Universal G-code Sender (its issues 742 and 2673), Candle (its
issues 505 and 616), bCNC (issue 999), Klipper's pull request 7253, and Beacon's Klipper module.
"""

from pathlib import Path

import numpy as np
import pytest

from refusals import Program
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

    assert touches.feed_mm_min[~touches.missed].tolist() == [25, 250] * 4


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
    moves = list(run_program(RELEASING))

    assert [(move.feed, move.is_release) for move in moves] == [(60, False), (30, True)] * 2


def test_branch_whose_condition_is_not_known_is_taken() -> None:
    text = "o1 if [#<_there> EQ 1]\nG38.2 Z-1 F5\no1 else\nG38.2 Z-1 F6\no1 endif\nG38.2 Z-1 F7\n"

    assert [move.feed for move in run_program(text)] == [5, 7]


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


def test_distance_that_a_probe_reads_at_rest_grows_as_the_bed_sinks(tmp_path: Path) -> None:
    lines = "Recv: // probe at 150.000,150.000,2.000 is z=2.00{}000\n"
    (tmp_path / "o.log").write_text("".join(lines.format(i) for i in range(1, 5)))

    run = Run(tmp_path, "klipper", str(tmp_path / "o.log"))

    assert np.diff(run.campaign.touches.deviation_um).tolist() == pytest.approx([1.0] * 3)
    assert np.isnan(run.campaign.touches.feed_mm_min).all()
    assert "4 distances that a probe read at rest" in run.text


def test_contact_of_an_eddy_probe_counts_once(tmp_path: Path) -> None:
    (tmp_path / "o.log").write_text(
        "// probe: at 10.000,20.000 bed will contact at z=0.091244\n"
        "// Result: at 10.000,20.000 estimate contact at z=0.091244\n"
    )

    assert Run(tmp_path, "klipper", str(tmp_path / "o.log")).coordinates() == [0.091244]


def saleae(probe_idles_high: bool, *, toggles: bool = False) -> str:
    """Twenty touches: 0.1 s apart, latched after 40 µs, reset with the probe after 10 ms."""
    rest, lines, latch = int(probe_idles_high), [], 0
    for i in range(20):
        at = 0.1 * (i + 1)
        lines.append((at, 1 - rest, latch))
        latch = 1 - latch if toggles else 1
        lines.append((at + 40e-6, 1 - rest, latch))
        latch = latch if toggles else 0
        lines.append((at + 0.01, rest, latch))
    rows = "".join(f"{t:.9f}, {p}, {q}\n" for t, p, q in lines)
    return f"Time[s], Channel 0, Channel 1\n0.000000000, {rest}, 0\n{rows}"


@pytest.mark.parametrize(("idles_high", "toggles"), [(True, False), (True, True), (False, True)])
def test_latch_output_has_a_polarity_of_its_own(
    tmp_path: Path, idles_high: bool, toggles: bool
) -> None:
    (tmp_path / "c.csv").write_text(saleae(idles_high, toggles=toggles))

    run = Run(
        tmp_path,
        *("edges", str(tmp_path / "c.csv"), "--probe", "0", "--latch", "1"),
        *(["--falling"] if idles_high else []),
    )

    touches = run.campaign.touches
    assert touches.latch_us - touches.edge_us == pytest.approx(np.full(20, 40.0))
    assert "Channel 1 tells the latch by its rising" in run.text
    assert "Odd" not in run.text


PULSEVIEW = """$comment
  Acquisition with 3/8 channels at 500 kHz
$end
$timescale 1 ns $end
$scope module libsigrok $end
$var wire 1 ! D0 $end
$var wire 1 " D1 $end
$var wire 1 # D2 $end
$upscope $end
$enddefinitions $end
#0 0! 0" 0#
#1000000 1!
#1010000 1"
#1020000 1#
#1030000 0! 0" 0#
#9000000 1!
#9010000 1"
#9012000 1#
#9030000 0! 0" 0#
"""


def test_capture_of_both_paths_is_not_odd_and_knows_its_samples(tmp_path: Path) -> None:
    (tmp_path / "c.vcd").write_text(PULSEVIEW)

    run = Run(
        tmp_path,
        *("edges", str(tmp_path / "c.vcd"), "--probe", "D0", "--latch", "D1"),
        *("--plc-latch", "D2"),
    )

    assert "Odd" not in run.text
    assert run.campaign.nominal.skip.tick_us == pytest.approx(2.0)


def iso(reversal_um: float, zero_um: float) -> str:
    rows = [
        f"{p};{zero_um + 0.03 * p:.1f};{zero_um + 0.03 * p - reversal_um:.1f}"
        for p in range(100, 600, 100)
    ]
    return "\n".join(["Achse X", "Position [mm];1 +;1 -", *rows]) + "\n"


@pytest.mark.parametrize("zero_um", [0.0, 6.0, -250.0])
def test_zero_of_the_instrument_is_no_reversal_error(tmp_path: Path, zero_um: float) -> None:
    (tmp_path / "i.csv").write_text(iso(12.0, zero_um))

    touches = Run(tmp_path, "iso230", str(tmp_path / "i.csv"), "--axis", "X").campaign.touches

    along = touches.sign * touches.deviation_um - 0.03 * touches.position_mm
    assert along[touches.sign > 0] == pytest.approx(np.zeros(5), abs=0.01)
    assert along[touches.sign < 0] == pytest.approx(np.full(5, -12.0), abs=0.01)


def test_column_of_another_quantity_is_no_run(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("Touch,Feed (ipm),Z (in)\n1,2.0,-1.5\n2,12.0,-1.5\n")

    said = refused("import", "iso230", tmp_path / "t.csv", "-o", tmp_path / "x")

    assert 'expected runs with deviations, got a column in ipm: "Feed (ipm)"' in said


def test_table_begins_at_its_head(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(
        "Antastprotokoll, Maschine 7\n\nNr.;Vorschub [mm/min];Abweichung [µm]\n1;100;1,5\n2;500;x\n"
    )
    mapped = ("--map", "deviation_um=Abweichung", "--map", "feed_mm_min=Vorschub [mm/min]")
    good = (tmp_path / "t.csv").read_text().replace(";x", ";2,5")
    (tmp_path / "good.csv").write_text(good)

    run = Run(tmp_path, "csv", str(tmp_path / "good.csv"), *mapped)

    assert run.campaign.touches.deviation_um.tolist() == [1.5, 2.5]
    assert run.said["could_not_be_read"][0] == "2 lines before the head of the table"


def test_wrong_cell_below_a_title_is_told_by_its_line(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("Protokoll\n\nNr.;Abweichung [µm]\n1;1,5\n2;x\n")

    said = refused(
        *("import", "csv", tmp_path / "t.csv", "--map", "deviation_um=Abweichung"),
        *("-o", tmp_path / "x"),
    )

    assert "t.csv:5" in said


def test_compressed_log_is_told(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "klippy.log.gz").write_bytes(b"\x1f\x8b\x08\x00" + bytes(20))

    said = refused("import", "klipper", tmp_path / "klippy.log.gz", "-o", tmp_path / "x")

    assert "a compressed file: unpack it first" in said


def test_delay_shows_where_surfaces_were_touched_at_other_shares_of_the_feeds(
    tmp_path: Path,
) -> None:
    head = "PROBE_ACCURACY at X:5.000 Y:5.000 Z:5.000 (samples=10 retract=3.000 speed={}.0)\n"
    line = "probe: at 5.000,30.000 bed will contact at z={:.6f}\n"
    noise = np.random.default_rng(1).normal(0.0, 1e-3, 60)
    runs = [5, 20, 5, 20, 5, 20]
    text = ""
    for number, speed in enumerate(runs):
        text += "G28\n" if number == 3 else ""
        text += head.format(speed)
        zs = 0.1 + 0.03 * (number > 2) - 3e-3 * speed + noise[10 * number : 10 * number + 10]
        text += "".join(line.format(z) for z in zs)
    (tmp_path / "klippy.log").write_text(text)

    found = repeatability(Run(tmp_path, "klipper", str(tmp_path / "klippy.log")).campaign)

    assert found.slope is not None
    assert found.slope.value == pytest.approx(3.0, abs=0.1)
    assert not found.outliers


def test_drift_of_the_axis_shows_from_either_side(tmp_path: Path) -> None:
    """A slot that moves by half a µm a touch: one side comes later and the other earlier."""
    noise = np.random.default_rng(2).normal(0.0, 1e-3, 60)
    text = "g0x0\n"
    for touch in range(60):
        sense = 1 - 2 * (touch % 2)
        x = -100 + sense * 15.0 + 5e-4 * touch + noise[touch]
        text += f"g91g38.3f100x{30 * sense}\n[PRB:{x:.3f},-50.000,-12.345:1]\nok\n"
        text += f"g0x{-15 * sense}\nok\n"
    (tmp_path / "b.log").write_text(text)

    found = repeatability(Run(tmp_path, "grbl", str(tmp_path / "b.log")).campaign)

    assert found.axis_drift is not None
    assert found.axis_drift.value == pytest.approx(0.5, abs=0.03)
    assert found.sigma.value < 1.4
