"""Diagnoses put together by hand, so that what is told of them is tested apart from the search."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from skiplatch.diagnosis import Diagnosis, Named, Verdict
from skiplatch.diagnosis.plays.playing import Rig


def made(
    verdict: Verdict,
    believed: Rig,
    rig: Rig,
    named: Sequence[Named] = (),
    **others: Any,  # noqa: ANN401
) -> Diagnosis:
    """Give a diagnosis that names effects; all else is empty but for what is given by name."""
    empty = Diagnosis(
        verdict=verdict,
        where=[],
        effects=named,
        gap={},
        ranking=[],
        rivals=[],
        left=[],
        touches=400,
        used=400,
        notes=[],
        believed=believed,
        rig=rig,
    )
    return replace(empty, **others)
