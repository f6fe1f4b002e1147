"""Logs of CAN traffic with the project's own frames: latch records and edge reports.

candump -L, ASC, BLF and what else python-can reads.
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import can
import numpy as np

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.bench.latches import TICK_NS, TICKS, Latch, LatchReports
from skiplatch.bench.protocol import EDGE_ID, LATCH_ID, Edge, EdgeReports
from skiplatch.campaign import NOT_RECORDED, InputPath, Kind, Status, Touches
from skiplatch.errors import CampaignWarning, InputError
from skiplatch.files import foreign_reader
from skiplatch.importing.apart import read_apart
from skiplatch.importing.candump import is_logged, is_shown, shown_frames
from skiplatch.importing.encodings import in_utf8
from skiplatch.importing.model import Imported
from skiplatch.importing.packed import unpacked
from skiplatch.units import NS_PER_US

MDF = ".mf4"
"""Ending of what python-can has asammdf read."""
MOST_BYTES = 2 * 2**30
MOST_MISSED = 0.5  # of the edges; with more of them the two clocks are hardly the same
LATEST_NS = 1_000_000_000  # from an edge to its latch
FEWEST_EARLY = 5  # latches before their edges, from which on they tell how stamps scatter
EARLY = 0.01
"""Of the time since the edge before: stamps that scatter may tell a latch so long before its edge,
which may also have come any time within its window."""


@dataclass(frozen=True, slots=True)
class _Traffic:
    """What was found on the bus.

    Attributes:
        edges: In the order in which they were reported.
        latches: Likewise.
        after_lost: Whether the log lost records just before each.
        latch_ns: Their device clock, extended beyond its 32 bits.
        lost: Records that are missing, damaged or without their other half.
    """

    edges: list[Edge]
    latches: list[Latch]
    after_lost: list[bool]
    latch_ns: list[int]
    lost: int


def read_can(path: Path) -> Imported:
    """Read a log.

    Raises:
        InputError: It cannot be read, or holds no latch record.
    """
    traffic = read_apart(_read, path) if path.suffix.lower() == MDF else _read(path)
    if not traffic.latches:
        expected = f"expected latch records, two frames of id {LATCH_ID:#x} each, found none"
        raise InputError(path, None, None, expected)
    found = Imported(kind=Kind.BENCH, preset="bench")
    if traffic.edges:
        found.columns = _of_edges(traffic, found)
    else:
        found.columns = _of_latches(traffic)
        found.assumed.append(
            "no edge reports on the bus: latches alone, so no delay can be told, only their paths "
            "and the times between them"
        )
    found.figure("skip", "tick_us", TICK_NS / NS_PER_US, "tick of the latch record's clock")
    if traffic.lost:
        found.unread.append(f"{traffic.lost} frames or records are damaged, lost or without a half")
    found.assumed.append(
        "the log's own times are of another clock than the records: report_us is left out"
    )
    return found


def _read(path: Path) -> _Traffic:
    latches, edges = LatchReports(), EdgeReports()
    found_latches: list[Latch] = []
    after_lost: list[bool] = []
    found_edges: list[Edge] = []
    for number, data in _frames(path):
        lost = latches.lost
        if number == LATCH_ID and (latch := latches.take(data)):
            # A log that begins with a later record had some before.
            is_first = not found_latches
            after_lost.append(latch.sequence > 0 if is_first else latches.lost > lost)
            found_latches.append(latch)
        elif number == EDGE_ID and (edge := edges.take(data)):
            found_edges.append(edge)
    lost = latches.lost + latches.damaged + latches.unpaired + edges.damaged + edges.unpaired
    latch_ns = _extended(found_latches, found_edges)
    return _Traffic(found_edges, found_latches, after_lost, latch_ns, lost)


def _frames(path: Path) -> Iterator[tuple[int, bytes]]:
    """Give id and bytes of each frame; what candump wrote is known by its lines."""
    with foreign_reader(path, MOST_BYTES, "log that python-can reads"):
        if is_shown(path):
            yield from shown_frames(path)
            return
        with (
            unpacked(path, MOST_BYTES) as whole,
            in_utf8(whole) as plain,
            _reader(plain) as reader,
        ):
            for message in _up_to_a_break(path, reader):
                yield message.arbitration_id, bytes(message.data)


def _up_to_a_break(path: Path, reader: can.io.generic.MessageReader) -> Iterator[can.Message]:
    """Give the frames up to a line that holds none, as the last one of a log that was cut."""
    read = 0
    messages = iter(reader)
    while True:
        try:
            message = next(messages, None)
        except ValueError as error:
            if not read:
                expected = "expected frames of a CAN bus, as candump and python-can write them"
                raise InputError(path, None, None, f"{expected}, found none") from error
            said = f"a line holds no frame: nothing was read after the {read} frames before it"
            warnings.warn(CampaignWarning(path, None, None, said), stacklevel=2)
            return
        if message is None:
            return
        read += 1
        yield message


def _reader(path: Path) -> can.io.generic.MessageReader:
    return can.CanutilsLogReader(path) if is_logged(path) else can.LogReader(path)


def _extended(latches: list[Latch], edges: list[Edge]) -> list[int]:
    """Extend the clock, from the first edge on where there is one."""
    if not latches:
        return []
    about = edges[0].time_ns // TICK_NS if edges else latches[0].ticks
    found = []
    for latch in latches:
        ahead = (latch.ticks - about + TICKS // 2) % TICKS - TICKS // 2
        about += ahead
        found.append(about * TICK_NS)
    return found


def _of_edges(traffic: _Traffic, found: Imported) -> Touches:
    edge_ns = np.array([edge.time_ns for edge in traffic.edges], dtype=float)
    windows_ns = np.array([edge.window_ns for edge in traffic.edges], dtype=float)
    latch_ns = np.array(traffic.latch_ns, dtype=float)
    order = np.argsort(latch_ns, kind="stable")
    index, missed = _own_latches(edge_ns, windows_ns, latch_ns[order])
    latched = np.append(latch_ns[order], np.inf)[index]
    row = order[np.minimum(index, len(order) - 1)]
    zero = float(edge_ns[0])
    lost = missed & np.append(np.array(traffic.after_lost)[order], False)[index]
    _say_clocks(found, missed & ~lost, len(latch_ns))
    if lost.any():
        found.unread.append(
            f"edges whose latch record the log lost, as the numbers of the records tell: "
            f"{int(lost.sum())}; what came of them is not known"
        )
    path = np.array([_path(traffic.latches[i]) for i in row])
    waits_us = (latched - edge_ns)[~missed & (path == InputPath.SKIP)] / NS_PER_US
    _say_windows(found, windows_ns / NS_PER_US, _scatter(waits_us))
    return Touches.from_columns(
        touch=np.arange(len(edge_ns)),
        path=path,
        edge_us=(edge_ns - zero) / NS_PER_US,
        latch_us=np.where(missed, np.nan, (latched - zero) / NS_PER_US),
        status=np.where(lost, NOT_RECORDED, np.where(missed, Status.MISSED, Status.OK)),
    )


def _own_latches(
    edge_ns: FloatArray, windows_ns: FloatArray, latch_ns: FloatArray
) -> tuple[IndexArray, BoolArray]:
    """Give the place of each edge's own latch among all, and which edges have none.

    That is the first one after the edge. It may stand a little before it: a scan stamps its time
    and then reads the line, and stamps scatter. Of such a one and the next the nearer one counts.
    """
    since = np.diff(edge_ns, prepend=np.nan)
    since[0] = np.nanmin(since) if len(since) > 1 else 0.0
    begins = edge_ns - np.maximum(windows_ns.max(), EARLY * since)
    ends = np.append(begins[1:], np.inf)
    index = np.searchsorted(latch_ns, begins)
    first, second = (np.append(latch_ns, [np.inf, np.inf])[index + i] for i in (0, 1))
    is_second = (second < ends) & (np.abs(second - edge_ns) < edge_ns - first)
    own = np.where(is_second, second, first)
    return index + is_second, (own >= ends) | (own - edge_ns > LATEST_NS)


def _say_clocks(found: Imported, missed: BoolArray, latches: int) -> None:
    if missed.any():
        found.known.append(f"edges without a latch: {int(missed.sum())}")
    if missed.mean() > MOST_MISSED:
        found.assumed.append(
            f"the ticks of the latch records are {TICK_NS} ns of the clock that stamps the edges, "
            f"as of the Linux port: few of {latches} latches follow an edge, so it may be "
            "another clock or tick"
        )
    found.known.append("edges and latches, both by CLOCK_MONOTONIC of the rig")


def _scatter(waits_us: FloatArray) -> float:
    """Give how stamps scatter at least by waits of a skip input for edges; 0 where none shows.

    No interrupt comes before its edge. What stands before it is the half of a scatter about 0, or
    less than that where there is a delay.
    """
    before = waits_us[waits_us < 0.0]
    return float(np.sqrt(np.mean(before**2))) if len(before) >= FEWEST_EARLY else 0.0


def _say_windows(found: Imported, windows_us: FloatArray, scatter_us: float) -> None:
    middle_us = float(np.median(windows_us))
    found.assumed.append(
        "the beginning of its window stands for an edge, as for bench run: it came up to "
        f"{middle_us:.4g} µs later"
    )
    noise_us, source = (
        middle_us / np.sqrt(12.0),
        "width of the window that edge reports give, over √12",
    )
    if scatter_us > noise_us:
        noise_us, source = scatter_us, "by latches before their edges, which scattered stamps make"
        found.assumed.append(
            f"stamps scatter by {scatter_us:.3g} µs, more than their windows say: latches of the "
            "skip input stand before their edges"
        )
    found.figure("bench", "reference_jitter_us", noise_us, source)


def _of_latches(traffic: _Traffic) -> Touches:
    latch_ns = np.array(traffic.latch_ns, dtype=float)
    return Touches.from_columns(
        touch=np.arange(len(latch_ns)),
        path=np.array([_path(latch) for latch in traffic.latches]),
        latch_us=(latch_ns - latch_ns[0]) / NS_PER_US,
    )


def _path(latch: Latch) -> InputPath:
    return InputPath.PLC if latch.path == "plc" else InputPath.SKIP
