"""A comparison in words, tables and JSON."""

from dataclasses import asdict
from typing import Any

import numpy as np

from skiplatch.comparison.model import CellGap, Comparison, Missed
from skiplatch.comparison.observables import ALL_OBSERVABLES, Observable
from skiplatch.statistics import Interval
from skiplatch.tables import NOTHING, beside, number, table

DIGITS = 3
LEGEND = """\
± after a difference is half of its 95 % interval. Spread is the standard deviation about the
simulated mean of the same touch. Distance is how far a touch has to be moved, on average, to turn
one distribution into the other (Wasserstein). Floor is the distance that 5 % of the simulation's
own replicates exceed. p is corrected for the number of cells."""
FREE_DATUM = """\
Where the surfaces lie is not known here. Their share of a mean is the same at all feeds, so only
how means change with the feed tells of the rig. skiplatch diagnose fits it."""
INVISIBLE = 1e-6  # µm or µs: the rounding of the computer


def as_text(comparison: Comparison) -> str:
    """Everything, for the terminal."""
    if not comparison.gaps:
        return "No path and feed with enough recorded outcomes: nothing to compare."
    parts = [_table(comparison, observable) for observable in ALL_OBSERVABLES]
    parts.append(LEGEND)
    parts.append(FREE_DATUM if comparison.is_datum_free else "")
    parts.append("\n".join(missed_line(missed) for missed in comparison.missed))
    parts.append(verdict(comparison))
    return "\n\n".join(part for part in parts if part)


def header(observable: Observable) -> tuple[str, ...]:
    """Give the head of the table of an observable."""
    return (
        "path",
        observable.feed_unit,
        "n",
        "recorded",
        "simulated",
        f"mean, {observable.unit}",
        f"mean, {observable.other_unit}",
        f"spread, {observable.unit}",
        "distance",
        "floor",
        "p",
        "verdict",
    )


def _table(comparison: Comparison, observable: Observable) -> str:
    rows = [row(gap, comparison.alpha) for gap in comparison.gaps if gap.observable is observable]
    if not rows:
        return ""
    title = f"{observable.title} in {observable.unit}: mean ± spread; recorded minus simulated"
    return f"{title}\n{table(header(observable), rows)}"


def row(gap: CellGap, alpha: float) -> tuple[str, ...]:
    """Give the row of a cell; it differs if chance gives as much less often than `alpha`."""
    return (
        gap.path.name.lower(),
        f"{gap.feed_mm_min:g}" if gap.is_feed_known else NOTHING,
        str(gap.touches),
        _with_spread(gap.recorded_mean, gap.recorded_spread),
        _with_spread(gap.simulated_mean, gap.simulated_spread),
        _interval(gap.mean_difference),
        _interval(_in_other_unit(gap)).split(" ")[0] if gap.is_feed_known else NOTHING,
        _interval(gap.spread_difference),
        _number(gap.distance),
        _number(gap.noise_floor),
        f"{gap.p_value:.3f}",
        "differs" if gap.p_value <= alpha else "",
    )


def _number(value: float) -> str:
    return number(value, DIGITS) if abs(value) > INVISIBLE else "0"


def _with_spread(mean: float, spread: float) -> str:
    """Give both, with two digits of the spread."""
    if spread <= INVISIBLE:
        return f"{_number(mean)} ± 0"
    return f"{beside(mean, spread)} ± {beside(spread, spread)}"


def _interval(interval: Interval) -> str:
    """Give the value with its sign and half the width of its interval."""
    text = _with_spread(abs(interval.value), (interval.high - interval.low) / 2.0)
    is_zero = not text.split(" ")[0].strip("0.")
    return text if is_zero else ("−" if interval.value < 0.0 else "+") + text


def _in_other_unit(gap: CellGap) -> Interval:
    """Give the difference of the means as a time, where it is a length, and the other way round."""
    speed = gap.feed_mm_min * gap.observable.units_per_us
    return gap.mean_difference.scaled(speed if gap.observable.unit == "µs" else 1.0 / speed)


def missed_line(missed: Missed) -> str:
    """Say how many touches of a path were missed."""
    share = missed.share
    return (
        f"{missed.path.name.lower()}: {missed.missed} of {missed.touches} touches missed "
        f"({100 * share.low:.2f} … {100 * share.high:.2f} %), none in the simulation"
    )


def verdict(comparison: Comparison) -> str:
    """Say whether they differ, and where the most."""
    tested = f"{len(comparison.gaps)} cells, {comparison.replicates} replicates of the simulation"
    rate = f"false-alarm rate {comparison.alpha:.1%} over all cells together"
    differing = comparison.differing
    if not differing:
        return f"Distributions agree within the noise floor ({tested}; {rate})."
    worst = max(
        differing, key=lambda gap: gap.distance / gap.noise_floor if gap.noise_floor else np.inf
    )
    return (
        f"Distributions differ in {len(differing)} of {tested}; {rate}.\n"
        f"Farthest beyond the noise: {worst.observable.title}, {worst.path.name.lower()} path, "
        f"{worst.feed_words}: distance {number(worst.distance, 3)} "
        f"{worst.observable.unit}, noise floor {number(worst.noise_floor, 3)} "
        f"{worst.observable.unit}."
    )


def as_json(comparison: Comparison) -> dict[str, Any]:
    """Everything, in plain types."""
    return {
        "format": "skiplatch-comparison/1",
        "agrees": comparison.agrees,
        "is_datum_free": comparison.is_datum_free,
        "alpha": comparison.alpha,
        "replicates": comparison.replicates,
        "cells": [_cell_json(gap, comparison.alpha) for gap in comparison.gaps],
        "missed": [_missed_json(missed) for missed in comparison.missed],
    }


def _cell_json(gap: CellGap, alpha: float) -> dict[str, Any]:
    values = asdict(gap) | {
        "observable": gap.observable.name,
        "unit": gap.observable.unit,
        "path": gap.path.name.lower(),
        "differs": gap.p_value <= alpha,
    }
    del values["is_feed_known"]
    known = gap.is_feed_known
    values["feed_unit"] = gap.observable.feed_unit
    values["feed_mm_min"] = gap.feed_mm_min if known else None
    values["mean_difference_at_feed"] = _in_other_unit(gap).value if known else None
    values["mean_difference_at_feed_unit"] = gap.observable.other_unit
    return values


def _missed_json(missed: Missed) -> dict[str, Any]:
    return asdict(missed) | {"path": missed.path.name.lower()}
