"""``skiplatch import``: consoles, captures and tables as instruments and printers give them.

The wording is that of the programs: Klipper (its pull request 7253), Beacon's module for it, Marlin
(its pull request 23868), Saleae's Logic 1, and sigrok's PulseView.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from refusals import Program
from skiplatch.campaign import InputPath
from skiplatch.diagnosis import diagnose
from skiplatch.errors import CampaignWarning
from skiplatch.repeatability import repeatability
from skiplatch.stand_ins import playable
from test_import_logs import Run


def test_distance_that_a_probe_reads_at_rest_grows_as_the_bed_sinks(tmp_path: Path) -> None:
    lines = "Recv: // probe at 150.000,150.000,2.000 is z=2.00{}000\n"
    (tmp_path / "o.log").write_text("".join(lines.format(i) for i in range(1, 5)))

    run = Run(tmp_path, "klipper", str(tmp_path / "o.log"))

    assert np.diff(run.campaign.touches.deviation_um).tolist() == pytest.approx([1.0] * 3)
    assert np.isnan(run.campaign.touches.feed_mm_min).all()
    assert "4 distances that a probe read at rest" in run.text
    assert "diagnose needs a feed all the same, by which nothing is found; give --feed" in run.text


def test_distance_read_at_rest_takes_the_feed_that_is_given(tmp_path: Path) -> None:
    lines = "Recv: // probe at 150.000,150.000,2.000 is z=2.00{}000\n"
    (tmp_path / "o.log").write_text("".join(lines.format(i) for i in range(1, 5)))

    run = Run(tmp_path, "klipper", str(tmp_path / "o.log"), "--feed", "300")

    assert set(run.campaign.touches.feed_mm_min) == {300.0}
    assert "diagnose needs a feed" not in run.text


@pytest.mark.parametrize("unit", ["i;1;2;3\nP [mm]", "mm"])
def test_table_with_positions_in_columns_is_read(tmp_path: Path, unit: str) -> None:
    runs = "".join(f"{i} {arrow};1,{i};2,0;0,{i}\n" for i in (1, 2) for arrow in "↑↓")
    (tmp_path / "t.csv").write_text(f"{unit};-4,0;0,0;4,0\n{runs}")

    touches = Run(tmp_path, "iso230", str(tmp_path / "t.csv")).campaign.touches

    assert sorted(set(touches.position_mm.tolist())) == [-4.0, 0.0, 4.0]
    assert touches.sign.tolist() == [1.0] * 3 + [-1.0] * 3 + [1.0] * 3 + [-1.0] * 3


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

    assert 'expected runs with deviations in µm or mm, got "Feed (ipm)"' in said


def test_table_begins_at_its_head(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(
        "Antastprotokoll, Maschine 7\n\nNr.;Vorschub [mm/min];Abweichung [µm]\n1;100;1,5\n2;500;x\n"
    )
    mapped = ("--map", "deviation_um=Abweichung", "--map", "feed_mm_min=Vorschub [mm/min]")
    good = (tmp_path / "t.csv").read_text().replace(";x", ";2,5")
    (tmp_path / "good.csv").write_text(good)

    run = Run(tmp_path, "csv", str(tmp_path / "good.csv"), *mapped)

    assert run.campaign.touches.deviation_um.tolist() == [1.5, 2.5]
    assert run.said["could_not_be_read"][0] == "lines before the head of the table: 2"


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


def test_columns_beside_coordinates_are_kept(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(
        "n;z;T;path;table\n7;-1,001;20,5;plc;0\n9;-1,002;21,5;skip;90\n12;-1,003;22,5;plc;180\n"
    )
    columns = {
        "touch": "n",
        "coordinate_mm": "z",
        "temp_c": "T",
        "path": "path",
        "rotary_deg": "table",
    }
    mapped = [word for name, head in columns.items() for word in ("--map", f"{name}={head}")]

    touches = Run(
        tmp_path, "csv", str(tmp_path / "t.csv"), *mapped, "--sign", "-1"
    ).campaign.touches

    assert touches.touch.tolist() == [7, 9, 12]
    assert touches.path.tolist() == [InputPath.PLC, InputPath.SKIP, InputPath.PLC]
    assert touches.temp_c.tolist() == [20.5, 21.5, 22.5]
    assert touches.rotary_deg.tolist() == [0, 90, 180]


@pytest.mark.parametrize(("bed", "is_machine"), [(1.0, True), (0.1, False)])
def test_bed_that_warms_is_the_temperature_of_the_machine(
    tmp_path: Path, bed: float, is_machine: bool
) -> None:
    """A drift with the temperature is looked for by the machine's thermometer alone."""
    (tmp_path / "g30.log").write_text(
        "".join(
            f"RECV:  T:25.10 /0.00 B:{25 + bed * i:.2f} /85.00 @:0 B@:127\n"
            f"RECV: Bed X: 110.00 Y: 110.00 Z: {0.1 + 2e-3 * i:.3f}\n"
            for i in range(6)
        )
    )

    run = Run(tmp_path, "marlin", str(tmp_path / "g30.log"), "--feed", "240")

    touches = run.campaign.touches
    assert touches.thermometers["bed"].tolist() == pytest.approx([25 + bed * i for i in range(6)])
    assert np.array_equal(touches.temp_c, touches.thermometers["bed"]) == is_machine
    assert ("temp_c, is that of bed" in run.text) == is_machine


