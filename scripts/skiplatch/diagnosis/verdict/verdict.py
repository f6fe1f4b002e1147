"""What a diagnosis comes to, by the rules that its evidence fails."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.rules import EXPLAINS, HAS_GAP, NAMES, SEES, Rule


class Verdict(StrEnum):
    """What a diagnosis comes to."""

    NO_GAP = "no_gap"
    EXPLAINED = "explained"
    PARTLY_EXPLAINED = "partly_explained"
    UNKNOWN = "unknown"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Failure:
    """A rule that does not hold, and by how much."""

    rule: str
    threshold: float
    reason: str
    words: str


def failures(rules: Sequence[Rule], evidence: Evidence) -> list[Failure]:
    """Give the rules that the evidence fails."""
    found = []
    for rule in rules:
        words = rule.misses(evidence, rule.threshold)
        if words:
            found.append(Failure(rule.name, rule.threshold, rule.reason, words))
    return found


def decide(evidence: Evidence) -> tuple[Verdict, list[Failure]]:
    """Apply the rules: give the verdict, and what kept it from a better one."""
    if evidence.effects:
        unnamed = failures(NAMES, evidence)
        if unnamed:
            return Verdict.UNKNOWN, unnamed
        short = failures(EXPLAINS, evidence)
        return (Verdict.PARTLY_EXPLAINED if short else Verdict.EXPLAINED), short
    gap = failures(HAS_GAP, evidence)
    if gap:
        return Verdict.UNKNOWN, gap
    unseen = failures(SEES, evidence)
    return (Verdict.UNDECIDED if unseen else Verdict.NO_GAP), unseen


def shows_too_little(evidence: Evidence) -> bool:
    """Tell whether nothing but a lack of touches may keep effects from being named."""
    return [one.rule for one in failures(NAMES, evidence)] == [NAMES[0].name]
