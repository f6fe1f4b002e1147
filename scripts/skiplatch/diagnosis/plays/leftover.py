"""What a hypothesis leaves: can one tell from anything known which touches its plays miss?

What it leaves to chance (which edges bounce, where a value lies between two lines) has to be so.
If something known tells it, the hypothesis does not hold, whatever form the truth has, and what
tells it is what that looks like.
"""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.comparison.observables import Recorded
from skiplatch.diagnosis.fit.material import Materiality
from skiplatch.diagnosis.likelihood.likelihood import MISSED
from skiplatch.diagnosis.plays.left import EVERYWHERE, Left, Memo
from skiplatch.diagnosis.plays.look import FARTHEST, Look
from skiplatch.diagnosis.plays.playing import Rig, has_like_grid
from skiplatch.diagnosis.plays.setting import Setting
from skiplatch.diagnosis.plays.telling import FEWEST, SMALLEST, told_which
from skiplatch.diagnosis.scene.covariates import varying
from skiplatch.diagnosis.scene.observed import LINE, observed_evenly
from skiplatch.diagnosis.scene.pitches import is_on_grid, kept_pitch
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.side_by_side import side_by_side
from skiplatch.simulator.playing import Outcomes
from skiplatch.span import Span, parted
from skiplatch.statistics import errors_of, errors_of_excess
from skiplatch.units import UM_PER_MM

PLAYS = 60
"""Of each touch: ranks to a sixtieth."""
MOST_TOUCHES = 1_500
MOST_PLAYED = 4_000
NOTICED = 3.5
"""Standard errors from which on something may be worth a search, which then decides."""
USUALLY_MISSED = 1e-3
"""Share of touches that any rig may miss."""


def left_over(
    beside: "Beside", memo: Memo | None = None, executor: Executor | None = None
) -> list[Left]:
    """Look for all that is left of touches; all that was tried, the most significant first.

    Args:
        beside: The touches beside plays of them.
        memo: What was found of other rigs, to be looked up and added to.
        executor: Looks from several sides at a time.
    """
    memo = {} if memo is None else memo
    looks = {look.key: look for here in beside.looks.values() for look in here}
    new = {key: look for key, look in looks.items() if key not in memo}
    memo.update(zip(new, side_by_side(executor, Look.all, new.values()), strict=True))
    found = [left for key in looks for left in memo[key]]
    for path, here in beside.paths.items():
        for rows in parted(beside.spans, beside.setting.scene.touches.touch, here):
            found += _missing(beside.setting, path, rows, beside.outcomes)
        found += _steps(beside.setting, path, here, beside.resolution_um)
    return sorted(found, key=lambda left: -left.z)


