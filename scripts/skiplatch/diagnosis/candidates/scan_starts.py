"""Where the search for the parameters of an effect on the scans begins."""

from collections.abc import Sequence

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.scan_surrogates import FEW_TICKS
from skiplatch.diagnosis.candidates.surrogates import LOOSEST
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.likelihood.scan_wait import SHORTEST_PERIOD
from skiplatch.diagnosis.scene.grid import (
    APART,
    FEWEST_STAMPS,
    folded,
    grid_period,
    kept_grid,
    mean_turn,
    off_grid,
    sharpened,
)
from skiplatch.diagnosis.scene.scene import Scene

FEWEST_LATE = 3
MOST_SCANS_LATE = 8
PLACES = 20
"""Of a scan, at which edges are counted."""
EARLIEST = 0.02
"""Share of the scans that may begin sooner than what is taken for on time."""
WELL_KEPT = 0.95
"""Length of the mean turn of stamps that keep a grid, from which on no other is looked for."""
OTHER_PERIODS = tuple(APART**k for k in (-3, -2, -1, 1, 2, 3))
"""Of the scan, over the believed one, about which a grid is looked for."""
MOST_STAMPS = 1000
"""Touches of a whole campaign, up to which half of it may have too few stamps to tell a grid."""
SHARP = 0.02
"""Scatter of the edge, over the scan period, that does not blur the waits for a scan."""


