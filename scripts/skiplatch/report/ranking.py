"""The models that were tried, ranked by what they gain."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from skiplatch.diagnosis import Diagnosis
from skiplatch.diagnosis.candidates.first_axis import OF_AN_AXIS
from skiplatch.diagnosis.reported.diagnosis import Ranked
from skiplatch.report.words import DIGITS
from skiplatch.simulator.effects import Effect
from skiplatch.tables import compact, whole
from skiplatch.units import PER_CENT

MOST_RANKED = 10
HOPELESS_NATS = 30.0
"""Bars of what falls short by more are cut, and drawn broken."""


@dataclass(frozen=True, slots=True)
class Rank:
    """A model that was tried.

    Attributes:
        score: Nats gained over no effect.
        behind: By how many nats it falls short of the best.
        percent: Length of the bar of that, 0 to 100.
        is_cut: Whether the bar would be longer.
        said: What the diagnosis makes of it.
    """

    name: str
    parameters: str
    score: str
    behind: str
    percent: str
    is_cut: bool
    said: str


def ranking(diagnosis: Diagnosis) -> list[Rank]:
    """Give the models that gained anything, the best first."""
    models = sorted(_gaining(diagnosis), key=lambda model: -model.score_nats)[:MOST_RANKED]
    best = max((model.score_nats for model in models), default=0.0)
    rivals = {_name(model.effects) for model in diagnosis.rivals}
    finding = {named.effect.id for named in diagnosis.effects}
    closest = set(diagnosis.closest)
    return [_rank(model, best, rivals, finding, closest) for model in models]


def cut_bars(ranks: Iterable[Rank]) -> str:
    """Say where bars are cut; nothing if none is."""
    if not any(rank.is_cut for rank in ranks):
        return ""
    return f"A bar with a broken end is cut at {HOPELESS_NATS:g} nats: its number goes on."


def no_gain(diagnosis: Diagnosis) -> str:
    """Say how many models are not in the ranking; nothing if all are."""
    gaining = len(_gaining(diagnosis))
    worse = max(gaining - MOST_RANKED, 0)
    parts = [f"{whole(worse)} more gained less"] if worse else []
    if none := len(diagnosis.ranking) - gaining:
        parts.append(f"{whole(none)} gained nothing")
    return f"Of the others tried, {' and '.join(parts)}." if parts else ""


def _gaining(diagnosis: Diagnosis) -> list[Ranked]:
    return [model for model in diagnosis.ranking if model.score_nats > 0.0]


def _rank(
    model: Ranked, best: float, rivals: set[str], finding: set[str], closest: set[str]
) -> Rank:
    name = _name(model.effects)
    ids = {effect.id for effect in model.effects}
    if ids == finding:
        said = "finding"
    elif ids == closest:
        said = "closest, but refused"
    else:
        said = "cannot be told from it" if name in rivals else ""
    behind = best - model.score_nats
    parameters = "; ".join(
        ", ".join(
            f"{key} {compact(value, DIGITS)}"
            for key, value in effect.parameters.items()
            if value or key not in OF_AN_AXIS
        )
        for effect in model.effects
    )
    return Rank(
        name,
        parameters,
        _nats(model.score_nats),
        _nats(behind),
        f"{PER_CENT * min(behind / HOPELESS_NATS, 1.0):.1f}",
        behind > HOPELESS_NATS,
        said,
    )


def _nats(nats: float) -> str:
    return f"{nats:,.1f}".replace(",", " ")


def _name(found_effects: Sequence[Effect]) -> str:
    return " + ".join(effect.id for effect in found_effects)
