"""What the tests of the packages share: running a tool, or saying that it is not here."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest


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
