"""The devices of the bench as `devices.sh` made them: interface, chip and lines."""

import os
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Self

PROJECT = Path(__file__).parents[2]
PROGRAMS = PROJECT / "build" / "host"


@dataclass(frozen=True)
class Line:
    """A line of a gpio-sim chip, driven from outside as a probe would drive it."""

    offset: int
    folder: Path

    @property
    def pull(self) -> Path:
        """File that drives the line."""
        return self.folder / "pull"

    def set(self, *, high: bool) -> tuple[int, int]:
        """Drive the line; return CLOCK_MONOTONIC in ns just before and just after."""
        text = b"pull-up" if high else b"pull-down"
        file = os.open(self.pull, os.O_WRONLY)
        try:
            before_ns = time.monotonic_ns()
            os.write(file, text)
            return before_ns, time.monotonic_ns()
        finally:
            os.close(file)

    def pulse(self, width_s: float = 0.002) -> tuple[int, int]:
        """Deflect and release; return the times of the rising edge, as `set` does."""
        edge = self.set(high=True)
        time.sleep(width_s)
        self.set(high=False)
        return edge


@dataclass(frozen=True)
class Rig:
    """What the tests may use; `machine` is `vm` or `host`."""

    can: str
    chip: Path
    pulls: Path
    config: Path
    machine: str

    @classmethod
    def from_environment(cls) -> Self | None:
        """Return the rig that `devices.sh` exported, if it did."""
        if "BENCH_PULLS" not in os.environ:
            return None
        return cls(
            can=os.environ["BENCH_CAN"],
            chip=Path(os.environ["BENCH_CHIP"]),
            pulls=Path(os.environ["BENCH_PULLS"]),
            config=Path(os.environ["BENCH_CONFIG"]),
            machine=os.environ.get("BENCH_MACHINE", "host"),
        )

    def line(self, offset: int) -> Line:
        """Return the line at that offset."""
        return Line(offset, self.pulls / f"sim_gpio{offset}")

    def set_link(self, *, up: bool) -> None:
        """Bring the interface up or take it down."""
        state = "up" if up else "down"
        subprocess.run(["ip", "link", "set", self.can, state], check=True)  # noqa: S607

    def set_chip_live(self, *, live: bool) -> None:
        """Plug the chip in or pull it out."""
        state, file = ("1" if live else "0"), self.config / "live"
        if file.read_text(encoding="ascii").strip() != state:  # the kernel refuses what is so
            file.write_text(state, encoding="ascii")
