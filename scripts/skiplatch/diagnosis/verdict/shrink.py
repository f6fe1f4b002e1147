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
from typing import Self

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.campaign import InputPath
from skiplatch.comparison.cells import cells_of
from skiplatch.comparison.gap import RESOLVABLE
from skiplatch.comparison.observables import OBSERVABLES, Observable
from skiplatch.diagnosis.plays.playing import Folds, Rig
from skiplatch.diagnosis.scene.observed import before_wait
from skiplatch.diagnosis.scene.scene import Scene, rounding_step
from skiplatch.diagnosis.verdict.cell_scores import Cell, CellScores, Ensemble
from skiplatch.diagnosis.verdict.gap_observables import observables
from skiplatch.diagnosis.verdict.luck import is_no_luck, may_be_luck, tightness
from skiplatch.simulator.playing import Outcomes
from skiplatch.span import Span, parted
from skiplatch.statistics import CONFIDENCE, Interval

PLAYED_TOUCHES = 40_000
FEWEST_REPLICATES = 16
MOST_REPLICATES = 100
FEWEST_TOUCHES = 3  # in a cell
RESAMPLES = 999
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
    """What the simulation with the effects scores on its own plays, and by its rounding; without
    them, where that is above what was there before."""
    shrink: Interval
    """Share of what lay above the noise floor that is gone."""
    could_hide: float = 0.0
    """Shift of half of the touches against the others that could have hidden, 95 %."""
    is_clear: bool = True
    """There is a gap somewhere, before or after, beyond the luck of the held-out touches."""
    may_be_luck: bool = False
    """It is clear, and some play of the effects is as far off the others as the record is."""
    grows: bool = False
    """The effects score worse than their own plays would if they were the truth."""
    tightness: float = 1.0
    """How far the record is off plays of the effects, over how far these are off each other; 1 if
    it is as close to them as any play of theirs by luck."""
    oracle: float | None = None
    """The score of the true effects, where somebody knows them."""
    oracle_shrink: Interval | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PlayedRigs:
    """A campaign played without effects and with them, and on the true rig where it is known."""

    scene: Scene
    before: Rig
    after: Rig | Folds
    plays: Sequence[Outcomes]
    seed: int

    @classmethod
    def of(
        cls,
        scene: Scene,
        before: Rig,
        after: Rig | Folds,
        *,
        seed: int,
        jobs: int,
        truth: Rig | None = None,
    ) -> Self:
        """Play all touches.

        Args:
            scene: The campaign.
            before: The rig as it is believed to be.
            after: The rig with the effects that were found, or rigs fitted to other touches each.
            seed: Of the plays.
            jobs: Threads.
            truth: The rig that a simulated campaign really is of.
        """
        rigs = [before, after] if truth is None else [before, after, truth]
        return cls(scene, before, after, [_play(scene, rig, seed, jobs) for rig in rigs], seed)

    def gaps(self, scored: BoolArray) -> Mapping[str, Gap]:
        """Measure every observable that was recorded, on some touches, shape (n,); by name."""
        found = {}
        for observable in observables(self.scene, self.after, self.seed):
            cells = list(self._cells(scored, observable))
            if cells:
                least = _least(self.scene, observable)
                found[observable.name] = _gap(cells, observable, least, self.seed)
        return found

    def _cells(self, scored: BoolArray, observable: Observable) -> Iterator[Cell]:
        """Score cell by cell what was played: nominal, with the effects found, with the true."""
        scene = self.scene
        recorded = observable.values(scene.touches, scene.contact)
        played = [observable.values(outcomes, scene.contact) for outcomes in self.plays]
        known = scored & ~np.isnan(recorded)
        for values in played:
            known = known & ~np.isnan(values).all(axis=0)
        expected, scale = self._expected(observable)
        for path, rows in _cells_within(scene, known, self.after.spans):
            # On the grid of the scans no phase is left.
            is_pooled = path == InputPath.PLC and observable in OBSERVABLES
            # Where there are stamps, positions beside them tell of places, without the wait.
            has_places = observable.unit == "µm" and "position" not in scene.streams
            middle, unit = (expected[rows], scale[rows]) if is_pooled else (0.0, np.ones(len(rows)))
            ensembles = [
                Ensemble.of(
                    (values[:, rows] - middle) / unit,
                    unit,
                    is_pooled=is_pooled,
                    has_places=has_places,
                )
                for values in played
            ]
            yield Cell.of(path, (recorded[rows] - middle) / unit, ensembles)

    def _expected(self, observable: Observable) -> tuple[FloatArray, FloatArray]:
        """Give what is expected of each touch before its wait for a scan, and what a µs adds.

        Touches of surfaces that lie apart are pooled, each from where its surface is found to be.
        """
        is_from_contact = observable.name == "latch_after_contact_us"
        expected, scale = before_wait(self.scene, observable.unit, is_from_contact=is_from_contact)
        surface_um, coordinate_um = self.before.datum.sizes_um(
            self.scene.nominal, self.scene.touches
        )
        if observable.unit == "µm":
            return expected + surface_um + coordinate_um, scale
        return expected + surface_um / self.scene.speed * is_from_contact, scale


