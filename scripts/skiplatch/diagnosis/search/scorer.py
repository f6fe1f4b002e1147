"""Fitted models, scored and asked: what they gain, where they act, whether they matter."""

from collections.abc import Collection
from functools import reduce

import numpy as np

from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.density.law import SMALLEST, Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.forms import given_way
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality, is_material
from skiplatch.diagnosis.likelihood.laws import LATTICE, law_under
from skiplatch.diagnosis.likelihood.likelihood import MISSED, affected, likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.own_way import (
    OwnWay,
    by_giving_way,
    gain_beyond_reach,
    own_way,
)
from skiplatch.diagnosis.search.parts import Split
from skiplatch.diagnosis.search.places import are_told_by_places
from skiplatch.diagnosis.search.scored import Scored, is_no_accident

MORE_VARIANCE = 1.2
"""Variance over the believed one from which on an effect leaves more to chance."""


def _in_view(part: Scene, names: Collection[str]) -> set[str]:
    """Add the grid of the scans to the waits for them: what a scan does shows in both."""
    is_waiting = any(name in part.streams and part.streams[name].is_polled for name in names)
    return {*names, "lattice"} if is_waiting and "lattice" in part.streams else set(names)


def _reached(part: Scene, model: Fit) -> frozenset[str]:
    """Name the streams where the last effect of a model changes anything."""
    return affected(part, model.candidates[-1].acting(part, model.parameters[-1]))


def gain_in(part: Scene, model: Fit, names: Collection[str] | None = None) -> float:
    """Give what a model gains over the unchanged simulation in some streams; in all without any."""
    changed = likelihood(part, model.change(part), names=names).total
    return changed - likelihood(part, NOTHING, names=names).total


def _last_and_others(part: Scene, model: Fit) -> tuple[Change, Change]:
    """Give what the last effect of a model changes, and what the others do."""
    effects = zip(model.candidates, model.parameters, strict=True)
    *others, last = (candidate.acting(part, parameters) for candidate, parameters in effects)
    return last, reduce(Change.joined, others, NOTHING)


def _scatters_more(scene: Scene, stream: Stream, law: Law) -> bool:
    """Tell whether a law adds more scatter than it shifts touches of a surface apart."""
    datum, senses = scene.datum_of(stream), scene.datum_senses[stream.rows]
    shift = (law.mean - stream.law.mean)[stream.rows] * senses
    added = (law.variance - stream.law.variance)[stream.rows]
    counts = np.maximum(np.bincount(datum), 1)
    apart = shift - (np.bincount(datum, shift) / counts)[datum]
    return float(np.mean(added)) > float(np.mean(apart**2)) + SMALLEST**2


def _narrowed(part: Scene, change: Change, before: Change) -> set[str]:
    """Name the streams that scatter less under a change than under one before it."""
    ratios = {
        name: law_under(part, stream, change).variance / law_under(part, stream, before).variance
        for name, stream in part.streams.items()
        if name != LATTICE and stream.rows.any()
    }
    rows = {name: part.streams[name].rows for name in ratios}
    return {n for n, ratio in ratios.items() if np.median(ratio[rows[n]]) < 1.0 / MORE_VARIANCE}


