"""The rules of a verdict, each with its threshold and the reason why it is there.

A rule looks at the evidence alone: made-up evidence tries it without playing a campaign.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from skiplatch.diagnosis.plays.left import CHANCE, SIGNIFICANT, Left
from skiplatch.diagnosis.search.scored import PLAIN
from skiplatch.diagnosis.verdict.accidents import MOST_OUTLIERS, may_be_accidents
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.gap_rules import (
    LEAST_SHRINK,
    TIGHTEST,
    grows_nowhere,
    is_as_wide,
    listed,
    shrinks,
    shrinks_somewhere,
)
from skiplatch.diagnosis.verdict.mostly import MOST, mostly_left
from skiplatch.diagnosis.verdict.undoing import UNDONE
from skiplatch.tables import number

GAINED = 2.0 / 3.0
"""Share of what an effect gains on plays of itself that it has to gain on the record."""


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule.

    Attributes:
        name: For reports and tests.
        threshold: Beyond which it fails.
        reason: Where the threshold comes from: theory, a level, or tuned, and on what.
        misses: By how much the evidence misses it, in words; empty if it holds.
    """

    name: str
    threshold: float
    reason: str
    misses: Callable[[Evidence, float], str]


def _seen_enough(evidence: Evidence, threshold: float) -> str:
    if evidence.hidden <= threshold:
        return ""
    if not math.isfinite(evidence.hidden):
        return "too few touches were made to tell any noise"
    return f"a gap of {number(evidence.hidden, 2)} times the noise could have hidden"


def _few_outliers(evidence: Evidence, threshold: float) -> str:
    far, touches, told = evidence.outlying, evidence.touches, evidence.outlying_with
    if may_be_accidents(far, touches, threshold, told):
        return ""
    where = f" in {' and '.join(evidence.outlying_in)}" if evidence.outlying_in else ""
    told = told and f" and go with {told}"
    return f"{far} of {touches} touches are far off all plays{where}{told}: that is no accident"


def gains_too_little(evidence: Evidence, threshold: float = GAINED) -> list[str]:
    """Give the ids of effects that gain less than they would if they were there."""
    return [name for name, share in evidence.gains.items() if share < threshold]


def _gains_as_much(evidence: Evidence, threshold: float) -> str:
    for name in gains_too_little(evidence, threshold):
        return f"{name} gains {evidence.gains[name]:.0%} of what it does where it is there"
    return ""


def wandering(evidence: Evidence, threshold: float = PLAIN) -> list[str]:
    """Give the ids of effects that gain no more than something slow that wanders would."""
    nats = evidence.beyond_wandering.items()
    return [name for name, gained in nats if gained < threshold]


def _is_no_wandering(evidence: Evidence, threshold: float) -> str:
    return listed("anything slow does as well as", wandering(evidence, threshold))


def _leaves_nothing(evidence: Evidence, threshold: float) -> str:
    left = [one for one in evidence.after if one.z > threshold]
    return f"left: {left[0].observable} on {left[0].path}, {left[0].looks_like}" if left else ""


def _held_out(evidence: Evidence, _: float) -> str:
    return "" if evidence.is_held_out else "too few touches were held out to show that it shrinks"


def _within_limits(evidence: Evidence, _: float) -> str:
    return listed("at a limit of its range", evidence.at_limit)


def _known(evidence: Evidence, _: float) -> str:
    return listed("may be anything in its range", evidence.open)


def _is_definite(evidence: Evidence, _: float) -> str:
    return listed("most of it may be anything", evidence.vague)


def _has_form(evidence: Evidence, _: float) -> str:
    return "its form is as far off as can be" if evidence.is_loose else ""


def _undoes_nothing(evidence: Evidence, _: float) -> str:
    return listed("each undoes what another one does", evidence.undoing)


def _is_confirmed(evidence: Evidence, _: float) -> str:
    return "" if evidence.is_confirmed else "plain simulation does no better with it"


def told_of_chance(evidence: Evidence, threshold: float = CHANCE) -> list[Left]:
    """Give what tells of touches how a finding's chance fell: it is none, then."""
    return [one for one in evidence.chance if one.z > threshold]


def _chance_is_chance(evidence: Evidence, threshold: float) -> str:
    told = told_of_chance(evidence, threshold)
    return f"what it leaves to chance in {told[0].observable} {told[0].looks_like}" if told else ""


def _takes_most(evidence: Evidence, threshold: float) -> str:
    for one in mostly_left(evidence, threshold):
        return f"it leaves {one.size:.3g} {one.unit} of {one.observable}, much of what was there"
    return ""


EXPLAINS: Sequence[Rule] = (
    Rule("shrinks", 0.8, "a level: what an engineer calls explained; at its lower end", shrinks),
    Rule(
        "leaves_nothing",
        SIGNIFICANT,
        "a level: one in a million for each of some hundred looks, which are not quite normal",
        _leaves_nothing,
    ),
    Rule(
        "few_outliers",
        MOST_OUTLIERS,
        "a level: what any campaign may have of gross errors; one in a hundred has more by chance",
        _few_outliers,
    ),
    Rule("has_form", 0.0, "theory: a form that needs all slack is another one", _has_form),
    Rule("held_out", 0.0, "theory: touches that named do not judge the name", _held_out),
    Rule("known", 0.0, "theory: an interval that is all of the range tells nothing", _known),
    Rule(
        "is_confirmed", 0.0, "theory: the simulator is the judge of its own effects", _is_confirmed
    ),
)
"""What holds of a finding that explains the gap."""
NAMES: Sequence[Rule] = (
    Rule(
        "shrinks_somewhere",
        LEAST_SHRINK,
        "a level: of something that is named for certain; lower end of the interval",
        shrinks_somewhere,
    ),
    Rule(
        "grows_nowhere",
        0.0,
        "theory: a right name makes no gap larger than its own plays do",
        grows_nowhere,
    ),
    Rule(
        "is_as_wide",
        TIGHTEST,
        "a level: a right name scatters no more than what was recorded, by its form or by luck",
        is_as_wide,
    ),
    Rule(
        "gains_as_much",
        GAINED,
        "a level: an effect makes the record likelier by what it does for plays of itself",
        _gains_as_much,
    ),
    Rule(
        "is_no_wandering",
        PLAIN,
        "theory: what wanders goes with all that is slow; nats that need no check",
        _is_no_wandering,
    ),
    Rule("within_limits", 0.0, "theory: at an end of its range nothing is found", _within_limits),
    Rule("is_definite", 0.0, "theory: what may be anything says nothing", _is_definite),
    Rule(
        "undoes_nothing",
        UNDONE,
        "theory: what effects undo of each other no touch shows",
        _undoes_nothing,
    ),
    Rule(
        "chance_is_chance",
        CHANCE,
        "theory: chance goes with nothing; a level of one in thirty thousand a look",
        _chance_is_chance,
    ),
    Rule(
        "takes_most",
        MOST,
        "a level: what leaves more than half of the variance of a gap is not its cause",
        _takes_most,
    ),
)
"""What holds of a finding whose effects are named at all."""
SEES: Sequence[Rule] = (
    Rule("seen_enough", 6.0, "a level: what stands out by more is plain", _seen_enough),
)
"""What holds of touches that tell whether there is a gap."""
HAS_GAP: Sequence[Rule] = (
    Rule("believed_leaves_nothing", SIGNIFICANT, "a level, as above", _leaves_nothing),
    Rule("believed_few_outliers", MOST_OUTLIERS, "a level, as above", _few_outliers),
)
"""What holds of touches without a gap, in which nothing was found."""
