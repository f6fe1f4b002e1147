"""What could be the matter in general: families that name no effect but have its look.

An error that grows with something recorded, that comes and goes with time, or that scatters. A
family that does clearly better than every effect of the catalogue says that none of them is it.
"""

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, optimize, stats

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.candidates import Candidate
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.law import SMALLEST, Extra
from skiplatch.diagnosis.likelihood import law_under
from skiplatch.diagnosis.periodogram import explained_by_sines
from skiplatch.diagnosis.scene import Scene, Stream
from skiplatch.diagnosis.surrogates import Parameters

PREFIX = "~"
"""Of the ids of families."""
SCREENED = 1e-3
"""Significance below which a feature is looked into."""
MOST_FEATURES = 4
WINDOW = 9
"""Touches that a course in time is smoothed over."""
NARROW = 5
"""The same where there are few."""
MANY = 80
FEWEST = 12
FEWEST_A_SIDE = 5
WINSOR = 4.0
RELAXATION_S = 15.0
BEYOND = 3.0
"""Standard deviations of a stretch beyond which it is itself a news."""
MOST_IN_A_STATE = 0.8
"""Share of the touches at which a clock of two states may be in the other one."""
SHORTEST_SWING = 4.0
"""Touches a period, on average, of the fastest swing that is looked for."""

Feature = Callable[[Scene], FloatArray]

FEATURES: dict[str, tuple[Feature, ...]] = {
    "approach": (lambda s: s.touches.approach_mm,),
    "elevation": (lambda s: np.sin(np.deg2rad(np.nan_to_num(s.touches.beta_deg))),),
    "azimuth": (lambda s: np.cos(s.alpha) * s.cos_beta, lambda s: np.sin(s.alpha) * s.cos_beta),
    "azimuth at any elevation": (lambda s: np.cos(s.alpha), lambda s: np.sin(s.alpha)),
    "twice the azimuth": (
        lambda s: np.cos(2.0 * s.alpha) * s.cos_beta,
        lambda s: np.sin(2.0 * s.alpha) * s.cos_beta,
    ),
    "direction of the touch before": (
        lambda s: np.cos(s.alpha_before),
        lambda s: np.sin(s.alpha_before),
    ),
    "feed squared": (lambda s: s.speed**2 / np.max(s.speed) ** 2,),
    "rest": (lambda s: -np.expm1(-s.rest_s / RELAXATION_S),),
    "distance from the middle": (lambda s: np.abs(np.nan_to_num(s.touches.position_mm)) / 100.0,),
}
"""By name; what is periodic in an angle has two. Each of shape (n,)."""
OF_BEFORE = ("direction of the touch before", "rest")
"""Features that are not known of a touch whose predecessor was not recorded."""


def _beyond(scene: Scene, *names: str) -> FloatArray:
    """By how much touches lie outside the believed law of some streams; shape (n,), else 0."""
    off = np.zeros(len(scene))
    for name in names:
        if name in scene.streams:
            stream = scene.streams[name]
            residuals = stream.residuals - stream.law.mean
            outside = np.maximum(np.abs(residuals) - BEYOND * stream.law.spread, 0.0)
            off = np.where(stream.rows, np.sign(residuals) * outside, off)
    return off


OTHERS: dict[str, dict[str, tuple[Feature, ...]]] = {
    "latch_skip": {"what the report is off by": (lambda s: _beyond(s, "report"),)},
    "position": {
        "what the latch is off by": (lambda s: s.speed * _beyond(s, "latch_skip", "latch_plc"),),
        "what the report is off by": (lambda s: s.speed * _beyond(s, "report"),),
    },
}
"""What other stretches show of a touch, by stream: in a chain that is known, nothing."""


def families(scene: Scene, given: Change) -> list[Candidate]:
    """Give the families worth a look on these touches, on top of what is known to differ."""
    return [
        *_with_features(scene, given),
        *_in_time(scene, given),
        *_swings(scene, given),
        *_steps(scene, given),
        _noise("noise", 0.0),
        _noise("noise that grows with the root of the feed", 0.5),
        _noise("noise that grows with the feed", 1.0),
        *_other_clock(scene),
        _now_and_then(),
        _noisy_now_and_then(),
    ]


