"""LinuxCNC's own latch beside ours, on the same touches: ``measure [--touches N] [--out FOLDER]``.

The real LinuxCNC, without a screen, probes a simulated surface by G38.2, at several feeds. At first
it latches by itself while the component looks on; then the component stands between, and what the
program finds in #5061 is what the component has latched. Errors are against where the surface was.
Touches in which the machine stalled are left out and counted: a tick of the servo thread came more
than a tenth of a period off its time shortly before, or the fast thread left out ticks around the
edge. (After a stall LinuxCNC makes up for lost ticks, and the axis leaps.) Prints a table; writes
figures.json.
"""

import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray

HERE = Path(__file__).parent
FEEDS_MM_MIN = (50, 200, 600, 1500, 3000)
BASE_NS = 100_000
SERVO_NS = 1_000_000
STALL = 0.1
"""Share of a servo period that a tick of it may be off its time."""
US_PER_MIN_BY_UM_PER_MM = 60_000.0
"""So many µs is an error of 1 µm at 1 mm/min."""
MODULES = Path("build/linuxcnc/modules")


@dataclass(frozen=True)
class Errors:
    """How far latches were from the surface: mean and largest absolute error."""

    mean_um: float
    max_um: float
    mean_us: float
    max_us: float


@dataclass(frozen=True)
class Row:
    """One feed, in one of the two ways to wire it."""

    mode: str
    feed_mm_min: int
    touches: int
    stalled: int
    linuxcnc: Errors
    skiplatch: Errors
    overtravel_mm: float


def missing() -> str | None:
    """Say what is not here of what this needs."""
    for tool in ("linuxcnc", "halcompile", "unshare", "setpriv"):
        if shutil.which(tool) is None:
            return f"no {tool}: scripts/setup/system.sh linuxcnc"
    if os.geteuid() != 0:
        return "no root, which gives LinuxCNC its own shared memory"
    return None


def build() -> None:
    """Build the component as its users do, and the simulated axis."""
    packed = Path("build/packages")
    packed.mkdir(parents=True, exist_ok=True)
    _made(Path(), sys.executable, "scripts/pack_firmware.py", str(packed))
    halcompile = str(shutil.which("halcompile"))
    MODULES.mkdir(parents=True, exist_ok=True)
    for source in (packed / "linuxcnc/skiplatch.comp", HERE / "touchrig.comp"):
        for file in source.parent.glob(f"{source.stem}.*"):
            shutil.copy(file, MODULES)
        _made(MODULES, halcompile, "--compile", source.name)


def _made(folder: Path, *command: str) -> None:
    """Run a step of the build in a folder; what it printed is shown if it fails."""
    done = subprocess.run(
        command,
        cwd=folder,
        check=False,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    )
    if done.returncode:
        print(done.stdout, file=sys.stderr)
    done.check_returncode()


def plan(touches: int, seed: int, bounces: int) -> list[dict[str, float]]:
    """Choose the touches: feeds in any order, contacts anywhere between two servo ticks.

    A move begins at a tick, so it is its length that has to differ, by more than a tick's way.
    """
    rng = np.random.default_rng(seed)
    feeds = rng.permutation(np.repeat(FEEDS_MM_MIN, touches))
    return [
        {
            "feed": int(feed),
            "surface": round(float(rng.uniform(10.0, 11.0)), 6),
            "sense": 1,
            "further": float(rng.uniform(0.0, 0.2)),
            "bounces": bounces,
        }
        for feed in feeds
    ]


def run(
    folder: Path,
    mode: str,
    touches: list[dict[str, float]],
    pins: Mapping[str, float],
    servo_ns: int = SERVO_NS,
) -> None:
    """Let LinuxCNC make the touches, into touches.csv and probe.log of the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "plan.json").write_text(json.dumps({"pins": dict(pins), "touches": touches}))
    subprocess.run(
        [HERE / "run.sh", MODULES, folder, mode, str(BASE_NS), str(servo_ns)], check=True
    )


def read(folder: Path) -> dict[str, FloatArray]:
    """Read the columns of touches.csv."""
    with (folder / "touches.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def on_time(columns: dict[str, FloatArray], servo_ns: int = SERVO_NS) -> NDArray[np.bool_]:
    """Tell the touches around which the machine did not stall."""
    servo = columns["off_us"] <= STALL * servo_ns / 1000.0
    return servo & (columns["window_us"] <= 2.0 * BASE_NS / 1000.0)


def errors(latched_mm: FloatArray, surface_mm: FloatArray, feed_mm_min: float) -> Errors:
    """Sum up absolute errors."""
    um = 1000.0 * np.abs(latched_mm - surface_mm)
    us = US_PER_MIN_BY_UM_PER_MM / feed_mm_min
    mean, largest = float(um.mean()), float(um.max())
    return Errors(mean, largest, mean * us, largest * us)


def table(mode: str, columns: dict[str, FloatArray]) -> list[Row]:
    """Sum up each feed."""
    rows = []
    for feed in FEEDS_MM_MIN:
        at_feed = columns["feed_mm_min"] == feed
        good = at_feed & on_time(columns)
        if not good.any():
            continue
        surface = columns["surface_mm"][good]
        rows.append(
            Row(
                mode,
                feed,
                int(good.sum()),
                int((at_feed & ~good).sum()),
                errors(columns["linuxcnc_mm"][good], surface, feed),
                errors(columns["skiplatch_mm"][good], surface, feed),
                float(columns["overtravel_mm"][good].mean()),
            )
        )
    return rows


def show(rows: list[Row]) -> None:
    """Print the table."""
    print(
        "           feed  touches      #5061, µm        µs   component, µm       µs  over-   ratio"
    )
    print(
        "         mm/min  (stalled)    mean    max     mean    mean    max     mean travel of means"
    )
    for row in rows:
        own, ours = row.linuxcnc, row.skiplatch
        # Standing between, the component is what #5061 shows.
        ratio = f"{own.mean_um / ours.mean_um:8.1f}" if row.mode == "beside" else ""
        print(
            f"{row.mode:8} {row.feed_mm_min:6} {row.touches:5} ({row.stalled})"
            f"    {own.mean_um:7.2f} {own.max_um:6.2f} {own.mean_us:8.1f}"
            f" {ours.mean_um:7.2f} {ours.max_um:6.2f} {ours.mean_us:8.1f}"
            f"   {row.overtravel_mm:4.2f} {ratio}"
        )


def main() -> int:
    """Run both ways; 0 also where LinuxCNC is not to be had, which is then said."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--touches", type=int, default=20, help="at each feed, each way")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("build/linuxcnc"))
    arguments = parser.parse_args()
    if lack := missing():
        print(f"SKIPPED: linuxcnc: {lack}")
        return 0
    build()
    rows = []
    for mode in ("beside", "through"):
        folder = arguments.out / mode
        run(folder, mode, plan(arguments.touches, arguments.seed, 0), {})
        rows += table(mode, read(folder))
    show(rows)
    figures = json.dumps([asdict(row) for row in rows], indent=1)
    (arguments.out / "figures.json").write_text(figures + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
