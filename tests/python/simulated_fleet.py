"""A fleet of rigs whose campaigns are drawn touch by touch, with nothing of the product's formulas.

Each rig has an offset of its own that its nominal knows nothing of, its campaigns wander about it,
and the seasons move all of them. Here and there a campaign is wild: a chip under the probe. Some
rigs change for good from a week on, at once or over many weeks. A campaign's gap is the score of
its touches against plays (mean distance to a play, less half of that between two plays), as a
diagnosis gives it.
"""

from dataclasses import dataclass, field
from datetime import datetime, timedelta

import numpy as np

from skiplatch.fleet.history import Entry, Gap, History, Parameter

START = datetime(2025, 1, 6, 6)  # noqa: DTZ001 - a store has UTC without a zone
WEEK = timedelta(weeks=1)


@dataclass(frozen=True)
class Observable:
    """What touches show; lengths and times in the unit."""

    name: str
    unit: str
    scatter: float
    effect: str
    stage: str
    parameter: str


LATCH = Observable("latch error", "µs", 1.0, "isr_latency", "latch", "latency_us")
DEVIATION = Observable("deviation", "µm", 0.5, "backlash", "position", "backlash_um")
OBSERVABLES = (LATCH, DEVIATION)


@dataclass(frozen=True)
class Fault:
    """A rig changes: from a week on, by so many standard deviations of its touches.

    With the last of the weeks that it takes it is whole; with one week it is a step.
    """

    week: int
    observable: Observable
    size: float
    takes: int = 1

    def size_in(self, week: int) -> float:
        """Give how much of it there is in a week."""
        return self.size * min(max((week - self.week + 1) / self.takes, 0.0), 1.0)


@dataclass(frozen=True, kw_only=True)
class Fleet:
    """What is drawn.

    Attributes:
        sizes: Least and greatest step, in standard deviations of a single touch.
        wander: Standard deviation between campaigns, likewise; with `tails` degrees of freedom.
        season: Amplitude of a year's wave, likewise.
        wild: Probability of a wild campaign.
        first: The first week that a change may begin in.
        last: The last one; from the end, if it is negative.
        takes: Weeks that a change takes.
    """

    rigs: int = 200
    weeks: int = 52
    changing: int = 8
    touches: int = 40
    sizes: tuple[float, float] = (3.0, 8.0)
    wander: float = 0.2
    tails: float = 8.0
    season: float = 0.1
    wild: float = 0.003
    first: int = 8
    last: int = -5
    takes: int = 1
    faults: dict[str, Fault] = field(default_factory=dict)

    def drawn(self, seed: int) -> tuple[History, dict[str, Fault]]:
        """Give all campaigns, and what changed."""
        rng = np.random.default_rng(seed)
        names = [f"rig-{number:03}" for number in range(self.rigs)]
        faults = {
            str(rig): Fault(
                int(rng.integers(self.first, self.last % self.weeks + 1)),
                OBSERVABLES[rng.integers(2)],
                float(rng.uniform(*self.sizes)),
                self.takes,
            )
            for rig in rng.choice(names, self.changing, replace=False)
        }
        gaps = {one.name: self._gaps(rng, one, names, faults) for one in OBSERVABLES}
        return {
            name: [self._entry(rng, name, rig, week, gaps, faults) for week in range(self.weeks)]
            for rig, name in enumerate(names)
        }, faults

    def _gaps(
        self, rng: np.random.Generator, one: Observable, names: list[str], faults: dict[str, Fault]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Draw recorded touches and plays, and score them; shapes (rigs, weeks)."""
        shape = self.rigs, self.weeks
        own = rng.normal(0.0, 1.5, (self.rigs, 1))
        offset = own + self.wander * rng.standard_t(self.tails, shape)
        offset = offset + self.season * np.sin(2.0 * np.pi * np.arange(self.weeks) / 52.0)
        offset += (rng.random(shape) < self.wild) * rng.normal(0.0, 10.0, shape)
        for rig, name in enumerate(names):
            if name in faults and faults[name].observable is one:
                way = 1.0 if own[rig, 0] >= 0.0 else -1.0
                offset[rig] += [way * faults[name].size_in(week) for week in range(self.weeks)]
        recorded = offset[..., None] + rng.normal(size=(*shape, self.touches))
        play, other = rng.normal(size=(2, *shape, self.touches))
        floor = np.abs(play - other).mean(-1) / 2.0
        before = np.abs(recorded - play).mean(-1) - floor
        return one.scatter * before, one.scatter * floor

    def _entry(
        self,
        rng: np.random.Generator,
        name: str,
        rig: int,
        week: int,
        gaps: dict[str, tuple[np.ndarray, np.ndarray]],
        faults: dict[str, Fault],
    ) -> Entry:
        found = {
            one.name: Gap(
                one.name,
                one.unit,
                float(gaps[one.name][0][rig, week]),
                float(gaps[one.name][1][rig, week]),
            )
            for one in OBSERVABLES
        }
        parameters = []
        if name in faults and week >= faults[name].week:
            one = faults[name].observable
            true = faults[name].size_in(week) * one.scatter
            value = float(rng.normal(true, 0.05 * true))
            half = 0.1 * true
            parameters = [
                Parameter(one.effect, one.stage, one.parameter, value, value - half, value + half)
            ]
        return Entry(
            campaign=f"{rig:08x}{week:08x}".ljust(64, "0"),
            time=START + week * WEEK + timedelta(minutes=float(rng.uniform(0.0, 600.0))),
            folder=f"week-{week:02}",
            kind="machine",
            touches=self.touches,
            verdict="explained" if parameters else "no_gap",
            stage=parameters[0].stage if parameters else None,
            gap_um=found[DEVIATION.name].before,
            gaps=found,
            parameters=parameters,
        )
