"""``skiplatch import``: forms of logs and tables that other programs write by default."""

from pathlib import Path

import can
import numpy as np
import pytest
from click.testing import CliRunner

from bench_rig import c_frames
from refusals import Program
from skiplatch.bench.protocol import EDGE_ID, LATCH_ID
from skiplatch.cli import group
from test_import_logs import Run

HEAD = "sep=;\nDatum/Zeit;Richtung;Vorschub [mm/min];Abweichung [µm];Temperatur [°C]\n"
ROWS = "07.10.2025 08:15:00;+;100;33,3;21,3\n08.10.2025 08:15:14;-;300;-4,5;21,4\n"


@pytest.mark.parametrize("encoding", ["cp1252", "utf-16", "utf-8-sig", "utf-8"])
def test_table_of_a_spreadsheet_is_read_in_its_encoding(tmp_path: Path, encoding: str) -> None:
    table = tmp_path / "t.csv"
    table.write_bytes((HEAD + ROWS).replace("\n", "\r\n").encode(encoding))

    run = Run(
        tmp_path,
        *("csv", str(table), "--map", "time=Datum/Zeit", "--map", "sign=Richtung"),
        *("--map", "deviation_um=Abweichung", "--map", "temp_c=Temperatur [°C]"),
        *("--map", "feed_mm_min=Vorschub"),
    )

    touches = run.campaign.touches
    assert touches.deviation_um.tolist() == [33.3, -4.5]
    assert touches.temp_c.tolist() == [21.3, 21.4]
    assert touches.sign.tolist() == [1, -1]
    assert touches.time_s.tolist() == [0.0, 86_414.0]
    assert any("Windows-1252" in line for line in run.said["assumed"]) == (encoding == "cp1252")


def test_table_in_no_encoding_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_bytes(b"a,\x81\n1,2\n")

    said = refused("import", "csv", tmp_path / "t.csv", "--map", "deviation_um=a", "-o", "x")

    assert "t.csv" in said
    assert "not UTF-8 text" in said


@pytest.mark.parametrize(
    ("head", "mapping", "um"),
    [
        ("Error (in)", "deviation_um=Error (in)", 25_400.0),
        ("Error (in)", "deviation_um=Error", 25_400.0),
        ("Error [mm]", "deviation_um=Error [mm]", 1000.0),
        ("Error [\u03bcm]", "deviation_um=Error", 1.0),
        ("Error", "deviation_um=Error (mm)", 1000.0),
        ("Error", "deviation_um=Error", 1.0),
        ("Error (of X)", "deviation_um=Error (of X) [mm]", 1000.0),
        ("Error [mm] (of X)", "deviation_um=Error", 1000.0),
    ],
)
def test_unit_in_a_head_counts(tmp_path: Path, head: str, mapping: str, um: float) -> None:
    (tmp_path / "t.csv").write_text(f"{head};n\n1;1\n2;2\n", encoding="utf-8")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), "--map", mapping)

    assert run.campaign.touches.deviation_um.tolist() == pytest.approx([um, 2 * um])
    is_assumed = any("as none is named" in line for line in run.said["assumed"])
    assert is_assumed == (head == mapping.partition("=")[2] == "Error")


@pytest.mark.parametrize("head", ["Feed (furlong/h)", "Feed [furlong/h]", "Feed {furlong/h}"])
@pytest.mark.parametrize("is_given", [True, False])
def test_what_is_no_unit_in_brackets_is_refused(
    tmp_path: Path, refused: Program, head: str, is_given: bool
) -> None:
    (tmp_path / "t.csv").write_text(f"e [mm],{head}\n1,1\n")
    maps = ("--map", "deviation_um=e", "--map", f"feed_mm_min={head if is_given else 'Feed'}")

    said = refused("import", "csv", tmp_path / "t.csv", *maps, "-o", "x")

    assert 'feed_mm_min: unit "furlong/h" is none of mm/min, mm/s' in said
    assert f'if it is no unit, name one behind it: "{head} [mm/min]"' in said


def test_unit_other_than_that_of_the_head_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("Error [in],n\n1,1\n")

    said = refused(
        *("import", "csv", tmp_path / "t.csv", "--map", "deviation_um=Error [mm]", "-o", "x")
    )

    assert 'no column "Error"' in said
    assert "there are: Error [in], n" in said


