"""An experiment for the terminal and in JSON."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from skiplatch.campaign import COLUMNS
from skiplatch.diagnosis.experiment.conditions import rests_s
from skiplatch.diagnosis.experiment.experiment import Experiment
from skiplatch.tables import compact, prose, table

SHOWN = 10
DECIMALS = 3
REST = "rest_s"
VARIED = (
    "path",
    "axis",
    "sign",
    "alpha_deg",
    "beta_deg",
    "feed_mm_min",
    "approach_mm",
    "position_mm",
    "rotary_deg",
    "session",
)


def experiment_text(experiment: Experiment) -> str:
    """What to do and why, with the touches that are to be made most often."""
    words = prose(experiment.words)
    return "\n".join([words, table(*touches_table(experiment)), *remarks(experiment)])


def touches_table(experiment: Experiment) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
    """Give header and rows of the touches made most often, without what is empty in all."""
    names = (*VARIED, REST)
    header = (*names, "touches")
    rows = [
        (*map(_shown, names, cells), str(count)) for cells, count in _distinct(experiment)[:SHOWN]
    ]
    kept = [i for i in range(len(header)) if not rows or any(row[i] for row in rows)]
    return [header[i] for i in kept], [[row[i] for i in kept] for row in rows]


def remarks(experiment: Experiment) -> list[str]:
    """Say what is not in the table, and what is expected of all touches."""
    more = len(_distinct(experiment)) - SHOWN
    said = [f"… and {more} other conditions"] if more > 0 else []
    if experiment.touches_needed is not None:
        said.append(
            f"Expected: {compact(experiment.expected_bits, 3)} bits in all touches, "
            f"{compact(experiment.bits_per_touch, 2)} bits in one."
        )
    return said


def experiment_json(experiment: Experiment) -> dict[str, Any]:
    """The same in plain types; ``touches`` are distinct conditions, each with its ``count``."""
    return {
        "why": experiment.words,
        "record": experiment.record,
        "touches": [
            {**_plain(dict(zip((*VARIED, REST), cells, strict=True))), "count": count}
            for cells, count in _distinct(experiment)
        ],
        "expected_bits": experiment.expected_bits,
        "bits_per_touch": experiment.bits_per_touch,
        "touches_needed": experiment.touches_needed,
        "separates": [list(group) for group in experiment.separates],
    }


def _distinct(experiment: Experiment) -> list[tuple[tuple[str, ...], int]]:
    """Give the cells of the distinct conditions, and how often each is to be made.

    What was invented is empty, and with it the rest, which is what motion leaves of the time.
    """
    touches, empty = experiment.touches, [""] * len(experiment.touches)
    columns = touches.columns()
    columns["session"] = np.array(touches.session_names, dtype=object)[touches.session]
    cells = [
        empty if name in experiment.invented else COLUMNS[name].format(columns[name])
        for name in VARIED
    ]
    rests = empty if experiment.invented else [f"{rest:.1f}" for rest in rests_s(touches)]
    return Counter(zip(*cells, rests, strict=True)).most_common()


def _shown(column: str, cell: str) -> str:
    """Give a number of many decimals to a thousandth; what is made of it has all of them.

    A session is named as it is, even if by a number.
    """
    is_short = len(cell.partition(".")[2]) <= DECIMALS
    return cell if is_short or column == "session" else f"{float(cell):.{DECIMALS}f}"


def _plain(cells: dict[str, str]) -> dict[str, str | float | None]:
    """Turn cells into numbers where they are some, and into None where they are empty."""
    texts = ("path", "axis", "session")
    return {k: (v if k in texts else float(v)) if v else None for k, v in cells.items()}
