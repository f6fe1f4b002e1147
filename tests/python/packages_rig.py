"""What the tests of the packages share: running a tool, or saying that it is not here."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CORES = Path("/usr/share/arduino/hardware/arduino/avr/cores")


def run(*command: str | Path) -> str:
    """Run a command that has to succeed; give what it printed."""
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def tool(name: str, group: str) -> str:
    """Give the path of a tool, or skip the test, which then says how to install it."""
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"no {name} here: scripts/setup/system.sh {group}")
    return path


def packed_into(folder: Path) -> Path:
    """Pack the single header and the library of the firmware into a folder, and give it."""
    run(sys.executable, "scripts/pack_firmware.py", folder)
    return folder


def uno_run(folder: Path) -> Path:
    """Build what touches the probe of a simulated Uno and shows what it prints."""
    if not Path("/usr/include/simavr/sim_avr.h").exists():
        pytest.skip("no libsimavr here: scripts/setup/system.sh emulators")
    program = folder / "uno_run"
    run("gcc", "-O2", "-isystem", "/usr/include/simavr", "tests/packages/uno_run.c",
        "-lsimavr", "-lelf", "-o", program)  # fmt: skip
    return program


def stamps_of(uno: Path, program: Path) -> list[int]:
    """Give the stamps that a sketch prints on the simulated Uno."""
    return [int(stamp) for stamp in re.findall(r"^(\d+)$", run(uno, program), re.M)]
