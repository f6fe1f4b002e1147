"""``make gap-check PLANTED=54``: are parameters found, and do their intervals hold them?

The sealed campaigns cannot say so, for their effects have other forms than the table's. Here the
simulator itself plays the effects, each with parameters drawn over the whole of its ranges, and
so tells nothing of how well names are found on a rig: only what becomes of the numbers. Left out
are draws whose numbers nobody could find, because others do just the same.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from skiplatch.campaign import Campaign
from skiplatch.commands.kept import Kept
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.candidates.surrogates import SWITCHES, highest
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_text
from skiplatch.progress import shown
from skiplatch.simulator.effects import Effect, effects
from skiplatch.statistics import proportion
from skiplatch.tables import compact, table
from skiplatch.workers import Workers, in_order, opened
from tests.withheld.chain import Setup
from tests.withheld.conditions import Recording, draw_setup
from tests.withheld.parts import recordings_for
from tests.withheld.simulated import as_recorded, draw_effect, play_once

TOUCHES = (200, 1000)
MEDIAN_GOAL, COVERAGE_GOAL = 0.03, (0.88, 0.92)
SETTLED = 0.5
"""Width of its interval, over the value, below which a parameter counts as settled."""
A_TURN_DEG = 360.0
A_RADIAN_DEG = 180.0 / np.pi


@dataclass(frozen=True, slots=True)
class Found:
    """A parameter of an effect that was named, in its unit.

    Attributes:
        name: As in the table of effects.
        truth: What it was.
        value: What it was found to be.
        low: Where its interval of 90 % begins.
        high: Where that ends.
        is_angle: It comes again after a turn.
    """

    name: str
    truth: float
    value: float
    low: float
    high: float
    is_angle: bool

    @property
    def is_settled(self) -> bool:
        """The touches leave little of it open."""
        return self.high - self.low < SETTLED * self._scale(self.value)

    @property
    def is_held(self) -> bool:
        """The interval holds the truth."""
        turns = (-A_TURN_DEG, 0.0, A_TURN_DEG) if self.is_angle else (0.0,)
        return any(self.low <= self.truth + turn <= self.high for turn in turns)

    @property
    def error(self) -> float:
        """How far it is off, over the truth; of an angle in radians."""
        off = self.value - self.truth
        if self.is_angle:
            off = (off + A_TURN_DEG / 2.0) % A_TURN_DEG - A_TURN_DEG / 2.0
        return abs(off) / self._scale(self.truth)

    def _scale(self, value: float) -> float:
        return A_RADIAN_DEG if self.is_angle else abs(value)


@dataclass(frozen=True, slots=True)
class Planted:
    """A campaign with one effect, and what the diagnosis says.

    Attributes:
        effect: The effect.
        recording: What was recorded.
        verdict: Of the diagnosis.
        groups: Each effect that was named, first, and what would do as well.
        parameters: Of the effect, if that is the only one named.
    """

    effect: Effect
    recording: str
    verdict: str
    groups: Sequence[tuple[str, ...]]
    parameters: Sequence[Found]

    @property
    def is_right(self) -> bool:
        """It is named alone, or stands in the group of what is."""
        return len(self.groups) == 1 and self.effect.id in self.groups[0]

    def as_json(self) -> dict[str, Any]:
        """Give it in plain types."""
        return {
            "effect": self.effect.id,
            "recording": self.recording,
            "verdict": self.verdict,
            "groups": [list(group) for group in self.groups],
            "parameters": [
                {"name": p.name, "truth": p.truth, "value": p.value, "interval": [p.low, p.high]}
                for p in self.parameters
            ],
        }


def plant(seed: int, number: int) -> tuple[Recording, Effect, Campaign]:
    """Play a campaign with one effect: each in its turn, on a rig that shows it."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(8, number)))
    kind, setup, effect = _draw(rng, list(effects())[number % len(effects())])
    played = play_once(setup.nominal, setup.touches, [effect], int(rng.integers(2**31)))
    touches = as_recorded(setup.touches, played)
    if kind is Recording.POSITION:
        nothing = np.full(len(touches), np.nan)
        touches = replace(touches, latch_us=nothing, report_us=nothing)
    return kind, effect, Campaign(setup.nominal, touches, Path("planted"))


def _draw(rng: np.random.Generator, effect_id: str) -> tuple[Recording, Setup, Effect]:
    kinds = recordings_for(effect_id)
    while True:
        kind = kinds[rng.integers(len(kinds))]
        setup = draw_setup(rng, kind, TOUCHES)
        effect = draw_effect(rng, effect_id, setup.nominal, setup.touches)
        if effect is not None and _is_unique(effect, setup):
            return kind, setup, _as_simulated(effect)


