"""``skiplatch import linuxcnc`` without a program: lines that are missing, as LinuxCNC has it."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from test_import_logs import Run
from test_import_programs import row

MISSING = "no line is as the one before, though many are alike"


def steps(seed: int, step: float = 0.004) -> list[float]:
    """Where forty touches of one surface end, to a step of the encoder."""
    found = np.random.default_rng(seed).normal(-1.234, 0.002, 40)
    return [float(place) for place in np.round(found / step) * step]


def without_repeats(places: Sequence[float]) -> list[float]:
    """Leave out those that LinuxCNC writes no line for."""
    return [places[0], *(b for a, b in pairwise(places) if b != a)]


def in_turns(places: Sequence[float]) -> list[float]:
    """Touch another surface after each."""
    return [place for one in places for place in (one, round(one + 7.0, 6))]


@pytest.mark.parametrize(
    ("places", "is_said"),
    [
        (without_repeats(steps(1)), True),
        (steps(1), False),
        (in_turns(steps(1)), False),
        (steps(1, 1e-6), False),
        (without_repeats(steps(1))[:4], False),
    ],
)
def test_touches_without_a_line_are_said_to_be_missing(
    tmp_path: Path, places: list[float], *, is_said: bool
) -> None:
    (tmp_path / "p.txt").write_text("".join(row(0.0, 0.0, z) for z in places))

    run = Run(tmp_path, "linuxcnc", str(tmp_path / "p.txt"))

    assert (MISSING in run.text) is is_said