def _scores(
    scene: Scene, name: str, given: Change, most: float = WINSOR
) -> tuple[FloatArray, BoolArray]:
    """Residuals of a stream over their own spread, cut at a few of it, and their rows."""
    stream = scene.streams[name]
    rows = stream.rows
    law = law_under(scene, stream, given).select(rows)
    scores = (stream.residuals[rows] - law.mean) / law.spread
    scores = scores - np.median(scores)
    return np.clip(scores, -most, most), rows


def _shown(scene: Scene, *more: str) -> dict[str, Stream]:
    """Give the streams that families are looked for in, where enough was recorded."""
    names = ("position", "deviation_skip", "latch_skip", *more)
    streams = {name: scene.streams[name] for name in names if name in scene.streams}
    return {name: stream for name, stream in streams.items() if stream.rows.sum() >= FEWEST}


def _with_features(scene: Scene, given: Change) -> list[Candidate]:
    found: list[tuple[float, Candidate]] = []
    for name, stream in _shown(scene).items():
        scores, rows = _scores(scene, name, given)
        for label, features in (FEATURES | OTHERS.get(name, {})).items():
            known = scene.follows[rows] if label in OF_BEFORE else np.full(len(scores), True)
            if known.sum() < FEWEST:
                continue
            p_value = min(
                _significance(scores[known], feature(scene)[rows][known]) for feature in features
            )
            if p_value < SCREENED:
                values = [feature(scene)[rows][known] for feature in features]
                residuals = stream.residuals[rows][known]
                start = _regression(residuals, scores[known], values)
                found.append((p_value, _shifted(name, label, features, start)))
    found.sort(key=lambda item: item[0])
    return [family for _, family in found[:MOST_FEATURES]]


def _significance(scores: FloatArray, values: FloatArray) -> float:
    if np.ptp(values) < SMALLEST or np.ptp(scores) < SMALLEST:
        return 1.0
    # By ranks too: what saturates hardly shows in a straight line.
    straight, ranked = stats.pearsonr(scores, values), stats.spearmanr(scores, values)
    return float(min(straight.pvalue, ranked.pvalue))


def _regression(
    residuals: FloatArray, scores: FloatArray, features: Sequence[FloatArray]
) -> list[float]:
    """Give slopes and offset by least squares, over the touches that are not far off."""
    near = np.abs(scores) < WINSOR
    if np.mean(near) <= 0.5:
        near = np.full(len(scores), fill_value=True)
    design = np.column_stack([*features, np.ones(len(residuals))])[near]
    found, *_ = np.linalg.lstsq(design, residuals[near], rcond=None)
    return [float(value) or SMALLEST for value in found]


def _shifted(
    stream: str, label: str, features: Sequence[Feature], start: Sequence[float]
) -> Candidate:
    """Shift the stream by a multiple of each feature, and by as much everywhere.

    Where a feature is not known, scatter it by what the feature does elsewhere.
    """

    def change(scene: Scene, p: Parameters) -> Change:
        shift = np.asarray(
            sum(
                (slope * feature(scene) for slope, feature in zip(p, features, strict=False)), p[-1]
            )
        )
        if label not in OF_BEFORE or scene.follows.all():
            return _shift(stream, shift)
        usual = float(np.mean(shift[scene.follows])) if scene.follows.any() else 0.0
        scatter = float(np.std(shift[scene.follows])) if scene.follows.any() else 0.0
        unknown = np.where(scene.follows, 0.0, scatter)
        return _scattered(stream, np.where(scene.follows, shift, usual), unknown)

    senses = product((1.0, -1.0), repeat=len(features))
    starts = [
        start,
        *([*(size * sense for sense in s), 0.01] for s in senses for size in (1.0, 10.0)),
    ]
    names = (*(f"slope_{i}" for i in range(len(features))), "offset")
    return Candidate(f"{PREFIX}{stream}: {label}", names, change, lambda _s, _g: starts)


def _scattered(stream: str, amount: FloatArray, sigma: FloatArray) -> Change:
    if stream == "latch_skip":
        return Change(skip_us=amount, skip_extra=(Extra(1.0, sigma=sigma),))
    return Change(position_um=amount, position_sigma_um=sigma)


