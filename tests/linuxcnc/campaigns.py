"""Campaigns from the real LinuxCNC, one for each thing that may be wrong: ``campaigns [NAME…]``.

LinuxCNC latches by itself, at its servo tick: a PLC path whose scan is the servo period. Where the
surface was is known, so the datum is. Touches around which the machine
stalled are left out, as in measure.py: without a real-time kernel it does so now and then. Each
folder of build/linuxcnc/campaigns is a campaign, with LinuxCNC's own log and the lines that were
run.
"""

import argparse
import csv
import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tests.linuxcnc.measure import SERVO_NS, build, missing, on_time, read, run

FEEDS_MM_MIN = (100, 300, 900, 1800, 3000)
TOUCHES = 28
"""At each feed; half of them in each sense."""
SPAN_MM = 40.0
FACES_MM = {1: 11.2503, -1: -7.1301}
"""Where the faces of a workpiece stand still, by the sense that meets them."""
NOMINAL = """\
format = "skiplatch-campaign/1"
kind = "machine"

[probe]
pretravel_um = 0.0
lobe_um = 0.0
lobe_phase_deg = 0.0
repeatability_um = 0.0
delay_us = 0.0

[input]
filter_us = 0.0

[skip]
latency_us = 0.0
jitter_us = 0.0
tick_us = 1.0

[plc]
scan_us = 1000.0

[axis]
resolution_um = 0.001
accel_mm_s2 = 500.0  # of 1000: the planner keeps half of it for blending

[report]
latency_us = 0.0
jitter_us = 0.0

[bench]
reference_jitter_us = 0.0
"""


@dataclass(frozen=True)
class Condition:
    """What is wrong with the machine, beside what nominal.toml says."""

    mode: str = "beside"
    servo_ns: int = SERVO_NS
    pins: Mapping[str, float] = field(default_factory=dict)
    bouncing: float = 0.0
    """Share of the touches whose contact conducts late, by 4 ms in the mean."""


CONDITIONS = {
    "nothing": Condition(),
    "servo_period": Condition(servo_ns=2_000_000),
    "debounced": Condition(mode="debounced"),
    "backlash": Condition(pins={"touchrig.0.backlash": 0.06}),
    "screw": Condition(pins={"touchrig.0.scale-error": 0.001}),
    "lagging": Condition(pins={"touchrig.0.lag-us": 3000.0}),
    "bounced": Condition(pins={"touchrig.0.closing-us": 0.0}, bouncing=0.3),
}


def plan(condition: Condition, seed: int, *, has_faces: bool) -> list[dict[str, float]]:
    """Choose the touches: feeds, senses and, where no face stands still, places in any order."""
    rng = np.random.default_rng(seed)
    touches = [(feed, 1 - 2 * (i % 2)) for feed in FEEDS_MM_MIN for i in range(TOUCHES)]
    return [
        {
            "feed": touches[i][0],
            "sense": touches[i][1],
            "surface": FACES_MM[touches[i][1]]
            if has_faces
            else round(float(rng.uniform(-SPAN_MM, SPAN_MM)), 6),
            "further": float(rng.uniform(0.0, 0.2)),
            "bounces": int(rng.random() < condition.bouncing),
            "bounce-us": round(float(rng.exponential(4000.0)), 3),
        }
        for i in rng.permutation(len(touches))
    ]


def write(folder: Path, condition: Condition) -> int:
    """Make a campaign of what was recorded; give how many touches were left out."""
    columns = read(folder)
    good = on_time(columns, condition.servo_ns)
    sense = columns["sense"]
    deviation_um = 1000.0 * sense * (columns["linuxcnc_mm"] - columns["surface_mm"])
    shutil.move(folder / "touches.csv", folder / "rig.csv")
    (folder / "nominal.toml").write_text(NOMINAL, encoding="utf-8")
    with (folder / "touches.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(
            ["touch", "time_s", "path", "axis", "sign", "alpha_deg", "beta_deg", "feed_mm_min",
             "approach_mm", "position_mm", "rotary_deg", "temp_c", "edge_us", "latch_us",
             "report_us", "deviation_um", "status"]
        )  # fmt: skip
        for i in np.flatnonzero(good):
            writer.writerow(
                [i, f"{columns['time_s'][i] - columns['time_s'][0]:.3f}", "plc", "X",
                 int(sense[i]), 0 if sense[i] > 0 else 180, 0, f"{columns['feed_mm_min'][i]:g}",
                 f"{columns['approach_mm'][i]:.4f}", f"{columns['surface_mm'][i]:.6f}", 0, 20,
                 "", "", "", f"{deviation_um[i]:.3f}", "ok"]
            )  # fmt: skip
    return int((~good).sum())


def main() -> int:
    """Record the named conditions, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("names", nargs="*", choices=[*CONDITIONS, []])
    parser.add_argument("--out", type=Path, default=Path("build/linuxcnc/campaigns"))
    parser.add_argument("--faces", action="store_true", help="touch two faces that stand still")
    arguments = parser.parse_args()
    if lack := missing():
        print(f"SKIPPED: linuxcnc: {lack}")
        return 0
    build()
    for seed, (name, condition) in enumerate(CONDITIONS.items(), start=1):
        if arguments.names and name not in arguments.names:
            continue
        folder = arguments.out / name
        shutil.rmtree(folder, ignore_errors=True)
        touches = plan(condition, seed, has_faces=arguments.faces)
        run(folder, condition.mode, touches, condition.pins, condition.servo_ns)
        print(f"{folder}: {write(folder, condition)} touches left out", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
