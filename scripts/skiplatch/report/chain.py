"""The chain of stages as the page draws it, with what was found marked."""

from collections.abc import Sequence
from dataclasses import dataclass

from skiplatch.campaign import Kind
from skiplatch.campaign.kind import NOT_ON_A_BENCH
from skiplatch.diagnosis import Diagnosis
from skiplatch.simulator.effects import effects

STAGES = {
    "motion": "the axis meets the surface",
    "probe": "trips after its pretravel",
    "link": "carries the trigger",
    "input": "filters the edge",
    "latch": "skip: interrupt and stamp",
    "scan": "PLC: the task polls",
    "position": "the axis is read",
    "report": "the record arrives",
}
PARALLEL = ("latch", "scan")


@dataclass(frozen=True, slots=True)
class Link:
    """One stage of the chain.

    Attributes:
        mark: ``found``, ``possible``, ``left``, ``absent`` or nothing; names a style of the page.
        said: What the mark says in words.
    """

    stage: str
    does: str
    mark: str
    said: str


def steps(diagnosis: Diagnosis, kind: Kind) -> list[list[Link]]:
    """Give the chain in its order; the stages in which the paths differ stand in one step."""
    links = [_link(stage, diagnosis, kind) for stage in STAGES]
    before = [[link] for link in links if link.stage not in PARALLEL]
    at = list(STAGES).index(PARALLEL[0])
    return [*before[:at], [link for link in links if link.stage in PARALLEL], *before[at:]]


def described(chain: Sequence[Sequence[Link]]) -> str:
    """Say the chain in one paragraph, for those who cannot see it."""
    links = [link for step in chain for link in step]
    marked = [f"{link.stage}: {link.said}" for link in links if link.said]
    order = ", ".join(" or ".join(link.stage for link in step) for step in chain)
    return f"The chain is {order}. " + (f"Marked: {'; '.join(marked)}." if marked else "No mark.")


def _link(stage: str, diagnosis: Diagnosis, kind: Kind) -> Link:
    does = STAGES[stage]
    if found := [named.effect.id for named in diagnosis.effects if named.stage == stage]:
        return Link(stage, does, "found", " and ".join(found))
    if possible := [other for other in _alternatives(diagnosis) if effects()[other].stage == stage]:
        return Link(stage, does, "possible", f"or {', '.join(possible)}")
    if not diagnosis.effects and stage in {place.stage for place in diagnosis.where}:
        return Link(stage, does, "left", "the gap shows up to here")
    if kind == Kind.BENCH and stage in NOT_ON_A_BENCH:
        return Link(stage, does, "absent", "not on a bench")
    return Link(stage, does, "", "")


def _alternatives(diagnosis: Diagnosis) -> list[str]:
    """Give what stands instead of an effect that was found; a pair is one of several ids."""
    texts = [text for named in diagnosis.effects for text in named.alternatives]
    return [effect_id for effect_id in effects() if any(effect_id in text for text in texts)]