def _shift(stream: str, amount: FloatArray) -> Change:
    if stream == "latch_skip":
        return Change(skip_us=amount)
    return Change(position_um=amount)


def _in_time(scene: Scene, given: Change) -> list[Candidate]:
    """Whatever comes and goes slowly with time, as these touches show it themselves."""
    found = []
    for name, stream in _shown(scene, "report").items():
        rows = stream.rows
        law = law_under(scene, stream, given).select(rows)
        residuals = stream.residuals[rows] - law.mean
        scores, _ = _scores(scene, name, given)
        window = WINDOW if len(scores) > MANY else NARROW
        around = ndimage.median_filter(scores, window, mode="nearest")
        apart = around[window // 2 :: window]  # share no touch
        if len(apart) < FEWEST_A_SIDE or _significance(apart[:-1], apart[1:]) > SCREENED:
            continue
        smooth = _around(residuals, window)
        times_s = scene.touches.time_s[rows]
        if name == "report":  # a stamp that is early makes its report late
            found.append(_course("stamp", (times_s, -smooth)))
            continue
        kinds = ("stamp", name) if name == "latch_skip" else (name,)
        found += [_course(kind, (times_s, smooth)) for kind in kinds]
    return found


def _around(values: FloatArray, window: int) -> FloatArray:
    """Median of the values about each one without its own, which would explain itself; (n,)."""
    half = window // 2
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(values, half, "reflect"), window)
    return np.asarray(np.median(np.delete(windows, half, axis=1), axis=1))


def _course(kind: str, course: tuple[FloatArray, FloatArray]) -> Candidate:
    times_s, values = course

    def change(scene: Scene, p: Parameters) -> Change:
        amount = p[0] * np.interp(scene.touches.time_s, times_s, values)
        return Change(stamp_us=amount) if kind == "stamp" else _shift(kind, amount)

    return Candidate(
        f"{PREFIX}{kind}: comes and goes with time", ("share",), change, lambda _s, _g: [[0.9]]
    )


def _swings(scene: Scene, given: Change) -> list[Candidate]:
    """Whatever swings with time too fast for its course to show."""
    found = []
    for name, stream in _shown(scene).items():
        scores, rows = _scores(scene, name, given)
        times_s = scene.touches.time_s[rows]
        span_s, count = float(np.ptp(times_s)), len(scores)
        if span_s < SMALLEST or np.ptp(scores) < SMALLEST:
            continue
        fastest = count / SHORTEST_SWING / span_s
        hertz, explained = explained_by_sines(times_s, scores, np.ones(count), 1.0, fastest)
        best = int(np.argmax(explained))
        if len(hertz) * (1.0 - explained[best]) ** ((count - 3.0) / 2.0) < SCREENED:
            start = _sine(times_s, stream.residuals[rows], 1.0 / float(hertz[best]))
            found.append(_swing(name, start))
    return found


