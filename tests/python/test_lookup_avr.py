"""The controller's lookup on an ATmega in simavr: its cycles, and the same bits as here."""

import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from skiplatch.compensation.radius_map import Lookup

ROOT = Path(__file__).parents[2]
SOURCES = ("tests/avr/lookup_cycles.c", "firmware/comp/pretravel_lookup.c")
MOST_CYCLES = {8: 400, 16: 400, 32: 420}
"""By M."""
MOST_BYTES = 512

TOOLS = {name: shutil.which(name) for name in ("avr-gcc", "avr-size", "simavr")}
MISSING = [name for name, path in TOOLS.items() if path is None]
pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"no {', '.join(MISSING)} here")


@dataclass(frozen=True)
class Outcome:
    directions: int
    most_cycles: int
    mean_cycles: int
    worst: tuple[int, int, int]
    checksum: int


def call(tool: str, *arguments: str | Path) -> str:
    done = subprocess.run(
        [TOOLS[tool] or tool, *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    return done.stdout + done.stderr


def chip_of(divisions: int) -> str:
    """Give a chip of the same core with room for the table in its RAM."""
    return "atmega328p" if divisions <= 16 else "atmega1284p"


def compiled(folder: Path, divisions: int, option: str) -> Path:
    program = folder / "lookup.elf"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", option, f"-mmcu={chip_of(divisions)}"]
    call("avr-gcc", *flags, "-Ifirmware", f"-DDIVISIONS={divisions}u", *SOURCES, "-o", program)
    return program


def run(program: Path, divisions: int) -> Outcome:
    told = call("simavr", "-m", chip_of(divisions), "-f", "16000000", program)
    line = re.search(r"(?:\d+ ){7}", told)
    assert line is not None, told
    directions, most, mean, x, y, z, checksum = map(int, line[0].split())
    return Outcome(directions, most, mean, (x, y, z), checksum)


class Random:
    """The program's own random numbers."""

    def __init__(self) -> None:
        self.state = 1

    def __call__(self) -> int:
        self.state = (self.state * 1664525 + 1013904223) % 2**32
        return self.state >> 16


def direction(random: Random, *, is_any: bool) -> tuple[int, int, int]:
    shift = random() % 14
    x, y, z = random(), random(), random()
    if is_any:
        return (signed(x) >> shift, signed(y) >> shift, (z & 0x7FFF) >> shift)
    side = x & 0x3FFF | 0x4000
    return (-side, -(side - (y & 0xFF)), z >> (shift + 2))


def signed(bits: int) -> int:
    return bits - 2**16 if bits >= 2**15 else bits


def checksum_here(divisions: int, directions: int) -> int:
    random = Random()
    size = 2 * divisions * (divisions + 1) + 1
    vertices = np.array([random() & 0xFF for _ in range(size)], dtype=np.uint8)
    vectors = [direction(random, is_any=i % 2 == 1) for i in range(directions)]
    total = 0
    for speed in Lookup(vertices, divisions, 1.0).speed_mm_min(vectors).tolist():
        total = (total * 31 + int(speed)) % 2**32
    return total


@pytest.mark.parametrize("option", ["-Os", "-O2"])
@pytest.mark.parametrize("divisions", [8, 16, 32])
def test_a_lookup_takes_no_more_cycles_than_allowed(
    tmp_path: Path, divisions: int, option: str
) -> None:
    found = run(compiled(tmp_path, divisions, option), divisions)

    print(f"M = {divisions}, {option}: at most {found.most_cycles}, mean {found.mean_cycles}")
    assert 100 < found.mean_cycles < found.most_cycles <= MOST_CYCLES[divisions]


@pytest.mark.parametrize("divisions", [2, 8, 16, 32])
def test_the_controller_finds_the_same_bits_as_the_host(tmp_path: Path, divisions: int) -> None:
    found = run(compiled(tmp_path, divisions, "-Os"), divisions)

    assert found.directions > 10_000
    assert found.checksum == checksum_here(divisions, found.directions)


def test_the_lookup_is_small_and_keeps_no_constants_in_ram(tmp_path: Path) -> None:
    object_file = tmp_path / "lookup.o"
    flags = ["-std=c99", "-Os", "-mmcu=atmega328p", "-Ifirmware", "-c"]
    call("avr-gcc", *flags, SOURCES[1], "-o", object_file)
    shown = call("avr-size", "-A", object_file)

    sizes = {name: int(size) for name, size in re.findall(r"^(\.\w+)\s+(\d+)", shown, re.M)}
    assert 100 < sizes[".text"] <= MOST_BYTES
    assert sizes[".data"] + sizes[".bss"] + sizes.get(".rodata", 0) == 0