def test_table_without_a_head_is_told(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("1.00000,2.00000,-12.00760\n1.00000,2.00000,-12.02457\n")

    said = refused("import", "csv", tmp_path / "t.csv", "--map", "coordinate_mm=Z", "-o", "x")

    assert "t.csv:1: expected a line of heads above the numbers, such as X [mm],Z [mm]" in said


LIST = "[G54:0.000,0.000,0.000]\n[G92:0.000,0.000,0.000]\n[TLO:0.000]\n"


@pytest.mark.parametrize(
    "listed",
    [
        f">>> $#\n{LIST}[PRB:0.000,0.000,-5.123:1]\nok\n",
        'Received offsets: "[TLO:0.000]; [PRB:0.000,0.000,-5.123:1]; ok"\n',
        "[08:00:01] [ $# ] [PRB:0.000,0.000,-5.123:1]\n[08:00:01] [ $# ] ok\n",
    ],
)
def test_last_touch_in_a_list_of_parameters_is_no_further_one(tmp_path: Path, listed: str) -> None:
    touch = "[08:00:00] >>> G38.2 Z-9 F60\n[PRB:0.000,0.000,-5.123:1]\nok\n"
    (tmp_path / "s.log").write_text(f"G21 G91\n{touch}{listed}{touch}")

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    assert run.campaign.touches.feed_mm_min.tolist() == [60.0, 60.0]


def test_replies_of_grbl_get_the_digits_of_their_steps(tmp_path: Path) -> None:
    touches = "".join(
        f"G38.2 Z-9 F60\n[PRB:0.000,0.000,{z}:1]\nok\n" for z in ("-5.123", "-5.125", "-5.128")
    )
    (tmp_path / "s.log").write_text(f"$102=400.000\nok\nG21 G91\n{touches}")

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    assert run.coordinates() == [-5.1225, -5.125, -5.1275]


def test_commands_sent_ahead_follow_the_touch_that_they_were_sent_after(tmp_path: Path) -> None:
    sent = "G38.2 Z-9 F60\nG0 Z3\nG38.2 Z-9 F240\nG0 Z2\n"
    answers = "[PRB:0.000,0.000,-5.000:1]\nok\nok\n[PRB:0.000,0.000,-5.000:1]\nok\nok\n"
    later = "G38.2 Z-9 F60\n[PRB:0.000,0.000,-5.000:1]\nok\n"
    (tmp_path / "s.log").write_text(f"G21 G91\n{sent}{answers}{later}")

    touches = Run(tmp_path, "grbl", str(tmp_path / "s.log")).campaign.touches

    assert touches.feed_mm_min.tolist() == [60.0, 240.0, 60.0]
    assert touches.approach_mm[1:].tolist() == [3.0, 2.0]


def test_reply_beyond_any_machine_is_left_as_it_is(tmp_path: Path) -> None:
    far = "9" * 400
    (tmp_path / "s.log").write_text(f"$102=400.000\n[PRB:0.000,0.000,{far}:1]\n")

    result = CliRunner().invoke(group, ["import", "grbl", str(tmp_path / "s.log"), "-o", "x"])

    assert not isinstance(result.exception, OverflowError)


def test_replies_between_the_steps_of_a_preset_tell_their_own(tmp_path: Path) -> None:
    (tmp_path / "s.log").write_text("[PRB:0.000,0.000,-5.121:1]\n[PRB:0.000,0.000,-5.124:1]\n")

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    assert run.campaign.nominal.axis.resolution_um == 1.0
    assert run.coordinates() == [-5.121, -5.124]


def test_reach_that_a_log_tells_is_that_of_the_axis(tmp_path: Path) -> None:
    head = "[MSG:INFO: FluidNC v3.7.18]\n[MSG:INFO: Axis Z (-110.000,5.000)]\n"
    (tmp_path / "f.log").write_text(f"{head}G91\nG38.2 Z-9 F60\n[PRB:0.000,0.000,-5.120:1]\nok\n")
    config = "[stepper_z]\nposition_min = -5\nposition_max: 235.5\n"
    (tmp_path / "klippy.log").write_text(f"{config}probe at 1.000,2.000 is z=0.125000\n")
    (tmp_path / "k").mkdir()

    fluid = Run(tmp_path, "grbl", str(tmp_path / "f.log")).campaign.nominal.axis
    klipper = Run(tmp_path / "k", "klipper", str(tmp_path / "klippy.log")).campaign.nominal.axis

    assert (fluid.min_mm, fluid.max_mm) == (-110.0, 5.0)
    assert (klipper.min_mm, klipper.max_mm) == (-5.0, 235.5)


def test_touches_of_unknown_feed_among_others_are_left_out(tmp_path: Path) -> None:
    reply = "[PRB:0.000,0.000,-5.120:1]\nok\n"
    (tmp_path / "s.log").write_text(reply + "G21 G91\n" + f"G38.2 Z-9 F60\n{reply}" * 3)

    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    lacking = Run(tmp_path / "a", "grbl", str(tmp_path / "s.log"))
    given = Run(tmp_path / "b", "grbl", str(tmp_path / "s.log"), "--feed", "60")

    assert lacking.campaign.touches.feed_mm_min.tolist() == [60.0] * 3
    assert any("unknown feed are left out" in line for line in lacking.said["could_not_be_read"])
    assert given.campaign.touches.feed_mm_min.tolist() == [60.0] * len(given.campaign.touches)
    assert len(given.campaign.touches) > 3


FORMS = {
    "times.txt": " ({i:017.6f})  can0  {id:03X}   [{n}]  {data}",
    "bare.log": "  can0  {id:03X}   [{n}]  {data}",
    "extra.log": " (2025-11-03 20:00:05.{i:06d})  can0  RX - -  {id:03X}   [{n}]  {data}",
    "named.asc": "({i}.000000) can0 {id:03X}#{packed}",
}


@pytest.mark.parametrize("name", FORMS)
def test_candump_is_read_as_people_write_it_down(tmp_path: Path, name: str) -> None:
    frames = [(EDGE_ID, f) for f in c_frames("edge 5000000000 0 0 1 0")]
    frames += [(LATCH_ID, f) for f in c_frames("latch 50000650 0 0 0 8")]
    lines = [
        FORMS[name].format(
            i=i, id=number, n=len(f), data=f.hex(" ").upper(), packed=f.hex().upper()
        )
        for i, (number, f) in enumerate([(0x7F0, b"\x01\x02"), *frames])
    ]
    (tmp_path / name).write_text("\n".join(lines) + "\n")

    touches = Run(tmp_path, "can", str(tmp_path / name)).campaign.touches

    assert (touches.latch_us - touches.edge_us).tolist() == pytest.approx([65.0])


def test_candump_goes_straight_to_repeat(tmp_path: Path) -> None:
    lines = []
    for i in range(3):
        lines.append(f"edge {5_000_000_000 + i * 100_000_000} {i} 12 1 {2 * i}")
        lines.append(f"latch {50_000_650 + i * 1_000_000} 0 {i} 0 8")
    frames = [(EDGE_ID if line.startswith("edge") else LATCH_ID, line) for line in lines]
    shown = [f"can0  {n:03X}   [8]  {f.hex(' ')}" for n, line in frames for f in c_frames(line)]
    (tmp_path / "bus.txt").write_text("\n".join(shown) + "\n")

    result = CliRunner().invoke(group, ["repeat", str(tmp_path / "bus.txt")])

    assert "log of CAN traffic, 3 touches" in result.output
    assert "3 latches come" in result.output


def capture(path: Path, edges_ms: list[float], latches_ms: list[float]) -> Path:
    changes = [(t, 0, 1) for t in edges_ms] + [(t + 0.01, 0, 0) for t in edges_ms]
    changes += [(t, 1, 1) for t in latches_ms] + [(t + 0.01, 1, 0) for t in latches_ms]
    levels, lines = [0, 0], ["Time [s],probe,latch", "-0.001,0,0"]
    for time_ms, channel, level in sorted(changes):
        levels[channel] = level
        lines.append(f"{time_ms / 1e3:.7f},{levels[0]},{levels[1]}")
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize(
    ("edges_ms", "latches_ms", "touches_ms"),
    [
        ([0, 0.5, 1.0, 1.5], [0.1, 0.6, 1.1, 1.6], [0, 0.5, 1.0, 1.5]),  # one latch each
        ([0, 0.05, 9], [0.1, 9.1], [0, 9]),  # a bounce before the latch
        ([0, 0.3, 9], [0.1, 9.1], [0, 9]),  # a bounce after it
        ([0, 0.5, 0.53, 9], [0.1, 0.6, 9.1], [0, 0.5, 9]),  # a bounce of the second touch
    ],
)
def test_edge_near_another_is_a_touch_if_it_has_a_latch_of_its_own(
    tmp_path: Path, edges_ms: list[float], latches_ms: list[float], touches_ms: list[float]
) -> None:
    path = capture(tmp_path / "c.csv", edges_ms, latches_ms)

    touches = Run(tmp_path, "edges", str(path)).campaign.touches

    assert (touches.edge_us / 1e3).tolist() == pytest.approx(touches_ms)
    assert not np.isnan(touches.latch_us).any()


def traffic(path: Path) -> Path:
    """Write three touches of a bench as candump -L does, or as ASC."""
    lines = []
    for i in range(3):
        lines.append((EDGE_ID, f"edge {5_000_000_000 + i * 100_000_000} {i} 12 1 {2 * i}"))
        lines.append((LATCH_ID, f"latch {50_000_650 + i * 1_000_000} 0 {i} 0 8"))
    frames = [(number, frame) for number, line in lines for frame in c_frames(line)]
    with can.Logger(path) as log:
        for i, (number, frame) in enumerate(frames):
            log(
                can.Message(
                    timestamp=1e9 + i, arbitration_id=number, data=frame, is_extended_id=False
                )
            )
    return path


LOGS = Path(__file__).parent / "data" / "logs"
MARKED = {
    "bus.log": "can",
    "bus.asc": "can",
    "capture.vcd": "edges",
    "saleae_latches.csv": "edges",
    "grbl_serial.log": "grbl",
    "klippy.log": "klipper",
    "marlin_m48.log": "marlin",
    "linuxcnc_probe.txt": "linuxcnc",
    "iso230_x.csv": "iso230",
}


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig"])
@pytest.mark.parametrize("name", MARKED)
def test_log_with_a_byte_order_mark_is_read_as_without(
    tmp_path: Path, name: str, encoding: str
) -> None:
    plain = traffic(tmp_path / name) if name.startswith("bus") else LOGS / name
    marked = tmp_path / "marked" / name
    marked.parent.mkdir()
    marked.write_bytes(plain.read_text(encoding="utf-8").encode(encoding))
    axis = ("--axis", "X") if MARKED[name] == "iso230" else ()
    folders = [tmp_path / "a", tmp_path / "b"]
    for folder in folders:
        folder.mkdir()

    runs = [
        Run(folder, MARKED[name], str(path), *axis)
        for folder, path in zip(folders, (plain, marked), strict=True)
    ]

    tables = [(folder / "campaign" / "touches.csv").read_text() for folder in folders]
    assert len(runs[0].campaign.touches) > 1
    assert tables[0] == tables[1]


@pytest.mark.parametrize("name", ["bus.log", "bus.asc"])
def test_marked_log_goes_straight_to_repeat(tmp_path: Path, name: str) -> None:
    text = traffic(tmp_path / name).read_text(encoding="utf-8")
    (tmp_path / name).write_bytes(text.encode("utf-16"))

    result = CliRunner().invoke(group, ["repeat", str(tmp_path / name)])

    assert result.exit_code == 0, result.output
    assert "latches come" in result.output


def test_two_bytes_a_character_without_a_mark_are_named(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "s.log").write_bytes("[PRB:0.000,0.000,-1.000:1]\n".encode("utf-16-le"))

    said = refused("import", "grbl", tmp_path / "s.log", "-o", tmp_path / "made")

    assert "UTF-16 without a byte order mark: save it as UTF-8" in said


COMMANDS = [["repeat"], *(["import", kind] for kind in ("grbl", "marlin", "klipper"))]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Send: G30\nRecv: Z:4.6062 C:737\nRecv: ok\n", "Smoothieware"),
        ("Recv: Z-probe:20.580 X:-0.01 Y:0.00\n", "Repetier-Firmware"),
        ("Recv: echo:Starting probe at 1\nRecv: echo:endstops hit:  Z:19.53\n", "Prusa's Buddy"),
        ('{"gc":"g38.2 z-10 f100"}\n{"prb":{"e":1,"x":0.0,"z":-5.1}}\n', "TinyG or g2core"),
    ],
)
def test_log_of_an_unknown_controller_says_what_to_do(
    tmp_path: Path, refused: Program, command: list[str], text: str, name: str
) -> None:
    (tmp_path / "c.log").write_text(text)
    out = ["-o", tmp_path / "x"] if command[0] == "import" else []

    said = refused(*command, tmp_path / "c.log", *out)

    assert f"c.log: touches of {name}" in said
    assert "whose logs are not read: put their coordinates into a table" in said
    assert "import csv --map coordinate_mm=Z" in said


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Recv: Delta Grid Probe...\nRecv: probe at 0,0 is 0.000000 mm\n", "Smoothieware"),
        ("Bed probe heights: -0.350 -0.387, mean -0.327\n", "RepRapFirmware (Duet)"),
        ("RepRapFirmware height map file v2 generated\nX,Y\n 0.1, 0.2\n", "RepRapFirmware (Duet)"),
        ("CurrentZ:21.09 atZ:19.00\n", "Repetier-Firmware"),
        ("Recv: Num X,Y: 7,7\nRecv: Measured points:\n", "Prusa's firmware"),
    ],
)
def test_map_of_a_bed_says_that_nothing_in_it_repeats(
    tmp_path: Path, refused: Program, command: list[str], text: str, name: str
) -> None:
    (tmp_path / "c.log").write_text(text)
    out = ["-o", tmp_path / "x"] if command[0] == "import" else []

    said = refused(*command, tmp_path / "c.log", *out)

    assert f"c.log: a map of the bed by {name}, with one touch of each place: touch one" in said
    assert "import csv --map coordinate_mm=Z" in said