def _play(scene: Scene, rig: Rig | Folds, seed: int, jobs: int) -> Outcomes:
    replicates = int(np.clip(PLAYED_TOUCHES // len(scene), FEWEST_REPLICATES, MOST_REPLICATES))
    return rig.play(scene.touches, seed=seed, replicates=replicates, jobs=jobs)


def _least(scene: Scene, observable: Observable) -> float:
    """Give the noise floor of what is known but for its rounding."""
    return ROUNDING * rounding_step(scene, observable.unit)


def _cells_within(
    scene: Scene, known: BoolArray, spans: Iterable[Span]
) -> Iterator[tuple[InputPath, IndexArray]]:
    """Give the cells, the touches apart at which an effect that begins or ends is not there.

    Feeds at which there are too few are one cell: each touch is held against its own feed anyhow.
    """
    for part in parted(spans, scene.touches.touch, known):
        few: dict[InputPath, list[IndexArray]] = {}
        for path, _, rows in cells_of(scene.touches, part, 1):
            if len(rows) >= FEWEST_TOUCHES:
                yield path, rows
            else:
                few.setdefault(path, []).append(rows)
        together = ((path, np.sort(np.concatenate(rows))) for path, rows in few.items())
        yield from ((path, rows) for path, rows in together if len(rows) >= FEWEST_TOUCHES)


def _clear(cells: Sequence[Cell], least: float) -> list[Cell]:
    """Give the cells that show a gap, by themselves or else together with others of their path."""
    limit = ALPHA / (len(cells) + len(InputPath))
    shown: list[Cell] = []
    for path in InputPath:
        there = [cell for cell in cells if cell.path == path]
        alone = [cell for cell in there if CellScores.of([cell], least).is_clear(limit)]
        if not alone and there and CellScores.of(there, least).is_clear(limit):
            alone = there  # too few touches in each
        shown += alone
    return shown


def _gap(cells: Sequence[Cell], observable: Observable, least: float, seed: int) -> Gap:
    clear = _clear(cells, least)
    scores = CellScores.of(clear or cells, least)
    whole = float(np.sum(1.0 / scores.units))  # turns units of the floor into those of the figures

    floor = _floor(scores)

    def share_gone(after: FloatArray) -> Interval:
        samples = (scores.before - after, scores.before - floor)
        return _share_gone(samples, seed, is_clear=bool(clear))

    shrinks = share_gone(scores.after)
    return Gap(
        title=observable.title,
        unit=observable.unit,
        before=float(scores.before.sum()) / whole,
        after=float(scores.after.sum()) / whole,
        noise_floor=float(floor.sum()) / whole,
        shrink=shrinks,
        is_clear=bool(clear),
        may_be_luck=bool(clear) and may_be_luck(cells, least),
        # Cells that are clear for what did not come there were chosen by luck: all of them count.
        grows=shrinks.high < 0.0 and is_no_luck(cells, least),
        tightness=tightness(clear, least) if clear else 1.0,
        oracle=None if scores.truth is None else float(scores.truth.sum()) / whole,
        oracle_shrink=None if scores.truth is None else share_gone(scores.truth),
    )


def _floor(scores: CellScores) -> FloatArray:
    """Give the noise floor of each touch: what a rig with the effects scores on its own plays.

    One above what was there before is that of effects which scatter too much, and no measure of a
    gap: then that of the nominal simulation is, which makes the gap rather too large.
    """
    is_below = (scores.before - scores.floor).sum() > 0.0
    return scores.floor if is_below else scores.nominal_floor


def _share_gone(samples: tuple[FloatArray, FloatArray], seed: int, *, is_clear: bool) -> Interval:
    """Give the share of a gap that is gone, with its interval; 0 without a gap.

    Args:
        samples: By touch, what is gone, and what was there above the floor.
        seed: Of the bootstrap.
        is_clear: There is a gap.
    """
    value = float(_share(*samples)) if is_clear else 0.0
    resampled = scipy.stats.bootstrap(
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
