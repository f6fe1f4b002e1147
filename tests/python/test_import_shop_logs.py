"""``skiplatch import``: logs in the forms that shops and printers have, each with what made it."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from skiplatch.campaign import Axis
from test_import_can import bus_log
from test_import_logs import Run

FEEDS = (60.0, 300.0)
DELAY_MS = 0.8
INCH = 25.4


def late_mm(feed: float) -> float:
    return feed / 60.0 * DELAY_MS / 1e3


def slope_ms(run: Run) -> float:
    """What a straight line of deviation over feed says; a delay makes it."""
    touches = run.campaign.touches
    slope, _ = np.polyfit(touches.feed_mm_min / 60.0, touches.deviation_um, 1)
    return float(slope)


def german_table(times: list[str]) -> str:
    """A protocol with a title, decimal commas and semicolons."""
    rows = ["Messprotokoll;;;", "Nr.;Uhrzeit;Z [mm];Vorschub [mm/min]"]
    for i, time in enumerate(times):
        feed = FEEDS[i % 2]
        z = f"{-12.3456 - late_mm(feed):+.4f}".replace(".", ",")
        rows.append(f"{i + 1};{time};{z};{feed:.1f}".replace(".0", ",0"))
    return "\r\n".join(rows) + "\r\n"


GERMAN = ("--map", "coordinate_mm=Z [mm]", "--map", "feed_mm_min=Vorschub [mm/min]")


@pytest.mark.parametrize(
    ("times", "seconds"),
    [
        (["8:15:00", "08:15:10,5", "08:15:20", "8:16:00,25"], [0.0, 10.5, 20.0, 60.25]),
        (["23:59:50", "00:00:05", "", "00:01:00"], [0.0, 15.0, np.nan, 70.0]),
        (["00:00:05", "23:59:50", "23:59", "23:58:00"], [125.0, 110.0, 60.0, 0.0]),
    ],
)
def test_times_of_day_go_on_past_midnight(
    tmp_path: Path, times: list[str], seconds: list[float]
) -> None:
    (tmp_path / "t.csv").write_text(german_table(times), encoding="utf-8-sig")

    run = Run(
        *(tmp_path, "csv", str(tmp_path / "t.csv"), *GERMAN, "--map", "time=Uhrzeit"),
        *("--axis", "Z", "--sign", "-1"),
    )

    np.testing.assert_allclose(run.campaign.touches.time_s, seconds)
    assert slope_ms(run) == pytest.approx(DELAY_MS, rel=0.05)
    assert (
        "times of day without a date: from one touch to the next less than half a day" in run.text
    )


def test_axes_with_their_senses_are_read(tmp_path: Path) -> None:
    rows = (
        "Achse;Sollwert [mm];Abweichung [mm];F\nX+;+100,0000;+0,0031;100\nZ-;-5,0000;-0,0022;600\n"
    )
    (tmp_path / "t.csv").write_text(rows)
    words = ("position_mm=Sollwert [mm]", "deviation_um=Abweichung [mm]", "feed_mm_min=F [mm/min]")
    maps = [part for word in (*words, "axis=Achse") for part in ("--map", word)]

    (tmp_path / "a").mkdir()
    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *maps, "--map", "sign=Achse")
    bare = Run(tmp_path / "a", "csv", str(tmp_path / "t.csv"), *maps)

    touches = run.campaign.touches
    assert touches.axis.tolist() == [Axis.X, Axis.Z]
    assert touches.sign.tolist() == [1.0, -1.0]
    assert touches.deviation_um.tolist() == [3.1, -2.2]
    assert 'axes from "Achse", whose senses --map sign=Achse takes' in bare.text


def shown(lines: list[str], stamp: Callable[[int, float], str], flags: str = "") -> list[str]:
    """Write a log of candump -L as candump shows it."""
    found = []
    for i, line in enumerate(lines):
        _, bus, frame = line.split()
        number, data = frame.split("#")
        spaced = " ".join(data[j : j + 2] for j in range(0, len(data), 2))
        found.append(
            f" {stamp(i, 0.05 * i)}  {bus}  {flags}{number}   [{len(data) // 2}]  {spaced}"
        )
    return found


STAMPS: Mapping[str, Callable[[int, float], str]] = {
    "-t a": lambda _, s: f"({1711044252.123456 + s:.6f})",
    "-t A": lambda _, s: f"(2024-03-21 18:04:{12.123456 + s:09.6f})",
    "-t z": lambda _, s: f"({s:010.6f})",
    "-t d": lambda i, _: f"({0.05 * bool(i):010.6f})",
    "none": lambda _, __: "",
}
FORMS: Mapping[str, Callable[[list[str]], list[str]]] = {
    "-L": lambda lines: lines,
    "-L, newer": lambda lines: [f"{line} R" for line in lines],
    "-L, ns": lambda lines: [line.replace(".000000)", ".000000000)") for line in lines],
    "-x": lambda lines: shown(lines, STAMPS["-t a"], "RX - -  "),
    "-a": lambda lines: [f"{line}   '..|A(..'" for line in shown(lines, STAMPS["-t a"])],
    "-c": lambda lines: [f"\x1b[1;34m{line}\x1b[0m" for line in shown(lines, STAMPS["-t a"])],
    **{name: partial(shown, stamp=stamp) for name, stamp in STAMPS.items()},
}
EDGES_NS = [5_000_000_000 + 50_000_000 * i for i in range(6)]
LATE_NS = [40_000, 41_000, 40_300, 40_800, 41_200, 40_100]


@pytest.mark.parametrize("form", FORMS)
def test_candump_is_read_with_whatever_options(tmp_path: Path, form: str) -> None:
    latches = [edge + late for edge, late in zip(EDGES_NS, LATE_NS, strict=True)]
    bus = Path(bus_log(tmp_path, EDGES_NS, latches))
    bus.write_text("\n".join(FORMS[form](bus.read_text().splitlines())) + "\n")

    run = Run(tmp_path, "can", str(bus))

    touches = run.campaign.touches
    late_us = [late / 1e3 for late in LATE_NS]
    assert touches.latch_us - touches.edge_us == pytest.approx(late_us)


@pytest.mark.parametrize(("words", "scale"), [("G21", 1.0), ("G20", 1.0 / INCH)])
def test_replies_of_grbl_in_inches_have_commands_in_either_unit(
    tmp_path: Path, words: str, scale: float
) -> None:
    lines = ["Grbl 1.1h ['$' for help]", "$13=1", "$102=250.000", "$122=10.000", "ok"]
    for i in range(8):
        feed = FEEDS[i % 2]
        z = -20.32 - late_mm(feed)
        lines += [f">>> {words} G91 G38.2 Z{-30 * scale:.4f} F{feed * scale:.6f}"]
        lines += [f"[PRB:-2.0000,-3.1250,{z / INCH:.4f}:1]", "ok", f">>> G0 Z{2 * scale:.5f}", "ok"]
    (tmp_path / "p.log").write_text("\n".join(lines) + "\n")

    run = Run(tmp_path, "grbl", str(tmp_path / "p.log"))

    touches = run.campaign.touches
    assert touches.feed_mm_min == pytest.approx(np.tile(FEEDS, 4), rel=1e-4)
    assert touches.position_mm == pytest.approx(-20.32, abs=0.004)
    assert touches.approach_mm[1:] == pytest.approx(2.0, abs=0.01)


def test_unit_of_temperature_changes_no_reading_of_marlin(tmp_path: Path) -> None:
    """Marlin prints readings in °C, whatever M149 says of those that it is given."""
    lines = ["Recv: echo:  M149 F ; Units in Fahrenheit", "Send: M48 P8 V4 X110 Y110"]
    lines += ["Recv: ok T:71.60 /32.00 B:60.40 /60.00 @:0 B@:64"]
    lines += ["Recv: M48 Z-Probe Repeatability Test", "Recv: Positioning the probe..."]
    zs = [-0.012, -0.015, -0.011, -0.01, -0.013, -0.012, -0.014, -0.012]
    lines += [
        f"Recv: {i + 1} of 8: z: {z:.3f} mean: {np.mean(zs[: i + 1]):.4f} sigma: "
        f"{np.std(zs[: i + 1]):.6f} min: {min(zs[: i + 1]):.3f} max: {max(zs[: i + 1]):.3f} "
        f"range: {np.ptp(zs[: i + 1]):.3f}"
        for i, z in enumerate(zs)
    ]
    (tmp_path / "m48.log").write_text("\n".join([*lines, "Recv: Finished!", "Recv: ok"]) + "\n")

    run = Run(tmp_path, "marlin", str(tmp_path / "m48.log"), "--feed", "120")

    touches = run.campaign.touches
    assert touches.deviation_um.tolist() == pytest.approx([-1e3 * (z + 0.012) for z in zs])
    rows = (tmp_path / "campaign" / "touches.csv").read_text().splitlines()[1:]
    assert all(",60.4," in f"{row}," and ",71.6," in f"{row}," for row in rows)


def test_meshes_and_accuracy_of_klipper_are_surfaces_by_place(tmp_path: Path) -> None:
    lines = [
        "[probe]",
        "pin = ^PG15",
        "speed = 5.0",
        "samples = 3",
        "sample_retract_dist = 2.0",
        "",
    ]
    rng = np.random.default_rng(3)

    def probed(x: float, y: float, base: float) -> str:
        return f"probe at {x:.3f},{y:.3f} is z={base + rng.normal(0.0, 0.003):.6f}"

    for mesh in range(2):
        lines += [
            "PROBE_ACCURACY at X:125.000 Y:125.000 Z:8.000 (samples=10 retract=2.000 speed=5.0)"
        ]
        lines += [probed(125, 125, 1.95) for _ in range(10)]
        lines += ["probe accuracy results: maximum 1.96, minimum 1.94, range 0.01, average 1.95"]
        lines += [
            probed(x, y, 1.9 + 0.001 * x) for y in (30, 220) for x in (30, 220) for _ in range(3)
        ]
        lines += [f"Mesh Bed Leveling Complete {mesh}"]
    (tmp_path / "klippy.log").write_text("\n".join(lines) + "\n")

    run = Run(tmp_path, "klipper", str(tmp_path / "klippy.log"))

    assert "44 touches of 5 surfaces" in run.text
    assert np.nanstd(run.campaign.touches.deviation_um) == pytest.approx(3.0, rel=0.4)
    assert set(run.campaign.touches.feed_mm_min) == {300.0}