@pytest.mark.parametrize(
    ("kind", "text", "got"),
    [
        ("marlin", "Bed Topography Report:\n 0 | -0.090 -0.010\nok\n", "got a mesh that is done"),
        ("marlin", "Bilinear Leveling Grid:\n 0 +0.090 -0.010\nok\n", "got a mesh that is done"),
        ("klipper", "touch accuracy results:\nmaximum 0.002000\n", "got results of a test alone"),
    ],
)
def test_results_without_touches_are_told_from_any_other_text(
    tmp_path: Path, refused: Program, kind: str, text: str, got: str
) -> None:
    (tmp_path / "p.log").write_text(text)

    assert got in refused("import", kind, str(tmp_path / "p.log"), "-o", str(tmp_path / "c"))


@pytest.mark.parametrize(
    ("kind", "text", "other"),
    [
        ("klipper", "1 of 2: z: 0.185\n2 of 2: z: 0.186\n", "marlin"),
        ("marlin", "[PRB:0.000,0.000,-5.123:1]\nok\n", "grbl"),
        ("grbl", "// probe at 10.000,10.000 is z=1.320000\n", "klipper"),
        ("grbl", " ".join(["1.000000"] * 9) + "\n", "linuxcnc"),
    ],
)
def test_log_of_another_kind_is_named(
    tmp_path: Path, refused: Program, kind: str, text: str, other: str
) -> None:
    (tmp_path / "p.log").write_text(text)

    said = refused("import", kind, str(tmp_path / "p.log"), "-o", str(tmp_path / "c"))

    assert f"no touches of {kind}, but of {other}: skiplatch import {other} reads them" in said


REPORT = """----------------------------------------------------
COMPONENT NO 1            FEATURE NO 1
----------------------------------------------------
SIZE D50.0000   ACTUAL 50.0204   TOL 0.0500     DEV 0.0204
POSN X80.0000   ACTUAL 79.9764   TOL TP 0.2000  DEV -0.0236
"""


@pytest.mark.parametrize(
    "command",
    [
        *COMMANDS,
        ["import", "csv", "--map", "deviation_um=DEV [mm]"],
        ["import", "csv", "--map", "coordinate_mm=ACTUAL", "--axis", "X"],
    ],
)
def test_report_of_features_says_what_to_print_instead(
    tmp_path: Path, refused: Program, command: list[str]
) -> None:
    """In the form that appendix G of the manual of Inspection Plus gives."""
    (tmp_path / "r.txt").write_text(REPORT)
    out = ["-o", tmp_path / "x"] if command[0] == "import" else []

    said = refused(*command, tmp_path / "r.txt", *out)

    assert "r.txt: a report of features, each worked out of several touches: print where" in said
    assert "DPRNT[X#5061[44]]" in said
