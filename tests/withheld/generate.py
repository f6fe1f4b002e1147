"""Makes the campaigns of the withheld check.

``python -m tests.withheld.generate OUT --seed 1 --count 60``, from the root of the tree.

OUT/campaigns/NAME is what the diagnosis gets; OUT/sealed/NAME is what only the scoring may open.
The same seed, count and choice of cases give the same bytes.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from skiplatch.progress import shown
from tests.withheld.cases import draw_campaign
from tests.withheld.conditions import Recording
from tests.withheld.orders import Case, is_for, orders
from tests.withheld.writing import is_written, write

FEWEST, MOST = 200, 2000  # touches of a campaign


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
    parser.add_argument("--cases", type=_cases, help="all that there are for the kinds if none")
    parser.add_argument("--touches", type=int, nargs=2, default=(FEWEST, MOST))
    options = parser.parse_args(arguments)
    plan = np.random.default_rng(np.random.SeedSequence(options.seed, spawn_key=(0,)))
    cases = options.cases or [case for case in Case if is_for(case, options.kinds)]
    planned = orders(plan, options.count, options.kinds, cases)
    for i, order in enumerate(shown(planned, options.count, "campaigns")):
        if not is_written(options.out, f"g{i:04d}"):
            rng = np.random.default_rng(np.random.SeedSequence(options.seed, spawn_key=(1, i)))
            write(options.out, f"g{i:04d}", draw_campaign(rng, order, tuple(options.touches)))


if __name__ == "__main__":
    main()
