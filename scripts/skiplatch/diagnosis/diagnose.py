"""The diagnosis of a campaign: where the gap lies, what causes it, how far it shrinks."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from skiplatch.campaign import Campaign, InputPath
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.confirm import Confirmation, settle
from skiplatch.diagnosis.decide import Finding, find, weigh, with_third
from skiplatch.diagnosis.generic import PREFIX
from skiplatch.diagnosis.intervals import estimates
from skiplatch.diagnosis.judge import Judge, Scored, split
from skiplatch.diagnosis.material import DEFAULT, Materiality
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.search import Fit
from skiplatch.diagnosis.shrink import Gap, shrink
from skiplatch.diagnosis.simulated import Simulated, admitted_values
from skiplatch.diagnosis.structure import Structure, structures
from skiplatch.diagnosis.surplus import without_surplus
from skiplatch.diagnosis.surrogates import HALF_WAY, SWITCHES, highest
from skiplatch.diagnosis.where import Place, places
from skiplatch.simulator import Effect, effects

MOST_TOUCHES = 4_000
"""Touches that the search looks at; a larger campaign is drawn from."""
FEWEST_TOUCHES = 30
FEWEST_FALSE = 2
"""Latches without a contact that are no accident."""
MOST_LEFT = 0.35
"""Share of the structures that may be left for a finding to count as explained."""


class Verdict(StrEnum):
    """What a diagnosis comes to."""

    NO_GAP = "no_gap"
    EXPLAINED = "explained"
    PARTLY_EXPLAINED = "partly_explained"
    UNKNOWN = "unknown"


RELIABILITY = {Verdict.EXPLAINED: 0.975, Verdict.PARTLY_EXPLAINED: 0.8}
"""How often a name that nothing in the catalogue rivals was right in the withheld check: 107 of 109
where the finding explained the gap, 9 of 11 where it did so in part."""


@dataclass(frozen=True, slots=True)
class Named:
    """An effect that was found."""

    effect: Effect
    stage: str
    intervals: Mapping[str, tuple[float, float]]
    """Of 90 %, the other parameters being as open."""
    alternatives: tuple[str, ...]
    confidence: float


@dataclass(frozen=True, slots=True)
class Ranked:
    """A model that was tried: its effects, and how much better than no effect it does."""

    effects: tuple[Effect, ...]
    score_nats: float
    """Gain in log-likelihood, less what so many parameters gain by chance."""


@dataclass(frozen=True, slots=True, eq=False)
class Diagnosis:
    """All that is said of a campaign."""

    verdict: Verdict
    where: Sequence[Place]
    effects: Sequence[Named]
    gap: Mapping[str, Gap]
    ranking: Sequence[Ranked]
    """The models tried last, by falling score."""
    rivals: Sequence[Ranked]
    """What the recorded columns do not tell from the finding, which is the first; may be empty."""
    left: Sequence[Structure]
    """What no effect of the catalogue accounts for."""
    touches: int
    used: int
    """Touches that the search looked at."""
    notes: Sequence[str]
    """What the campaign does not allow to say."""
    materiality: Materiality = DEFAULT
    """From which size on a gap was one."""


def diagnose(
    campaign: Campaign,
    *,
    seed: int,
    jobs: int = 1,
    materiality: Materiality = DEFAULT,
    truth: Sequence[Effect] | None = None,
) -> Diagnosis:
    """Diagnose a recorded campaign; what is not material is no gap.

    Args:
        campaign: What was recorded.
        seed: Of the split of the touches, and of the plays.
        jobs: Processes and threads; the result does not depend on it.
        materiality: From which size on a gap is one.
        truth: The effects of a simulated campaign, for an oracle beside the shrink.
    """
    whole = Scene.of(campaign)
    scene = _drawn(whole, seed)
    executor = ProcessPoolExecutor(jobs) if jobs > 1 else nullcontext()
    with executor as pool:
        return _diagnose(scene, len(whole), pool, seed, jobs, materiality, truth)


def _drawn(scene: Scene, seed: int) -> Scene:
    """Draw touches from a large campaign, in order of time."""
    if len(scene) <= MOST_TOUCHES:
        return scene
    rows = np.random.default_rng(seed).choice(len(scene), MOST_TOUCHES, replace=False)
    return scene.select(np.sort(rows))


def _diagnose(
    scene: Scene,
    touches: int,
    pool: Executor | None,
    seed: int,
    jobs: int,
    materiality: Materiality,
    truth: Sequence[Effect] | None,
) -> Diagnosis:
    parts = split(len(scene), seed)
    judge = Judge(scene, parts, pool, materiality)
    finding, stranger = weigh(judge, find(judge))
    finding = without_surplus(judge, finding, as_effects, seed=seed, executor=pool)
    finding, stranger = with_third(judge, finding, stranger)
    finding, confirmed = settle(
        scene, parts, finding, as_effects, seed=seed, jobs=jobs, executor=pool
    )
    # The shrink is that of parameters which its touches had no part in.
    views = (scene, scene.select(parts.naming))
    named, unseeing = (pool.map if pool else map)(_named, (finding, finding), views)
    known = finding.model or finding.small
    left = structures(scene, known.fit.change(scene) if known else Change(), materiality)
    is_loose = finding.model is not None and finding.model.fit.is_loose
    verdict = _verdict(scene, named, left, stranger, confirmed, is_loose=is_loose)
    held_out = parts.shrinking if finding.model else np.full(len(scene), fill_value=True)
    return Diagnosis(
        verdict=verdict,
        where=places(scene, finding, left),
        effects=[replace(n, confidence=n.confidence * RELIABILITY[verdict]) for n in named],
        gap=shrink(
            scene, held_out, [n.effect for n in unseeing], seed=seed, jobs=jobs, truth=truth
        ),
        ranking=_ranked(finding.ranking),
        rivals=_ranked(finding.rivals),
        left=left,
        touches=touches,
        used=len(scene),
        materiality=materiality,
        notes=[*_looks(stranger), *_notes(scene, touches)],
    )


def _ranked(models: Sequence[Scored]) -> list[Ranked]:
    return [Ranked(tuple(as_effects(model.fit)), model.score) for model in models]


def _looks(family: str) -> list[str]:
    """Say what looks like something that no effect of the catalogue is."""
    stretch, _, look = family.removeprefix(PREFIX).partition(": ")
    return [f"Something that no effect explains shows in {stretch}: {look}."] if family else []


def _notes(scene: Scene, touches: int) -> list[str]:
    notes = []
    if touches < FEWEST_TOUCHES:
        notes.append(f"Only {touches} touches: no more than a gross gap could be seen.")
    for path in InputPath:
        if not (scene.touches.path == path).any():
            name = path.name.lower()
            notes.append(f"No touches on the {name} path: nothing can be said of it.")
    if not scene.has_stamps.any():
        notes.append("No time stamps: what shifts time and what shifts length look alike.")
    if len(scene) < touches:
        notes.append(f"The search looked at {len(scene)} of {touches} touches.")
    return notes


def _verdict(
    scene: Scene,
    named: Sequence[Named],
    left: Sequence[Structure],
    stranger: str,
    confirmed: Confirmation | None,
    *,
    is_loose: bool,
) -> Verdict:
    if not named:
        is_unknown = left or stranger or scene.false.sum() >= FEWEST_FALSE
        return Verdict.UNKNOWN if is_unknown else Verdict.NO_GAP
    if stranger or is_loose or (confirmed and not confirmed.holds):
        return Verdict.PARTLY_EXPLAINED
    before = structures(scene, Change())
    was = sum(abs(np.log(max(s.p_value, 1e-300))) for s in before)
    remains = sum(abs(np.log(max(s.p_value, 1e-300))) for s in left)
    return Verdict.PARTLY_EXPLAINED if remains > MOST_LEFT * was else Verdict.EXPLAINED


def _named(finding: Finding, scene: Scene) -> list[Named]:
    if finding.model is None:
        return []
    fit = finding.model.fit
    return [
        Named(
            effect=estimate.effect,
            stage=effects()[estimate.effect.id].stage,
            intervals=estimate.intervals,
            alternatives=finding.alternatives[i],
            confidence=finding.confidences[i],
        )
        for i, estimate in enumerate(estimates(scene, fit, as_effects(fit)))
    ]


def as_effects(fit: Fit) -> list[Effect]:
    """Give fitted effects as the simulator takes them."""
    found = []
    for candidate, values in zip(fit.candidates, fit.parameters, strict=True):
        parameters = dict(zip(candidate.names, map(float, values), strict=True))
        admitted = (
            admitted_values(effects()[candidate.id], values)
            if isinstance(candidate, Simulated)
            else _admitted(candidate.id, parameters)
        )
        found.append(Effect(candidate.id, admitted))
    return found


def _admitted(effect_id: str, parameters: dict[str, float]) -> dict[str, float]:
    """Bring parameters into their ranges; a negative amplitude is half a period of phase."""
    for amplitude, phase, half_turn in (
        ("amplitude_um", "azimuth_deg", 60.0),
        ("amplitude_um", "phase_deg", 180.0),
        ("amplitude2_um", "phase2_deg", 180.0),
        ("amplitude3_um", "phase3_deg", 180.0),
    ):
        if parameters.get(amplitude, 0.0) < 0.0 and phase in parameters:
            parameters[amplitude] *= -1.0
            parameters[phase] += half_turn
    admitted = {}
    for parameter in effects()[effect_id].parameters:
        value = parameters[parameter.name]
        if parameter.unit == "deg":
            value %= parameter.high
        elif parameter.name in SWITCHES:
            value = float(value > HALF_WAY)
        elif parameter.low >= 0.0:
            value = abs(value)
        high = highest(effect_id, parameter)
        admitted[parameter.name] = float(np.clip(value, parameter.low, high))
    return admitted
