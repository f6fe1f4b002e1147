"""What values on the lines of a coarse grid add to their likelihood."""

from dataclasses import replace

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.density.change import Change, Number
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import ROUNDING
from skiplatch.diagnosis.scene.grid import folded
from skiplatch.diagnosis.scene.scene import Scene

OFF_GRID = 1e-3
"""Share of values that may lie off a coarse grid."""
MOSTLY = 0.5
"""Share of values from which on those that keep no grid say that there is none."""
KNOWN_TO = 2.0
"""Believed ticks to which the lines of a foreign clock are known: its ticks are rounded so."""
FAR_APART = 8.0
"""Believed ticks between such lines from which on stamps show them: closer ones beat with these."""
FAR_OFF = 0.01
"""Of the mean density of a law, beyond which a value is none of it."""


def line_bonus(scene: Scene, stream: Stream, change: Change) -> FloatArray:
    """A coarse grid holds all its probability on few values: what that adds to the logarithm."""
    if stream.name == "latch_skip":
        return _in_ticks(scene, stream, change) + _in_slots(scene, stream, change)
    if stream.unit == "µm":
        deviation_um, fine_um = scene.touches.deviation_um, scene.nominal.axis.resolution_um
        return _by_lines(deviation_um, change.line_um, change.coarse_um, fine_um, stream.rows)
    return np.zeros(len(scene))


def _in_ticks(scene: Scene, stream: Stream, change: Change) -> FloatArray:
    """Weigh stamps by whether they lie on coarse ticks."""
    tick_us, line_us, coarse_us = scene.nominal.skip.tick_us, change.tick_line_us, change.coarse_us
    if line_us and coarse_us < FAR_APART * tick_us:
        return np.zeros(len(scene))
    fine_us = KNOWN_TO * tick_us if line_us else tick_us
    # A clock has one grid: stamps that mostly keep none were not rounded to it.
    return _by_lines(
        scene.touches.latch_us, line_us, coarse_us, fine_us, stream.rows, gridless=np.log(OFF_GRID)
    )


def _in_slots(scene: Scene, stream: Stream, change: Change) -> FloatArray:
    """Weigh stamps by the slots that triggers arrive in: latched so soon after the end of one.

    How long a trigger waits for that is in the law already, wherever the slots end.
    """
    width_us = scene.nominal.skip.jitter_us + scene.nominal.skip.tick_us
    if change.slots is None or change.slots[0] < 2.0 * width_us:
        return np.zeros(len(scene))
    slot_us, phase_us = change.slots
    behind_us = scene.nominal.input.filter_us + scene.nominal.skip.latency_us + change.skip_us
    off_us = folded(scene.touches.latch_us - behind_us - change.stamp_us - phase_us, slot_us)
    sharp = replace(stream.chain, sigma=np.zeros(len(scene)), box_a=scene.scatter_us)
    density = np.exp(sharp.log_density(np.nan_to_num(off_us), slot_us)) * stream.rows
    share_off = float(np.mean(density[stream.rows] * width_us < FAR_OFF))
    anywhere = _share_anywhere(share_off, slot_us, width_us)
    return np.where(stream.rows, np.log(anywhere + (1.0 - anywhere) * slot_us * density), 0.0)


def _share_anywhere(share_off: float, period: float, width: float) -> float:
    """Give the likeliest share of values that keep no grid, if so many are off lines so wide.

    All of them, unless most are on its lines: some grid of so many holds a few by accident.
    """
    share = max(share_off * period / (period - width), OFF_GRID)
    return share if share < MOSTLY else 1.0


def _by_lines(
    values: FloatArray,
    line: Number,
    coarse: float,
    fine: float,
    rows: BoolArray,
    gridless: float = 0.0,
) -> FloatArray:
    """Weigh values by whether they lie on lines `coarse` apart, shape (n,); 0 of what is unknown.

    Of lines that are told by the touches, these decide as well how many keep them at all: steps of
    more than one size do not, nor do those of another surface than the one recorded.

    Args:
        values: Shape (n,).
        line: Where one line is for each value; 0 for all where the believed grid has it, too.
        coarse: Distance of the lines.
        fine: What the values are rounded to, to the nearest or down.
        rows: Which of them count; shape (n,).
        gridless: What speaks against each if they say that they keep no lines.
    """
    if coarse <= fine:
        return np.zeros(len(values))
    known = rows & ~np.isnan(values)
    off = folded(values - line, coarse) / fine
    nearest, down = np.abs(off) < 0.5, (off > ROUNDING - 1.0) & (off < ROUNDING)
    is_on = nearest if nearest[known].sum() >= down[known].sum() else down
    anywhere = OFF_GRID
    if np.any(line):
        share_off = float(np.mean(~is_on[known])) if known.any() else 1.0
        anywhere = _share_anywhere(share_off, coarse, fine)
    if anywhere == 1.0:
        return np.where(known, gridless, 0.0)
    on_a_line = anywhere + (1.0 - anywhere) * coarse / fine
    return np.where(known, np.log(np.where(is_on, on_a_line, anywhere)), 0.0)
