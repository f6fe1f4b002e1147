#!/usr/bin/python3
"""Touches the simulated surface from inside LinuxCNC, as its display; writes touches.csv.

Each row of that is a touch: where the surface was, where LinuxCNC says and where the component says
it was touched. What is to be touched stands in plan.json; the lines that were run go to
program.ngc, and LinuxCNC itself writes probe.log.
"""

import csv
import json
import sys
import time
from pathlib import Path

import linuxcnc

import hal

CLEAR_MM = 0.3
PAST_MM = 4.0
AWAY_MM = 1000.0
STOP_MM_PER_FEED2 = 1.0 / 3.6e6
"""Way to reach a feed in mm/min, squared, at 1000 mm/s², of which the planner takes half."""
TIMEOUT_S = 60.0
COLUMNS = (
    "time_s", "feed_mm_min", "surface_mm", "sense", "approach_mm", "linuxcnc_mm", "skiplatch_mm",
    "overtravel_mm", "age_us", "window_us", "off_us", "bounces", "late_ticks",
)  # fmt: skip


class Machine:
    """The running LinuxCNC, homed and ready for lines of a program."""

    def __init__(self) -> None:
        """Switch it on."""
        self.command = linuxcnc.command()
        self.status = linuxcnc.stat()
        self.errors = linuxcnc.error_channel()
        self.command.state(linuxcnc.STATE_ESTOP_RESET)
        self.command.wait_complete()
        self.command.state(linuxcnc.STATE_ON)
        self.command.wait_complete()
        self.command.home(0)
        self._wait(lambda: self.status.homed[0])
        self.command.mode(linuxcnc.MODE_MDI)
        self.command.wait_complete()

    def _wait(self, is_so) -> None:  # noqa: ANN001
        end = time.monotonic() + TIMEOUT_S
        while True:
            self.status.poll()
            if is_so():
                return
            if time.monotonic() > end:
                raise TimeoutError
            time.sleep(0.005)

    def run(self, line: str) -> None:
        """Run a line of a program to its end, and keep it as part of one."""
        with Path("program.ngc").open("a") as program:
            program.write(f"{line}\n")
        self.command.mdi(line)
        if self.command.wait_complete(TIMEOUT_S) not in (linuxcnc.RCS_DONE, 1):
            raise RuntimeError(f"{line}: {self.errors.poll()}")
        self._wait(lambda: self.status.inpos and self.status.interp_state == linuxcnc.INTERP_IDLE)
        if failure := self.errors.poll():
            raise RuntimeError(f"{line}: {failure}")


def value(pin: str) -> float:
    """Read a pin."""
    return hal.get_value(pin)


def touch(machine: Machine, planned: dict[str, float]) -> dict[str, float]:
    """Touch once, and go back."""
    feed, surface, sense = planned["feed"], planned["surface"], planned["sense"]
    # Where the move begins moves the phase of the ticks at which the surface is met.
    approach = CLEAR_MM + planned["further"] + 1.5 * feed * feed * STOP_MM_PER_FEED2
    start = surface - sense * approach
    machine.run(f"G0 X{start:.4f}")
    time.sleep(0.02)  # the feedback may lag
    for pin in ("surface", "sense", "bounces", "bounce-us"):
        if pin in planned:
            hal.set_p(f"touchrig.0.{pin}", str(planned[pin]))
    counted = value("skiplatch.0.bounce-count"), value("touchrig.0.late-ticks")
    began_s = time.monotonic()
    machine.run(f"G38.2 X{surface + sense * PAST_MM:.4f} F{feed}")
    machine.status.poll()
    row = {
        "time_s": began_s,
        "feed_mm_min": feed,
        "surface_mm": surface,
        "sense": sense,
        "approach_mm": approach,
        "linuxcnc_mm": machine.status.probed_position[0],
        "skiplatch_mm": value("skiplatch.0.position"),
        "overtravel_mm": value("skiplatch.0.overtravel"),
        "age_us": value("skiplatch.0.age-us"),
        "window_us": value("skiplatch.0.window-us"),
        "off_us": value("touchrig.0.off-us"),
        "bounces": value("skiplatch.0.bounce-count") - counted[0],
        "late_ticks": value("touchrig.0.late-ticks") - counted[1],
    }
    machine.run(f"G0 X{start:.4f}")
    time.sleep(0.02)  # the release
    hal.set_p("touchrig.0.surface", str(AWAY_MM * sense))  # the way to the next one is free
    return row


def main() -> int:
    """Make the touches of plan.json."""
    component = hal.component("driver")  # gone as soon as nothing holds it
    component.ready()
    plan = json.loads(Path("plan.json").read_text())
    for pin, setting in plan["pins"].items():
        hal.set_p(pin, str(setting))
    machine = Machine()
    machine.run("G21 G90 G64")
    machine.run("(PROBEOPEN probe.log)")
    with Path("touches.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for planned in plan["touches"]:
            writer.writerow(touch(machine, planned))
            file.flush()
    machine.run("(PROBECLOSE)")
    Path("finished").touch()
    return 0


if __name__ == "__main__":
    sys.exit(main())
