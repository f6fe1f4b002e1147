"""Playing a plan: programs, loads and touches, and what is recorded of them."""

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from skiplatch.bench.listener import Arrival
from skiplatch.bench.plan import Plan
from skiplatch.bench.processes import Program, compiled, module
from skiplatch.bench.recording import Played, VirtualAxis
from skiplatch.bench.station import Pulse, Station
from skiplatch.campaign import InputPath
from skiplatch.progress import shown
from skiplatch.units import NS_PER_S, NS_PER_US, US_PER_S

EDGE_PATIENCE_S = 1.0
LATCH_PATIENCE_S = 0.5  # beyond the pulse, the debounce and two scans
SETTLE_S = 0.05  # for what is still on its way when a controller ends


@dataclass(frozen=True, slots=True)
class Rig:
    """Where the bench is, as the options say.

    Attributes:
        interface: CAN interface.
        chip: GPIO chip of the watched line; None if the controller is not ours to start.
        line: Its offset.
        active_low: The line is low while the probe is deflected.
        inject_line: Options of the injector that name the driven line; empty if it is not ours to
            start.
        latch_id: CAN id of latch records.
        cpu: Processor of the controller and of the load on it; None for any.
        priority: SCHED_FIFO priority of the controller; 0 for usual scheduling.
        injector_priority: The same of the injector.
        key_path: File with the key of the injector; None for none.
    """

    interface: str
    chip: str | None
    line: int
    active_low: bool
    inject_line: tuple[str, ...]
    latch_id: int
    cpu: int | None = None
    priority: int = 0
    injector_priority: int = 0
    key_path: Path | None = None


@dataclass
class Recording:
    """What was recorded with one scan period; grows while it is played.

    Attributes:
        scan_us: Scan period of the controller.
        axis: Its axis.
        played: What came of each touch.
        counters: What the controller counted, by path.
        lost_latches: Records that were lost on the way.
        restarts: How often the controller started anew while it was played.
    """

    scan_us: int
    axis: VirtualAxis
    played: list[Played] = field(default_factory=list)
    counters: dict[str, dict[str, object]] = field(default_factory=dict)
    lost_latches: int = 0
    restarts: int = 0


def injector(rig: Rig) -> AbstractContextManager[object]:
    """Give the injector, to be started, or nothing if it is not ours to start."""
    if not rig.inject_line:
        return ExitStack()
    rest = ("--rest", "1") if rig.active_low else ()
    priority = ("--fifo", str(rig.injector_priority)) if rig.injector_priority else ()
    key = ("--key", str(rig.key_path)) if rig.key_path else ()
    options = ("--can", rig.interface, *rig.inject_line, *rest, *priority, *key)
    return compiled("skiplatch-injector", *options)


def controller(
    rig: Rig, plan: Plan, path: InputPath, scan_us: int, axis: VirtualAxis
) -> AbstractContextManager[object]:
    """Give the controller on one path, to be started, or nothing if it is not ours to start."""
    if rig.chip is None:
        return ExitStack()
    options = [
        *("--chip", rig.chip, "--line", str(rig.line), "--can", rig.interface),
        *("--path", path.name.lower(), "--scan-us", str(scan_us)),
        *("--debounce-us", str(plan.load.debounce_us), "--latch-id", hex(rig.latch_id)),
        *("--feed", repr(axis.feed_mm_min), "--resolution-um", repr(axis.resolution_um)),
    ]
    options += ["--active-low"] if rig.active_low else []
    options += ["--cpu", str(rig.cpu)] if rig.cpu is not None else []
    options += ["--fifo", str(rig.priority), "--lock-memory"] if rig.priority else []
    return compiled("skiplatch-controller", *options)


def loads(rig: Rig, plan: Plan) -> list[Program]:
    """Give the processes that disturb the bench, to be started."""
    load = plan.load
    processes = []
    if load.cpu_share:
        options = (rig.cpu or 0, load.cpu_share, load.cpu_period_us, load.cpu_priority)
        processes.append(module("skiplatch.bench.busy", *map(str, options)))
    if load.bus_frames_per_s:
        options_of_flood = (rig.interface, str(load.bus_frames_per_s))
        processes.append(module("skiplatch.bench.flood", *options_of_flood))
    return processes


