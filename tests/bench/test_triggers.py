"""Triggers end to end: command, edge, latch, record; none lost, none doubled."""

import os

import numpy as np
import pytest

from tests.bench.bus import Bus
from tests.bench.injection import Edges, Host, edges_of
from tests.bench.latches import SEQUENCES, TICK_NS, Latches, decode
from tests.bench.programs import LATCH_ID, controller, injector
from tests.bench.rig import Line, Rig

TRIGGERS = int(os.environ.get("BENCH_TRIGGERS", "100000"))
PERIOD_US = int(os.environ.get("BENCH_PERIOD_US", "500"))
# A scan sees a pulse that lasts for longer than the period and its lateness; an emulated machine on
# a busy host stands still for some 10 ms at times.
PLC_PERIOD_US = 100_000
TRAIN = 5_000  # the recorder catches up after each
# Below the kernel's own threads for interrupts, which stand at 50: the kernel has to hear an edge
# before the next one is driven.
INJECTOR_FIFO = "40"
FRAMES_PER_TRIGGER = 4  # two of the edge report, two of the latch record
QUIET_S = 5.0
SLOWNESS = 5.0


def play(host: Host, count: int, period_us: int) -> bytes:
    """Play one train and return all frames that came of it, also what came too much."""
    host.shoot(count=count, period_us=period_us, width_us=period_us // 2)
    limit_s = SLOWNESS * count * period_us * 1e-6 + QUIET_S
    expected = FRAMES_PER_TRIGGER * count + 1  # and one that tells that the train is over
    raw = host.bus.receive_raw(QUIET_S, limit_s, expected)
    return raw + host.bus.receive_raw(0.5, limit_s, expected)


def check_each_edge_latched_once(edges: Edges, latches: Latches) -> None:
    """One latch from each edge to the next, as far as the injector knows when its edges were."""
    times_ns = latches.times_ns(int(edges.time_ns[0]))
    earliest_ns = edges.time_ns - edges.half_window_ns - TICK_NS
    next_latest_ns = (edges.time_ns + edges.half_window_ns)[1:]
    assert np.all(times_ns >= earliest_ns)
    assert np.all(times_ns[:-1] <= next_latest_ns)


@pytest.mark.parametrize("path", ["skip", "plc"])
def test_no_trigger_is_lost_or_doubled(rig: Rig, line: Line, bus: Bus, path: str) -> None:
    triggers, period_us = (TRIGGERS, PERIOD_US) if path == "skip" else (200, PLC_PERIOD_US)
    raw = b""
    scan = ("--scan-us", "2000")
    with (
        injector(rig, line, "--fifo", INJECTOR_FIFO) as driver,
        controller(rig, line, *scan, "--fifo", "70", path=path) as latcher,
    ):
        host = Host(bus)
        for start in range(0, triggers, TRAIN):
            raw += play(host, min(TRAIN, triggers - start), period_us)
        counters = latcher.stop()
        driven = driver.stop()

    edges, latches = edges_of(raw), decode(raw, LATCH_ID)
    print(f"{path}: {len(edges)} edges, {len(latches)} latches, {counters}, {driven}")
    assert (len(edges), len(latches), latches.damaged) == (triggers, triggers, 0)
    assert np.all(np.diff(latches.sequence) % SEQUENCES == 1)
    assert np.all(np.diff(edges.number) % (1 << 16) == 1)
    assert (counters["latches"], counters["dropped"]) == (triggers, 0)
    check_each_edge_latched_once(edges, latches)
