"""How often names were right: the file that the diagnosis takes its confidence from."""

import json
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

from tests.withheld.scoring import Scored

NAMING = ("explained", "partly_explained")
"""Verdicts with names."""


def as_json(results: Sequence[Scored], seed: int) -> str:
    """Give the counts of right and wrong names by verdict, with the seed and the version."""
    names: dict[str, Any] = {}
    for verdict in NAMING:
        given = [r for r in results if r.found.verdict == verdict]
        wrong = sum(r.strays for r in given)
        total = sum(len(r.found.names) for r in given)
        names[verdict] = {"right": total - wrong, "wrong": wrong}
    cases = sorted({r.label.case for r in results})
    document = {
        "version": version("skiplatch"),
        "seed": seed,
        "campaigns": len(results),
        "cases": cases,
        "names": names,
    }
    return json.dumps(document, indent=1) + "\n"
