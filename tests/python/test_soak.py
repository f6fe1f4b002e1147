"""A bad bus at random loses no record without counting it, and power cuts mix up no store."""

import re
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
TOUCHES = 100_000


def test_records_over_a_bad_bus_come_once_and_whole_or_are_counted() -> None:
    make = shutil.which("make") or "make"
    subprocess.run([make, "-s", "INNER=yes", "build/host/soak"], cwd=ROOT, check=True)

    played = subprocess.run(
        [ROOT / "build/host/soak", "600", "7", str(TOUCHES)],
        capture_output=True,
        text=True,
        check=True,
    )

    numbers = map(int, re.findall(r"(\d+)", played.stdout))
    seed, touches, restarts, wraps, disturbed, received, lost, cuts, operations = numbers
    assert (seed, received + lost) == (7, touches)
    assert touches >= TOUCHES
    assert min(restarts, wraps, disturbed, lost) > 0
    assert operations > cuts > operations / 4
