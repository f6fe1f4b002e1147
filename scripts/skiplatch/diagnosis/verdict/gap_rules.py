"""What rules of a verdict ask of gaps: whether they shrink, grow, or are scattered over."""

from collections.abc import Callable, Mapping, Sequence

from skiplatch.diagnosis.plays.left import CHANCE, Left
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.shrink import Gap

LIKELIER = 7.0
"""Nats by which touches held out are likelier under a finding than without it from which on that is
no luck, whatever the touches are: one in a thousand (Wasserman, Ramdas and Balakrishnan, PNAS 117
(2020) 16880, eq. 6)."""
LEAST_SHRINK = 0.2  # of a gap that shrinks for certain
TIGHTEST = 0.5
"""How far the record may be off plays of a finding, over how far these are off each other."""
UNMOVED = 0.1
"""Share of a gap by which scores of plays differ where effects leave it as it is."""


def listed(words: str, names: Sequence[str]) -> str:
    """Say what was found of some names; nothing where there are none."""
    return f"{words}: {', '.join(names)}" if names else ""


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


def shrinks(evidence: Evidence, threshold: float) -> str:
    """Say which gaps do not shrink by such a share for certain; empty if all do."""
    clear = {n: g for n, g in _clear(evidence.gaps).items() if not _is_left_alone(g)}
    small = [
        f"{n} by {g.shrink.low:.0%}" if g.shrink.low > 0.0 else f"{n} not at all"
        for n, g in clear.items()
        if g.shrink.low < threshold
    ]
    if not clear and not _is_lost_no_more(evidence, threshold):
        return "no gap is clear enough to tell that all of it is gone"
    return listed("the gap shrinks for certain only", small)


def shrinks_somewhere(evidence: Evidence, threshold: float) -> str:
    """Say that no gap shrinks by such a share for certain; empty if one does."""
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


def grows_nowhere(evidence: Evidence, _: float) -> str:
    """Say which gaps grow; empty if none does."""
    return listed("the gap grows", growing(evidence))


def too_wide(evidence: Evidence, threshold: float = TIGHTEST) -> list[str]:
    """Name the observables that scatter far less in the record than in plays of a finding."""
    return _seen_where(evidence, lambda gap: gap.tightness < threshold)


def is_as_wide(evidence: Evidence, threshold: float) -> str:
    """Say what scatters far less in the record than in plays; empty if nothing does."""
    wide = too_wide(evidence, threshold)
    return listed("what was recorded scatters far less than it plays", wide)
