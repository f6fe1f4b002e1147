"""How far the gap shrinks, on touches that served neither fitting nor naming.

The simulator decides: the held-out touches are played with and without the effects, and every
recorded one is scored against its own plays by the continuous ranked probability score (CRPS): the
length or time by which the plays miss it, less what their own scatter excuses. A simulation that
is right still scores its noise floor, half of the mean difference between two of its plays.

Touches count in units of the noise floor of their path and feed, so that the wide cells of the PLC
do not drown the narrow ones. Cells that show neither a gap nor a difference between the two
simulations are left out, so that a gap that sits on one path, or at some feeds, shows at its size.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scoringrules import crps_ensemble  # type: ignore[import-untyped]

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import InputPath
from skiplatch.comparison.cells import cells_of
from skiplatch.comparison.gap import RESOLVABLE
from skiplatch.comparison.observables import OBSERVABLES, Observable, Recorded
from skiplatch.diagnosis.grid import off_grid
from skiplatch.diagnosis.observed import before_wait, observed
from skiplatch.diagnosis.playing import Folds, Rig
from skiplatch.diagnosis.scene import Scene
from skiplatch.motion import Contact
from skiplatch.simulator.playing import Outcomes
from skiplatch.span import Span
from skiplatch.statistics import CONFIDENCE, Interval

IndexArray = NDArray[np.intp]

PLAYED_TOUCHES = 40_000
FEWEST_REPLICATES = 16
MOST_REPLICATES = 100
FEWEST_TOUCHES = 3  # in a cell
RESAMPLES = 999
MOST_POOLED = 400
NS = 3  # decimals of a µs
MOST_LUCKY = 60
"""Plays of the effects, at most, all of which have to do better by them for a gap to grow."""
ROUNDING = 1.0 / 6.0
"""Noise floor of what is known but for its rounding, in steps of it."""
ALPHA = 0.01
"""Chance that any cell or path of an observable counts for nothing but the luck of its touches."""


@dataclass(frozen=True, slots=True)
class Gap:
    """The gap of one observable before and after, as mean CRPS in its unit."""

    title: str
    """The observable's name for people."""
    unit: str
    before: float
    after: float
    noise_floor: float
    """What the simulation with the effects scores on its own plays."""
    shrink: Interval
    """Share of what lay above the noise floor that is gone."""
    could_hide: float = 0.0
    """Shift of half of the touches against the others that could have hidden, 95 %."""
    is_clear: bool = True
    """There is a gap somewhere, before or after, beyond the luck of the held-out touches."""
    grows: bool = False
    """The effects score worse than their own plays would if they were the truth."""
    oracle: float | None = None
    """The score of the true effects, where somebody knows them."""
    oracle_shrink: Interval | None = None


@dataclass(frozen=True, slots=True, eq=False)
class _Scored:
    """Touches and what a simulation scores on them; arrays of shape (m,)."""

    scores: FloatArray
    floor: FloatArray
    """What it scores on its own plays."""


@dataclass(frozen=True, slots=True, eq=False)
class _Cell:
    """Held-out touches of one path and feed under each simulation."""

    path: InputPath
    before: _Scored
    after: _Scored
    truth: _Scored | None
    ensembles: Sequence["_Ensemble"] = ()
    """Plays without the effects and with them, and those of the truth, where it is known."""

    @classmethod
    def of(cls, path: InputPath, recorded: FloatArray, ensembles: Sequence["_Ensemble"]) -> Self:
        """Score touches, shape (m,)."""
        before, after, *truth = (ensemble.scored(recorded) for ensemble in ensembles)
        return cls(path, before, after, truth[0] if truth else None, ensembles)

    def unit(self, least: float) -> float:
        """Give what scores count in: the noise floor, which is at least `least`."""
        return max(float(self.after.floor.mean()), least)

    def lost_by_luck(self, k: int) -> FloatArray:
        """Give by how much the effects score worse than none on a play of theirs; shape (m,)."""
        before, after = self.ensembles[:2]
        recorded = after.plays[k]
        return after.scored(recorded, but=k).scores - before.scored(recorded).scores