def _is_unique(effect: Effect, setup: Setup) -> bool:
    """Tell whether no other numbers do the same.

    A delay cannot be made shorter than none, what befalls nearly all touches is another effect, and
    an error of a higher order alone is one of the first order with a shorter period.
    """
    p, described = effect.parameters, effects()[effect.id].parameters
    believed_us = CANDIDATES[effect.id].believed_us
    return (
        (believed_us is None or p[described[0].name] >= -believed_us(setup.nominal))
        and all(p[d.name] <= highest(effect.id, d) for d in described)
        and all(p.get(f"amplitude{k}_um", 0.0) <= p.get("amplitude_um", 0.0) for k in (2, 3))
    )


def _as_simulated(effect: Effect) -> Effect:
    """Bring switches to a number; the simulator asks no more of them either."""
    switched = {
        name: float(np.rint(value)) if name in SWITCHES else value
        for name, value in effect.parameters.items()
    }
    return Effect(effect.id, switched)


def try_one(seed: int, number: int) -> Planted:
    """Plant an effect, by seed and number, and diagnose the campaign."""
    kind, effect, campaign = plant(seed, number)
    diagnosis = diagnose(campaign, seed=seed)
    groups = [(named.effect.id, *named.alternatives) for named in diagnosis.effects]
    only = diagnosis.effects[0] if len(groups) == 1 else None
    is_it = only is not None and only.effect.id == effect.id
    found = _found(effect, only.effect, only.intervals) if only and is_it else []
    return Planted(effect, str(kind), str(diagnosis.verdict), groups, found)


def _found(
    truth: Effect, named: Effect, intervals: Mapping[str, tuple[float, float]]
) -> list[Found]:
    return [
        Found(
            name=p.name,
            truth=truth.parameters[p.name],
            value=named.parameters[p.name],
            low=intervals[p.name][0],
            high=intervals[p.name][1],
            is_angle=p.unit == "deg",
        )
        for p in effects()[truth.id].parameters
        if p.name not in SWITCHES  # which are on or off, and by no share
    ]


def as_text(tried: Sequence[Planted]) -> str:
    """Say how far parameters are off, and how many intervals hold them; list what is not right."""
    settled = [p for one in tried for p in one.parameters if p.is_settled]
    lines = [_share("name or group", [one.is_right for one in tried])]
    if settled:
        median = float(np.median([p.error for p in settled]))
        goal = f"goal ≤ {100 * MEDIAN_GOAL:g} %"
        lines.append(f"settled parameters, median error: {100 * median:.2g} %, {goal}")
        low, high = (f"{100 * share:g}" for share in COVERAGE_GOAL)
        held = _share("  their intervals of 90 % hold the truth", [p.is_held for p in settled])
        lines.append(f"{held}, goal {low} … {high} %")
    rows = [(one.effect.id, one.recording, *_outcome(one)) for one in tried if not _is_well(one)]
    heads = ("effect", "recorded", "named", "parameters not held")
    return "\n".join(lines) + "\n\n" + table(heads, rows)


def _is_well(one: Planted) -> bool:
    return one.is_right and all(p.is_held for p in one.parameters if p.is_settled)


def _outcome(one: Planted) -> tuple[str, str]:
    named = " + ".join(group[0] for group in one.groups) or one.verdict
    missed = (p for p in one.parameters if p.is_settled and not p.is_held)
    return named, ", ".join(
        f"{p.name} {compact(p.truth)}: {compact(p.low)} … {compact(p.high)}" for p in missed
    )


def _share(title: str, hits: Sequence[bool]) -> str:
    share = proportion(sum(hits), len(hits))
    interval = f"{100 * share.low:.1f} … {100 * share.high:.1f} %"
    return f"{title}: {sum(hits)} of {len(hits)}, {100 * share.value:.1f} % ({interval})"


def main(arguments: Sequence[str] | None = None) -> None:
    """Read the command line and run the check."""
    parser = argparse.ArgumentParser(prog="gap-check (planted)", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=27, help="number of campaigns")
    parser.add_argument("--jobs", type=int, default=1, help="campaigns at the same time")
    parser.add_argument("--cluster", help="local:N, or the address of a Dask scheduler")
    parser.add_argument("--json", type=Path, help="write every campaign as JSON")
    options = parser.parse_args(arguments)
    tasks = [(options.seed, number) for number in range(options.count)]
    names = [f"planted campaign {number} of seed {seed}" for seed, number in tasks]
    try:
        kept = Kept.beside(options.json)
        with opened(Workers(jobs=options.jobs, cluster=options.cluster)) as executor:
            coming = in_order(executor, try_one, tasks, names, kept)
            tried = list(shown(coming, len(tasks), "planted"))
    except InputError as error:
        raise SystemExit(f"gap-check: {error}") from error
    print(as_text(tried))
    if options.json:
        document = json.dumps([one.as_json() for one in tried], indent=1)
        atomic_write_text(options.json, document + "\n")
    kept.drop()


if __name__ == "__main__":
    main()
