"""What takes long shows how far it is, on a terminal alone."""

import os
import pty
import struct
import subprocess
import sys
from fcntl import ioctl
from termios import TIOCSWINSZ

import numpy as np
import pytest

from played_campaigns import BENCH
from skiplatch.campaign import read_campaign, write_campaign


@pytest.fixture(scope="module")
def diagnose(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The command that diagnoses a campaign of few touches: it shows as much as of many."""
    campaign, folder = read_campaign(BENCH), tmp_path_factory.mktemp("few") / "bench"
    few = campaign.touches.select(np.arange(0, len(campaign.touches), 8))
    write_campaign(folder, campaign.nominal, few)
    return [sys.executable, "-m", "skiplatch", "diagnose", str(folder)]


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


def test_a_diagnosis_shows_on_a_terminal_how_much_is_done(diagnose: list[str]) -> None:
    shown = on_a_terminal(diagnose)

    counts = [line.split()[1] for line in shown.split("\r") if line.startswith("diagnosing: ")]
    assert len(set(counts)) > 2
    assert not shown.endswith("tasks/s]")


@pytest.mark.long
def test_a_diagnosis_is_silent_in_a_pipe(diagnose: list[str]) -> None:
    ran = subprocess.run(diagnose, capture_output=True, check=True)

    assert ran.stderr == b""