@dataclass(frozen=True, slots=True, eq=False)
class _Ensemble:
    """Plays of m touches, each moved and scaled alike; arrays of shape (m,), plays of (r, m).

    Attributes:
        plays: Of each touch; one that was not latched has another play's outcome.
        scale: Turns their unit into that of the observable.
        is_pooled: A touch is held against the plays of all. All touches of a campaign share the
            phase of one scan, and so do those of a replicate: its own plays alone show a touch no
            more phases than there are replicates, and to all of them the same.
    """

    plays: FloatArray
    scale: FloatArray
    is_pooled: bool

    @classmethod
    def of(cls, plays: FloatArray, scale: FloatArray, *, is_pooled: bool) -> Self:
        """Fill in what was not latched; some play of each touch was."""
        filled = plays.copy()
        for i in np.flatnonzero(np.isnan(plays).any(axis=0)):
            filled[:, i] = np.resize(plays[~np.isnan(plays[:, i]), i], len(plays))
        return cls(filled, scale, is_pooled)

    def scored(self, recorded: FloatArray, but: int | None = None) -> _Scored:
        """Score touches, shape (m,), in units of the plays, by all replicates but one."""
        plays = self.plays if but is None else np.delete(self.plays, but, axis=0)
        if self.is_pooled:
            pool = np.sort(plays.ravel())
            chosen = np.linspace(0, len(pool) - 1, min(MOST_POOLED, len(pool)))
            pool = pool[np.rint(chosen).astype(int)]
            ensemble = np.broadcast_to(pool, (len(recorded), len(pool)))
        else:
            ensemble = plays.T
        return _Scored(self.scale * _crps(recorded, ensemble), self.scale * _floor(ensemble))


@dataclass(frozen=True, slots=True, eq=False)
class _Scores:
    """Scores of the touches of some cells, in units of their noise floors; shape (m,)."""

    units: FloatArray
    before: FloatArray
    after: FloatArray
    floor: FloatArray
    nominal_floor: FloatArray
    truth: FloatArray | None

    @classmethod
    def of(cls, cells: Sequence[_Cell], least: float) -> Self:
        """Put cells together; `least` is the noise floor of what is known but for its rounding."""
        floors = [cell.after.floor for cell in cells]
        units = np.concatenate([np.full(len(cell.after.floor), cell.unit(least)) for cell in cells])

        def together(scores: Iterable[FloatArray]) -> FloatArray:
            return np.asarray(np.concatenate(list(scores)) / units)

        truth = [cell.truth.scores for cell in cells if cell.truth]
        return cls(
            units=units,
            before=together(cell.before.scores for cell in cells),
            after=together(cell.after.scores for cell in cells),
            floor=together(floors),
            nominal_floor=together(cell.before.floor for cell in cells),
            truth=together(truth) if truth else None,
        )

    def is_clear(self, limit: float) -> bool:
        """Tell whether there is a gap, or one that the effects made or took away.

        Each simulation is held against its own noise floor. One that scatters hides any gap by it:
        where the two differ, the worse is held against the lower floor as well, for two of which
        neither misses the touches differ by how their plays happen to be rounded.
        """
        floors = (self.floor, self.nominal_floor)
        worse = max(self.before, self.after, key=np.mean)
        return (
            _chance(self.before - self.nominal_floor, "greater") < limit
            or _chance(self.after - self.floor, "greater") < limit
            or (
                _chance(self.before - self.after, "two-sided") < limit
                and _chance(worse - min(floors, key=np.mean), "greater") < limit
            )
        )


def shrink(
    scene: Scene,
    held_out: BoolArray,
    before: Rig,
    after: Rig | Folds,
    *,
    seed: int,
    jobs: int,
    truth: Rig | None = None,
) -> Mapping[str, Gap]:
    """Measure every observable that was recorded; by name.

    Args:
        scene: The campaign.
        held_out: Which touches to score; shape (n,).
        before: The rig as it is believed to be.
        after: The rig with the effects that were found, or rigs fitted to other touches each.
        seed: Of the plays.
        jobs: Threads.
        truth: The rig that a simulated campaign really is of.
    """
    rigs = [before, after] if truth is None else [before, after, truth]
    plays = [_play(scene, rig, seed, jobs) for rig in rigs]
    gaps = {}
    for observable in _observables(scene, after):
        cells = list(_cells(scene, held_out, observable, plays, after.spans))
        if cells:
            gaps[observable.name] = _gap(cells, observable, _least(scene, observable), seed)
    return gaps


