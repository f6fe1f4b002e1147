"""One observable of the touches on one path, held against its plays from every side.

Each recorded touch has a rank among plays of the same touch, and with it a normal score. If what is
played is right, the scores know nothing: not of the conditions, not of the sequence, not of the
touches around. So they are looked at as a whole, along every condition, along waves, and by a
forest that predicts each touch by trees that have not seen it (Breiman, Machine Learning 45 (2001)
5, on out-of-bag estimates). Touches that share something, as where ticks and scans meet, go with
each other in plays as well: then what is seen is held against the same look at plays.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray, IndexArray
from skiplatch.diagnosis.plays.left import EVERYWHERE, Left
from skiplatch.diagnosis.plays.memory import remembered
from skiplatch.diagnosis.plays.scan_place import off_in_scan
from skiplatch.diagnosis.plays.scores import go_together, normal_scores
from skiplatch.diagnosis.plays.setting import Setting
from skiplatch.diagnosis.plays.size import apart, far_off, upper, wider
from skiplatch.diagnosis.plays.telling import SMALLEST, told_by_forest, told_by_one
from skiplatch.diagnosis.plays.turns import Turn, happens_in_turn, in_turn
from skiplatch.diagnosis.plays.waves import Wave, waves_along
from skiplatch.diagnosis.scene.covariates import WITHIN, before, varying
from skiplatch.diagnosis.scene.observed import UNITS
from skiplatch.statistics import errors_of, errors_of_excess, robust_deviation

FEWEST_FOR_FOREST = 25  # touches
DIGITS = 6
"""Decimals of a µs or µm from which on values are the same."""
SELDOM = 1e-3
"""Share of touches that a rig that is right may have far off."""
HELD_AGAINST = 6
"""Plays that are looked at as the record is."""
CHANCE = 2.0
"""Standard errors up to which a look is not held against plays: it tells no more than chance."""
FARTHEST = 3.0
"""Standard deviations off the mean of its plays that a touch counts for at most."""
IN_WORDS = {"shift": "", "scatter": " in size"}
NEVER_ERRS = "grid"
"""Observable without gross errors: a scan whose stamp is off the grid of the others was off it."""


class Look:
    """One observable on one path; arrays of shape (m,) over its touches, plays of shape (r, m).

    Attributes:
        name: Of the observable.
        path: On which the touches were latched.
        recorded: Shape (m,).
        played: Shape (r, m).
        off: By how much each is off the middle of its plays.
        scale: What each touch repeats to, or its plays scatter by, whichever is more.
    """

    def __init__(
        self,
        setting: Setting,
        name: str,
        path: str,
        rows: BoolArray,
        recorded: FloatArray,
        played: FloatArray,
    ) -> None:
        """Rank the touches among their plays.

        Args:
            setting: What is known of all touches.
            name: Of the observable.
            path: On which the touches were latched.
            rows: Which touches these are; shape (n,).
            recorded: Shape (n,).
            played: Shape (r, n).
        """
        self._setting, self.name, self.path, self._rows = setting, name, path, rows
        self._all_played = played
        self._step = setting.step(name)
        self.played = np.round(played[:, rows], DIGITS)
        self.recorded = np.round(recorded[rows], DIGITS)
        self._scores = normal_scores(self.recorded, self.played)
        # In the middle of equal plays a touch would seem to scatter less than others do: drawn by
        # lot (Smith, Journal of Forecasting 4 (1985) 283), it scatters alike whatever is played.
        lot = np.random.default_rng(setting.seed).random(len(self.recorded))
        self._sizes = np.abs(normal_scores(self.recorded, self.played, lot))
        middle = np.nanmedian(self.played, axis=0)
        self.off, self._plays_off = recorded[rows] - middle, self.played - middle
        self._noise = np.maximum(np.nanstd(self.played, axis=0), self._step / np.sqrt(12.0))
        self.scale = np.maximum(self._noise, setting.repeats_to(name))

    @property
    def key(self) -> bytes:
        """Tell it from others, by its record and its plays."""
        seen = b"".join(np.round(v, DIGITS).tobytes() for v in (self._scores, self.off))
        return f"{self.name} {self.path} ".encode() + seen

    def all(self) -> list[Left]:
        """Give everything that may be left of it."""
        return [*self.everywhere(), *self.told()]

    def told(self) -> Iterator[Left]:
        """Give all that goes with anything known."""
        yield from self._by(
            Look.straight, Look.predicted, Look.waves, Look.recurring, Look.remembered
        )

    def told_of_chance(self) -> list[Left]:
        """Give all that goes with anything known, also of what happens to some touches alone."""
        return [*self.told(), *self._by(Look.happened, Look.happened_in_turn, Look.fast_waves)]

    def _by(self, *looks: Callable[["Look"], Iterator[Left]]) -> Iterator[Left]:
        for look in looks:
            yield from self._beside_plays(look) if self._is_shared else look(self)

    def _beside_plays(self, look: Callable[["Look"], Iterator[Left]]) -> Iterator[Left]:
        """Count standard errors from what the same look tells of plays."""
        recorded = list(look(self))
        if all(left.z <= CHANCE for left in recorded):
            yield from recorded
            return
        played = [list(look(one)) for one in self._plays_as_recorded]
        for left in recorded:
            usual = [max((o.z for o in one if o.kind == left.kind), default=0.0) for one in played]
            yield replace(left, z=(left.z - float(np.mean(usual))) / max(1.0, float(np.std(usual))))

    @cached_property
    def _plays_as_recorded(self) -> list["Look"]:
        """Hold some plays against the others, without the touches that they miss."""
        return [
            Look(
                self._setting,
                self.name,
                self.path,
                self._rows & ~np.isnan(one),
                one,
                np.delete(self._all_played, k, axis=0),
            )
            for k, one in enumerate(self._all_played[:HELD_AGAINST])
        ]

    @cached_property
    def _is_shared(self) -> bool:
        return go_together(self._scores_of_plays)

    @cached_property
    def _scores_of_plays(self) -> FloatArray:
        """Rank each play among the others, but those that latched none of them; shape (r, m)."""
        others = (np.delete(self.played, k, axis=0) for k in range(len(self.played)))
        scores: FloatArray = np.array(list(map(normal_scores, self.played, others)))
        return scores[~np.isnan(scores).all(axis=1)]

    def everywhere(self) -> Iterator[Left]:
        """Compare middle and scatter of the scores with those of plays among the others."""
        for kind, power in (("shift", 1), ("scatter", 2)):
            usual = np.nanmean(self._scores_of_plays**power, axis=1)
            size = float(np.mean(self._scores**power) - usual.mean())
            error = max(float(usual.std(ddof=1)), SMALLEST)
            # A rig that scatters less than believed has no gap: nothing is left of it.
            z = (abs(size) if kind == "shift" else max(size, 0.0)) / error
            if kind == "scatter" and self.name == NEVER_ERRS:
                # Ranks do not tell how far off.
                z = max(z, errors_of_excess(int(self.far.sum()), len(self.off), SELDOM))
            yield self._left(kind, (EVERYWHERE,), np.full(len(self.off), fill_value=True), z)
        if self._setting.is_mostly_wait(self.name, self.path, self._noise, self._rows):
            yield self._shape()

    @property
    def far(self) -> BoolArray:
        """Tell which touches are far off the plays of all; shape (m,)."""
        return far_off(self.off, float(np.nanmax(np.abs(self._plays_off))), self._step)

    def _shape(self) -> Left:
        """Compare where in the scan touches fall with where plays do."""
        off, z = off_in_scan(
            self._setting.scene, UNITS[self.name], self._rows, self.recorded, self.played
        )
        size, relative = (
            off * float(np.median(values)) for values in (self._noise, self._noise / self.scale)
        )
        return self._of("shape", (EVERYWHERE,), size, relative, z)

    def straight(self) -> Iterator[Left]:
        """Correlate the scores with every condition, by ranks, and compare them at its values.

        Scores are normal where nothing is left, and tell of a shift no less than what is measured
        does itself; ranks of them tell less (Chernoff and Savage, Annals of Mathematical Statistics
        29 (1958) 972). Their size is not normal, and is ranked.
        """
        yield from self._by_condition("shift", self._scores)
        yield from self._by_condition("scatter", scipy.stats.rankdata(self._sizes))

    def _by_condition(self, kind: str, target: FloatArray) -> Iterator[Left]:
        for best in told_by_one(varying(self._setting.known, self._rows), target):
            yield self._left(kind, best.names, upper(best.values), errors_of(best.chance))

    def predicted(self) -> Iterator[Left]:
        """Let a forest predict the scores, and how far they are off, both by the same trees."""
        yield from self._by_forest({"shift": self._scores, "scatter": self._sizes})

    def happened(self) -> Iterator[Left]:
        """Predict how far touches are off the mean of plays, in deviations of these.

        By each condition, and by a forest. That tells to which of them something happened that
        happens to some: ranks tell less of it, for among those each has a rank of its own.
        """
        yield from self._by_condition("shift", self._deviations)
        yield from self._by_forest({"shift": self._deviations})

    @cached_property
    def _deviations(self) -> FloatArray:
        """Give how far touches are off the mean of their plays, in deviations of these."""
        deviation = np.maximum(np.nanstd(self.played, axis=0), SMALLEST)
        off = (self.recorded - np.nanmean(self.played, axis=0)) / deviation
        return np.asarray(np.clip(off, -FARTHEST, FARTHEST))

    def _by_forest(self, targets: Mapping[str, FloatArray]) -> Iterator[Left]:
        """Predict targets, shape (m,) each, by the kind of what they tell, by the same trees."""
        values = np.column_stack(list(targets.values()))
        if len(values) < FEWEST_FOR_FOREST or np.any(np.ptp(values, axis=0) == 0.0):
            return
        columns = dict(varying(self._setting.known, self._rows))
        for kind, target in targets.items():
            full = np.full(len(self._rows), np.nan)
            full[self._rows] = target
            around = varying(before(self._setting.order, full), self._rows)
            columns |= {f"{name}{IN_WORDS[kind]}": column for name, column in around.items()}
        if not columns:
            return
        scaled = values / values.std(axis=0)
        predicted, names = told_by_forest(columns, scaled, self._setting.seed)
        for told, (kind, target) in zip(predicted.T, targets.items(), strict=True):
            if np.ptp(told) > 0.0:
                correlation = float(np.corrcoef(told, target)[0, 1])
                z = correlation * float(np.sqrt(len(target)))
                yield self._left(kind, names, told > np.median(told), z)

    def waves(self) -> Iterator[Left]:
        """Look for a wave in the position, in time or in the sequence: too fast for a forest."""
        sizes = robust_deviation(self.off), robust_deviation(self.off / self.scale)
        for found in waves_along(self._setting.places, self._rows, self._scores):
            yield self._wave(found, sizes)

    def fast_waves(self) -> Iterator[Left]:
        """Look for waves that come and go many times from one touch to the next, as mains do."""
        places, off = self._setting.irregular_places, self._deviations
        noise = np.median(self._noise), np.median(self._noise / self.scale)
        sizes = [float(one * np.std(off)) for one in noise]
        for found in waves_along(places, self._rows, off, is_fast=True):
            yield self._wave(found, sizes)

    def _wave(self, found: Wave, sizes: Sequence[float]) -> Left:
        size, relative = (float(np.sqrt(found.share)) * one for one in sizes)
        return self._of("wave", found.words, size, relative, found.z)

    def recurring(self) -> Iterator[Left]:
        """Look for touches that come every so many and are off."""
        yield from self._in_turn(in_turn(self._serial, self._scores))

    def remembered(self) -> Iterator[Left]:
        """Look for touches that are off as those before them were, or as far."""
        ranks = scipy.stats.rankdata(self._sizes) / (len(self._sizes) + 1.0)
        for kind, scores in (("shift", self._scores), ("scatter", scipy.stats.norm.ppf(ranks))):
            found = remembered(self._setting.order, self._rows, scores)
            if found is not None:
                words = (f"{WITHIN} {found.window} touches{IN_WORDS[kind]}",)
                yield self._left(kind, words, found.rows, found.z)

    def happened_in_turn(self) -> Iterator[Left]:
        """Look for touches that come every so many, to which something happened."""
        # What happens to less than half of them takes these beyond a deviation of the mean.
        yield from self._in_turn(happens_in_turn(self._serial, np.abs(self._deviations) > 1.0))

    @property
    def _serial(self) -> IndexArray:
        return self._setting.order.serial[self._rows]

    def _in_turn(self, found: Turn | None) -> Iterator[Left]:
        if found is not None:
            words = (f"serial number, every {found.apart} touches",)
            yield self._left("shift", words, found.rows, found.z)

    def _left(self, kind: str, names: tuple[str, ...], high: BoolArray, z: float) -> Left:
        """Say how large it is, by the difference between the touches of a mask and the others."""
        scales = np.ones(len(self.off)), self.scale
        if high.all() and kind == "scatter":
            size, relative = (wider(self.off / scale, self._plays_off / scale) for scale in scales)
        else:
            size, relative = (apart(self.off / scale, high, kind) for scale in scales)
        return self._of(kind, names, size, relative, z)

    def _of(
        self, kind: str, names: tuple[str, ...], size: float, relative: float, z: float
    ) -> Left:
        noise, unit = float(np.median(self._noise)), UNITS[self.name]
        return Left(self.name, self.path, kind, names, size, unit, relative, noise, self._step, z)