def test_attempts_of_klipper_without_a_touch_are_counted(tmp_path: Path) -> None:
    accuracy = (
        "// PROBE_ACCURACY at X:97.000 Y:2.000 Z:3.315 (samples=10 retract=2.000 speed=5.0)\n"
    )
    touch = "// probe at 97.000,2.000 is z=1.32{}000\n"
    (tmp_path / "o.log").write_text(
        accuracy
        + "".join(touch.format(i) for i in range(4))
        + "Recv: !! No trigger on probe after full movement\n"
        + accuracy
        + "".join(touch.format(i) for i in range(3))
        + "!! Probe triggered prior to movement\n"
    )

    run = Run(tmp_path, "klipper", str(tmp_path / "o.log"))

    touches = run.campaign.touches
    assert len(touches) == 9
    assert np.flatnonzero(touches.missed).tolist() == [4]
    assert np.flatnonzero(touches.false).tolist() == [8]
    assert np.flatnonzero(touches.ok).tolist() == [0, 1, 2, 3, 5, 6, 7]
    assert (touches.feed_mm_min == 300.0).all()
    assert "missed touches, as the probe did not trigger: 1 of 9 attempts to touch" in run.text
    assert "false triggers, before the axis moved: 1 of 9 attempts to touch" in run.text
    assert "7 touches of one surface" in run.text


def test_a_failed_probing_of_marlin_is_a_missed_touch(tmp_path: Path) -> None:
    (tmp_path / "m.log").write_text(
        "Bed X: 10.00 Y: 10.00 Z: 0.01\nBed X: 10.00 Y: 10.00 Z: 0.02\nError:Probing Failed\n"
    )

    run = Run(tmp_path, "marlin", str(tmp_path / "m.log"), "--feed", "120")

    assert run.campaign.touches.missed.tolist() == [False, False, True]
    assert "missed touches, as the probe did not trigger: 1 of 3 attempts to touch" in run.text


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("klipper", "!! No trigger on probe after full movement\n"),
        ("marlin", "Error:Probing Failed\n"),
    ],
)
def test_a_log_of_missed_touches_alone_is_refused(
    tmp_path: Path, refused: Program, kind: str, text: str
) -> None:
    (tmp_path / "o.log").write_text(text)

    said = refused("import", kind, tmp_path / "o.log", "--out", tmp_path / "made")

    assert "expected lines such as" in said


GERMAN = (
    "Messprotokoll Positioniergenauigkeit nach ISO 230-2;;;;;\n"
    "Maschine:;DMU 50 evo;;;;\n"
    "Achse:;X;;;;\n"
    ";;;;;\n"
    "Sollposition [mm];1 vorwärts [µm];1 rückwärts [µm];2 vorwärts [µm];2 rückwärts [µm];"
    "Mittelwert [µm]\n"
    "0,0;0,1;-5,9;-0,1;-6,1;-3,0\n"
    "100,0;1,1;-4,9;0,9;-5,1;-2,0\n"
    "200,0;2,1;-3,9;1,9;-4,1;-1,0\n"
    ";;;;;\n"
    "Umkehrspanne B [µm];6,0;;;;\n"
)


@pytest.mark.parametrize("encoding", ["cp1252", "utf-8-sig", "utf-16"])
def test_german_protocol_of_iso_230_is_read(tmp_path: Path, encoding: str) -> None:
    (tmp_path / "x.csv").write_bytes(GERMAN.replace("\n", "\r\n").encode(encoding))

    run = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--axis", "X")

    touches = run.campaign.touches
    up = touches.sign > 0.0
    assert up.sum() == (~up).sum() == 6
    assert sorted(set(touches.position_mm.tolist())) == [0.0, 100.0, 200.0]
    reversal_um = touches.deviation_um[up].mean() + touches.deviation_um[~up].mean()
    assert reversal_um == pytest.approx(6.0)
    assert run.said["could_not_be_read"][:3] == [
        "lines before the head of the table: 4",
        "lines below the table: 1",
        "columns that are no runs: Mittelwert [µm]",
    ]


def test_slip_in_a_position_is_no_line_below_the_table(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "x.csv").write_text("mm;1+;1-\n0;0,1;-6\n100;1,1;-5\n2OO;2,1;-4\n")

    said = refused("import", "iso230", tmp_path / "x.csv", "-o", tmp_path / "made")

    assert 'x.csv:4: mm: expected a number, got "2OO"' in said


