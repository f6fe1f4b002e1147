"""What stands for the files that a user of the examples has: logs, maps, points, campaigns."""

import shutil
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from bench_rig import c_frames
from effects_rig import MACHINE
from rotary_machines import TABLE_TABLE, centres, plant, positions, write_machine, write_points
from seat_probe import OMP40, radii, write_radii, write_speeds
from skiplatch.bench.protocol import EDGE_ID, LATCH_ID
from skiplatch.campaign import write_campaign
from skiplatch.compensation import campaigns
from skiplatch.transmission.pulses import write_csv
from test_kinematics_probing import sphere
from test_pretravel_experiment import quick_result
from test_settle_command import LAG, made
from test_transmission_command import planted

ROOT = Path(__file__).parents[2]
LOGS = ROOT / "tests" / "python" / "data" / "logs"
SAMPLES = ROOT / "scripts" / "samples"
MAP_FEED_MM_MIN, MAP_TAU_MS = 50.0, 12.68


def _copy(source: Path, path: Path) -> None:
    (shutil.copytree if source.is_dir() else shutil.copyfile)(source, path)


def _capture(path: Path) -> None:
    text = (LOGS / "capture.vcd").read_text()
    path.write_text(text.replace(" probe ", " D0 ").replace(" latch ", " D1 "))


def _table(path: Path) -> None:
    path.write_text("Error,Remark\n0.002,a\n-0.001,\n0.001,\n")


def _gauge(path: Path) -> None:
    """Both faces of a gauge of 20 mm, at two feeds."""
    rows = "".join(f"plc,X,{s},{f},{10 - 10 * s},{f / 100}\n" for s in (1, -1) for f in (100, 400))
    path.write_text(f"path,axis,sign,feed_mm_min,position_mm,deviation_um\n{rows}")


def _bus_log(path: Path) -> None:
    """Three edges, each latched 65 µs later."""
    text = ""
    for number in range(3):
        edge_ns = (number + 1) * 1_000_000_000
        edge = c_frames(f"edge {edge_ns} {number} 12 1 0")
        latch = c_frames(f"latch {(edge_ns + 65_000) // 100} 0 {number} 0 8")
        for frame_id, frames in ((EDGE_ID, edge), (LATCH_ID, latch)):
            for frame in frames:
                text += f"({number + 1}.000000) can0 {frame_id:03X}#{frame.hex().upper()}\n"
    path.write_text(text)


def _recording(path: Path) -> None:
    asammdf = pytest.importorskip("asammdf", reason="asammdf is not installed: make mdf")
    times_s = np.arange(100_000) * 1e-6
    edge, latch = ((times_s % 0.03 > begin_s).astype(np.uint8) for begin_s in (0.01, 0.010012))
    signals = [asammdf.Signal(edge, times_s, name="Edge")]
    signals.append(asammdf.Signal(latch, times_s, name="Latch"))
    with asammdf.MDF(version="4.10") as recording:
        recording.append(signals)
        recording.save(path)


def _map(path: Path, seed: int = 1) -> None:
    write_radii(path, radii(OMP40, MAP_FEED_MM_MIN, MAP_TAU_MS, runs=5, sigma_um=0.3, seed=seed))


def _speeds(path: Path) -> None:
    write_speeds(path, MAP_TAU_MS)


def _pulses(path: Path) -> None:
    write_csv(path, [planted(1.0)])


def _probed(path: Path) -> None:
    campaigns.record(path.parent / "probed", quick_result("haas"))
    (path.parent / "probed" / campaigns.BEFORE).rename(path)


def _kinematics(path: Path) -> None:
    """Points and the machine that they are of, whichever of both is asked for."""
    rng = np.random.default_rng(1)
    machine = plant(TABLE_TABLE, rng)
    angles = positions(TABLE_TABLE)
    if path.suffix == ".toml":
        write_machine(path, machine)
    else:
        write_points(path, machine, angles, centres(machine, angles, rng, 1e-3))


def _sphere(path: Path, runs: int) -> None:
    rows = [(run, *point) for run in range(1, runs + 1) for point in sphere(12.5)]
    header = "run,x_mm,y_mm,z_mm" if runs > 1 else "x_mm,y_mm,z_mm"
    table = np.array(rows)[:, 0 if runs > 1 else 1 :]
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=header, comments="")


def _touched(path: Path, columns: tuple[str, ...], n: int, seed: int) -> None:
    write_campaign(path, MACHINE, made(LAG, columns, n, seed).touches)


STAND_INS: dict[str, Callable[[Path], None]] = {
    "klippy.log": partial(_copy, LOGS / "klippy.log"),
    "probe.txt": partial(_copy, LOGS / "linuxcnc_probe.txt"),
    "probe.ngc": partial(_copy, LOGS / "linuxcnc_probe.ngc"),
    "serial.log": partial(_copy, LOGS / "grbl_serial.log"),
    "x_axis.csv": partial(_copy, LOGS / "iso230_x.csv"),
    "m48.log": partial(_copy, LOGS / "marlin_m48.log"),
    "duet.log": partial(_copy, LOGS / "marlin_duet.log"),
    "capture.vcd": _capture,
    "t.csv": _table,
    "gauge.csv": _gauge,
    "bus.log": _bus_log,
    "bench.mf4": _recording,
    "radii.csv": _map,
    "radii2.csv": partial(_map, seed=2),
    "speeds.csv": _speeds,
    "campaign": _probed,
    "PULSES.csv": _pulses,
    "POINTS.csv": _kinematics,
    "points.csv": _kinematics,
    "MACHINE.toml": _kinematics,
    "machine.toml": _kinematics,
    "sphere.csv": partial(_sphere, runs=3),
    "build/touches.csv": partial(_sphere, runs=1),
    "quiet": partial(_copy, SAMPLES / "rig_nominal"),
    "FOLDER": partial(_copy, SAMPLES / "bench_isr_latency"),
    "tied": partial(_touched, columns=("deviation_um",), n=150, seed=3),
    "made": partial(_touched, columns=("latch_us", "deviation_um"), n=40, seed=4),
}
"""By the last words of its path: who makes it there."""


def put(words: Sequence[str]) -> None:
    """Make the files that a command names, but for those that it writes."""
    for before, word in zip(["", *words], words, strict=False):
        for name, make in STAND_INS.items():
            if word not in (name, f"build/{name}") or before in ("-o", "--out"):
                continue
            if not Path(word).exists():
                make(Path(word))
