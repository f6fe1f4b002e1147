"""How often a name was right in the withheld check, by what the diagnosis came to."""

import json
from functools import cache
from importlib import resources

from scipy import stats

from skiplatch.diagnosis.verdict.verdict import Verdict

FILE = "reliability.json"
CERTAINTY = 0.9
"""With which as large a share of names is right as is said, or a larger one."""

RIGHT, WRONG = "right", "wrong"


@cache
def _counts(verdict: Verdict) -> tuple[int, int]:
    """Give how many names were right and how many wrong, over all sets that were measured."""
    text = resources.files("skiplatch.diagnosis.verdict").joinpath(FILE).read_text(encoding="utf-8")
    names = [one["names"][verdict] for one in json.loads(text)["sets"]]
    return sum(one[RIGHT] for one in names), sum(one[WRONG] for one in names)


def reliability(verdict: Verdict) -> float:
    """Give the share of names that are right at least, for certain: few were counted.

    It is the lower end of what the counts leave of a share of which nothing was known (Bayes). The
    file is written by the withheld check, with seeds and the versions that were checked, over
    campaigns with strangers, unknown data and wrong beliefs in their share.
    """
    right, wrong = _counts(verdict)
    return float(stats.beta.ppf(1.0 - CERTAINTY, right + 1.0, wrong + 1.0))
