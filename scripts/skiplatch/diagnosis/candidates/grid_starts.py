"""Where the search begins for what lies on a grid: ticks, slots, updates, steps of a position."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import scipy

from skiplatch.arrays import FloatArray, winsorised
from skiplatch.diagnosis.candidates.positions import positions
from skiplatch.diagnosis.candidates.starts import later_us, unknown_sigma
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.likelihood.laws import law_under
from skiplatch.diagnosis.scene.grid import APART, FEWEST_STAMPS, grid_told, kept_grid
from skiplatch.diagnosis.scene.pitches import MANY_STEPS, odd_pitch, whole_pitches
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import parameter_of
from skiplatch.simulator.library import connection
from skiplatch.units import DEG_PER_TURN, UM_PER_MM

MOST_VALUES = 2000
"""By which lines are told, of more."""
CLEAR = 6.0
"""Standard deviations over which ages spread that are not all the same."""
SHARP_AGE = 0.1
"""Scatter of the age of a position, over that of all ages, that tells an update's time."""


def ticks(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose grids that the stamps lie on, and ticks that share no grid with the believed one."""
    tick = scene.nominal.skip.tick_us
    # One clock makes the stamps of both paths; those of scans keep a grid of their own as well.
    telling = scene.plc if scene.plc.all() else ~scene.plc
    pitches = whole_pitches(scene.touches.latch_us[telling], tick)
    on_grid = [[pitch, 0.0, nearest] for pitch in pitches for nearest in (0.0, 1.0)]
    usual = on_grid + [
        [ratio * tick, origin * ratio * tick, 0.0]
        for ratio in (3.0, 10.0, 30.0)
        for origin in (0.5, 0.05)
    ]
    mean, sigma = later_us(scene, given)
    if "latch_skip" not in scene.streams or np.isnan(mean):
        return usual
    width = _box_of(sigma, tick)
    seen = [[width, mean + 0.5 * width, 0.0]]
    widest = parameter_of("timer_quantisation", "tick_us").high
    # Stamps are rounded down; those of both paths, if one clock makes them.
    step = scene.stamp_step_us
    stamps = scene.touches.latch_us + 0.5 * step
    on_skip, stamps = stamps[scene.streams["latch_skip"].rows], stamps[~np.isnan(stamps)]
    told = _lines_told(stamps, step, widest) or _lines_told(on_skip, step, widest)
    # Few stamps tell no steps, but show how wide they are.
    means = mean, later_us(scene, given, is_datum_fitted=True)[0]
    for pitch, turn in (*told, *_grids_as_wide(stamps, width, step)):
        for nearest, later in product((0.0, 1.0), means):
            whole = np.rint((later + 0.5 * (1.0 - nearest) * pitch) / pitch - turn)
            seen.append([pitch, (turn + whole) * pitch, nearest])
    return [*np.unique(seen, axis=0).tolist(), *usual]


def resolutions(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose grids that deviations lie on, or coordinates: what is coarse shows its steps."""
    fine = scene.nominal.axis.resolution_um
    deviations = scene.touches.deviation_um
    pitches = [*whole_pitches(deviations, fine), *odd_pitch(deviations, fine)]
    return [[pitch, 0.0, 0.0] for pitch in pitches] + _coordinate_lines(scene, given)


def slots(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose slots anywhere, and those that the skip path's stamps keep."""
    usual = [[slot_us, 0.0] for slot_us in (50.0, 500.0, 4000.0)]
    skip = scene.nominal.skip
    mean_us, sigma_us = later_us(scene, given)
    # Slots that are lost in the scatter keep their grid all the same, and cost half of one.
    spans_us = [us for us in (_box_of(sigma_us), 2.0 * mean_us) if us > skip.tick_us]
    if "latch_skip" not in scene.streams or not spans_us:
        return usual
    behind_us = (
        scene.nominal.input.filter_us + skip.latency_us + (skip.jitter_us - skip.tick_us) / 2.0
    )
    after_us = behind_us + given.skip_us + given.stamp_us
    ends_us = (scene.touches.latch_us - after_us)[scene.streams["latch_skip"].rows]
    seen = []
    for slot_us, turn in (grid for us in spans_us for grid in _grids_kept(ends_us, us)):
        # What keeps the ends of slots keeps those of slots half as long as well.
        seen += [
            [slot_us, turn],
            [2.0 * slot_us, turn / 2.0],
            [2.0 * slot_us, turn / 2.0 + 0.5],
        ]
    seen = [[slot_us, turn * DEG_PER_TURN] for slot_us, turn in seen]
    return [*seen, *usual]


def holds(scene: Scene, given: Change) -> Sequence[Sequence[float]]:
    """Propose periods of updates anywhere, and what is told by the ages of positions at stamps."""
    usual = [[period_us, 0.0, 0.0] for period_us in (50.0, 500.0, 2000.0)]
    stream = scene.streams.get("position")
    if stream is None or not scene.has_stamps.any():
        return usual
    law = law_under(scene, stream, given)
    ages_us = (law.mean - stream.residuals) / scene.speed
    unsure_us = law.spread / scene.speed
    rows = stream.rows & scene.has_stamps
    if rows.sum() < FEWEST_STAMPS:
        return usual
    # Where feeds are far apart, the age shows at the fastest touches alone.
    sharp = rows & (unsure_us <= np.sort(unsure_us[rows])[FEWEST_STAMPS - 1])
    span_us = float(np.ptp(winsorised(ages_us[sharp])))
    is_news = span_us > CLEAR * float(unsure_us[sharp].max())
    sharp = rows & (unsure_us < SHARP_AGE * span_us)
    if not is_news or not sharp.any():
        return usual
    updates_us = (scene.touches.latch_us - ages_us)[sharp]
    dead_us = max(float(ages_us[sharp].min()), 0.0)
    seen = []
    for period_us, middle in _grids_kept(updates_us, span_us):
        for age_us in (0.0, dead_us):
            turn = (middle + age_us / period_us) % 1.0 or 1.0
            seen.append([period_us, age_us, turn * DEG_PER_TURN])
    return [*seen, *usual]


def _coordinate_lines(scene: Scene, given: Change) -> list[list[float]]:
    """Propose grids that coordinates keep: of their own steps, and as wide as the scatter says."""
    fine = scene.nominal.axis.resolution_um
    told_of = positions(scene, given)
    if not len(told_of.rows):
        return []
    where_um = scene.latched_mm[~np.isnan(scene.touches.deviation_um)] * UM_PER_MM
    where_um = where_um[~np.isnan(where_um)]
    widest = parameter_of("encoder_quantisation", "resolution_um").high
    told = [*_lines_told(where_um, fine, widest), *_whole_lines(where_um, fine, widest)]
    seen_um = _box_of(unknown_sigma(told_of.off_um, told_of.spread_um), fine)
    seen = _grids_as_wide(where_um, seen_um, fine)
    return [[pitch, 1.0, turn or 1.0] for pitch, turn in (*told, *seen)]


def _lines_told(values: FloatArray, fine: float, widest: float) -> list[tuple[float, float]]:
    """Give the coarsest grid of lines apart by more than rounding that values keep, or none.

    Its period comes with where it lies, a share of that.
    """
    grid = grid_told(np.sort(values), fine, widest)
    far = connection()[1].SIM_LINES_APART * fine
    if not grid or grid[0] <= far:
        return []
    pitch, line = _midway(values, *_coarsest(values, *grid))
    return [(pitch, line / pitch % 1.0)]


def _whole_lines(values: FloatArray, fine: float, widest: float) -> list[tuple[float, float]]:
    """Give grids of whole steps that hold values of few places, through one of these."""
    if not len(values):
        return []
    pitches = whole_pitches(values - values[0], fine)
    return [(pitch, values[0] / pitch % 1.0) for pitch in pitches if 2.0 * fine < pitch <= widest]


def _midway(values: FloatArray, pitch: float, turn: float) -> tuple[float, float]:
    """Move lines so that no value is farther from its own than it has to be; give pitch and line.

    Rounded values lie within half a step of what they were rounded from, and none lies beyond: by
    the mean of all, some of many do.
    """
    some = values[np.linspace(0, len(values) - 1, min(len(values), MOST_VALUES)).astype(int)]
    line = turn * pitch
    counts = np.rint((some - line) / pitch)
    off, most = some - line - counts * pitch, float(np.abs(counts).max()) or 1.0
    lines, farthest = np.column_stack([counts / most, np.ones(len(some))]), -np.ones((len(some), 1))
    found = scipy.optimize.linprog(
        [0.0, 0.0, 1.0],
        A_ub=np.block([[lines, farthest], [-lines, farthest]]),
        b_ub=np.concatenate([off, -off]),
        bounds=(None, None),
    )
    moved = np.zeros(3) if found.x is None else found.x
    return pitch + float(moved[0]) / most, line + float(moved[1])


def _box_of(sigma: float, known: float = 0.0) -> float:
    """Give the width of a box with so much scatter beside a known box."""
    return float(np.hypot(np.sqrt(12.0) * sigma, known))


def _coarsest(values: FloatArray, period: float, turn: float) -> tuple[float, float]:
    """Give the coarsest grid that holds the lines that values keep: what keeps it keeps finer."""
    lines = np.rint(values / period - turn).astype(np.int64)
    step = int(np.gcd.reduce(lines - lines[0])) or 1
    return step * period, (int(lines[0]) % step + turn) / step


def _grids_as_wide(values: FloatArray, width: float, fine: float) -> list[tuple[float, float]]:
    """Give the grids that values keep about as wide as their scatter says, if rounding is none."""
    return _grids_kept(values, width) if width >= MANY_STEPS * fine else []


def _grids_kept(values: FloatArray, guess: float) -> list[tuple[float, float]]:
    """Give the grids, each not too far from the guess, that values keep by no accident.

    With each comes where it lies as a share of its period, above 0 and not above 1.
    """
    in_order, guesses = np.sort(values), (guess / APART, guess, guess * APART)
    kept = [kept_grid(in_order, near) for near in guesses]
    return [(grid[0], grid[1] or 1.0) for grid in kept if grid]