class Scorer:
    """Scores fitted models on one campaign, and tells what they do there."""

    def __init__(self, scene: Scene, parts: Split, materiality: Materiality = DEFAULT) -> None:
        """Prepare to score models.

        Args:
            scene: The touches.
            parts: Which of them serve what.
            materiality: From which size on a change matters.
        """
        self.materiality = materiality
        self.parts = parts
        self._look_at(scene)

    def _look_at(self, scene: Scene) -> None:
        self.scene = scene
        self._fitting = scene.select(self.parts.fitting)
        self._checking = scene.select(self.parts.checking)
        self._naming = scene.select(self.parts.naming)
        self.base = [likelihood(part, NOTHING).total for part in (self._fitting, self._checking)]

    def score(self, model: Fit) -> Scored:
        """Score a fitted model on both parts; a wave that no places tell gains nothing."""
        told = model.kept(are_told_by_places(self._naming, model))
        fitted, checked = (
            likelihood(part, told.change(part)).total - base
            for part, base in zip((self._fitting, self._checking), self.base, strict=True)
        )
        effects = zip(model.candidates, model.parameters, strict=True)
        impossible = sum(not candidate.is_possible(self.scene, p) for candidate, p in effects)
        return Scored(model, fitted, checked, impossible)

    def is_enough(self, scored: Scored, before: Scored | None = None) -> bool:
        """Tell whether a model is worth naming over a smaller one, or over none."""
        return self.is_significant(scored, before) and self.is_material(scored, before)

    def is_significant(self, scored: Scored, before: Scored | None = None) -> bool:
        """Tell whether a model does better than a smaller one, or than none, by no accident."""
        return is_no_accident(
            scored.fitted - (before.fitted if before else 0.0),
            scored.checked - (before.checked if before else 0.0),
            scored.fit.size - (before.fit.size if before else 0),
        )

    def is_elsewhere(self, pair: Scored, first: Scored) -> bool:
        """Tell whether the second effect of a pair shows where the first one changes nothing.

        There the first one has no form that could be mended.
        """
        fitted, checked = (
            gain_in(part, pair.fit, {*part.streams, MISSED} - affected(part, change))
            for part in (self._fitting, self._checking)
            for change in [first.fit.change(part)]
        )
        return is_no_accident(fitted, checked, pair.fit.size - first.fit.size)

    def is_narrower(self, pair: Scored, first: Scored) -> bool:
        """Tell whether the second effect of a pair has some streams scatter less, and they do.

        A form of the first one that is off makes them scatter more.
        """
        fitted, checked = (
            gain_in(part, pair.fit, names) - gain_in(part, first.fit, names)
            for part in (self._fitting, self._checking)
            for names in [_narrowed(part, pair.fit.change(part), first.fit.change(part))]
        )
        return is_no_accident(fitted, checked, pair.fit.size - first.fit.size)

    def is_beyond_reach(self, pair: Scored, first: Scored) -> bool:
        """Tell whether the last effect explains touches that no form of the others comes near."""
        fitted, checked = (
            gain_beyond_reach(part, pair.fit.change(part), first.fit.change(part))
            for part in (self._fitting, self._checking)
        )
        return is_no_accident(fitted, checked, pair.fit.size - first.fit.size)

    def own_way(self, model: Scored) -> OwnWay:
        """Weigh the shift of the last effect against other forms of the others."""
        return own_way(self._naming, *_last_and_others(self._naming, model.fit))

    def promise(self, model: Scored) -> float:
        """Give the score that a model may come to once the others give way to its last effect."""
        moved = self.score(given_way(self._fitting, model.fit))
        there = max(model, moved, key=lambda scored: scored.score)
        parts = _last_and_others(self._fitting, there.fit)
        return there.score + by_giving_way(self._fitting, *parts)

    def _acting(self, model: Scored, position: int) -> Change:
        """Give what one effect of a model changes, on the touches that serve fitting."""
        candidate, parameters = model.fit.candidates[position], model.fit.parameters[position]
        return candidate.acting(self._fitting, parameters)

    def reaches(self, model: Scored, position: int) -> frozenset[str]:
        """Name the streams in which one effect of a model changes anything."""
        return affected(self._fitting, self._acting(model, position))

    def scatters(self, model: Scored, position: int) -> frozenset[str]:
        """Name the streams in which one effect of a model leaves more to chance."""
        change, scene = self._acting(model, position), self._fitting
        found = set()
        for name in affected(scene, change) & scene.streams.keys():
            stream = scene.streams[name]
            variance = law_under(scene, stream, change).variance[stream.rows]
            if np.median(variance / stream.law.variance[stream.rows]) > MORE_VARIANCE:
                found.add(name)
        return frozenset(found)

    def share(self, pair: Scored, first: Scored) -> float:
        """What the last of a model gains, over what the first gains in the streams it reaches.

        Only there can it but mend the first one's form.
        """
        there = 0.0
        for part in (self._fitting, self._checking):
            there += gain_in(part, first.fit, _in_view(part, _reached(part, pair.fit)))
        gained = pair.fitted + pair.checked - first.fitted - first.checked
        return gained / there if there > 0.0 else np.inf

    def is_scatter(self, scored: Scored) -> bool:
        """Tell whether a model leaves more of some stream to chance than it tells touches apart."""
        change, scene = scored.fit.change(self._fitting), self._fitting
        reached = (scene.streams[name] for name in affected(scene, change) - {MISSED})
        return any(
            _scatters_more(scene, stream, law_under(scene, stream, change))
            for stream in reached
            if stream.rows.any()
        )

    def is_material(self, scored: Scored, before: Scored | None = None) -> bool:
        """Tell whether what a model has beyond a smaller one, or none, changes enough to matter."""
        gained = scored.fitted + scored.checked
        if before:
            gained -= before.fitted + before.checked
        position = len(before.ids) if before else 0
        change = self._acting(scored, position)
        touches = int(self.parts.naming.sum())
        is_seen = gained / touches > self.materiality.nats_a_touch
        return is_seen and is_material(self._fitting, change, self.materiality)

    def matters(self, model: Scored, position: int) -> bool:
        """Tell whether one effect of a model changes enough to matter, by itself."""
        return is_material(self._fitting, self._acting(model, position), self.materiality)
