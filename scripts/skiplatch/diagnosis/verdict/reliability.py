"""How often a name was right in the withheld check, by what the diagnosis came to."""

import json
from functools import cache
from importlib import resources

from skiplatch.diagnosis.verdict.verdict import Verdict

FILE = "reliability.json"


@cache
def _table() -> dict[str, dict[str, int]]:
    text = resources.files("skiplatch.diagnosis.verdict").joinpath(FILE).read_text(encoding="utf-8")
    names: dict[str, dict[str, int]] = json.loads(text)["names"]
    return names


def reliability(verdict: Verdict) -> float:
    """Give the share of names that were right, one more of each kind counted for want of more.

    The file is written by the withheld check, with its seed and the version that was checked, over
    campaigns with strangers, unknown data and wrong beliefs in their share.
    """
    counts = _table()[verdict]
    return (counts["right"] + 1.0) / (counts["right"] + counts["wrong"] + 2.0)
