"""The figures with which README.md argues stand in the pages that it names for them."""

import re
from pathlib import Path

from skiplatch.simulator.effects import effects

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
MEAN = {
    "grbl 1.1h, unmodified, on an ATmega328P": (
        "BOARDS.md",
        r"edge to latch at 100 mm/min, mean [^|]*\| ([\d.]+) /",
    ),
    "grbl's pins with this firmware (pin change)": (
        "BOARDS.md",
        r"edge to stamp, mean [^|]*\| ([\d.]+) /",
    ),
    "skip input on the ATmega328P's capture unit": (
        "BOARDS.md",
        r"edge to latch at 100 mm/min, mean [^|]*\|[^|]*\| ([\d.]+) /",
    ),
    "LinuxCNC by itself, servo period 1 ms": ("LINUXCNC.md", r"\n\| 50 \|[^|]*\| (\d+) \|"),
    "LinuxCNC with this latch as a component": (
        "LINUXCNC.md",
        r"\n\| 50 \|[^|]*\|[^|]*\|[^|]*\| (\d+) \|",
    ),
}
"""Who latches: the page that measured it, and the mean delay there, in µs."""


def test_delays_are_those_of_the_pages_that_measured_them() -> None:
    rows = re.findall(r"^\| ([^|]+) \| (?:100|50) \| ([\d.]+) \| \[", README, re.MULTILINE)

    measured = {
        who: re.findall(pattern, (ROOT / "docs" / page).read_text(encoding="utf-8"))
        for who, (page, pattern) in MEAN.items()
    }
    assert {who: [mean] for who, mean in rows} == measured


def test_there_are_as_many_effects_as_it_says() -> None:
    (said,) = re.findall(r"any of (\d+) \[effects\]", README)

    assert int(said) == len(effects())


def test_what_polling_costs_is_period_times_feed() -> None:
    found = re.search(r"polls every (\d+) ms errs by up to ([\d.]+) mm at (\d+) mm/min", README)

    assert found is not None
    period_ms, most_mm, feed_mm_min = map(float, found.groups())
    assert most_mm == period_ms / 60e3 * feed_mm_min
