"""``skiplatch import``: logs of each kind, and what is said of them."""

import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bench_rig import c_frames
from refusals import Program
from skiplatch.bench.protocol import EDGE_ID, LATCH_ID
from skiplatch.campaign import Axis, Campaign, DatumFreedom, InputPath, Kind, Status, read_campaign
from skiplatch.cli import group
from skiplatch.errors import CampaignWarning
from skiplatch.importing.gcode_program import run as run_program
from skiplatch.repeatability import repeatability

LOGS = Path(__file__).parent / "data" / "logs"


class Run:
    """An import: what it wrote and said."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        out = folder / "campaign"
        words = [*arguments, "--out", str(out), "--json", str(folder / "said.json")]
        result = CliRunner().invoke(group, ["import", *words], catch_exceptions=False)
        assert result.exit_code == 0, result.output
        self.text = result.output
        self.said = json.loads((folder / "said.json").read_text())
        self.campaign: Campaign = read_campaign(out)
        self.toml = (out / "nominal.toml").read_text()

    def coordinates(self) -> list[float]:
        """Where each touch was latched; one alone is where its surface is."""
        t = self.campaign.touches
        is_alone = np.isnan(t.deviation_um) & (t.status == Status.OK)
        beyond_um = np.nan_to_num(t.sign, nan=1.0) * np.where(is_alone, 0.0, t.deviation_um)
        return [round(v, 6) for v in (t.position_mm + beyond_um / 1e3).tolist()]


def log(name: str) -> str:
    return str(LOGS / name)


def test_klipper_console_keeps_places_feeds_and_approaches(tmp_path: Path) -> None:
    run = Run(tmp_path, "klipper", log("klipper_octoprint.log"))

    assert run.coordinates() == [1.32, 1.3175, 1.325, 1.32, 1.3025, 1.315]
    assert set(run.campaign.touches.feed_mm_min) == {600.0}
    assert run.campaign.touches.approach_mm == pytest.approx(
        [1.99625, 2.00125, 1.99875, 2.00625, 2.00125, 1.98375]
    )
    assert (run.campaign.touches.sign == -1).all()
    assert "one feed: a delay and a length look alike; touch at a second feed" in run.text
    assert (
        "no times in the log: the order of the lines is that of the touches" in run.said["assumed"]
    )


def test_console_with_the_newest_line_first_is_turned_round(tmp_path: Path) -> None:
    run = Run(tmp_path, "klipper", log("klipper_newest_first.log"))

    assert run.coordinates() == [6.098598, 6.098598, 6.101098, 6.101098, 6.101098]
    assert run.campaign.touches.time_s.tolist() == pytest.approx([0, 6, 7, 8, 9], abs=0.1)


def test_klippy_log_gives_steps_temperatures_and_times(tmp_path: Path) -> None:
    run = Run(tmp_path, "klipper", log("klippy.log"))

    touches, nominal = run.campaign.touches, run.campaign.nominal
    assert nominal.axis.resolution_um == pytest.approx(1e3 * 8 / (200 * 16 * 10))
    assert nominal.axis.accel_mm_s2 == 100.0
    assert set(touches.feed_mm_min) == {300.0}
    assert touches.thermometers["heater_bed"].tolist() == [59.5, 59.5, 60.5, 60.5]
    assert touches.thermometers["frame"].tolist() == [31.2, 31.2, 31.4, 31.4]
    assert touches.time_s.tolist() == [0.0, 0.5, 1.0, 1.5]
    assert nominal.datum.free is DatumFreedom.SESSION
    assert len(touches.session_names) == 2
    assert run.coordinates() == [1.00125, 1.001875, 1.003125, 1.25]
    assert any("of 2 surfaces 1 touched once only" in line for line in run.said["assumed"])


def test_a_line_too_long_for_a_touch_is_left_out_and_said(tmp_path: Path) -> None:
    """Statistics of many micro-controllers are long, what others write into the log is longer."""
    stats = "Stats 99.9: " + " ".join(f"mcu{i}: send_seq=1010 freq=180000229" for i in range(200))
    assert len(stats) > 7_000
    text = (LOGS / "klippy.log").read_text()
    (tmp_path / "k.log").write_text(f"{stats}\nThumbnail: {'A' * 20_000}\n{text}")

    with pytest.warns(CampaignWarning, match=r"k\.log:2: lines .* left out: 1"):
        run = Run(tmp_path, "klipper", str(tmp_path / "k.log"))

    assert run.coordinates() == [1.00125, 1.001875, 1.003125, 1.25]


def test_grbl_commands_queued_before_their_replies_go_with_them(tmp_path: Path) -> None:
    run = Run(tmp_path, "grbl", log("grbl_serial.log"))

    touches = run.campaign.touches
    assert [Axis(a).name for a in touches.axis] == ["Z", "Z", "Z", "X"]
    assert touches.feed_mm_min.tolist() == [100, 25, 50, 60]
    assert touches.sign.tolist() == [-1, -1, -1, -1]
    assert touches.missed.tolist() == [False, False, True, False]
    assert touches.session_names[touches.session[3]].startswith("after homing 1")
    assert run.campaign.nominal.axis.resolution_um == 4.0
    assert run.coordinates()[:2] == [-7.125, -7.13]
    assert "probing moves that ended without a touch (:0]): 1" in run.said["known"]


def test_grbl_settings_of_the_axis_that_probed_count(tmp_path: Path) -> None:
    text = (LOGS / "grbl_serial.log").read_text().split(">>> $H")[0]
    (tmp_path / "z.log").write_text(text)

    run = Run(tmp_path, "grbl", str(tmp_path / "z.log"))

    assert run.campaign.nominal.axis.resolution_um == 2.5
    assert run.campaign.nominal.axis.accel_mm_s2 == 50.0
    assert "$102 of the log" in run.toml


def test_grbl_absolute_moves_give_the_sense_and_g53_the_approach(tmp_path: Path) -> None:
    lines = [">>> G90 G0 X5", ">>> G38.2 X20 F60", "[PRB:-87.000,0.000,0.000:1]", "ok"]
    lines += [">>> G0 X40", ">>> G38.2 X20 F60", "[PRB:-65.000,0.000,0.000:1]", "ok"]
    lines += [">>> G90 G53 G0 X-60", ">>> G91 G38.2 X-8 F60", "[PRB:-65.001,0.000,0.000:1]", "ok"]
    (tmp_path / "x.log").write_text("\n".join(lines) + "\n")

    touches = Run(tmp_path, "grbl", str(tmp_path / "x.log")).campaign.touches

    assert touches.sign.tolist() == [1.0, -1.0, -1.0]
    assert np.isnan(touches.approach_mm[:2]).all()
    assert touches.approach_mm[2] == pytest.approx(5.0005)


def test_grbl_echoes_within_the_marks_of_a_page_are_read(tmp_path: Path) -> None:
    run = Run(tmp_path, "grbl", log("grbl_echoed.log"), "--inch")

    assert run.coordinates() == [round(25.4 * v, 6) for v in (-3.0375, -2.9454, -3.2879, -3.3772)]
    assert run.campaign.touches.sign.tolist() == [-1, -1, 1, 1]
    assert set(run.campaign.touches.feed_mm_min) == {25.4}


def test_command_that_stands_there_with_each_answer_counts_once(tmp_path: Path) -> None:
    run = Run(tmp_path, "grbl", log("fluidnc_answered.log"))

    touches = run.campaign.touches
    assert touches.feed_mm_min.tolist() == [200, 80]
    assert touches.sign.tolist() == [1, 1]
    assert touches.approach_mm[1] == pytest.approx(
        (44.643 - 44.572) / 2 + 3, abs=6e-4
    )  # to the middle of both
    assert touches.time_s.tolist() == pytest.approx([0, 3 - (44.643 - 41.572) / 80 * 60], abs=1e-5)


def test_replies_without_commands_are_read_with_what_is_not_known(tmp_path: Path) -> None:
    (tmp_path / "r.log").write_text("[PRB:0.000,0.000,-1.000:1]\r\n[PRB:0.000,0.000,-1.003:1]\r\n")

    run = Run(tmp_path, "grbl", str(tmp_path / "r.log"))

    assert run.coordinates() == [-1.0, -1.003]
    assert np.isnan(run.campaign.touches.feed_mm_min).all()
    assert any("2 replies have no command" in line for line in run.said["assumed"])
    assert any(line.startswith("the feed is not known") for line in run.said["assumed"])


def test_marlin_means_give_more_digits_than_are_printed(tmp_path: Path) -> None:
    run = Run(tmp_path, "marlin", log("marlin_m48.log"), "--feed", "120")

    assert run.coordinates() == pytest.approx([0.01125, 0.01125, 0.01, -0.2675, 0.0075], abs=2e-6)
    assert set(run.campaign.touches.feed_mm_min) == {120.0}


def test_marlin_g30_after_a_test_counts(tmp_path: Path) -> None:
    run = Run(tmp_path, "marlin", log("marlin_test_and_g30.log"), "--feed", "120")

    assert len(run.coordinates()) == 5 + 12


def test_klipper_console_of_today_gives_feeds_and_temperatures(tmp_path: Path) -> None:
    run = Run(tmp_path, "klipper", log("klipper_three_speeds.log"))

    touches = run.campaign.touches
    assert touches.feed_mm_min.tolist() == [120.0] * 10 + [300.0] * 10 + [600.0] * 10
    assert set(touches.thermometers["bed"][1:].tolist()) == {60.1}


def test_speeds_are_read_as_people_type_them(tmp_path: Path) -> None:
    console = tmp_path / "console.log"
    touch = "Send: PROBE PROBE_SPEED={}\nRecv: // probe at 10.000,10.000 is z={:.6f}\nRecv: ok\n"
    console.write_text(
        "".join(touch.format(v, z) for v, z in ((".5", 1.0), ("2.", 1.1), ("5", 1.0)))
    )

    run = Run(tmp_path, "klipper", str(console))

    assert run.campaign.touches.feed_mm_min.tolist() == [30.0, 120.0, 300.0]


def test_marlin_g30_goes_on_past_midnight(tmp_path: Path) -> None:
    run = Run(tmp_path, "marlin", log("marlin_g30.log"))

    assert run.coordinates() == [0.12, 0.13, 0.11]
    assert run.campaign.touches.time_s.tolist() == [0, 43190, 43194]
    assert run.campaign.nominal.axis.resolution_um == 2.5
    assert run.campaign.touches.thermometers["bed"].tolist() == [60.25] * 3
    assert any("mm/min); give --feed" in line for line in run.said["assumed"])


def test_linuxcnc_log_gets_feeds_and_senses_from_its_program(tmp_path: Path) -> None:
    run = Run(
        tmp_path, "linuxcnc", log("linuxcnc_probe.txt"), "--program", log("linuxcnc_probe.ngc")
    )

    touches = run.campaign.touches
    assert touches.feed_mm_min.tolist() == [100, 400] * 3
    assert (touches.path == InputPath.PLC).all()
    assert run.campaign.nominal.plc.scan_us == 1000.0
    assert touches.approach_mm[1] == pytest.approx(5.001205)  # to the reference
    assert run.coordinates()[:2] == [0.001234, -0.006321]
    assert run.said["could_not_be_read"] == ["1 lines that do not hold 9 numbers: line 6"]


def test_linuxcnc_program_with_other_count_gives_what_all_moves_share(tmp_path: Path) -> None:
    (tmp_path / "p.ngc").write_text("G20 G91\nG38.2 Z-1 F4\n")

    run = Run(tmp_path, "linuxcnc", log("linuxcnc_probe.txt"), "--program", str(tmp_path / "p.ngc"))

    assert run.campaign.touches.feed_mm_min.tolist() == pytest.approx([101.6] * 6)
    assert run.coordinates()[0] == pytest.approx(0.001234 * 25.4, abs=1e-6)
    assert any("6 lines and the program 1 probing moves" in line for line in run.said["assumed"])


def test_linuxcnc_subroutine_gives_each_touch_its_feed_and_sense(tmp_path: Path) -> None:
    program = log("linuxcnc_bore.ngc")

    run = Run(tmp_path, "linuxcnc", log("linuxcnc_bore.txt"), "--program", program)

    touches = run.campaign.touches
    assert touches.feed_mm_min.tolist() == pytest.approx([50.8, 203.2] * 16)
    assert touches.sign.tolist() == [1, 1, -1, -1] * 8
    found = repeatability(run.campaign)
    assert found.slope is not None
    assert found.slope.low < 4.0 < found.slope.high


@pytest.mark.parametrize(
    ("program", "feeds"),
    [
        (
            "o1 sub\nF#1\nG38.2 Z-1\no1 endsub\no1 call [60]\no1 call [#1]\no1 call",
            [60, None, None],
        ),
        ("#1=0\nF9\nG91\no2 do\nG38.2 Z-1\n#1=[#1+1]\no2 while [#1 LT 3]\nM2", [9, 9, 9]),
        ("o3 sub\nG38.2 Z-1\no3 return\nG38.2 Z-2\no3 endsub\nF7\no3 call\no3 call", [7, 7]),
        ("o4 sub\nF5\nG38.2 Z-1\no4 call\no4 endsub\no4 call", [5] * 20),
        ("F3\nG38.2 Z-1\no5 call\no6 endwhile\no7 endsub\nG38.2 Z-1", [3, 3]),
        (f"F{'9' * 400}.\no8 repeat [{'9' * 400}.]\no8 endrepeat\nG38.2 Z-1", [None]),
    ],
)
def test_flow_of_a_program_is_carried_out(program: str, feeds: list[float | None]) -> None:
    assert [move.feed for move in run_program(program, [(0.0,) * 9] * 9).moves] == feeds


@pytest.mark.long
def test_a_program_without_an_end_is_run_as_far_as_its_log_can_reach() -> None:
    endless = "o1 while [1]\nG0 Z5\nG38.2 Z-5 F100\no1 endwhile\n"

    moves = {
        touches: len(run_program(endless, [(0.0,) * 9] * touches).moves) for touches in (5, 4_000)
    }

    assert 5 <= moves[5] <= 4_000 <= moves[4_000]


def test_linuxcnc_log_alone_finds_its_axis(tmp_path: Path) -> None:
    run = Run(tmp_path, "linuxcnc", log("linuxcnc_probe.txt"), "--feed", "50")

    assert {Axis(a) for a in run.campaign.touches.axis} == {Axis.Z}
    assert any(line.startswith("axis Z, whose") for line in run.said["assumed"])


@pytest.mark.parametrize(
    ("name", "latched_us"),
    [("saleae.csv", [12.5, 13.0, np.nan]), ("capture.vcd", [12.0, 14.0])],
)
def test_edges_and_latches_are_a_bench(tmp_path: Path, name: str, latched_us: list[float]) -> None:
    run = Run(tmp_path, "edges", log(name))

    touches = run.campaign.touches
    assert run.campaign.nominal.kind is Kind.BENCH
    np.testing.assert_allclose(touches.latch_us - touches.edge_us, latched_us, atol=1e-3)
    assert touches.missed.tolist() == np.isnan(latched_us).tolist()


def test_capture_with_dates_is_read(tmp_path: Path) -> None:
    run = Run(tmp_path, "edges", log("saleae_dates.csv"))

    touches = run.campaign.touches
    waits_us = touches.latch_us - touches.edge_us
    assert len(touches) == 40
    assert ((waits_us >= 20.0) & (waits_us <= 25.0)).all()
    assert np.diff(touches.edge_us).min() > 50_000.0
    assert "no times" not in run.text
    assert "Odd" not in run.text


def test_stretch_without_a_channel_is_no_edge(tmp_path: Path) -> None:
    lines = ["Time [s],probe,latch", "0,X,X", "1,0,0", "2,1,0", "2.001,1,1", "3,0,0", "4,X,X"]
    lines += ["5,1,0", "6,0,0", "7,1,0", "7.002,1,1"]
    (tmp_path / "gap.csv").write_text("\n".join(lines) + "\n")

    touches = Run(tmp_path, "edges", str(tmp_path / "gap.csv")).campaign.touches

    waits_us = (touches.latch_us - touches.edge_us).tolist()
    assert waits_us[0] == pytest.approx(1000.0)
    assert waits_us[-1] == pytest.approx(2000.0)


def test_samples_of_sigrok_as_csv_have_their_rate(tmp_path: Path) -> None:
    head = ["; CSV generated by libsigrok 0.5.2", "; Channels (2/8): D0, D1"]
    samples = 3 * (40 * ["0,0"] + 5 * ["1,0"] + 20 * ["1,1"])
    lines = [*head, "; Samplerate: 2 kHz", "logic,logic", *samples]
    (tmp_path / "s.csv").write_text("\n".join(lines) + "\n")

    run = Run(tmp_path, "edges", str(tmp_path / "s.csv"), "--probe", "D0")

    touches = run.campaign.touches
    assert (touches.latch_us - touches.edge_us).tolist() == pytest.approx([2500.0] * 3)
    assert np.diff(touches.edge_us).tolist() == pytest.approx([32_500.0] * 2)
    assert run.campaign.nominal.skip.tick_us == pytest.approx(500.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Time [s],a,b\n0,0,0\nlater,1,0\n", "x.csv:3: expected a time, got"),
        ("Time [s],a,b\n0,0,0\n1,2,0\n", "x.csv:3: expected levels 0 and 1, got"),
        ("Time [s],a,b\n0,0\n", "x.csv:2: expected levels of 2 channels, got 1"),
        ("Time [ticks],a,b\n0,0,0\n", "x.csv:1: expected a unit of time such as [s] or [us]"),
        ("\nmicroseconds,logic,logic\n0,0,0\n", 'x.csv:2: two channels are named "logic"'),
        ("Time [s]\n0\n", "expected"),
        ("; Samplerate: 0 Hz\na,b\n0,0\n1,0\n", "sample rate"),
        ("2024-01-01T00:00:00,0,0\n", "expected a header"),
        ("", "an empty file"),
    ],
)
def test_capture_that_is_none_is_refused(
    text: str, message: str, tmp_path: Path, refused: Program
) -> None:
    (tmp_path / "x.csv").write_text(text)

    out = tmp_path / "out"
    assert message in refused("import", "edges", tmp_path / "x.csv", "--out", out)
    assert not out.exists()


BOTH_PATHS = """Time [s],probe,skip,plc
0,0,0,0
1,1,0,0
1.00002,1,1,0
1.0032,1,1,1
2,0,0,0
3,1,0,0
3.00003,1,1,0
4,0,0,0
"""


def test_latches_of_a_plc_task_are_touches_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "both.csv").write_text(BOTH_PATHS)
    words = ("--plc-latch", "plc", "--scan-us", "4000")

    run = Run(tmp_path, "edges", str(tmp_path / "both.csv"), "--latch", "skip", *words)

    touches = run.campaign.touches
    assert touches.on_plc.tolist() == [False, True, False, True]
    assert touches.missed.tolist() == [False, False, False, True]
    waits_us = touches.latch_us - touches.edge_us
    np.testing.assert_allclose(waits_us, [20.0, 3200.0, 30.0, np.nan], atol=1e-3)
    assert run.campaign.nominal.plc.scan_us == 4000.0
    assert "channels: probe probe, latch skip, latch of the PLC task plc" in run.said["known"]


def test_a_capture_may_have_latches_of_a_plc_task_only(tmp_path: Path) -> None:
    (tmp_path / "both.csv").write_text(BOTH_PATHS)

    run = Run(tmp_path, "edges", str(tmp_path / "both.csv"), "--plc-latch", "plc")

    assert run.campaign.touches.on_plc.tolist() == [True, True]


def test_bounces_are_one_edge(tmp_path: Path) -> None:
    run = Run(tmp_path, "edges", log("saleae.csv"))

    assert run.campaign.touches.edge_us.tolist() == [0.0, 1e6, 2e6]
    (said,) = (line for line in run.said["assumed"] if line.startswith("1 edges so near"))
    assert "which of them was latched cannot be told from it" in said


@pytest.mark.parametrize(
    ("latched_us", "said"),
    [
        ((70, 75), ["2 latches of D1 come after a bounce, 11.5 µs (9 … 14) after the last"]),
        ((20, 75), ["1 latches of D1 come after a bounce, 14 µs (14 … 14) after the last"]),
        ((20, 21), []),
    ],
)
def test_latches_after_a_bounce_are_told_from_the_last_one_on(
    tmp_path: Path, latched_us: tuple[int, int], said: list[str]
) -> None:
    rows = ["Time [us],D0,D1", "0,0,0"]
    for start, wait in zip((1000, 9000), latched_us, strict=True):
        changes = {0: "1,0", 30: "0,{0}", 61: "1,{0}", wait: "1,1", 3000: "0,1", 3001: "0,0"}
        for after, levels in sorted(changes.items()):
            rows.append(f"{start + after},{levels.format(int(after > wait))}")
    (tmp_path / "c.csv").write_text("\n".join(rows) + "\n")

    known = Run(tmp_path, "edges", str(tmp_path / "c.csv")).said["known"]

    told = [line for line in known if "come after a bounce" in line]
    assert [line.partition(" edge before")[0] for line in told] == said


def test_channels_are_named_or_numbered(tmp_path: Path, refused: Program) -> None:
    turned = Run(tmp_path, "edges", log("saleae.csv"), "--probe", "1", "--latch", "Channel 0")
    said = refused(
        *("import", "edges", log("saleae.csv"), "--probe", "Chanel 0", "-o", tmp_path / "x")
    )

    assert len(turned.campaign.touches) == 2
    assert 'no channel "Chanel 0"; did you mean "Channel 0"?; there are: Channel 0, ' in said


def test_session_of_sigrok_is_read(tmp_path: Path) -> None:
    samples = bytearray(1000)
    samples[100:200] = bytes([0b01]) * 100
    samples[112:150] = bytes([0b11]) * 38
    metadata = (
        "[global]\nsigrok version=0.5.2\n[device 1]\ncapturefile=logic-1\ntotal probes=2\n"
        "samplerate=1 MHz\nprobe1=D0\nprobe2=D1\nunitsize=1\n"
    )
    with zipfile.ZipFile(tmp_path / "s.sr", "w") as archive:
        archive.writestr("version", "2")
        archive.writestr("metadata", metadata)
        archive.writestr("logic-1-2", bytes(samples[500:]))
        archive.writestr("logic-1-1", bytes(samples[:500]))

    run = Run(tmp_path, "edges", str(tmp_path / "s.sr"))

    assert run.campaign.touches.latch_us.tolist() == [12.0]
    assert run.campaign.nominal.skip.tick_us == 1.0
    assert run.campaign.nominal.bench.reference_jitter_us == pytest.approx(0.2887, abs=1e-4)


@pytest.mark.parametrize("line", ["unitsize=0", "unitsize=x", "samplerate=0 Hz"])
def test_session_of_sigrok_with_an_impossible_figure_is_refused(
    line: str, tmp_path: Path, refused: Program
) -> None:
    head = "[device 1]\ncapturefile=logic-1\nprobe1=D0\nprobe2=D1\n"
    name = line.split("=", maxsplit=1)[0]
    others = {"unitsize": "samplerate=1 MHz\n", "samplerate": "unitsize=1\n"}[name]
    with zipfile.ZipFile(tmp_path / "s.sr", "w") as archive:
        archive.writestr("metadata", head + others + line + "\n")
        archive.writestr("logic-1", bytes(100))

    said = refused("import", "edges", tmp_path / "s.sr", "-o", tmp_path / "x")

    assert "s.sr: expected a " in said


def test_vcd_with_a_time_beyond_any_clock_is_refused(tmp_path: Path, refused: Program) -> None:
    text = (LOGS / "capture.vcd").read_text()
    (tmp_path / "late.vcd").write_text(text + f"#{'9' * 400}\n")

    said = refused("import", "edges", tmp_path / "late.vcd", "-o", tmp_path / "x")

    assert "late.vcd:22:1: expected times up to 2^63" in said


@pytest.mark.parametrize(
    ("name", "function"),
    [
        ("capture.vcd", "captures.only_changes"),
        ("saleae.csv", "capture_csv._times"),
        ("bus.log", "can_frames._extended"),
    ],
)
def test_a_fault_of_the_importers_own_is_not_taken_for_a_bad_file(
    name: str, function: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    (tmp_path / "bus.log").write_text(f"(1.000000) can0 {LATCH_ID:03X}#0011223344556677\n")
    monkeypatch.setattr(f"skiplatch.importing.{function}", fail)
    path = tmp_path / name if name == "bus.log" else LOGS / name
    kind = "can" if name == "bus.log" else "edges"

    result = CliRunner().invoke(group, ["import", kind, str(path), "-o", str(tmp_path / "x")])

    assert isinstance(result.exception, ZeroDivisionError)


def test_iso_table_gives_positions_runs_and_senses(tmp_path: Path) -> None:
    run = Run(tmp_path, "iso230", log("iso230_x.csv"), "--axis", "Y", "--feed", "1000")

    touches = run.campaign.touches
    assert touches.position_mm.tolist() == [0, 100, 200, 200, 100, 0, 0, 100, 200, 100, 0]
    zero = 0.627  # of the positive sense at position 0, by the common slope
    assert (touches.deviation_um + touches.sign * zero).tolist()[:6] == pytest.approx(
        [0.5, 1.5, 2.5, 0.5, 1.5, 2.5]
    )
    assert touches.sign.tolist()[2:4] == [1, -1]
    assert touches.session_names == ("",)  # a session each would hide the reversal error


@pytest.mark.parametrize(
    "words",
    [
        ("iso230", log("iso230_x.csv")),
        ("csv", log("table.csv"), "--map", "deviation_um=Error (mm) [mm]"),
    ],
)
def test_last_digit_of_a_table_is_its_resolution(words: tuple[str, ...], tmp_path: Path) -> None:
    nominal = Run(tmp_path, *words, "--axis", "X").campaign.nominal

    assert nominal.axis.resolution_um == pytest.approx(0.1)


def test_rotary_table_is_in_degrees(tmp_path: Path) -> None:
    text = Path(log("iso230_x.csv")).read_text(encoding="utf-8")
    (tmp_path / "b.csv").write_text(text.replace("mm", "deg", 1))

    run = Run(tmp_path, "iso230", str(tmp_path / "b.csv"), "--axis", "B")

    assert run.campaign.touches.position_deg.tolist()[:3] == [0, 100, 200]
    assert np.diff(run.campaign.touches.deviation_arcsec).tolist()[:2] == pytest.approx([1, 1])


def test_any_table_is_mapped_with_its_units(tmp_path: Path) -> None:
    run = Run(
        tmp_path,
        *("csv", log("table.csv"), "--axis", "X", "--sign", "-1", "--map", "time=When"),
        *("--map", "deviation_um=Error (mm) [mm]", "--map", "feed_mm_min=Speed"),
        *("--map", "position_mm=Where [in]"),
    )

    touches = run.campaign.touches
    assert touches.time_s.tolist() == [0, 5, 10]
    assert touches.deviation_um.tolist()[:2] == pytest.approx([12.3, -4.5])
    assert touches.position_mm.tolist() == pytest.approx([266.7] * 3)
    assert {Axis(a) for a in touches.axis} == {Axis.X}
    assert run.said["could_not_be_read"] == ["columns that no --map names: Remark"]


def test_coordinates_of_a_table_are_held_against_their_surface(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("z;place\n1,5;1\n1,502;1\n7,25;2\n")

    run = Run(
        tmp_path,
        *("csv", str(tmp_path / "t.csv"), "--map", "coordinate_mm=z", "--map", "session=place"),
    )

    assert run.coordinates() == [1.5, 1.502, 7.25]
    assert run.campaign.nominal.datum.free is DatumFreedom.SESSION


@pytest.mark.parametrize(
    ("mapping", "message"),
    [
        (
            "deviation_mm=x",
            '"deviation_mm" is no column of a campaign; did you mean "deviation_um"',
        ),
        ("deviation_um=Error [furlong]", 'deviation_um: unit "furlong" is none of µm, um, mm'),
        ("nothing", "expected COLUMN=HEAD"),
    ],
)
def test_wrong_mapping_is_told(tmp_path: Path, mapping: str, message: str) -> None:
    arguments = ["import", "csv", log("table.csv"), "--map", mapping, "-o", str(tmp_path / "x")]

    result = CliRunner().invoke(group, arguments)

    assert result.exit_code == 2
    assert message in result.output


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("linuxcnc", "expected lines of 9 numbers"),
        ("grbl", "expected replies such as [PRB:"),
        ("klipper", "expected lines such as"),
        ("marlin", "expected lines such as"),
        ("edges", "expected a header such as"),
        ("can", "python-can"),
        ("iso230", "expected a number"),
    ],
)
def test_log_of_another_kind_is_told_and_nothing_written(
    tmp_path: Path, refused: Program, kind: str, words: str
) -> None:
    (tmp_path / "other.txt").write_text("what, is\nthis, then\n")

    said = refused("import", kind, tmp_path / "other.txt", "--out", tmp_path / "x")

    assert said.startswith(f"skiplatch: {tmp_path}/other.txt")
    assert words in said
    assert not (tmp_path / "x").exists()


def test_occupied_folder_is_refused_before_the_work(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").write_text("")

    said = refused("import", "grbl", tmp_path / "none.log", "-o", tmp_path / "full")

    assert "full: exists already and is not an empty folder" in said


@pytest.fixture
def candump(tmp_path: Path) -> Callable[..., Path]:
    """A log of what the C codec makes of lines."""

    def write(*lines: str) -> Path:
        ids = {"edge": EDGE_ID, "latch": LATCH_ID}
        frames = [(ids[line.split()[0]], frame) for line in lines for frame in c_frames(line)]
        text = "".join(
            f"(1700000000.{i:06d}) can0 {number:03X}#{frame.hex().upper()}\n"
            for i, (number, frame) in enumerate(frames)
        )
        (tmp_path / "bus.log").write_text(text)
        return tmp_path / "bus.log"

    return write


WRAP_NS = 2**32 * 100


def test_edges_and_latches_of_a_candump_go_together_over_the_wrap(
    tmp_path: Path, candump: Callable[..., Path]
) -> None:
    lines = []
    for number in range(4):
        edge_ns = WRAP_NS - 1_500_000_000 + number * 1_000_000_000
        latch_ticks = (edge_ns + 65_000) // 100 % 2**32
        lines.append(f"edge {edge_ns} {number} 12 1 0")
        if number != 2:
            sequence = number - (number > 2)
            lines.append(f"latch {latch_ticks} 0 {sequence} {int(number == 3)} 8")

    run = Run(tmp_path, "can", str(candump(*lines)))

    touches = run.campaign.touches
    late_us = (touches.latch_us - touches.edge_us).tolist()
    assert late_us[:2] == pytest.approx([65.0] * 2, abs=0.1)
    assert touches.missed.tolist() == [False, False, True, False]
    assert "edges without a latch: 1" in run.said["known"]


def test_latches_alone_are_read_with_what_they_cannot_tell(
    tmp_path: Path, candump: Callable[..., Path]
) -> None:
    run = Run(tmp_path, "can", str(candump("latch 10 0 0 0 8", "latch 4010 0 1 0 8")))

    assert run.campaign.touches.latch_us.tolist() == [0.0, 400.0]
    assert any(line.startswith("no edge reports on the bus") for line in run.said["assumed"])


def test_surface_touched_once_tells_nothing_of_the_scatter(tmp_path: Path) -> None:
    heights = (-3.21249, -3.21351, -3.2195, -3.21376, -3.21028, -3.2)
    rows = [f"{10.0 * i:.6f} 0.000000 {z:.6f}\n" for i, z in enumerate(heights)]
    (tmp_path / "grid.txt").write_text("".join(rows))
    run = Run(tmp_path, "linuxcnc", str(tmp_path / "grid.txt"), "--feed", "60")

    assert run.campaign.touches.position_mm.tolist() == list(heights)
    assert np.isnan(run.campaign.touches.deviation_um).all()
    assert run.said["odd"] == []
    assert any("6 touched once only, whose deviation" in line for line in run.said["assumed"])


def test_deviation_is_from_the_place_as_written(tmp_path: Path) -> None:
    rows = ["0.000000 0.000000 -0.071362\n"] * 5
    (tmp_path / "same.txt").write_text("".join(rows))
    run = Run(tmp_path, "linuxcnc", str(tmp_path / "same.txt"), "--feed", "60")

    assert set(run.campaign.touches.position_mm) == {-0.071362}
    assert set(run.campaign.touches.deviation_um) == {0.0}


@pytest.mark.parametrize(
    ("between", "sessions"),
    [
        ("Send: M851 Z-2.0", 2),
        ("echo:  M851 X-40.00 Y-10.00 Z-1.25 ; (mm)", 1),
        ("echo:  M851 Z-1.25\nSend: M851 Z-1.25", 1),
        ("echo:  M851 Z-1.25\nSend: M851 Z-1.30", 2),
    ],
)
def test_marlin_offset_of_the_probe_begins_a_session(
    tmp_path: Path, between: str, sessions: int
) -> None:
    bed = "Bed X: 100.00 Y: 100.00 Z: {}\n"
    text = bed.format(0.02) + bed.format(0.03) + between + "\n" + bed.format(0.52)
    (tmp_path / "m.log").write_text(text + bed.format(0.53))

    run = Run(tmp_path, "marlin", str(tmp_path / "m.log"))

    assert len(set(run.campaign.touches.session.tolist())) == sessions
    assert any("(M851)" in line for line in run.said["assumed"]) == (sessions == 2)
