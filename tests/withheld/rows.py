"""A line of the table of goals: a share with its interval, or a figure, beside what is wanted."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from skiplatch.statistics import Interval, proportion
from skiplatch.tables import number, table
from tests.withheld.scoring import Scored, calibration_error

Which = Callable[[Scored], bool]


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the table.

    Attributes:
        title: What is measured.
        value: The figure; NaN if there was nothing to measure it on.
        interval: Of 95 % (Clopper and Pearson), or None where there is none to give.
        count: Of campaigns, or of names.
        goal: What is wanted, in words.
        met: Whether it is met, or None if there was nothing to measure it on.
        is_share: Shown in percent.
    """

    title: str
    value: float
    interval: Interval | None
    count: int
    goal: str
    met: bool | None
    is_share: bool = True

    def as_json(self) -> dict[str, Any]:
        """Give it in plain types."""
        ends = None if self.interval is None else [self.interval.low, self.interval.high]
        return {
            "title": self.title.strip(),
            "value": None if np.isnan(self.value) else self.value,
            "interval": ends,
            "of": self.count,
            "goal": self.goal,
            "met": self.met,
        }


def at_least(title: str, goal: float | None, of: Sequence[Scored], hit: Which) -> Row:
    """Give the share of campaigns that are hit, which should be large."""
    return share(title, sum(map(hit, of)), len(of), goal, sense=1)


def at_most(title: str, goal: float | None, of: Sequence[Scored], hit: Which) -> Row:
    """Give the share of campaigns that are hit, which should be small."""
    return share(title, sum(map(hit, of)), len(of), goal, sense=-1)


def share(title: str, hits: int, count: int, goal: float | None, sense: int) -> Row:
    """Give a share; a positive sense wants it to be as large as the goal or larger."""
    words = "" if goal is None else f"{'≥' if sense > 0 else '≤'} {100 * goal:.3g} %"
    if not count:
        return Row(title, float("nan"), None, 0, words, None)
    measured = proportion(hits, count)
    met = None if goal is None else sense * measured.value >= sense * goal
    return Row(title, measured.value, measured, count, words, met)


def quantile(at: float) -> Callable[[Sequence[float]], float]:
    """Give the function that takes a quantile."""
    return lambda values: float(np.quantile(values, at))


def figure(
    title: str,
    values: Sequence[float],
    statistic: Callable[[Sequence[float]], float],
    goal: float | None = None,
) -> Row:
    """Give a figure of many; a size of 1 is a goal to be kept, a larger share one to be reached."""
    least = goal is not None and goal < 1.0
    words = "" if goal is None else f"{'≥' if least else '≤'} {goal:.3g}"
    if not values:
        return Row(title, float("nan"), None, 0, words, None, is_share=False)
    value = float(statistic(values))
    met = None if goal is None else (value >= goal if least else value <= goal)
    return Row(title, value, None, len(values), words, met, is_share=False)


def calibration(title: str, results: Sequence[Scored], goal: float | None) -> Row:
    """Give the calibration error of all that was named."""
    error, names = calibration_error(results)
    met = None if goal is None or not names else error <= goal
    words = "" if goal is None else f"≤ {goal:.3g}"
    return Row(title, error, None, names, words, met, is_share=False)


def as_text(measured: Sequence[Row]) -> str:
    """Lay out the table."""
    lines = [
        (row.title, _value(row), _interval(row), str(row.count), row.goal, _word(row.met))
        for row in measured
    ]
    return table(("", "measured", "95 % interval", "of", "goal", ""), lines)


def _value(row: Row) -> str:
    if np.isnan(row.value):
        return "—"
    return f"{100 * row.value:.1f} %" if row.is_share else number(row.value, 3)


def _interval(row: Row) -> str:
    if row.interval is None:
        return ""
    return f"{100 * row.interval.low:.1f} … {100 * row.interval.high:.1f} %"


def _word(met: bool | None) -> str:
    return {None: "", True: "met", False: "missed"}[met]
