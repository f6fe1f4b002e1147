"""What takes long shows how far it is, on a terminal alone."""

import os
import pty
import struct
import subprocess
import sys
from fcntl import ioctl
from pathlib import Path
from termios import TIOCSWINSZ

LATE_BENCH = Path(__file__).parents[2] / "scripts" / "samples" / "bench_isr_latency"
DIAGNOSE = [sys.executable, "-m", "skiplatch", "diagnose", str(LATE_BENCH)]


def on_a_terminal(command: list[str]) -> str:
    """Give what a command writes to the terminal that its stderr is."""
    ours, its = pty.openpty()
    ioctl(its, TIOCSWINSZ, struct.pack("HHHH", 40, 100, 0, 0))
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=its) as process:
        os.close(its)
        shown = b""
        while True:
            try:
                more = os.read(ours, 4096)
            except OSError:  # Linux says so where nobody writes any more
                break
            if not more:
                break
            shown += more
    os.close(ours)
    assert process.returncode == 0
    return shown.decode()


def test_a_diagnosis_shows_on_a_terminal_how_much_is_done() -> None:
    shown = on_a_terminal(DIAGNOSE)

    counts = [line.split()[1] for line in shown.split("\r") if line.startswith("diagnosing: ")]
    assert len(set(counts)) > 2
    assert not shown.endswith("tasks/s]")


def test_a_diagnosis_is_silent_in_a_pipe() -> None:
    ran = subprocess.run(DIAGNOSE, capture_output=True, check=True)

    assert ran.stderr == b""