def _sine(times_s: FloatArray, residuals: FloatArray, period_s: float) -> list[float]:
    """Fit a sine of about this period, whatever a few touches do."""
    middle, size = float(np.median(residuals)), float(np.std(residuals))

    def off(p: Parameters) -> FloatArray:
        turn = 2.0 * np.pi * times_s / p[2]
        return np.asarray(p[0] * np.cos(turn) + p[1] * np.sin(turn) + p[3] - residuals)

    begun = [[a * size, b * size, period_s, middle] for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    scales = [size, size, 0.1 * period_s, size]
    fits = [
        optimize.least_squares(off, start, x_scale=scales, loss="soft_l1", f_scale=0.3 * size)
        for start in begun
    ]
    return [float(value) or SMALLEST for value in min(fits, key=lambda f: f.cost).x]


def _swing(name: str, start: Sequence[float]) -> Candidate:
    def change(scene: Scene, p: Parameters) -> Change:
        turn = 2.0 * np.pi * scene.touches.time_s / max(abs(p[2]), SMALLEST)
        return _shift(name, p[0] * np.cos(turn) + p[1] * np.sin(turn) + p[3])

    names = ("cosine", "sine", "period_s", "offset")
    return Candidate(f"{PREFIX}{name}: swings with time", names, change, lambda _s, _g: [start])


def _steps(scene: Scene, given: Change) -> list[Candidate]:
    """Whatever changes once and stays so."""
    found = []
    for name, stream in _shown(scene).items():
        scores, rows = _scores(scene, name, given, np.inf)  # ranks need no limit, which would tie
        splits = np.arange(FEWEST_A_SIDE, len(scores) - FEWEST_A_SIDE + 1)
        k = _sharpest(scores, splits)
        if stats.mannwhitneyu(scores[:k], scores[k:]).pvalue * len(splits) < SCREENED:
            residuals = stream.residuals[rows]
            before, after = (float(np.median(part)) for part in (residuals[:k], residuals[k:]))
            times_s = scene.touches.time_s[rows]
            at_s = float(times_s[k - 1] + times_s[k]) / 2.0
            found.append(_step(name, at_s, [before or SMALLEST, (after - before) or SMALLEST]))
    return found


def _sharpest(scores: FloatArray, splits: NDArray[np.intp]) -> int:
    """Give the split whose parts differ most in the ranks of their scores, over their scatter."""
    count = len(scores)
    ranks = np.cumsum(stats.rankdata(scores))[splits - 1]
    off = np.abs(ranks - splits * (count + 1) / 2.0) / np.sqrt(splits * (count - splits))
    return int(splits[np.argmax(off)])


def _step(name: str, at_s: float, start: Sequence[float]) -> Candidate:
    def change(scene: Scene, p: Parameters) -> Change:
        return _shift(name, p[0] + p[1] * (scene.touches.time_s > at_s))

    names = ("before", "step")
    return Candidate(f"{PREFIX}{name}: changes once", names, change, lambda _s, _g: [start])


def _other_clock(scene: Scene) -> list[Candidate]:
    """Stamps that are off where their reports are off the other way."""
    off = _beyond(scene, "report")
    if np.count_nonzero(off) < FEWEST_A_SIDE:
        return []

    def change(scene: Scene, p: Parameters) -> Change:
        off = _beyond(scene, "report")
        late_us = p[0] * off + p[1] * np.sign(off)
        return Change(stamp_us=late_us, report_us=late_us)  # of reports it is no explanation

    starts = [[-1.0, 0.0]]
    if np.count_nonzero(off) < MOST_IN_A_STATE * len(off):  # else the reports differ, not the clock
        report = scene.streams["report"]
        jump_us = float(np.median(np.abs(report.residuals - report.law.mean)[off != 0.0]))
        starts.append([0.0, -jump_us])
    names = ("slope", "jump_us")
    return [
        Candidate(f"{PREFIX}stamp: what the report is off by", names, change, lambda _s, _g: starts)
    ]


def _noise(label: str, power: float) -> Candidate:
    def change(scene: Scene, p: Parameters) -> Change:
        grown = (scene.speed / np.max(scene.speed)) ** power
        return Change(position_um=p[1], position_sigma_um=abs(p[0]) * grown)

    starts: Sequence[Sequence[float]] = [[0.5, 0.01], [5.0, 0.01]]
    return Candidate(
        f"{PREFIX}position: {label}", ("sigma", "shift"), change, lambda _s, _g: starts
    )


def _now_and_then() -> Candidate:
    """Some touches are off by about the same length, or by up to that."""

    def change(_scene: Scene, p: Parameters) -> Change:
        share = float(np.clip(abs(p[0]), 0.0, 0.5))
        return Change(position_extra=(Extra(share, offset=p[1], sigma=abs(p[2])),))

    starts = [[0.1, sign * size, 0.2 * size] for size in (2.0, 20.0) for sign in (1.0, -1.0)]
    names = ("share", "offset_um", "sigma_um")
    return Candidate(f"{PREFIX}position: now and then off", names, change, lambda _s, _g: starts)


def _noisy_now_and_then() -> Candidate:
    def change(_scene: Scene, p: Parameters) -> Change:
        share = float(np.clip(abs(p[0]), 0.0, 0.9))
        return Change(position_extra=(Extra(share, sigma=abs(p[1])),))

    starts: Sequence[Sequence[float]] = [[0.3, 1.0], [0.3, 10.0]]
    names = ("share", "sigma_um")
    return Candidate(f"{PREFIX}position: noisy now and then", names, change, lambda _s, _g: starts)
