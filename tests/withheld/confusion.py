"""What was taken for what, and how well each effect is known by its size."""

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from skiplatch.tables import table
from tests.withheld.effects import EFFECTS
from tests.withheld.nats import FAINT, PLAIN
from tests.withheld.scoring import Scored

NOTHING = "(none)"
UNKNOWN = "(unknown)"
SIZES = (0.2, 1.0, 3.0, 10.0, np.inf)
"""Ends of the classes of sizes, in units of the spread that the engineer expects."""


def matrix(results: Sequence[Scored]) -> Counter[tuple[str, str]]:
    """Count truth × name over the campaigns of at most one effect.

    Where nothing was named that is NOTHING, or UNKNOWN if the verdict was so; of several names the
    true one counts, else the first.
    """
    counts: Counter[tuple[str, str]] = Counter()
    for scored in results:
        if len(scored.truth) <= 1:
            counts[_truth(scored), _named(scored)] += 1
    return counts


def _truth(scored: Scored) -> str:
    return next(iter(scored.truth), f"({scored.label.case})")


def _named(scored: Scored) -> str:
    ids = [name.id for name in scored.found.names]
    if not ids:
        return UNKNOWN if scored.found.verdict == "unknown" else NOTHING
    return next((one for one in ids if one in scored.truth), ids[0])


def matrix_text(results: Sequence[Scored]) -> str:
    """Show a line for every truth: how often it was hit, and what it was taken for."""
    counts = matrix(results)
    lines = []
    for truth in _in_order({truth for truth, _ in counts}):
        named = {name: n for (t, name), n in counts.items() if t == truth}
        right = UNKNOWN if truth in {"(stranger)", "(strangers)"} else NOTHING
        right = truth if truth in EFFECTS else right
        others = sorted(((n, name) for name, n in named.items() if name != right), reverse=True)
        words = ", ".join(f"{name} {n}" for n, name in others)
        lines.append((truth, f"{named.get(right, 0)}/{sum(named.values())}", words))
    return "\n".join(f"{truth:26}{share:>8}  {words}".rstrip() for truth, share, words in lines)


def _in_order(truths: set[str]) -> list[str]:
    return [*(effect for effect in EFFECTS if effect in truths), *sorted(truths - EFFECTS.keys())]


def by_effect_text(results: Sequence[Scored]) -> str:
    """Show the share of right names or groups of single effects, by effect and plainness."""
    singles = [r for r in results if r.label.case == "single"]
    header = ("effect", f"> {PLAIN:.0f} nats", f"{FAINT:.0f}–{PLAIN:.0f}", f"< {FAINT:.0f}")
    lines = []
    for effect in _in_order({e for r in singles for e in r.truth}):
        here = [r for r in singles if effect in r.truth]
        parts = (
            [r for r in here if r.nats > PLAIN],
            [r for r in here if FAINT <= r.nats <= PLAIN],
            [r for r in here if r.nats < FAINT],
        )
        lines.append((effect, *map(_share, parts)))
    return table(header, lines)


def by_size_text(results: Sequence[Scored]) -> str:
    """Show the same by size in units of the expected spread, and by kind of recording."""
    singles = [r for r in results if r.label.case == "single"]
    kinds = ("bench", "stamped", "position")
    lines = []
    for low, high in pairwise(SIZES):
        here = [r for r in singles if low <= r.label.visible[next(iter(r.truth))] < high]
        shares = (_share([r for r in here if r.label.recording == kind]) for kind in kinds)
        lines.append((f"{low:g} … {high:g}" if high < np.inf else f"> {low:g}", *shares))
    return table(("size", *kinds), lines)


def _share(results: Sequence[Scored]) -> str:
    right = sum(r.names_in_group for r in results)
    return f"{right}/{len(results)}" if results else ""