@dataclass(frozen=True, eq=False)
class Beside:
    """Touches beside plays of them, taken apart by observable.

    Attributes:
        setting: What is known of the touches.
        outcomes: The plays.
        recorded: Shape (n,), by observable.
        played: Shape (r, n), by observable.
        resolution_um: What the rig played rounds positions to.
        spans: At which some effect of it acts: a look at what was missed knows no plays.
    """

    setting: Setting
    outcomes: Outcomes
    recorded: Mapping[str, FloatArray]
    played: Mapping[str, FloatArray]
    resolution_um: float
    spans: Sequence[Span] = ()

    @classmethod
    def of(cls, scene: Scene, rig: Rig, *, seed: int, jobs: int = 1) -> Self:
        """Play the touches of a scene; some of them, if there are many.

        Args:
            scene: The touches.
            rig: What to play.
            seed: Of the plays, and of the forests that look at them.
            jobs: Threads to play on.
        """
        scene = scene.drawn(MOST_TOUCHES, seed)
        # What a touch does may depend on those before it, whether they are looked at or not.
        sequence, rows = scene.in_sequence(MOST_PLAYED)
        outcomes = rig.play(sequence.touches, seed=seed, replicates=PLAYS, jobs=jobs).select(rows)
        recorded, played = _without_rests(scene, *_dithered(scene, rig, outcomes, seed))
        # A latch without a contact says nothing of what latches contacts.
        recorded = {k: np.where(scene.false, np.nan, values) for k, values in recorded.items()}
        if not has_like_grid(rig, sequence.touches):
            recorded = {**recorded, "grid": np.full(len(scene), np.nan)}
        setting = Setting(scene, seed, rig.longest_scan_us)
        return cls(setting, outcomes, recorded, played, rig.resolution_um, rig.spans)

    @property
    def paths(self) -> Mapping[str, BoolArray]:
        """Give the touches of each path; shape (n,)."""
        plc = self.setting.scene.plc
        return {"skip": ~plc, "plc": plc}

    def known(self, name: str) -> BoolArray:
        """Tell which touches show an observable, recorded and played; shape (n,)."""
        return ~np.isnan(self.recorded[name]) & ~np.isnan(self.played[name]).all(axis=0)

    @cached_property
    def looks(self) -> Mapping[str, Sequence[Look]]:
        """Hold all touches of each path that show an observable against their plays."""
        seen = {
            path: {name: here & self.known(name) for name in self.recorded}
            for path, here in self.paths.items()
        }
        return {
            path: [self.look(n, path, rows) for n, rows in of.items() if rows.sum() >= FEWEST]
            for path, of in seen.items()
        }

    def look(self, name: str, path: str, rows: BoolArray) -> Look:
        """Hold some touches of a path against their plays."""
        return Look(self.setting, name, path, rows, self.recorded[name], self.played[name])


STREAMS = {
    "edge": ("motion",),
    "latch": ("latch_skip", "latch_plc"),
    "grid": ("lattice",),
    "position": ("position", "deviation_skip", "deviation_plc"),
    "report": ("report", "arrival"),
    MISSED: (MISSED,),
}
"""Of the likelihood, by the observable that shows the same."""


def streams_of(left: Left) -> frozenset[str]:
    """Name the streams that show the same."""
    return streams_at(left.observable, left.path)


def streams_at(observable: str, path: str) -> frozenset[str]:
    """Name the streams that show an observable; those of a path where the paths are apart."""
    other = {"skip": "plc", "plc": "skip"}[path]
    return frozenset(s for s in STREAMS[observable] if not s.endswith(f"_{other}"))


def noticed(looks: Sequence[Left], materiality: Materiality) -> frozenset[str]:
    """Name the streams in which something that matters may be left."""
    seen = (look for look in looks if look.z > NOTICED and look.is_material(materiality))
    return frozenset(name for look in seen for name in streams_of(look))


def _dithered(
    scene: Scene, rig: Rig, outcomes: Outcomes, seed: int
) -> tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]]:
    """Take record and plays apart, all spread evenly over what they are rounded to.

    What lies close to a tick that was found is on it.
    """
    rng, tick_us = np.random.default_rng(seed), LINE * rig.tick_us * rig.has_coarse_tick

    def spread(seen: Recorded) -> Mapping[str, FloatArray]:
        # Beside a period that is off a belief by little, stamps over an hour lie anywhere.
        values = observed_evenly(scene, seen, rig.resolution_um, rng, scan_us=rig.scan_us)
        if not tick_us:
            return values
        stamps = {
            name: values[name] + tick_us * (rng.random(values[name].shape) - 0.5)
            for name in ("latch", "grid")
        }
        return {**values, **stamps}

    return spread(rig.counted(scene.touches)), spread(outcomes)


