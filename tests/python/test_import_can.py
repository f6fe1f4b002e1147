"""``skiplatch import can``: the campaign of a log is that of the bench that was heard live."""

from pathlib import Path

import numpy as np
import pytest

from bench_rig import c_frames
from skiplatch.bench.latches import Latch
from skiplatch.bench.listener import Arrival
from skiplatch.bench.plan import read_plan
from skiplatch.bench.protocol import EDGE_ID, LATCH_ID, Edge
from skiplatch.bench.recording import Played, VirtualAxis, as_touches
from skiplatch.campaign import InputPath
from skiplatch.errors import CampaignWarning
from skiplatch.importing.can_frames import read_can
from test_bench_plan import PLANS
from test_import_logs import Run

WINDOW_BITS = 13
FEED_MM_MIN = 300.0


def bus_log(
    folder: Path, edges_ns: list[int], latches_ns: list[int], window_bits: int = WINDOW_BITS
) -> str:
    """Write what candump -L does of edges that came within 2^13 ns, and of latches."""
    edges = [f"edge {time} {i} {window_bits} 1 {2 * i % 256}" for i, time in enumerate(edges_ns)]
    latches = [f"latch {time // 100} 0 {i} 0 8" for i, time in enumerate(latches_ns)]
    frames = [(EDGE_ID, frame) for line in edges for frame in c_frames(line)]
    frames += [(LATCH_ID, frame) for line in latches for frame in c_frames(line)]
    lines = [f"(1.000000) can0 {number:03X}#{frame.hex().upper()}" for number, frame in frames]
    (folder / "bus.log").write_text("\n".join(lines) + "\n")
    return str(folder / "bus.log")


def test_a_log_gives_the_edges_and_latches_of_bench_run(tmp_path: Path) -> None:
    edges_ns = [5_000_000_000, 5_500_000_000, 6_000_000_000]
    latches_ns = [5_000_040_000, 5_500_040_700, 6_000_041_300]
    plan = read_plan(PLANS / "nominal.toml")
    played = [
        Played(
            InputPath.SKIP,
            FEED_MM_MIN,
            edge_ns,
            Edge(edge_ns, 1 << WINDOW_BITS, i, 1),
            Arrival(Latch(latch_ns // 100, 0, i, 0), latch_ns, latch_ns + 100_000),
        )
        for i, (edge_ns, latch_ns) in enumerate(zip(edges_ns, latches_ns, strict=True))
    ]

    run = Run(tmp_path, "can", bus_log(tmp_path, edges_ns, latches_ns))

    heard = as_touches(plan, plan.nominal, VirtualAxis(FEED_MM_MIN, 1.0), played)
    read = run.campaign.touches
    assert read.latch_us - read.edge_us == pytest.approx(heard.latch_us - heard.edge_us)
    assert read.edge_us == pytest.approx(heard.edge_us - heard.edge_us[0])
    said = "the beginning of its window stands for an edge, as for bench run: it came up to"
    assert f"{said} 8.192 µs later" in run.said["assumed"]


def test_a_latch_just_before_an_edge_is_of_that_edge_alone(tmp_path: Path) -> None:
    edges_ns = [5_000_000_000, 5_100_000_000]

    run = Run(tmp_path, "can", bus_log(tmp_path, edges_ns, [5_099_999_000]))

    touches = run.campaign.touches
    assert touches.missed.tolist() == [True, False]
    assert touches.latch_us[1] - touches.edge_us[1] == pytest.approx(-1.0)


def test_log_that_was_cut_is_read_up_to_there(tmp_path: Path) -> None:
    edges_ns = [5_000_000_000 + i * 500_000_000 for i in range(3)]
    path = Path(bus_log(tmp_path, edges_ns, [time + 40_000 for time in edges_ns]))
    path.write_text(path.read_text() + "(1.000000) can0 1\n")

    with pytest.warns(CampaignWarning, match="nothing was read after the 12 frames before it"):
        found = read_can(path)

    assert found.columns is not None
    assert len(found.columns) == 3


def without_record(path: Path, number: int) -> str:
    """The log without both frames of a latch record."""
    lines = path.read_text().splitlines()
    records = [i for i, line in enumerate(lines) if f" {LATCH_ID:03X}#" in line]
    gone = records[2 * number : 2 * number + 2]
    path.write_text("".join(f"{line}\n" for i, line in enumerate(lines) if i not in gone))
    return str(path)


@pytest.mark.parametrize("number", [0, 2])
def test_edge_whose_record_was_lost_has_no_outcome(tmp_path: Path, number: int) -> None:
    edges_ns = [5_000_000_000 + i * 500_000_000 for i in range(5)]
    latches_ns = [time + 40_000 for time in edges_ns]
    path = Path(bus_log(tmp_path, edges_ns, latches_ns))

    run = Run(tmp_path, "can", without_record(path, number))

    touches = run.campaign.touches
    assert not touches.missed.any()
    assert touches.ok.tolist() == [i != number for i in range(5)]
    assert any(
        line.startswith("edges whose latch record") for line in run.said["could_not_be_read"]
    )


def test_edge_without_a_record_is_missed_where_none_was_lost(tmp_path: Path) -> None:
    edges_ns = [5_000_000_000 + i * 500_000_000 for i in range(5)]
    latches_ns = [time + 40_000 for i, time in enumerate(edges_ns) if i != 2]

    run = Run(tmp_path, "can", bus_log(tmp_path, edges_ns, latches_ns))

    assert run.campaign.touches.missed.tolist() == [i == 2 for i in range(5)]


@pytest.mark.parametrize("scatter_us", [0.5, 5.0])
def test_latch_whose_stamp_scatters_to_before_its_edge_is_of_that_edge(
    tmp_path: Path, scatter_us: float
) -> None:
    """As stamps of 0.5 µs make of a latch with hardly a delay, of windows of 64 ns."""
    draw = np.random.default_rng(1)
    edges_ns = [5_000_000_000 + i * 500_000_000 for i in range(200)]
    waits_ns = (1e3 * scatter_us * draw.standard_normal(200)).astype(int)
    latches_ns = [edge + int(wait) for edge, wait in zip(edges_ns, waits_ns, strict=True)]

    run = Run(tmp_path, "can", bus_log(tmp_path, edges_ns, latches_ns, window_bits=6))

    touches = run.campaign.touches
    assert not touches.missed.any()
    assert touches.latch_us - touches.edge_us == pytest.approx(waits_ns / 1e3, abs=0.1001)
    # No interrupt comes before its edge: it is the stamps that scatter, whatever the windows say.
    jitter_us = run.campaign.nominal.bench.reference_jitter_us
    assert jitter_us == pytest.approx(scatter_us, rel=0.15)
    assert any(line.startswith("stamps scatter by") for line in run.said["assumed"])


def test_stray_latch_before_an_edge_is_not_taken_for_its_own(tmp_path: Path) -> None:
    edges_ns = [5_000_000_000 + i * 500_000_000 for i in range(3)]
    stray_ns = edges_ns[1] - 3_000_000
    latches_ns = sorted([stray_ns, *(time + 40_000 for time in edges_ns)])

    run = Run(tmp_path, "can", bus_log(tmp_path, edges_ns, latches_ns))

    touches = run.campaign.touches
    assert touches.latch_us - touches.edge_us == pytest.approx(np.full(3, 40.0))