def overruns(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose the reach of the late stamps, that scan or the one after being late."""
    period = scene.nominal.plc.scan_us
    usual = [
        [0.05, share * period, span * period, 0.0]
        for share, span in ((0.3, 0.0), (0.5, 0.0), (1.2, 0.0), (2.3, 0.0), (0.5, 1.0), (1.5, 1.0))
    ]
    longest = _whole_scans_late(scene)
    usual.append([0.02, 0.0, max(longest, 2) * period, 1.0])
    stream = scene.streams.get("lattice")
    if stream is None:
        return usual
    late = (stream.known - np.median(stream.known)) % period
    on_time = FEW_TICKS * scene.nominal.skip.tick_us
    late = late[np.abs(late - period / 2.0) < 0.5 * period - on_time]
    if len(late) < FEWEST_LATE:
        return usual
    low, span = float(late.min()), float(np.ptp(late))
    reaches = [(low, span), (low + period, span), (0.0, low + span), (float(np.median(late)), 0.0)]
    apart = _apart(stream.known % period, period)
    first, width = float(apart.min()), float(np.ptp(apart))
    seen = [(len(apart), first, width)]
    seen += [(len(late), us, more) for us, more in reaches]
    # By whole periods more, too; scans so late that most edges meet them are thought to be on time.
    for whole_us in period * np.arange(1, longest + 1):
        seen.append((len(apart), first + whole_us, width))
        seen.append((len(stream.known) - len(apart), whole_us - first - width, 0.0))
    # The longer gap before a late scan meets more edges than it is scans.
    met = [
        [n / len(stream.known) / (1.0 + (us + more / 2.0) / period), us, more, 0.0]
        for n, us, more in seen
    ]
    return [*met, *usual]


def _whole_scans_late(scene: Scene) -> int:
    """Give by how many whole scans the longest wait is longer than any should be."""
    stream = scene.streams.get("latch_plc")
    if stream is None or not stream.rows.any():
        return 0
    longest_us = float(np.max((stream.residuals - stream.law.mean)[stream.rows]))
    return min(int(longest_us / scene.nominal.plc.scan_us + 0.5), MOST_SCANS_LATE)


def jitters(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose how late scans are by how far their stamps lie behind the first of the grid."""
    usual = [[20.0, 5.0, 0.0], [200.0, 100.0, 0.0], [100.0, 500.0, 0.0], [10.0, 0.0, 0.5]]
    stream = scene.streams.get("lattice")
    if stream is None:
        return usual
    off_us = off_grid(stream.known, scene.nominal.plc.scan_us)
    late_us = off_us - np.quantile(off_us, EARLIEST)
    is_late = late_us > FEW_TICKS * scene.nominal.skip.tick_us
    if is_late.sum() < FEWEST_LATE:
        return usual
    mean_us, box_us = float(np.mean(late_us)), float(np.sqrt(12.0) * np.std(late_us))
    often_us, on_time = float(np.mean(late_us[is_late])), 1.0 - float(is_late.mean())
    now_and_then = [[0.0, often_us, on_time], [2.0 * often_us, 0.0, on_time]]
    return [[box_us, 0.0, 0.0], [0.0, mean_us, 0.0], *now_and_then, *usual]


def _apart(places: FloatArray, period: float) -> FloatArray:
    """Give how late those are that lie apart, behind others that may be a little late themselves.

    Counted from the first place behind the widest empty stretch of the turn.
    """
    turn = np.sort(places)
    widest = int(np.argmax(np.diff(turn, append=turn[0] + period)))
    late = np.sort((turn - turn[(widest + 1) % len(turn)]) % period)
    return late[int(np.argmax(np.diff(late))) + 1 :]


def locks(scene: Scene, _given: Change) -> Sequence[Sequence[float]]:
    """Propose phases anywhere, and that of the touches whose stamps keep no grid with others."""
    usual = [
        *([phase, 0.1, 0.0, 0.0, 0.0] for phase in (0.2, 0.5, 0.8)),
        *([phase, 0.05, 0.5, 0.0, 0.0] for phase in (0.1, 0.3, 0.5, 0.7, 0.9)),
    ]
    grid, waits = scene.streams.get("lattice"), scene.streams.get("latch_plc")
    if grid is None or waits is None:
        return usual
    period = scene.nominal.plc.scan_us
    rows = grid.rows & waits.rows
    off = folded(grid.residuals - np.median(grid.known), period)
    is_off = np.abs(off[rows]) > SHARP * period
    if is_off.sum() < FEWEST_LATE:
        return usual
    turns = np.exp(2j * np.pi * waits.residuals[rows][is_off] / period)
    wait = float(np.angle(turns.mean())) / (2.0 * np.pi)
    spread = float(np.sqrt(max(-2.0 * np.log(np.abs(turns.mean())), 1e-6))) / (2.0 * np.pi)
    unlocked = 1.0 - float(is_off.mean())
    two = _two_points(np.angle(np.conj(turns)) / (2.0 * np.pi) % 1.0)
    return [
        [-wait % 1.0, min(spread, LOOSEST), unlocked, 0.0, 0.0],
        [two[0], 1.0 / PLACES, unlocked, *two[1:]],
        *usual,
    ]


def _two_points(phases: FloatArray) -> tuple[float, float, float]:
    """Give where most phases lie, how much later others do, and what share those are."""
    counts, edges = np.histogram(phases, PLACES, (0.0, 1.0))
    near = counts + np.roll(counts, 1) + np.roll(counts, -1)
    first = int(np.argmax(near))
    apart = (np.arange(PLACES) - first) % PLACES
    others = np.where((apart > 2) & (apart < PLACES - 2), near, 0)
    second = int(np.argmax(others))
    share = float(others[second]) / float(near[first] + others[second])
    return float(edges[first]) + 0.5 / PLACES, float(apart[second]) / PLACES, share


def scan_periods(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose periods by their waits, and by the grid that the stamps keep."""
    believed = scene.nominal.plc.scan_us
    coarse = [[share * believed] for share in (-0.5, -0.2, -0.05, 0.05, 0.2, 0.5, 1.0)]
    stream = scene.streams.get("latch_plc")
    if stream is None or stream.rows.sum() < FEWEST_STAMPS:
        return [*_told_by_all(scene), *coarse]
    sharp = stream.rows & (scene.mechanics_us < SHARP * believed)
    waits = stream.residuals[sharp if sharp.sum() >= FEWEST_STAMPS else stream.rows]
    # Where the scans bind the edges, the waits differ by far less than a period.
    width = max(float(np.ptp(np.quantile(waits, [0.01, 0.99]))), SHORTEST_PERIOD * believed)
    stamps = np.sort((scene.touches.latch_us - given.stamp_us)[stream.rows])
    near = [grid_period(stamps, guess) for guess in (width, believed)]
    far = [] if np.abs(mean_turn(stamps, near[1])) > WELL_KEPT else _far_periods(stamps, believed)
    wider = _wider(stamps, near[1], width)
    periods = [sharpened(stamps, period)[0] for period in (*near, *far, *wider)]
    return [*([period - believed] for period in periods), [width - believed], *coarse]


def _wider(stamps: FloatArray, period: float, longest: float) -> list[float]:
    """Give the multiples of a period whose grids stamps keep as well: a grid keeps its parts'."""
    multiples = period * np.arange(2, int(longest / period) + 1)
    return [wider for wider in multiples.tolist() if np.abs(mean_turn(stamps, wider)) > WELL_KEPT]


def _told_by_all(scene: Scene) -> list[list[float]]:
    """Propose the grid that all stamps of a campaign keep by no accident, if a part is too few.

    The scans run on from touch to touch. What the period gains is judged by touches apart.
    """
    whole, _ = scene.in_sequence(MOST_STAMPS)
    stamps, believed = np.sort(whole.touches.latch_us[whole.plc]), scene.nominal.plc.scan_us
    stamps = stamps[~np.isnan(stamps)]
    grid = kept_grid(stamps, believed)
    return [[grid[0] - believed]] if grid else []


def _far_periods(stamps: FloatArray, believed: float) -> list[float]:
    """Propose grids of periods far from the believed one."""
    found = [grid_period(stamps, ratio * believed, FEWEST_STAMPS) for ratio in OTHER_PERIODS]
    return [period for period in found if period > SHORTEST_PERIOD * believed]