def _without_rests(
    scene: Scene, recorded: Mapping[str, FloatArray], played: Mapping[str, FloatArray]
) -> tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]]:
    """Take away what all scans of a rig are stamped early by, in the positions of record and plays.

    Where the scan period is a whole number of ticks that is one rest of a tick, another in each
    play, and all positions of a path are off by its way.
    """
    rows = scene.plc & scene.has_stamps & (scene.speed > 0.0) & ~np.isnan(recorded["position"])
    rows &= ~np.isnan(played["position"]).any(axis=0)
    if not rows.any():
        return recorded, played
    middle, speed = played["position"][:, rows].mean(axis=0), scene.speed[rows]
    noise = np.maximum(played["position"][:, rows].std(axis=0), SMALLEST)
    weight, half_us = (speed / noise) ** 2, scene.nominal.skip.tick_us / 2.0

    def calm(position: FloatArray) -> FloatArray:
        off_us, error_us = (position[..., rows] - middle) / speed, noise / speed
        rest_us = np.quantile(off_us, 0.5, axis=-1, weights=weight, method="inverted_cdf")
        # Touches far off say nothing of it, and the others more together than their middle.
        usual = weight * (np.abs(off_us - rest_us[..., None]) <= FARTHEST * error_us + half_us)
        rest_us = np.sum(usual * off_us, axis=-1) / np.maximum(usual.sum(axis=-1), SMALLEST)
        calmed = position.copy()
        calmed[..., rows] -= np.clip(rest_us, -half_us, half_us)[..., None] * speed
        return calmed

    return (
        {**recorded, "position": calm(recorded["position"])},
        {**played, "position": calm(played["position"])},
    )


def _steps(setting: Setting, path: str, here: BoolArray, fine_um: float) -> Iterator[Left]:
    """Look whether positions are rounded to more than a rig's resolution: they show its lines."""
    deviation_um = setting.scene.touches.deviation_um[here]
    kept = kept_pitch(deviation_um, fine_um) or _kept_by_latches(setting.scene, here, fine_um)
    if kept:
        yield _step(setting, path, fine_um, *kept)


def _kept_by_latches(scene: Scene, here: BoolArray, fine_um: float) -> tuple[float, float] | None:
    """Give the pitch that latched coordinates keep, unless the surfaces lie on its lines as well.

    A latch that is off by nothing lies where its surface does.
    """
    known = here & ~np.isnan(scene.latched_mm)
    kept = kept_pitch(scene.latched_mm[known] * UM_PER_MM, fine_um)
    surfaces_um = scene.touches.position_mm[known] * UM_PER_MM
    return None if kept and is_on_grid(surfaces_um, kept[0], fine_um) else kept


def _step(setting: Setting, path: str, fine_um: float, pitch_um: float, z: float) -> Left:
    size_um = float(np.sqrt((pitch_um**2 - fine_um**2) / 12.0))
    noise_um = max(setting.repeats_to("position"), fine_um / np.sqrt(12.0))
    relative, where = size_um / noise_um, (EVERYWHERE,)
    return Left("position", path, "steps", where, size_um, "µm", relative, noise_um, fine_um, z)


def _missing(setting: Setting, path: str, here: BoolArray, outcomes: Outcomes) -> Iterator[Left]:
    """Look at the touches that were not latched: how many, and which."""
    if not here.any():
        return
    missed, played = setting.scene.touches.missed[here], ~outcomes.ok[:, here]
    n, expected = len(missed), float(played.mean())
    share = float(missed.mean()) - expected
    if missed.any() or expected > USUALLY_MISSED:
        z = _errors_of_count(int(missed.sum()), n, max(expected, USUALLY_MISSED))
        yield _share(path, (EVERYWHERE,), share, share, z)
    told = told_which(varying(setting.known, here), missed, setting.seed)
    if told is not None:
        predicted, names, z = told
        high = predicted > np.median(predicted)
        apart = float(missed[high].mean() - missed[~high].mean()) if high.any() else 0.0
        yield _share(path, names, apart / 2.0, apart, z)


def _share(path: str, names: tuple[str, ...], size: float, relative: float, z: float) -> Left:
    """Describe a share of missed touches, which neither scatters nor is rounded."""
    return Left(MISSED, path, "share", names, abs(size), "1", abs(relative), 0.0, 0.0, z)


def _errors_of_count(count: int, n: int, rate: float) -> float:
    """Give how many standard errors a count of n is from its rate: one alone is an accident."""
    if count > n * rate:
        return errors_of_excess(count, n, rate)
    return errors_of(float(scipy.stats.binom.cdf(count, n, rate)))
