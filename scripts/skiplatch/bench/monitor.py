"""Live latches and counters of a bench."""

import time
from collections.abc import Callable
from typing import Any

from skiplatch.bench.listener import Arrival
from skiplatch.bench.station import Station
from skiplatch.units import NS_PER_S, NS_PER_US

IDLE_S = 0.2
EDGE_MEMORY_NS = 1_000_000_000  # a latch later than that is none of the edge


class Monitor:
    """Listens, and tells each latch in a line.

    Attributes:
        latched: Latches so far.
        edges: Edges so far.
    """

    def __init__(self, station: Station, tell: Callable[[str], None]) -> None:
        self.latched = 0
        self.edges = 0
        self._station = station
        self._tell = tell
        self._edge_ns: int | None = None
        self._start_ns = time.monotonic_ns()
        self._restarts = 0

    def watch(self, seconds: float | None, latches: int | None) -> None:
        """Listen for so long and for so many latches; for ever without either."""
        end_s = None if seconds is None else time.monotonic() + seconds
        while latches is None or self.latched < latches:
            left_s = IDLE_S if end_s is None else min(end_s - time.monotonic(), IDLE_S)
            if left_s <= 0:
                return
            self._station.listen(left_s, self._has_news)
            self._take_in()
            self._tell_restarts()

    def counters(self, counts: dict[str, int]) -> dict[str, Any]:
        """Give what was counted here, and what the injector counts."""
        reports, edges = self._station.latch_reports, self._station.edge_reports
        return {
            "latches": self.latched,
            "lost_latches": reports.lost,
            "damaged_latch_frames": reports.damaged,
            "restarts": reports.restarts,
            "repeated_latch_frames": reports.repeated,
            "unpaired_latch_frames": reports.unpaired,
            "edges": self.edges,
            "damaged_edge_frames": edges.damaged,
            "unpaired_edge_frames": edges.unpaired,
            "damaged_status_frames": self._station.damaged_status,
            "injector": counts,
        }

    def _tell_restarts(self) -> None:
        reports = self._station.latch_reports
        if reports.restarts > self._restarts:
            self._restarts = reports.restarts
            self._tell(f"the controller has started anew; records lost up to now: {reports.lost}")

    def _has_news(self) -> bool:
        return bool(self._station.edges or self._station.latches)

    def _take_in(self) -> None:
        while self._station.edges:
            self._edge_ns = self._station.edges.popleft().time_ns
            self.edges += 1
        while self._station.latches:
            self._tell(self._line(self._station.latches.popleft()))
            self.latched += 1

    def _line(self, arrival: Arrival) -> str:
        latch = arrival.latch
        at_s = (arrival.latch_ns - self._start_ns) / NS_PER_S
        report_us = (arrival.report_ns - arrival.latch_ns) / NS_PER_US
        return (
            f"{at_s:12.6f} s  {latch.path:4}  record {latch.sequence:5}  "
            f"position {latch.position_counts:11}  edge to latch {self._after_edge(arrival)}  "
            f"latch to report {report_us:9.1f} µs"
        )

    def _after_edge(self, arrival: Arrival) -> str:
        if self._edge_ns is None or abs(arrival.latch_ns - self._edge_ns) > EDGE_MEMORY_NS:
            return f"{'?':>9}   "
        return f"{(arrival.latch_ns - self._edge_ns) / NS_PER_US:9.1f} µs"