@pytest.mark.parametrize("feed", [(), ("--feed", "600")])
def test_a_table_of_positions_at_rest_needs_no_feed(tmp_path: Path, feed: Sequence[str]) -> None:
    rows = "".join(f"{x};{e};{e - 6}\n" for x in (0, 90, 210) for e in (0.1, 0.3, 0.2))
    (tmp_path / "x.csv").write_text("mm;1+;1-\n" + rows)

    made = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), *feed)

    assert f"skiplatch diagnose {tmp_path / 'campaign'}" in made.text
    assert "positions at rest: nothing shows that goes by time" in made.text
    assert "one feed" not in made.text
    assert "feed_mm_min" not in made.text
    with pytest.warns(CampaignWarning, match="time_s"):
        played = playable(made.campaign)
    assert played.touches.deviation_um.tolist() == pytest.approx(
        made.campaign.touches.deviation_um.tolist()
    )


def test_capture_that_a_german_spreadsheet_saved_is_read(tmp_path: Path) -> None:
    text = saleae(probe_idles_high=False).replace("Time[s]", "Time [s]")
    german = text.replace(", ", ";").replace(".", ",")
    (tmp_path / "c.csv").write_text(german)

    run = Run(tmp_path, "edges", str(tmp_path / "c.csv"), "--probe", "0", "--latch", "1")

    touches = run.campaign.touches
    assert touches.latch_us - touches.edge_us == pytest.approx(np.full(20, 40.0))


def test_thousands_may_be_parted_where_the_decimals_have_a_comma(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("mm;1 hin;1 zurück\n0,0;0,1;-5,9\n1.250,5;1,1;-4,9\n")

    run = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--axis", "X")

    assert sorted(set(run.campaign.touches.position_mm.tolist())) == [0.0, 1250.5]
    assert (run.campaign.touches.sign < 0.0).sum() == 2


def test_capture_is_no_table_of_iso_230(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "c.csv").write_text("Time [s],0,1\n0.0,0,0\n0.1,1,0\n")

    said = refused("import", "iso230", tmp_path / "c.csv", "-o", tmp_path / "made")

    assert "no runs of ISO 230-2, but edges of a capture: skiplatch import edges reads" in said


def test_table_of_times_is_no_table_of_positions(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("Time,Run 1,Run 2\n0.0,0.5,0.7\n0.1,1.5,1.2\n")

    said = refused("import", "iso230", tmp_path / "t.csv", "-o", tmp_path / "made")

    assert 't.csv:1: expected positions in the first column, got "Time"' in said


def runs_of_iso_230(folder: Path) -> Run:
    """Five runs either way: 10 µm/m too long, a reversal error of 6 µm, a scatter of 0.3 µm."""
    rng = np.random.default_rng(5)
    off_um = rng.normal(0.0, 0.3, (11, 10)) - np.tile([0.0, 6.0], 5)
    heads = ";".join(f"{run} {sense}" for run in range(1, 6) for sense in "↑↓")
    rows = [
        ";".join([str(50 * i), *(f"{0.5 * i + off:.1f}".replace(".", ",") for off in row)])
        for i, row in enumerate(off_um)
    ]
    (folder / "x.csv").write_text("\n".join([f"mm;{heads}", *rows]) + "\n")
    return Run(folder, "iso230", str(folder / "x.csv"), "--feed", "1000")


def test_runs_of_iso_230_tell_how_they_repeat(tmp_path: Path) -> None:
    run = runs_of_iso_230(tmp_path)

    assert run.campaign.nominal.probe.repeatability_um == pytest.approx(0.3, abs=0.1)
    assert "scatter of the runs about their middles, 88 degrees of freedom" in run.toml


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")
def test_scale_and_reversal_of_iso_230_are_told_apart(tmp_path: Path) -> None:
    """A repeatability that is guessed too wide took both errors for scatter."""
    found = diagnose(playable(runs_of_iso_230(tmp_path).campaign), seed=1)

    effects = {named.effect.id: named.effect.parameters for named in found.effects}
    assert effects["scale_error"]["scale_ppm"] == pytest.approx(10.0, abs=0.5)
    assert effects["backlash"]["backlash_um"] == pytest.approx(-6.0, abs=0.3)


def test_single_runs_of_iso_230_do_not_tell_how_they_repeat(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("mm;1+;1-\n0;0,1;-6\n100;1,1;-5\n")

    run = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--feed", "1000")

    assert run.campaign.nominal.probe.repeatability_um == 3.0  # of the preset


@pytest.mark.parametrize("text", ["a;b\n;\n", ";\n;\n", "a;b\nMittelwert;1\n", "Mittelwert\n1\n"])
def test_table_without_a_run_is_refused(tmp_path: Path, refused: Program, text: str) -> None:
    (tmp_path / "x.csv").write_text(text)

    said = refused("import", "iso230", tmp_path / "x.csv", "-o", tmp_path / "made")

    assert "x.csv: expected" in said or "x.csv:2: a: expected a number" in said


def test_runs_that_are_all_alike_do_not_tell_how_they_repeat(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("mm;1+;1-;2+;2-\n0;0,1;-6;0,1;-6\n100;1,1;-5;1,1;-5\n")

    run = Run(tmp_path, "iso230", str(tmp_path / "x.csv"), "--feed", "1000")

    assert run.campaign.nominal.probe.repeatability_um == 3.0  # of the preset
