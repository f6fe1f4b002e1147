"""The rules of a verdict, each with its threshold and the reason why it is there.

A rule looks at the evidence alone: made-up evidence tries it without playing a campaign.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from skiplatch.diagnosis.plays.left import CHANCE, SIGNIFICANT, Left
from skiplatch.diagnosis.verdict.accidents import MOST_OUTLIERS, may_be_accidents
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.mostly import MOST, mostly_left
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.diagnosis.verdict.undoing import UNDONE
from skiplatch.tables import number

LIKELIER = 7.0
"""Nats by which touches held out are likelier under a finding than without it from which on that is
no luck, whatever the touches are: one in a thousand (Wasserman, Ramdas and Balakrishnan, PNAS 117
(2020) 16880, eq. 6)."""
LEAST_SHRINK = 0.2  # of a gap that shrinks for certain
GAINED = 2.0 / 3.0
"""Share of what an effect gains on plays of itself that it has to gain on the record."""
TIGHTEST = 0.5
"""How far the record may be off plays of a finding, over how far these are off each other."""
UNMOVED = 0.1
"""Share of a gap by which scores of plays differ where effects leave it as it is."""


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


def _listed(words: str, names: Sequence[str]) -> str:
    """Say what was found of some names; nothing where there are none."""
    return f"{words}: {', '.join(names)}" if names else ""


def _seen_enough(evidence: Evidence, threshold: float) -> str:
    if evidence.hidden <= threshold:
        return ""
    if not math.isfinite(evidence.hidden):
        return "too few touches were made to tell any noise"
    return f"a gap of {number(evidence.hidden, 2)} times the noise could have hidden"


def _few_false(evidence: Evidence, threshold: float) -> str:
    return f"{evidence.false} latches without a contact" if evidence.false > threshold else ""


def _few_outliers(evidence: Evidence, threshold: float) -> str:
    far, touches, told = evidence.outlying, evidence.touches, evidence.outlying_with
    if may_be_accidents(far, touches, threshold, told):
        return ""
    where = f" in {' and '.join(evidence.outlying_in)}" if evidence.outlying_in else ""
    told = told and f" and go with {told}"
    return f"{far} of {touches} touches are far off all plays{where}{told}: that is no accident"


def _clear(gaps: Mapping[str, Gap]) -> Mapping[str, Gap]:
    return {name: gap for name, gap in gaps.items() if gap.is_clear}


def _seen_where(evidence: Evidence, shows: Callable[[Gap], bool]) -> list[str]:
    """Name the observables whose clear gap shows something, held out or on all touches."""
    each = (evidence.gaps, evidence.everywhere)
    return [*{name: None for gaps in each for name, gap in _clear(gaps).items() if shows(gap)}]


def _is_left_alone(gap: Gap) -> bool:
    """Tell whether effects leave a gap as it is that may be luck: of several one often is."""
    moved = abs(gap.after - gap.before)
    return gap.may_be_luck and moved <= UNMOVED * (gap.before - gap.noise_floor)


def _shrinks(evidence: Evidence, threshold: float) -> str:
    clear = {n: g for n, g in _clear(evidence.gaps).items() if not _is_left_alone(g)}
    small = [
        f"{n} by {g.shrink.low:.0%}" if g.shrink.low > 0.0 else f"{n} not at all"
        for n, g in clear.items()
        if g.shrink.low < threshold
    ]
    if not clear and not _is_lost_no_more(evidence, threshold):
        return "no gap is clear enough to tell that all of it is gone"
    return _listed("the gap shrinks for certain only", small)


def _shrinks_somewhere(evidence: Evidence, threshold: float) -> str:
    is_likelier = _may_shrink_unseen(evidence, threshold) and evidence.nats > LIKELIER
    if shrinks_for_certain(evidence, threshold) or is_likelier:
        return ""
    return f"no gap {'shrinks for certain' if _clear(evidence.gaps) else 'is clear'}"


def _may_shrink_unseen(evidence: Evidence, threshold: float) -> bool:
    """Tell whether a gap may shrink that its score forgives: it does so of what comes by chance.

    One that stays, for certain, speaks against that; one that is larger by luck says nothing.
    Likelier by all the slack there is, is likelier by the slack, which is no effect.
    """
    if evidence.is_loose:
        return False
    clear = _clear(evidence.gaps).values()
    stay = (gap.grows or 0.0 <= gap.shrink.high <= threshold for gap in clear)
    return evidence.is_chancy and (not clear or not all(stay))


def shrinks_for_certain(evidence: Evidence, threshold: float = LEAST_SHRINK) -> bool:
    """Tell whether some gap shrinks by such a share, or in touches that were missed."""
    is_clear = any(gap.shrink.low > threshold for gap in _clear(evidence.gaps).values())
    return is_clear or _is_lost_no_more(evidence, threshold)


def _is_lost_no_more(evidence: Evidence, threshold: float) -> bool:
    """Tell whether more than such a share of a gap in touches that were missed is gone."""
    return any(_share_gone(evidence, one) > threshold for one in evidence.before if one.is_share)


def _share_gone(evidence: Evidence, was: Left) -> float:
    """Give how much for certain is gone of a gap in a share of touches, as of those missed."""
    unseen = CHANCE * was.relative / was.z
    now = max((one.relative for one in evidence.after if one.is_of(was)), default=unseen)
    return 1.0 - now / was.relative


def growing(evidence: Evidence) -> list[str]:
    """Name the observables whose gap is larger beside a finding than beside the beliefs."""
    return _seen_where(evidence, lambda gap: gap.grows)


def _grows_nowhere(evidence: Evidence, _: float) -> str:
    return _listed("the gap grows", growing(evidence))


def too_wide(evidence: Evidence, threshold: float = TIGHTEST) -> list[str]:
    """Name the observables that scatter far less in the record than in plays of a finding."""
    return _seen_where(evidence, lambda gap: gap.tightness < threshold)


def _is_as_wide(evidence: Evidence, threshold: float) -> str:
    wide = too_wide(evidence, threshold)
    return _listed("what was recorded scatters far less than it plays", wide)


def gains_too_little(evidence: Evidence, threshold: float = GAINED) -> list[str]:
    """Give the ids of effects that gain less than they would if they were there."""
    return [name for name, share in evidence.gains.items() if share < threshold]


def _gains_as_much(evidence: Evidence, threshold: float) -> str:
    for name in gains_too_little(evidence, threshold):
        return f"{name} gains {evidence.gains[name]:.0%} of what it does where it is there"
    return ""


def _leaves_nothing(evidence: Evidence, threshold: float) -> str:
    left = [one for one in evidence.after if one.z > threshold]
    return f"left: {left[0].observable} on {left[0].path}, {left[0].looks_like}" if left else ""


def _held_out(evidence: Evidence, _: float) -> str:
    return "" if evidence.is_held_out else "too few touches were held out to show that it shrinks"


def _within_limits(evidence: Evidence, _: float) -> str:
    return _listed("at a limit of its range", evidence.at_limit)


def _known(evidence: Evidence, _: float) -> str:
    return _listed("may be anything in its range", evidence.open)


def _is_definite(evidence: Evidence, _: float) -> str:
    return _listed("most of it may be anything", evidence.vague)


def _has_form(evidence: Evidence, _: float) -> str:
    return "its form is as far off as can be" if evidence.is_loose else ""


def _undoes_nothing(evidence: Evidence, _: float) -> str:
    return _listed("each undoes what another one does", evidence.undoing)


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
    Rule("shrinks", 0.8, "a level: what an engineer calls explained; at its lower end", _shrinks),
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
        _shrinks_somewhere,
    ),
    Rule(
        "grows_nowhere",
        0.0,
        "theory: a right name makes no gap larger than its own plays do",
        _grows_nowhere,
    ),
    Rule(
        "is_as_wide",
        TIGHTEST,
        "a level: a right name scatters no more than what was recorded, by its form or by luck",
        _is_as_wide,
    ),
    Rule(
        "gains_as_much",
        GAINED,
        "a level: an effect makes the record likelier by what it does for plays of itself",
        _gains_as_much,
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
    Rule("few_false", 1.0, "theory: two latches without a contact are no accident", _few_false),
    Rule("believed_leaves_nothing", SIGNIFICANT, "a level, as above", _leaves_nothing),
    Rule("believed_few_outliers", MOST_OUTLIERS, "a level, as above", _few_outliers),
)
"""What holds of touches without a gap, in which nothing was found."""
