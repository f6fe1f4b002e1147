"""How often a name was right in the withheld check, by what the diagnosis came to."""

import json
from collections.abc import Collection
from functools import cache
from importlib import resources

import scipy

from skiplatch.diagnosis.verdict.verdict import Verdict

FILE = "reliability.json"
CERTAINTY = 0.9
"""With which as large a share of names is right as is said, or a larger one."""

RIGHT, WRONG = "right", "wrong"
FAR_OFF = "form_far_off"
"""What names are counted by whose effects need all the slack there is: they are seldom right."""
MANY = "explained_by_many"
"""The same of effects that explain a gap together, so many that one may be a form of the others."""
FEWEST_OF_MANY = 3
STANDINGS = (str(Verdict.EXPLAINED), str(Verdict.PARTLY_EXPLAINED), MANY, FAR_OFF)
"""What names are counted by."""
HAS_FORM = "has_form"
"""The rule that such effects fail."""


def standing(verdict: str, failed: Collection[str], effects: int) -> str:
    """Give what the names of a verdict are counted by.

    Args:
        verdict: What the diagnosis came to.
        failed: The rules that failed.
        effects: How many were found.
    """
    if HAS_FORM in failed:
        return FAR_OFF
    is_by_many = verdict == Verdict.EXPLAINED and effects >= FEWEST_OF_MANY
    return MANY if is_by_many else verdict


@cache
def _counts(standing: str) -> tuple[int, int]:
    """Give how many names were right and how many wrong, over all sets that were measured.

    The first sets were measured before forms that are far off, or many effects, were counted by
    themselves.
    """
    text = resources.files("skiplatch.diagnosis.verdict").joinpath(FILE).read_text(encoding="utf-8")
    each = [one["names"].get(standing, {RIGHT: 0, WRONG: 0}) for one in json.loads(text)["sets"]]
    return sum(one[RIGHT] for one in each), sum(one[WRONG] for one in each)


def reliability(standing: str) -> float:
    """Give the share of names that are right at least, for certain: few were counted.

    It is the lower end of what the counts leave of a share of which nothing was known (Bayes). The
    file is written by the withheld check, with seeds and the versions that were checked, over
    campaigns with strangers, unknown data and wrong beliefs in their share.
    """
    right, wrong = _counts(standing)
    return float(scipy.stats.beta.ppf(1.0 - CERTAINTY, right + 1.0, wrong + 1.0))