class Player:
    """Plays the touches of a plan against controller and injector, and records them."""

    def __init__(self, plan: Plan, rig: Rig, station: Station, seed: int) -> None:
        self._plan = plan
        self._rig = rig
        self._station = station
        self._random = np.random.default_rng(seed)
        self._pulse = Pulse(line=0, level=0 if rig.active_low else 1, width_us=plan.pulse_us)
        self.recordings: list[Recording] = []

    def play(self) -> None:
        """Play all of the plan; what was played is recorded even if this is cut short."""
        with ExitStack() as stack:
            driver = stack.enter_context(injector(self._rig))
            for load in loads(self._rig, self._plan):
                stack.enter_context(load)
            self._station.connect()
            for scan_us in self._plan.scan_us:
                self._play_scan(scan_us, driver)
            self._station.disarm()

    def _play_scan(self, scan_us: int, driver: object) -> None:
        resolution_um = self._plan.nominal.axis.resolution_um
        axis = VirtualAxis(max(self._plan.feeds_mm_min), resolution_um)
        recording = Recording(scan_us, axis)
        self.recordings.append(recording)
        reports = self._station.latch_reports
        lost, restarts = reports.lost, reports.restarts
        for path in self._plan.paths:
            watcher = controller(self._rig, self._plan, path, scan_us, axis)
            try:
                with watcher:
                    self._play_path(recording, path, (driver, watcher))
            finally:
                recording.lost_latches = reports.lost - lost
                recording.restarts = reports.restarts - restarts
                if isinstance(watcher, Program):
                    recording.counters[path.name.lower()] = watcher.counters

    def _play_path(
        self, recording: Recording, path: InputPath, programs: tuple[object, ...]
    ) -> None:
        station = self._station
        station.listen(SETTLE_S)
        station.latch_reports.start_anew()
        station.latches.clear()
        station.edges.clear()
        feeds = self._feeds()
        title = f"{path.name.lower()}, scan {recording.scan_us} µs"
        due_s = time.monotonic()
        for feed in shown(feeds, self._plan.touches, title):
            station.listen(due_s - time.monotonic())
            # From touch to touch: one that took long must not push the next ones together.
            due_s = time.monotonic() + 1.0 / self._plan.rate_per_s
            recording.played += self._strays(path, feed)
            for program in programs:
                if isinstance(program, Program):
                    program.check()
            recording.played.append(self._touch(path, feed, recording.scan_us))
            recording.played += self._strays(path, feed)
        station.listen(SETTLE_S)
        recording.played += self._strays(path, max(feeds))

    def _feeds(self) -> list[float]:
        """Give the feed of each touch: each of the plan's as often as any other, mixed."""
        feeds = np.resize(np.array(self._plan.feeds_mm_min), self._plan.touches)
        return [float(feed) for feed in self._random.permutation(feeds)]

    def _touch(self, path: InputPath, feed: float, scan_us: int) -> Played:
        """Trigger at a random instant, and wait for the edge and its latch."""
        station = self._station
        delay_us = self._delay_us(scan_us)
        sent_ns = time.monotonic_ns()
        planned_ns = sent_ns + int(delay_us * NS_PER_US)
        station.trigger(self._pulse, delay_us)
        reported_us = delay_us + self._plan.pulse_us  # an edge is reported when its pulse is over
        station.listen(reported_us / US_PER_S + EDGE_PATIENCE_S, lambda: station.edges)
        edge = station.edges.popleft() if station.edges else None
        after_us = self._plan.pulse_us + self._plan.load.debounce_us + 2 * scan_us
        arrival = self._latch(sent_ns, after_us / US_PER_S + LATCH_PATIENCE_S)
        return Played(path, feed, planned_ns, edge, arrival)

    def _delay_us(self, scan_us: int) -> int:
        """Draw a part of a scan, and of the busy process's period, so that edges fall anywhere.

        This program runs only while the busy process rests, which would show in the edges: any
        instant plus a uniform part of a period is uniform in that period.
        """
        delay_us = self._random.integers(0, scan_us)
        if self._plan.load.cpu_share:
            delay_us += self._random.integers(0, round(self._plan.load.cpu_period_us))
        return int(delay_us)

    def _latch(self, since_ns: int, patience_s: float) -> Arrival | None:
        """Wait for a latch since the trigger; one from before it is left for a stray.

        A scan that stamps its time and then reads a line that has just changed latches before the
        edge, so the edge is no limit.
        """

        def latched() -> Arrival | None:
            latches = self._station.latches
            return next((arrival for arrival in latches if arrival.latch_ns >= since_ns), None)

        self._station.listen(patience_s, latched)
        arrival = latched()
        if arrival is not None:
            self._station.latches.remove(arrival)
        return arrival

    def _strays(self, path: InputPath, feed: float) -> Iterator[Played]:
        """Give latches that no touch was waiting for."""
        while self._station.latches:
            stray: Arrival = self._station.latches.popleft()
            yield Played(path, feed, stray.latch_ns, None, stray, is_false=True)


def summary(recording: Recording) -> dict[str, float]:
    """Count what came of the touches."""
    played = recording.played
    windows_us = [touch.edge.window_ns / NS_PER_US for touch in played if touch.edge]
    seconds = (played[-1].contact_ns - played[0].contact_ns) / NS_PER_S if played else 0.0
    return {
        "scan_us": recording.scan_us,
        "touches": sum(not touch.is_false for touch in played),
        "missed": sum(touch.arrival is None for touch in played),
        "false": sum(touch.is_false for touch in played),
        "without_edge": sum(touch.edge is None and not touch.is_false for touch in played),
        "lost_latches": recording.lost_latches,
        "restarts": recording.restarts,
        "edge_window_us": float(np.median(windows_us)) if windows_us else 0.0,
        "widest_edge_window_us": max(windows_us, default=0.0),
        "duration_s": round(seconds, 3),
    }
