"""Fuzz the importers of logs: mutated logs become campaigns or are refused in one line.

    python tests/fuzz/fuzz_import.py SECONDS [--seed N]

Starts from the logs of tests/python/data/logs and from corpus/import, mutates their bytes, tokens
and lines, and calls `skiplatch import`. What is accepted must be a campaign that can be read. An
input that breaks this is kept in the corpus and the exit status is 1.
"""

import argparse
import hashlib
import random
import struct
import sys
import tempfile
import time
import traceback
import warnings
import zipfile
from collections import Counter
from collections.abc import Mapping
from functools import cache
from io import BytesIO
from pathlib import Path

import can
from click.testing import CliRunner
from mutations import expect_refusal, mutated

from skiplatch.bench.protocol import EDGE_ID, LATCH_ID
from skiplatch.campaign import read_campaign
from skiplatch.cli import group
from skiplatch.errors import InputError

KEPT = Path(__file__).parent / "corpus" / "import"
LOGS = Path(__file__).parents[1] / "python" / "data" / "logs"
MOST_SECONDS = 5.0  # of processor time that one small file may take

CALLS: Mapping[str, tuple[str, ...]] = {
    "grbl*": ("grbl", "LOG"),
    "fluidnc*": ("grbl", "LOG", "--feed", "100"),
    "klip*": ("klipper", "LOG"),
    "marlin*": ("marlin", "LOG", "--feed", "120"),
    "linuxcnc_bore*.txt": ("linuxcnc", "LOG"),
    "linuxcnc*.txt": ("linuxcnc", "LOG", "--units", "mm"),
    "linuxcnc*.ini": ("linuxcnc", str(LOGS / "linuxcnc_probe.txt"), "--ini", "LOG"),
    "linuxcnc*.ngc": ("linuxcnc", str(LOGS / "linuxcnc_probe.txt"), "--program", "LOG"),
    "iso230*": ("iso230", "LOG", "--axis", "X"),
    "table*": (
        *("csv", "LOG", "--map", "deviation_um=Error (mm) [mm]", "--map", "time=When"),
        *("--map", "feed_mm_min=Speed", "--map", "position_mm=Where"),
    ),
    "saleae*": ("edges", "LOG"),
    "capture*": ("edges", "LOG"),
    "bus*": ("can", "LOG"),
}
"""How to call `skiplatch import` with a log, by its name."""
FOUND: set[str] = set()
"""Places that raised what they should not; one input is kept for each."""


def main() -> int:
    """Run for the time asked and report."""
    parser = argparse.ArgumentParser(description="fuzz the importers of logs")
    parser.add_argument("seconds", type=float)
    parser.add_argument("--seed", type=int)
    arguments = parser.parse_args()
    seed = random.SystemRandom().getrandbits(32) if arguments.seed is None else arguments.seed
    rng = random.Random(seed)
    seeds = {Path(name): data for name, data in read_seeds().items()}
    verdicts: Counter[str] = Counter()
    failures = sum(check_and_keep(path.name, data, verdicts) for path, data in seeds.items())
    end = time.monotonic() + arguments.seconds
    while time.monotonic() < end:
        path, data = rng.choice(list(seeds.items()))
        failures += check_and_keep(path.name, mutated(rng, data, seeds), verdicts)
    print(
        f"fuzz_import: seed {seed}, {verdicts.total()} executions "
        f"({verdicts['read']} read, {verdicts['refused']} refused), {failures} failures"
    )
    return 1 if failures else 0


def read_seeds() -> dict[str, bytes]:
    """Give logs by name: recorded ones, those that were found, and those of binary formats."""
    paths = [*LOGS.glob("*.*"), *KEPT.glob("*.*")]
    found = {path.name: path.read_bytes() for path in sorted(paths) if path.suffix != ".md"}
    return {**found, "capture_made.sr": sigrok(), "bus_made.log": candump(), **can_logs()}


def sigrok() -> bytes:
    """Make a session of sigrok with two channels."""
    meta = "[device 1]\ncapturefile=logic-1\nsamplerate=1 MHz\nunitsize=1\nprobe1=D0\nprobe2=D1\n"
    text = BytesIO()
    with zipfile.ZipFile(text, "w") as archive:
        archive.writestr("metadata", meta)
        archive.writestr("logic-1-1", bytes([0, 0, 1, 3, 3, 0, 0, 1, 1, 3, 0]))
    return text.getvalue()


def candump() -> bytes:
    """Make a log with the identifiers of the project's frames; few of the frames are whole."""
    rng = random.Random(1)
    lines = []
    for n in range(40):
        data = struct.pack("<II", n, rng.getrandbits(32)).hex().upper()
        lines.append(f"({n}.000000) can0 {(LATCH_ID, EDGE_ID)[n % 2]:03X}#{data}")
    return "\n".join(lines).encode()


@cache
def can_logs() -> Mapping[str, bytes]:
    """Give whole frames in each other form that python-can reads, and as candump shows them."""
    with can.CanutilsLogReader(KEPT / "bus_whole.log") as reader:
        frames = list(reader)
    shown = [f"can0  {f.arbitration_id:03X}   [{f.dlc}]  {f.data.hex(' ')}" for f in frames]
    logs = {"bus_shown.log": "\n".join(shown).encode()}
    with tempfile.TemporaryDirectory(prefix="skiplatch-fuzz-") as folder:
        for ending in (".asc", ".blf", ".csv", ".db", ".trc", ".log.gz"):
            path = Path(folder) / f"bus_made{ending}"
            with can.Logger(path) as writer:
                for frame in frames:
                    writer(frame)
            logs[path.name] = path.read_bytes()
    return logs


def check_and_keep(name: str, data: bytes, verdicts: Counter[str]) -> bool:
    """Tell whether the input broke the property; if so print how and keep it."""
    started = time.process_time()
    try:
        verdict = check(name, data)
        assert time.process_time() - started < MOST_SECONDS, "took too long"
    except Exception as error:  # noqa: BLE001
        verdicts["failed"] += 1
        place = "".join(traceback.format_tb(error.__traceback__)[-1:])
        if place in FOUND:
            return True
        FOUND.add(place)
        traceback.print_exc()
        KEPT.mkdir(parents=True, exist_ok=True)
        digest = hashlib.sha256(data).hexdigest()[:12]
        kept = KEPT / f"{pattern_of(name).split('*')[0]}_{digest}{ending_of(name)}"
        kept.write_bytes(data)
        print(f"fuzz_import: kept {kept}", file=sys.stderr)
        return True
    verdicts[verdict] += 1
    return False


def pattern_of(name: str) -> str:
    """Give the pattern of CALLS that a name is of."""
    return next(pattern for pattern in CALLS if Path(name).match(pattern))


def ending_of(name: str) -> str:
    """Give the ending, all of it where the log is packed."""
    return "".join(Path(name).suffixes)


def check(name: str, data: bytes) -> str:
    """Import the data and tell whether they were "read" or "refused"; raise if neither is so."""
    call = CALLS[pattern_of(name)]
    with tempfile.TemporaryDirectory(prefix="skiplatch-fuzz-") as folder:
        path, out = Path(folder) / f"input{ending_of(name)}", Path(folder) / "out"
        path.write_bytes(data)
        words = [str(path) if word == "LOG" else word for word in call]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = CliRunner().invoke(group, ["import", *words, "--out", str(out)])
            if result.exception is None:
                read_campaign(out)
                return "read"
        if not isinstance(result.exception, InputError):
            raise result.exception
        expect_refusal(result.exception)
        assert not out.exists(), "refused, and written"
        return "refused"


if __name__ == "__main__":
    sys.exit(main())
