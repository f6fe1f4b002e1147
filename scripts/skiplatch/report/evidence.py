"""What the page shows of a campaign: recorded, and played with and without the effects found."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray, drawn
from skiplatch.campaign import Campaign, InputPath, Touches
from skiplatch.comparison.observables import ALL_OBSERVABLES, OF_LINEAR_AXES, Observable
from skiplatch.diagnosis import Diagnosis
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.motion import Contact, expected_contact
from skiplatch.report.conditions import Condition, conditions
from skiplatch.simulator.effects import effects
from skiplatch.simulator.playing import Outcomes

MOST_TOUCHES = 4_000
"""Touches that are played; of a larger campaign, some are drawn."""
PLAYED_TOUCHES = 20_000
FEWEST_REPLICATES = 4
MOST_REPLICATES = 40

TIMES = ("latch_after_edge_us", "latch_after_contact_us")
POSITION = "deviation_um"
TELLING = {
    "motion": (TIMES[1], POSITION),  # an injected edge moves along with the contact
    "position": (POSITION,),
    "report": ("report_after_latch_us",),
}
"""Observables in which a stage shows most clearly; for any other stage, a latch time."""


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """One observable of n touches, NaN where there is none, as of axes of the other kind."""

    observable: Observable
    recorded: FloatArray
    """Shape (n,)."""
    before: FloatArray
    """In the nominal simulation; shape (r, n)."""
    after: FloatArray | None
    """In the simulation with the effects, if any was found; shape (r, n)."""

    @property
    def title(self) -> str:
        """Its name for people."""
        return self.observable.title

    @property
    def unit(self) -> str:
        """Its unit."""
        return self.observable.unit

    @property
    def stretch(self) -> str:
        """What it is called of linear axes."""
        return OF_LINEAR_AXES.get(self.observable.name, self.observable.name)

    @property
    def left_before(self) -> FloatArray:
        """Recorded less the mean of the nominal simulation; shape (n,)."""
        return self.recorded - _mean(self.before)

    @property
    def left_after(self) -> FloatArray | None:
        """Recorded less the mean of the simulation with the effects; shape (n,)."""
        return None if self.after is None else self.recorded - _mean(self.after)


@dataclass(frozen=True, slots=True)
class Missed:
    """Share of the touches of one path without a latch, 0 to 1."""

    path: InputPath
    recorded: float
    before: float
    after: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """All that the figures of the page are drawn from."""

    touches: Touches
    seen: Mapping[str, Seen]
    """Observables that were recorded, by name."""
    telling: str
    """The observable that shows the guilty stage most clearly."""
    path: InputPath
    """The path on which the effect found acts."""
    missed: Sequence[Missed]
    conditions: Sequence[Condition]
    stood_in: frozenset[str] = frozenset()
    """Columns whose values nobody recorded."""

    @property
    def stretch(self) -> str:
        """What the telling observable is called of linear axes."""
        return OF_LINEAR_AXES.get(self.telling, self.telling)

    @property
    def paths(self) -> list[InputPath]:
        """Those with touches."""
        return [path for path in InputPath if (self.touches.path == path).any()]


def gather(campaign: Campaign, diagnosis: Diagnosis, *, seed: int, jobs: int) -> Evidence:
    """Play a campaign with and without the effects found."""
    touches = campaign.touches.in_order_of_time()
    rows = drawn(len(touches), MOST_TOUCHES, seed)
    shown = touches.select(rows)
    before = _play(diagnosis.believed, shown, seed, jobs)
    after = _play(diagnosis.rig, shown, seed, jobs) if diagnosis.effects else None
    seen = _seen(shown, expected_contact(campaign.nominal, shown), before, after)
    found = conditions(touches, campaign.stood_in)
    return Evidence(
        touches=shown,
        seen=seen,
        telling=_telling(diagnosis, seen),
        path=_path(diagnosis, shown),
        missed=_missed(shown, before, after),
        conditions=[condition.select(rows) for condition in found],
        stood_in=campaign.stood_in,
    )


def _play(rig: Rig, touches: Touches, seed: int, jobs: int) -> Outcomes:
    replicates = int(np.clip(PLAYED_TOUCHES // len(touches), FEWEST_REPLICATES, MOST_REPLICATES))
    return rig.play(touches, seed=seed, replicates=replicates, jobs=jobs)


def _seen(
    touches: Touches, contact: Contact, before: Outcomes, after: Outcomes | None
) -> dict[str, Seen]:
    seen = {}
    for observable in ALL_OBSERVABLES:
        mine = touches.turns == observable.is_rotary

        def own(values: FloatArray, mine: BoolArray = mine) -> FloatArray:
            return np.where(mine, values, np.nan)

        recorded = own(observable.values(touches, contact))
        if np.isfinite(recorded).any():
            seen[observable.name] = Seen(
                observable,
                recorded,
                own(observable.values(before, contact)),
                None if after is None else own(observable.values(after, contact)),
            )
    return seen


def _telling(diagnosis: Diagnosis, seen: Mapping[str, Seen]) -> str:
    stages = [named.stage for named in diagnosis.effects] or [p.stage for p in diagnosis.where]
    wanted = TELLING.get(stages[0], (*TIMES, POSITION)) if stages else (POSITION,)
    turned = {plain: name for name, plain in OF_LINEAR_AXES.items()}
    both = [name for plain in wanted for name in (plain, turned[plain])]
    return next((name for name in (*both, *seen) if name in seen), POSITION)


def _path(diagnosis: Diagnosis, touches: Touches) -> InputPath:
    """The skip path where both will do: its own scatter is the smaller one."""
    known = effects()
    acting = [known[named.effect.id].paths for named in diagnosis.effects]
    acting = acting or [place.paths for place in diagnosis.where[:1]]
    wanted = InputPath.PLC if "plc" in acting else InputPath.SKIP
    present = touches.path[touches.path == wanted].size > 0
    return wanted if present else InputPath(touches.path[0])


def _missed(touches: Touches, before: Outcomes, after: Outcomes | None) -> list[Missed]:
    shares = []
    for path in InputPath:
        rows = touches.path == path
        known = rows & (touches.ok | touches.missed)
        if known.any():
            shares.append(
                Missed(
                    path,
                    float(touches.missed[known].mean()),
                    float(np.isnan(before.deviation_um[:, known]).mean()),
                    None if after is None else float(np.isnan(after.deviation_um[:, known]).mean()),
                )
            )
    return shares


def _mean(values: FloatArray) -> FloatArray:
    """Mean over the replicates in which there is a value; NaN where there is none."""
    known = np.isfinite(values)
    count = known.sum(axis=0)
    total = np.where(known, values, 0.0).sum(axis=0)
    nothing = np.full(values.shape[1], np.nan)
    return np.asarray(np.divide(total, count, out=nothing, where=count > 0))
