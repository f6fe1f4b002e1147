"""How often names were right: the file that the diagnosis takes its confidence from.

It has a line of counts for each sealed set that was measured. A set that is measured again takes
the place of what it had before.
"""

import json
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from skiplatch.diagnosis.verdict.reliability import STANDINGS
from tests.withheld.scoring import Scored


def with_set(file: Path, results: Sequence[Scored], seed: int) -> str:
    """Give the text of a file with the counts of right and wrong names of one set more.

    Args:
        file: What was measured before, if it is there.
        results: Of the set.
        seed: Of the set.
    """
    before = json.loads(file.read_text(encoding="utf-8"))["sets"] if file.exists() else []
    others = [one for one in before if one["seed"] != seed]
    return json.dumps({"sets": [*others, _counts(results, seed)]}, indent=1) + "\n"


def _counts(results: Sequence[Scored], seed: int) -> dict[str, Any]:
    names: dict[str, Any] = {}
    for standing in STANDINGS:
        given = [r for r in results if r.found.standing == standing]
        wrong = sum(r.strays for r in given)
        total = sum(len(r.found.names) for r in given)
        names[standing] = {"right": total - wrong, "wrong": wrong}
    return {
        "version": version("skiplatch"),
        "seed": seed,
        "campaigns": len(results),
        "cases": sorted({r.label.case for r in results}),
        "names": names,
    }
