"""What is left once the effects found are taken into account: does it still look like something?

Residuals of a right model are independent of everything that was recorded, and as wide as they
should be. What is not is told by where it sits and what it looks like.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import stats

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.law import SMALLEST
from skiplatch.diagnosis.likelihood import law_under
from skiplatch.diagnosis.material import DEFAULT, Materiality, is_rest_material
from skiplatch.diagnosis.scene import Scene, Stream, rounding_step

OUTLIERS = "now and then far off"
SCATTER = "scatter differs from the believed one"

ALPHA = 1e-3
"""False-alarm rate of one diagnosis, over all looks together."""
WINSOR = 4.0
LEAST_CORRELATION = 0.15
"""Correlations below explain less than 2 % of the scatter: not material."""
LEAST_EXCESS = 1.25
"""Scatter over what it should be that is material."""
BEYOND_BOXES = 1.8
"""Standard deviations that no box reaches."""
OUTLIER = 6.0
USUAL_OUTLIERS = 2e-3
FEWEST = 20
RESOLVED = 0.25
"""Rounding steps below which a shift is none."""
MOST_OF_ROUNDING = float(np.sqrt(1.0 / 4.0 - 1.0 / 12.0))
"""The same of scatter: what is rounded from anywhere scatters by a twelfth of the step squared,
what is rounded up or down from one place by as much as a fourth."""
GOES_WITH, GOES_WITHOUT = 0.9, 0.3
"""Correlations of a shift with a condition that it goes with, and with one that it does not."""


@dataclass(frozen=True, slots=True)
class Structure:
    """One thing that should not be there."""

    stream: Stream
    looks_like: str
    size: float
    """A correlation, a ratio of scatters or a share of touches."""
    p_value: float

    @property
    def is_condition(self) -> bool:
        """It names something recorded that the residuals go with."""
        return self.looks_like not in (OUTLIERS, SCATTER)

    @property
    def unit(self) -> str:
        """Of what it moves."""
        return "1" if self.looks_like == OUTLIERS else self.stream.unit

    @property
    def moves(self) -> float:
        """What it shifts or scatters residuals by, root mean square; or the share far off."""
        if self.looks_like == OUTLIERS:
            return self.size
        spread = float(np.median(self.stream.law.spread[self.stream.rows]))
        if self.looks_like == SCATTER:
            return spread * float(np.sqrt(abs(self.size**2 - 1.0)))
        return spread * abs(self.size)


def structures(scene: Scene, change: Change, materiality: Materiality = DEFAULT) -> list[Structure]:
    """Look for what is left in every stream; the most significant first."""
    found = []
    looks = 0
    for stream in scene.streams.values():
        if stream.name == "lattice" or stream.rows.sum() < FEWEST:
            continue
        if not is_rest_material(scene, stream, change, materiality):
            continue
        seen = _looks(scene, stream, change)
        looks += len(seen)
        found += seen
    limit = ALPHA / max(looks, 1)
    return sorted(
        (s for s in found if s.p_value < limit and _is_material(s) and _is_resolved(scene, s)),
        key=lambda s: s.p_value,
    )


def _is_resolved(scene: Scene, structure: Structure) -> bool:
    """Tell it from rounding, which need not be as random as its law has it."""
    if structure.looks_like == OUTLIERS:
        return True
    stream, step = structure.stream, rounding_step(scene, structure.stream)
    spread = float(np.median(stream.law.spread[stream.rows]))
    if structure.looks_like == SCATTER:
        more = spread * np.sqrt(max(structure.size**2 - 1.0, 0.0))
        return bool(more > MOST_OF_ROUNDING * step)
    return abs(structure.size) * spread > RESOLVED * step


def _is_material(structure: Structure) -> bool:
    if structure.looks_like == OUTLIERS:
        return structure.size > USUAL_OUTLIERS
    if structure.looks_like == SCATTER:
        return structure.size > LEAST_EXCESS
    return abs(structure.size) > LEAST_CORRELATION


def goes_its_own_way(scene: Scene, change: Change, other: Change) -> bool:
    """Tell whether a change shifts some stream with a condition that the other does not go with."""
    for stream in scene.streams.values():
        rows = stream.rows
        own, others = (
            (law_under(scene, stream, c).mean - stream.law.mean)[rows] for c in (change, other)
        )
        for values in features(scene, stream).values():
            goes, other_goes = (abs(_pearson(shift, values[rows])) for shift in (own, others))
            if goes > GOES_WITH and other_goes < GOES_WITHOUT:
                return True
    return False


def _pearson(shift: FloatArray, values: FloatArray) -> float:
    """Correlation of two arrays; 0 where one of them is the same everywhere."""
    is_same = min(np.ptp(shift), np.ptp(values)) < SMALLEST
    return 0.0 if is_same else float(np.corrcoef(shift, values)[0, 1])


def _looks(scene: Scene, stream: Stream, change: Change) -> list[Structure]:
    rows = stream.rows
    law = law_under(scene, stream, change).select(rows)
    spread = np.sqrt(np.maximum(law.variance, SMALLEST**2))
    scores = (stream.residuals[rows] - law.mean) / spread
    calm = np.clip(scores, -WINSOR, WINSOR)
    n = len(calm)
    # Rounding puts a value a step off, which is far where the rest hardly scatters.
    allowed = OUTLIER * spread + rounding_step(scene, stream)
    far = int((np.abs(stream.residuals[rows] - law.mean) > allowed).sum())
    found = [
        Structure(stream, OUTLIERS, far / n, float(stats.binom.sf(far - 1, n, USUAL_OUTLIERS)))
    ]
    found.append(_scatter(stream, calm[np.abs(scores) <= OUTLIER]))
    # Rounding leaves less scatter than its box where the rest stands still: that is no news.
    excess = np.maximum(np.abs(calm) - BEYOND_BOXES, 0.0)
    for name, values in features(scene, stream).items():
        found.append(_correlation(stream, name, calm, values[rows]))
        found.append(_correlation(stream, f"scatter with {name}", excess, values[rows]))
    found.append(_correlation(stream, "the touch before", calm[1:], calm[:-1]))
    return found


def _scatter(stream: Stream, scores: FloatArray) -> Structure:
    """Compare the variance with 1, whatever the shape."""
    n = len(scores)
    if n < FEWEST:
        return Structure(stream, SCATTER, 1.0, 1.0)
    variance = float(np.var(scores))
    error = np.sqrt(max(float(np.mean((scores - scores.mean()) ** 4)) - variance**2, 1e-12) / n)
    p_value = 2.0 * float(stats.norm.sf(abs(variance - 1.0) / max(error, 0.02)))
    return Structure(stream, SCATTER, float(np.sqrt(variance)), p_value)


def _correlation(stream: Stream, name: str, scores: FloatArray, values: FloatArray) -> Structure:
    if np.ptp(values) < 1e-12 or np.ptp(scores) < 1e-12:
        return Structure(stream, name, 0.0, 1.0)
    straight, ranked = stats.pearsonr(scores, values), stats.spearmanr(scores, values)
    # By ranks too: one touch far off in one or the other would make a straight line of chance.
    p_value = float(max(straight.pvalue, ranked.pvalue))
    return Structure(stream, name, float(straight.statistic), p_value)


def features(scene: Scene, stream: Stream) -> Mapping[str, FloatArray]:
    """What a residual of a stream could depend on; arrays of shape (n,)."""
    touches = scene.touches
    alpha = scene.alpha
    turn = np.deg2rad(np.nan_to_num(touches.rotary_deg))
    position = np.nan_to_num(touches.position_mm)
    found = {
        "sense of motion": scene.sign,
        "feed": scene.speed,
        "feed squared": scene.speed**2,
        "slowness": 1.0 / scene.speed,
        "approach": touches.approach_mm,
        "position": position,
        "distance from the middle": np.abs(position),
        "temperature": scene.warmth,
        "time": touches.time_s,
        "time squared": (touches.time_s - touches.time_s.mean()) ** 2,
        "rest before": scene.rest_s,
        "elevation": scene.cos_beta,
        "rotary angle (cosine)": np.cos(turn),
        "rotary angle (sine)": np.sin(turn),
        "turn since the touch before": np.cos(alpha - scene.alpha_before),
        "sense times temperature": scene.sign * scene.warmth,
        "sense times position": scene.sign * position,
        "sense times time": scene.sign * touches.time_s,
    }
    for order in (1, 2, 3, 4, 6):
        found[f"azimuth, order {order} (cosine)"] = np.cos(order * alpha) * scene.cos_beta
        found[f"azimuth, order {order} (sine)"] = np.sin(order * alpha) * scene.cos_beta
    if stream.name == "latch_skip":  # what scans keep from running shows in their phase
        turn = 2.0 * np.pi * np.nan_to_num(touches.latch_us) / scene.nominal.plc.scan_us
        found["phase in the scan (cosine)"] = np.cos(turn)
        found["phase in the scan (sine)"] = np.sin(turn)
    return found
