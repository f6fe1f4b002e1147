"""The experiment that would settle a diagnosis best, by what the simulation lets expect."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, Kind, Touches
from skiplatch.diagnosis.experiment import words
from skiplatch.diagnosis.experiment.channels import channels, recordable, recorded
from skiplatch.diagnosis.experiment.choice import choose
from skiplatch.diagnosis.experiment.conditions import (
    Conditions,
    elsewhere,
    spread_out,
    travel_s,
)
from skiplatch.diagnosis.experiment.evidence import Samples, exponents, log_likelihoods
from skiplatch.diagnosis.experiment.rehearsal import REHEARSALS, Rehearsal
from skiplatch.diagnosis.experiment.rivals import Model, rivals
from skiplatch.diagnosis.experiment.surfaces import are_varied, asked_for
from skiplatch.diagnosis.experiment.trial import Trial
from skiplatch.diagnosis.scene.arrivals import as_stamped, with_arrivals
from skiplatch.simulator.effects import effects
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller
from skiplatch.units import US_PER_S

if TYPE_CHECKING:
    from skiplatch.diagnosis.reported.diagnosis import Diagnosis


TOUCHES = 60
WARMER_K = 5.0
DRAWN = 160
"""Touches to choose from."""
DRAWN_REPLICATES = 64
REPLICATES = 192
FEWEST_REPLICATES = 32
MOST_SCANS = 1.5e6
"""Scans that one model may play in one go: irregular ones are played one by one."""
WORTH_RECORDING = 2
"""A column is recommended that saves all but one in so many touches."""
FEW = 6
"""So few touches are made sooner than a column is recorded."""


@dataclass(frozen=True, slots=True, eq=False)
class Experiment:
    """What to do next, and what it is expected to tell.

    Attributes:
        words: Why, for the reader.
        record: The column to record in addition, or None.
        touches: The touches to make, the most telling first, with no outcomes.
        bits_per_touch: Expected information on the model in a touch alone; 0 if nothing is told
            apart.
        expected_bits: The same in all touches together.
        touches_needed: After so many the groups of `separates` are told apart with a probability
            of 0.95; None if nothing is told apart.
        separates: The models by group: those within one remain tied. Empty without rivals.
        invented: Columns of the touches that stand in for the motion of a bench without any.
    """

    words: str
    record: str | None
    touches: Touches
    bits_per_touch: float
    expected_bits: float
    touches_needed: int | None
    separates: tuple[tuple[str, ...], ...]
    invented: frozenset[str] = frozenset()

    @property
    def resolves(self) -> bool:
        """Whether it tells every model from every other."""
        return bool(self.separates) and all(len(group) == 1 for group in self.separates)


@dataclass(frozen=True, slots=True, eq=False)
class _Option:
    """Touches made with one more column recorded, or none, or while the machine warms up."""

    setting: words.Setting
    conditions: Conditions
    trial: Trial

    @property
    def value(self) -> tuple[int, int]:
        """Orders options: groups told apart, then fewer touches."""
        return self.trial.count, -(self.trial.touches_needed or 0)


def next_experiment(
    campaign: Campaign, diagnosis: "Diagnosis", *, seed: int, jobs: int = 1, touches: int = TOUCHES
) -> Experiment:
    """Say what to record or to touch next.

    Args:
        campaign: What was diagnosed.
        diagnosis: What came of it.
        seed: Picks the random numbers.
        jobs: Threads to play on; the result does not depend on it.
        touches: How many touches to recommend.
    """
    return experiment_for(
        campaign, rivals(diagnosis), str(diagnosis.verdict), seed=seed, jobs=jobs, touches=touches
    )


def experiment_for(
    campaign: Campaign,
    models: Sequence[Model],
    verdict: str,
    *,
    seed: int,
    jobs: int = 1,
    touches: int = TOUCHES,
    as_recorded: bool = False,
) -> Experiment:
    """Do the same for models and a verdict; `as_recorded` asks for no column that is not there."""
    if len(models) > 1:
        found = settle(
            campaign, models, seed=seed, jobs=jobs, touches=touches, as_recorded=as_recorded
        )
    else:
        rng = np.random.default_rng(seed)
        plan = spread_out(campaign.touches, touches, rng, _reach_mm(campaign)).touches
        why = words.without_rivals(verdict, words.name(models[0]) if models else "")
        found = Experiment(why, None, plan, 0.0, 0.0, None, ())
    if campaign.nominal.kind is Kind.BENCH:
        found = replace(found, invented=campaign.stood_in & {"feed_mm_min", "approach_mm"})
    return found


def settle(
    campaign: Campaign,
    models: Sequence[Model],
    *,
    seed: int,
    jobs: int,
    touches: int = TOUCHES,
    as_recorded: bool = False,
) -> Experiment:
    """Find the experiment that tells two or more models apart best; see `experiment_for`."""
    campaign, rng = with_arrivals(campaign), np.random.default_rng(seed)
    count, reach_mm = max(DRAWN, touches), _reach_mm(campaign)
    drawn = spread_out(campaign.touches, count, rng, reach_mm).brief()
    stage = _Stage(campaign, models, Rehearsal.of(campaign, models), seed, jobs)
    kept = recorded(campaign.nominal, campaign.touches)
    settings = [words.AS_RECORDED]
    if not as_recorded:
        missing = (name for name in recordable(campaign.nominal) if name not in kept)
        settings += map(words.Setting, missing)
    options = stage.options(settings, drawn, kept, touches)
    if _best(options).trial.count < len(models) and not np.isnan(drawn.touches.temp_c).any():
        warm = [words.Setting(warmer_k=WARMER_K)]
        options += stage.options(warm, drawn, kept, touches)
    found = _recommended(options, models)
    if found.resolves or are_varied(campaign.touches):
        return found
    others = elsewhere(campaign.touches, count, rng, reach_mm).brief()
    beyond = stage.options([words.AS_RECORDED], others, kept, touches)[0]
    return replace(found, words=f"{found.words} {_of_other_surfaces(beyond, found, campaign)}")


def _of_other_surfaces(beyond: _Option, found: Experiment, campaign: Campaign) -> str:
    """Say whether surfaces that the campaign does not have would tell more."""
    told = beyond.trial.count > len(found.separates)
    telling = beyond.conditions.touches.select(slice(beyond.trial.touches_needed))
    asked = asked_for(telling, campaign.touches) if told else ""
    return words.other_surfaces(asked)


def _reach_mm(campaign: Campaign) -> tuple[float, float]:
    axis = campaign.nominal.axis
    return axis.min_mm, axis.max_mm


def _chosen(options: Sequence[_Option]) -> _Option:
    as_recorded, best = options[0], _best(options)
    return best if _is_worth_recording(as_recorded.trial, best.trial) else as_recorded


def _best(options: Sequence[_Option]) -> _Option:
    return max(options, key=lambda option: option.value)


@dataclass(frozen=True, slots=True, eq=False)
class _Stage:
    """The rig on which every model plays the same touches with the same random numbers."""

    campaign: Campaign
    models: Sequence[Model]
    rehearsal: Rehearsal
    seed: int
    jobs: int

    def options(
        self,
        settings: Sequence[words.Setting],
        drawn: Conditions,
        kept: frozenset[str],
        touches: int,
    ) -> list[_Option]:
        """Choose touches for each setting, and try them; all settings are as warm as the first."""
        warmer_k = settings[0].warmer_k
        pool = drawn.warming(warmer_k)
        seen = self.play(pool, self.replicates(pool, DRAWN_REPLICATES), first=0)
        found = []
        for setting in settings:
            columns = kept | {setting.column} if setting.column else kept
            told = exponents(self.samples(pool, seen, columns))
            pairs = told[np.triu_indices(len(self.models), k=1)]
            plan = drawn.chosen(choose(pairs, touches)).warming(warmer_k)
            trial = Trial.of(self.tried(plan, columns), self.groups(plan, columns))
            found.append(_Option(setting, plan, trial))
            if _is_soon_settled(found[0].trial):
                break
        return found

    def replicates(self, conditions: Conditions, wanted: int) -> int:
        """Give how often to play, fewer times where many scans are late one by one."""
        stages = {effects()[effect.id].stage for model in self.models for effect in model}
        if "scan" not in stages:
            return wanted
        polled_s = travel_s(conditions.touches)[conditions.touches.on_plc].sum()
        scans = polled_s * US_PER_S / self.campaign.nominal.plc.scan_us
        return int(np.clip(MOST_SCANS / max(scans, 1.0), FEWEST_REPLICATES, wanted))

    def play(self, conditions: Conditions, replicates: int, *, first: int) -> list[Outcomes]:
        nominal, touches = self.campaign.nominal, conditions.touches
        alone = partial(
            play,
            nominal,
            Controller.for_campaign(nominal, touches),
            touches,
            seed=self.seed,
            replicates=replicates,
            first_replicate=first,
            jobs=self.jobs,
        )
        return [as_stamped(nominal, alone(switched_on=model)) for model in self.models]

    def samples(
        self, conditions: Conditions, played: Sequence[Outcomes], columns: frozenset[str]
    ) -> Samples:
        nominal, touches = self.campaign.nominal, conditions.touches
        seen = [channels(nominal, touches, outcomes, columns) for outcomes in played]
        return {name: np.stack([model[name] for model in seen]) for name in seen[0]}

    def tried(self, plan: Conditions, columns: frozenset[str]) -> FloatArray:
        """Try the plan in replicates that had no part in choosing it; see `Trial.of`."""
        replicates = self.replicates(plan, REPLICATES)
        known, judged = (
            self.samples(plan, self.play(plan, replicates, first=first), columns)
            for first in (DRAWN_REPLICATES, DRAWN_REPLICATES + replicates)
        )
        return log_likelihoods(known, judged)

    def groups(self, plan: Conditions, columns: frozenset[str]) -> NDArray[np.intp]:
        """Play a plan to its end, and group the models as its outcome will; shape (m,)."""
        played = self.play(plan, REHEARSALS, first=DRAWN_REPLICATES + 2 * REPLICATES)
        return self.rehearsal.groups(plan.touches, played, columns)


def _recommended(options: Sequence[_Option], models: Sequence[Model]) -> Experiment:
    chosen = _chosen(options)
    names = [words.name(model) for model in models]
    groups = [
        tuple(name for name, group in zip(names, chosen.trial.groups, strict=True) if group == g)
        for g in range(chosen.trial.count)
    ]
    tried = {option.setting: option.trial for option in options}
    told = len(groups) > 1  # the bits take for known what the rehearsal fits
    return Experiment(
        words=words.with_rivals(groups, models, chosen.setting, tried),
        record=chosen.setting.column if told else None,
        touches=chosen.conditions.touches,
        bits_per_touch=chosen.trial.bits_per_touch if told else 0.0,
        expected_bits=chosen.trial.bits if told else 0.0,
        touches_needed=chosen.trial.touches_needed,
        separates=tuple(groups),
    )


def _is_soon_settled(trial: Trial) -> bool:
    all_apart = trial.count == len(trial.groups)
    return all_apart and trial.touches_needed is not None and trial.touches_needed <= FEW


def _is_worth_recording(as_recorded: Trial, best: Trial) -> bool:
    if best.count != as_recorded.count or as_recorded.touches_needed is None:
        return best.count > as_recorded.count
    needed = as_recorded.touches_needed
    return needed > FEW and WORTH_RECORDING * (best.touches_needed or needed) <= needed
