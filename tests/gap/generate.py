"""Makes the campaigns of the withheld check.

``python -m tests.gap.generate OUT --seed 1 --count 60``, from the root of the tree.

OUT/campaigns/NAME is what the diagnosis gets; OUT/sealed/NAME is what only the scoring may open.
The same seed, count and choice of cases give the same bytes.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from skiplatch.progress import shown
from tests.gap.cases import Case, Order, draw_campaign
from tests.gap.conditions import Recording
from tests.gap.effects import EFFECTS
from tests.gap.parts import recordings_for
from tests.gap.strangers import DULL, STRANGERS
from tests.gap.writing import is_written, write

FEWEST, MOST = 200, 2000  # touches of a campaign

TABLES: dict[Case, Sequence[str]] = {
    Case.SINGLE: tuple(EFFECTS),
    Case.TWO: tuple(EFFECTS),
    Case.NONE: (),
    Case.STRANGER: tuple(STRANGERS),
    Case.DULL: tuple(DULL),
    Case.STRANGERS: (),
}


def orders(
    rng: np.random.Generator, count: int, kinds: Sequence[Recording], cases: Sequence[Case]
) -> list[Order]:
    """Plan the campaigns: the cases in turns, their effects in turns, all of it shuffled."""
    planned: list[Order] = []
    turns = {case: _turns(rng, case, kinds) for case in cases}
    for i in range(count):
        case = cases[i % len(cases)]
        first = turns[case][i // len(cases) % len(turns[case])]
        planned.append(_order(rng, case, first, kinds))
    return [planned[i] for i in rng.permutation(count)]


def _turns(rng: np.random.Generator, case: Case, kinds: Sequence[Recording]) -> list[list[str]]:
    if not TABLES[case]:
        return [[]]
    possible = [[part] for part in TABLES[case] if set(recordings_for(part)) & set(kinds)]
    if not possible:
        raise SystemExit(f"no {case} for {', '.join(kinds)}")
    return [possible[i] for i in rng.permutation(len(possible))]


def _order(
    rng: np.random.Generator, case: Case, parts: list[str], kinds: Sequence[Recording]
) -> Order:
    usable = [kind for kind in kinds if all(kind in recordings_for(part) for part in parts)]
    recording = usable[rng.integers(len(usable))]
    if case is Case.TWO:
        others = [i for i in EFFECTS if i not in parts and recording in recordings_for(i)]
        second = others[rng.integers(len(others))]
        parts = [i for i in EFFECTS if i in {*parts, second}]
    return Order(case, recording, parts)


def _recordings(text: str) -> list[Recording]:
    return [Recording(word) for word in text.split(",")]


def _cases(text: str) -> list[Case]:
    return [Case(word) for word in text.split(",")]


def main(arguments: Sequence[str] | None = None) -> None:
    """Read the command line and make the campaigns."""
    parser = argparse.ArgumentParser(
        prog="generate", description="Make the campaigns of the withheld check."
    )
    parser.add_argument("out", type=Path, help="folder to write to")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, required=True, help="number of campaigns")
    parser.add_argument("--kinds", type=_recordings, default=list(Recording))
    parser.add_argument("--cases", type=_cases, default=list(Case))
    parser.add_argument("--touches", type=int, nargs=2, default=(FEWEST, MOST))
    options = parser.parse_args(arguments)
    plan = np.random.default_rng(np.random.SeedSequence(options.seed, spawn_key=(0,)))
    planned = orders(plan, options.count, options.kinds, options.cases)
    for i, order in enumerate(shown(planned, options.count, "campaigns")):
        if not is_written(options.out, f"g{i:04d}"):
            rng = np.random.default_rng(np.random.SeedSequence(options.seed, spawn_key=(1, i)))
            write(options.out, f"g{i:04d}", draw_campaign(rng, order, tuple(options.touches)))


if __name__ == "__main__":
    main()
