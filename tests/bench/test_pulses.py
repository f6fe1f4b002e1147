"""The recorder of pulses: what it writes is what the lines did, and a gap ends it."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from skiplatch.transmission.pulses import INPUT, OUTPUT, Pulses, read_pulses
from tests.bench.programs import Program, run
from tests.bench.rig import Line, Rig

NAME = "skiplatch-recorder"
TICK_NS = 100
STALL_NS = 20_000_000  # an emulated machine on a busy host stands still at times
ORDER = (0, 0, 0, 1, 0, 0, 1, 0) * 25


@pytest.fixture
def encoders(rig: Rig) -> Iterator[tuple[Line, Line]]:
    """Lines 3 and 4 of the chip, low before and after."""
    lines = rig.line(3), rig.line(4)
    for line in lines:
        line.set(high=False)
    yield lines
    rig.set_chip_live(live=True)
    for line in lines:
        line.set(high=False)


def options(rig: Rig, encoders: tuple[Line, Line], out: Path, *more: str) -> tuple[str, ...]:
    """Give the command line."""
    lines = ("--input", str(encoders[0].offset), "--output", str(encoders[1].offset))
    return ("--chip", str(rig.chip), *lines, "--out", str(out), *more)


def recorded(path: Path) -> Pulses:
    """Read a file that holds one block."""
    (block,) = read_pulses(path)
    return block


def test_each_pulse_is_recorded_with_its_channel_and_time(
    rig: Rig, encoders: tuple[Line, Line], tmp_path: Path
) -> None:
    out = tmp_path / "run.bin"
    with Program(NAME, *options(rig, encoders, out)) as recorder:
        windows = np.array([encoders[channel].pulse() for channel in ORDER])
        counters = recorder.stop()

    pulses = recorded(out)
    assert counters == {"pulses": len(ORDER)}
    assert pulses.channel.tolist() == [(INPUT, OUTPUT)[channel] for channel in ORDER]
    assert np.all(pulses.t_ns >= windows[:, 0] - TICK_NS)
    assert np.all(pulses.t_ns <= windows[:, 1] + STALL_NS)


def test_it_ends_after_as_many_pulses_as_asked(
    rig: Rig, encoders: tuple[Line, Line], tmp_path: Path
) -> None:
    out = tmp_path / "run.bin"
    with Program(NAME, *options(rig, encoders, out, "--pulses", "10")) as recorder:
        for channel in ORDER[:12]:
            encoders[channel].pulse()
        assert recorder.finish() == {"pulses": 10}

    assert len(recorded(out)) == 10


def test_a_chip_that_vanishes_ends_it_with_what_came_before(
    rig: Rig, encoders: tuple[Line, Line], tmp_path: Path
) -> None:
    out = tmp_path / "run.bin"
    with Program(NAME, *options(rig, encoders, out)) as recorder:
        for channel in ORDER[:20]:
            encoders[channel].pulse()
        time.sleep(0.5)
        rig.set_chip_live(live=False)
        status, complaint = recorder.outcome()

    assert status == 1
    assert "the lines are gone" in complaint
    assert len(recorded(out)) == 20


def test_a_line_that_another_has_is_named(
    rig: Rig, encoders: tuple[Line, Line], tmp_path: Path
) -> None:
    others = rig.line(5), encoders[1]
    with Program(NAME, *options(rig, others, tmp_path / "first.bin")):
        status, complaint = run(NAME, *options(rig, encoders, tmp_path / "second.bin"))

    assert status == 2
    assert f"line {encoders[1].offset}" in complaint
    assert f'in use by "{NAME}"' in complaint
    assert len(complaint.splitlines()) == 1
    assert not (tmp_path / "second.bin").exists()
