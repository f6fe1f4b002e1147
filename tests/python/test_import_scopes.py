"""``skiplatch import edges``: voltages that oscilloscopes write as CSV.

The forms of the heads are those that the exports of these makers have.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from refusals import Program
from skiplatch.cli import group
from test_import_logs import Run

STEP_S = 1e-6
TOUCHES = 4
LATE = 30  # samples from an edge to its latch


def volts() -> list[tuple[float, float]]:
    """A probe and a latch with noise, at rest between touches."""
    noise = np.random.default_rng(1).normal(0.0, 0.03, (TOUCHES * 2000, 2))
    at = np.arange(TOUCHES * 2000) % 2000
    levels = np.stack([(at >= 500) & (at < 1800), (at >= 500 + LATE) & (at < 1000)], axis=1)
    return [(a, b) for a, b in 3.3 * levels + noise]


def rows(unit_s: float = 1.0, start_s: float = -0.002, separator: str = ",") -> str:
    times = ((start_s + i * STEP_S) / unit_s for i in range(len(volts())))
    cells = ((f"{t:.9g}", f"{a:.4f}", f"{b:.4f}") for t, (a, b) in zip(times, volts(), strict=True))
    return "".join(separator.join(row) + "\n" for row in cells)


def counted() -> str:
    return "".join(f"{i},{a:.2e},{b:.2e},\n" for i, (a, b) in enumerate(volts()))


RIGOL = "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-2.000000e-03,1.000000e-06\n" + counted()
KEYSIGHT = "x-axis,1,2\nsecond,Volt,Volt\n" + rows()
SIGLENT = "Record Length,Analog:8000\nVertical Units,CH1:V CH2:V\nSecond,Volt,Volt\n" + rows()
RIGOL_TIMELESS = "CH1V,CH2V,t0 = -2.0e-03, tInc = 1.0e-06,\n" + "".join(
    f"{a:.6f},{b:.6f},\n" for a, b in volts()
)
PICO = "Time,Channel A,Channel B\n(ms),(V),(V)\n\n" + rows(1e-3)
PICO_GERMAN = "Zeit;Kanal A;Kanal B\n(ms);(V);(V)\n\n" + rows(1e-3, separator=";").replace(".", ",")
TEKTRONIX = "Model,MDO3024\nHorizontal Units,S,\nRecord Length,8000,\n\nTIME,CH1,CH2\n" + rows()
SALEAE_ANALOG = "Time [s],Channel 0,Channel 1\n" + rows()


@pytest.mark.parametrize(
    ("text", "probe", "latch"),
    [
        (RIGOL, "CH1", "CH2"),
        (RIGOL_TIMELESS, "CH1", "CH2"),
        (KEYSIGHT, "1", "2"),
        (SIGLENT, "CH1", "CH2"),
        (PICO, "Channel A", "Channel B"),
        (PICO_GERMAN, "Kanal A", "Kanal B"),
        (TEKTRONIX, "CH1", "CH2"),
        (SALEAE_ANALOG, "Channel 0", "Channel 1"),
    ],
    ids=[
        "rigol",
        "rigol_timeless",
        "keysight",
        "siglent",
        "pico",
        "pico_german",
        "tektronix",
        "saleae",
    ],
)
def test_voltages_are_edges_and_latches(tmp_path: Path, text: str, probe: str, latch: str) -> None:
    (tmp_path / "c.csv").write_text(text)

    run = Run(tmp_path, "edges", str(tmp_path / "c.csv"), "--probe", probe, "--latch", latch)

    touches = run.campaign.touches
    assert len(touches) == TOUCHES
    late_us = touches.latch_us - touches.edge_us
    assert late_us == pytest.approx([LATE * STEP_S * 1e6] * TOUCHES, abs=0.01)
    assert np.diff(touches.edge_us) == pytest.approx([2000.0] * (TOUCHES - 1), abs=0.01)
    assert any(f"{probe} from 1.6" in line for line in run.said["assumed"])


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (RIGOL, "an oscilloscope"),
        (RIGOL_TIMELESS, "an oscilloscope"),
        (KEYSIGHT, "an oscilloscope"),
        (SIGLENT, "an oscilloscope"),
        (PICO, "an oscilloscope"),
        (PICO_GERMAN, "an oscilloscope"),
        (TEKTRONIX, "an oscilloscope"),
        (SALEAE_ANALOG, "a logic analyser"),
    ],
)
def test_repeat_takes_voltages_without_being_told_what_they_are(
    tmp_path: Path, text: str, what: str
) -> None:
    (tmp_path / "c.csv").write_text(text)

    run = CliRunner().invoke(group, ["repeat", str(tmp_path / "c.csv")])

    assert run.exit_code == 0, run.output
    assert f"log of {what}, {TOUCHES} touches" in run.output


def test_a_table_of_positions_is_no_capture(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "t.csv").write_text("X,Y,Z\n0.125,1.5,-2.5\n0.25,1.5,-2.75\n")

    said = refused("repeat", str(tmp_path / "t.csv"))
    assert "for others skiplatch import csv or iso230 reads it" in said


def gaussian(at: int, noise: np.random.Generator) -> float:
    return float(noise.normal(1.6, 0.03))


def flickering(at: int, noise: np.random.Generator) -> float:
    """Between two steps of the converter."""
    return 0.04 * int(noise.integers(2))


@pytest.mark.parametrize("wave", [gaussian, flickering])
@pytest.mark.parametrize("options", [(), ("--probe", "1", "--latch", "2")])
def test_a_channel_of_noise_alone_has_no_edges(
    tmp_path: Path,
    refused: Program,
    wave: Callable[[int, np.random.Generator], float],
    options: tuple[str, ...],
) -> None:
    noise = np.random.default_rng(2)
    samples = (f"{i * 1e-6:.6f},{a:.4f},{wave(i, noise):.4f}\n" for i, (a, _) in enumerate(volts()))
    (tmp_path / "c.csv").write_text("x-axis,1,2\nsecond,Volt,Volt\n" + "".join(samples))

    said = refused("import", "edges", tmp_path / "c.csv", *options, "-o", tmp_path / "c")

    expected = (
        'channel "2" swings between no two levels: it is noise, or slopes'
        if options
        else "expected two channels that change; there are: 1, 2 (noise)"
    )
    assert f"c.csv: {expected}" in said


def test_blank_rows_below_the_samples_are_none(tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_text(f"{KEYSIGHT},,\n")

    assert len(Run(tmp_path, "edges", str(tmp_path / "c.csv")).campaign.touches) == TOUCHES


def test_time_without_a_unit_is_taken_for_seconds_and_said(tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_text(TEKTRONIX)

    run = Run(tmp_path, "edges", str(tmp_path / "c.csv"))

    assert 'times are in seconds, as "TIME" names no unit such as (ms)' in run.said["assumed"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "x-axis,1\nsecond,Volt\n0.0,0.1\n1e-6,OVER\n",
            ":4: expected a time and voltages of 1 channels",
        ),
        ("0.0,0.1\n1e-6,3.3\n", ":1: expected names of columns, and samples below them"),
    ],
)
def test_voltages_that_cannot_be_read_are_refused(
    tmp_path: Path, refused: Program, text: str, said: str
) -> None:
    (tmp_path / "c.csv").write_text(text, encoding="utf-8")

    assert said in refused("import", "edges", str(tmp_path / "c.csv"), "-o", str(tmp_path / "c"))


OVER, BELOW = "\u221e", "-\u221e"


def over_range(text: str, least: float) -> str:
    """Write what is above a voltage as PicoScope does where its range ends there."""
    lines = []
    for line in text.splitlines():
        time, *cells = line.split(",")
        is_sample = cells and cells[0].replace(".", "").replace("-", "").isdigit()
        cut = [OVER if is_sample and float(v) > least else v for v in cells]
        lines.append(",".join([time, *cut]))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("least", [3.3, 1.0], ids=["some of the high ones", "all of them"])
def test_samples_over_the_range_are_high(tmp_path: Path, least: float) -> None:
    text = over_range(PICO, least)
    (tmp_path / "c.csv").write_text(text, encoding="utf-8")

    touches = Run(tmp_path, "edges", str(tmp_path / "c.csv")).campaign.touches

    assert OVER in text
    assert (touches.latch_us - touches.edge_us).tolist() == pytest.approx([LATE] * TOUCHES)


def test_samples_below_the_range_are_low(tmp_path: Path) -> None:
    rows = ["Time,Channel A,Channel B", "(ms),(V),(V)", ""]
    for i in range(200):
        a, b = (i % 100 >= start for start in (20, 30))
        rows.append(f"{i / 1e3},{OVER if a else BELOW},{3.3 if b else BELOW}")
    (tmp_path / "c.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")

    touches = Run(tmp_path, "edges", str(tmp_path / "c.csv")).campaign.touches

    assert (touches.latch_us - touches.edge_us).tolist() == pytest.approx([10.0, 10.0])