def _play(scene: Scene, rig: Rig | Folds, seed: int, jobs: int) -> Outcomes:
    replicates = int(np.clip(PLAYED_TOUCHES // len(scene), FEWEST_REPLICATES, MOST_REPLICATES))
    return rig.play(scene.touches, seed=seed, replicates=replicates, jobs=jobs)


def _observables(scene: Scene, after: Rig | Folds) -> Iterator[Observable]:
    """Give those of every comparison, and two that stamps tell far more sharply.

    A scan that is late moves the stamp of its touch by little of the wait for a scan: it is only
    beside the other stamps that it shows. Nor does a position that is off show in that wait: it
    does beside the way until its own stamp.
    """
    yield from OBSERVABLES

    def beyond(recorded: Recorded, _: Contact) -> FloatArray:
        return np.where(scene.has_stamps, observed(scene, recorded)["position"], np.nan)

    if "position" in scene.streams:
        yield Observable(
            "deviation_beyond_stamp_um", "deviation − way until its stamp", "µm", beyond
        )

    def late(recorded: Recorded, _: Contact) -> FloatArray:
        stamps = np.where(scene.plc, recorded.latch_us, np.nan)
        return np.asarray(np.round(off_grid(stamps, after.scan_us), NS))

    if "lattice" in scene.streams and after.keeps_scan_grid:
        yield Observable("latch_off_scan_grid_us", "latch − grid of scans", "µs", late)


def _least(scene: Scene, observable: Observable) -> float:
    """Give the noise floor of what is known but for its rounding."""
    is_length = observable.unit == "µm"
    return ROUNDING * (
        scene.nominal.axis.resolution_um if is_length else scene.nominal.skip.tick_us
    )


def _cells(
    scene: Scene,
    held_out: BoolArray,
    observable: Observable,
    plays: Sequence[Outcomes],
    spans: Iterable[Span],
) -> Iterator[_Cell]:
    """Score cell by cell what was played: nominal, with the effects found, with the true ones."""
    recorded = observable.values(scene.touches, scene.contact)
    played = [observable.values(outcomes, scene.contact) for outcomes in plays]
    known = held_out & ~np.isnan(recorded)
    for values in played:
        known = known & ~np.isnan(values).all(axis=0)
    is_from_contact = observable.name == "latch_after_contact_us"
    expected, scale = before_wait(scene, observable.unit, is_from_contact=is_from_contact)
    for path, rows in _cells_within(scene, known, spans):
        # On the grid of the scans no phase is left.
        is_pooled = path == InputPath.PLC and observable in OBSERVABLES
        middle, unit = (expected[rows], scale[rows]) if is_pooled else (0.0, np.ones(len(rows)))
        ensembles = [
            _Ensemble.of((values[:, rows] - middle) / unit, unit, is_pooled=is_pooled)
            for values in played
        ]
        yield _Cell.of(path, (recorded[rows] - middle) / unit, ensembles)


def _cells_within(
    scene: Scene, known: BoolArray, spans: Iterable[Span]
) -> Iterator[tuple[InputPath, IndexArray]]:
    """Give the cells, the touches apart at which an effect that begins or ends is not there."""
    parts = [known]
    for span in spans:
        acts = span.holds(scene.touches.touch)
        parts = [half for part in parts for half in (part & acts, part & ~acts)]
    for part in parts:
        for path, _, rows in cells_of(scene.touches, part, FEWEST_TOUCHES):
            yield path, rows


def _crps(recorded: FloatArray, ensemble: FloatArray) -> FloatArray:
    return np.asarray(crps_ensemble(recorded, ensemble, estimator="pwm", backend="numpy"))


def _floor(ensemble: FloatArray) -> FloatArray:
    """Give half of the mean difference between two plays of a touch; shape (m,)."""
    ordered = np.sort(ensemble, axis=1)
    r = ordered.shape[1]
    return np.asarray(ordered @ (2.0 * np.arange(1, r + 1) - r - 1.0) / (r * (r - 1.0)))


def _chance(differences: FloatArray, sides: Literal["two-sided", "greater"]) -> float:
    """Give the p-value of a mean of 0, by Student's t."""
    mean = float(differences.mean())
    if np.ptp(differences) < RESOLVABLE:
        return float((mean if sides == "greater" else abs(mean)) < RESOLVABLE)
    return float(stats.ttest_1samp(differences, 0.0, alternative=sides).pvalue)


def _clear(cells: Sequence[_Cell], least: float) -> list[_Cell]:
    """Give the cells that show a gap, by themselves or else together with others of their path."""
    limit = ALPHA / (len(cells) + len(InputPath))
    shown: list[_Cell] = []
    for path in InputPath:
        there = [cell for cell in cells if cell.path == path]
        alone = [cell for cell in there if _Scores.of([cell], least).is_clear(limit)]
        if not alone and there and _Scores.of(there, least).is_clear(limit):
            alone = there  # too few touches in each
        shown += alone
    return shown


def _gap(cells: Sequence[_Cell], observable: Observable, least: float, seed: int) -> Gap:
    clear = _clear(cells, least)
    scores = _Scores.of(clear or cells, least)
    whole = float(np.sum(1.0 / scores.units))  # turns units of the floor into those of the figures

    def share_gone(after: FloatArray) -> Interval:
        return _share_gone(scores, after, seed, is_clear=bool(clear))

    shrinks = share_gone(scores.after)
    return Gap(
        title=observable.title,
        unit=observable.unit,
        before=float(scores.before.sum()) / whole,
        after=float(scores.after.sum()) / whole,
        noise_floor=float(scores.floor.sum()) / whole,
        shrink=shrinks,
        is_clear=bool(clear),
        grows=shrinks.high < 0.0 and _is_no_luck(clear, least),
        oracle=None if scores.truth is None else float(scores.truth.sum()) / whole,
        oracle_shrink=None if scores.truth is None else share_gone(scores.truth),
    )


def _is_no_luck(cells: Sequence[_Cell], least: float) -> bool:
    """Tell whether effects score worse than on most of their own plays, beside no effect.

    What comes now and then may not have come, and a rounded value fall as it likes.
    """

    def lost(of_cells: Iterable[FloatArray]) -> float:
        both = zip(of_cells, cells, strict=True)
        return sum(float(scores.sum()) / cell.unit(least) for scores, cell in both)

    seen = lost(cell.after.scores - cell.before.scores for cell in cells)
    replicates = min(len(cells[0].ensembles[1].plays), MOST_LUCKY)
    return all(lost(cell.lost_by_luck(k) for cell in cells) < seen for k in range(replicates))


def _share_gone(scores: _Scores, after: FloatArray, seed: int, *, is_clear: bool) -> Interval:
    """Give the share with its interval, by the scores after it; 0 without a gap.

    A floor above what was there before is that of effects which scatter too much, and no measure of
    a gap: then the floor of the nominal simulation is, which makes the gap rather too large.
    """
    above = scores.before - scores.floor
    if above.sum() <= 0.0:
        above = scores.before - scores.nominal_floor
    samples = (scores.before - after, above)
    value = float(_share(*samples)) if is_clear else 0.0
    resampled = stats.bootstrap(
        samples,
        _share,
        n_resamples=RESAMPLES,
        paired=True,
        vectorized=True,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(seed),
    ).confidence_interval
    return Interval(value, min(float(resampled.low), value), max(float(resampled.high), value))


def _share(gone: FloatArray, above: FloatArray, axis: int = -1) -> FloatArray:
    """Share of the gap above the floor that is gone; 0 where there was none and none came.

    Touches that score below the floor by luck have not lost more than all of their gap.
    """
    lost, gap = gone.sum(axis=axis), above.sum(axis=axis)
    whole = np.maximum(np.maximum(gap, lost), RESOLVABLE)
    share = np.clip(lost / whole, -1.0, 1.0)
    return np.asarray(np.where(np.abs(lost) > RESOLVABLE, share, 0.0))
