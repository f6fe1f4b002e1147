"""The table of goals: what is measured, of which campaigns, and what is wanted."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from skiplatch.statistics import Interval, proportion
from skiplatch.tables import number, table
from tests.gap.nats import FAINT, PLAIN
from tests.gap.scoring import FAILED, Scored, calibration_error

MACHINE = ("stamped", "position")
SHOWN_SIZE = 1.0
"""Of each of two effects, in units of the expected spread, to count as well above the noise."""

Which = Callable[[Scored], bool]
Values = Callable[[Sequence[Scored]], Sequence[float]]


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the table.

    Attributes:
        title: What is measured.
        value: The figure; NaN if there was nothing to measure it on.
        interval: Of 95 %, or None where there is none to give.
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


def rows(results: Sequence[Scored]) -> list[Row]:
    """Measure everything."""
    return [*_names(results), *_abstention(results), *_worth(results), *_running(results)]


def _names(results: Sequence[Scored]) -> list[Row]:
    plain = [r for r in results if r.label.case == "single" and r.nats > PLAIN]
    faint = [r for r in results if r.label.case == "single" and FAINT <= r.nats <= PLAIN]
    pairs = [r for r in results if r.label.case == "two" and _both_show(r)]
    bench, stamped, position = (_recorded(plain, k) for k in ("bench", "stamped", "position"))
    grouped = [len(name.group) for r in plain for name in r.found.names if name.group & r.truth]
    with_edges = [len(n.group) for r in bench for n in r.found.names if n.group & r.truth]
    on_bench = _recorded(pairs, "bench")
    of_machine = [r for r in pairs if r.label.recording in MACHINE]
    return [
        _at_least("right name, bench", 0.99, bench, lambda r: r.names_exactly),
        _at_least("  name or group", None, bench, lambda r: r.names_in_group),
        _at_least("name or group, machine with stamps", 0.98, stamped, lambda r: r.names_in_group),
        _at_least("  the very name", None, stamped, lambda r: r.names_exactly),
        _at_least("name or group, position only", 0.95, position, lambda r: r.names_in_group),
        _at_least("  the very name", None, position, lambda r: r.names_exactly),
        _at_least("name or group, faint (10–30 nats)", 0.85, faint, lambda r: r.names_in_group),
        _at_least("right stage", 0.99, plain, lambda r: r.has_right_stage),
        _at_least("truth in the reported group", 0.99, plain, lambda r: bool(r.covered)),
        _figure("  median size of the group", grouped, np.median),
        _figure("  the same with edges", with_edges, np.median, goal=1.0),
        _at_least("nothing named of one effect", None, plain, lambda r: not r.found.names),
        _at_least("both of two effects, bench", 0.95, on_bench, lambda r: r.names_in_group),
        _at_least("both of two effects, machine", 0.85, of_machine, lambda r: r.names_in_group),
        _at_most("a wrong name beside two effects", 0.02, pairs, lambda r: r.strays > 0),
    ]


def _abstention(results: Sequence[Scored]) -> list[Row]:
    none, dull, strangers = (_of(results, case) for case in ("none", "dull", "stranger"))
    return [
        _at_most("false alarm, no gap", 0.005, none, _sees_gap),
        _at_most("false material gap, dull base", 0.02, dull, _sees_gap),
        _at_least("stranger not named", 0.95, strangers, lambda r: not r.found.names),
        _at_most("stranger named with confidence ≥ 0.9", 0.02, strangers, lambda r: r.is_sure),
        _at_least(
            "stranger told as unknown", None, strangers, lambda r: r.found.verdict == "unknown"
        ),
    ]


def _worth(results: Sequence[Scored]) -> list[Row]:
    plain = [r for r in results if r.truth and r.nats > PLAIN]
    shrinks = [r.shrink for r in plain if not np.isnan(r.shrink)]
    known = [r for r in results if r.truth]
    return [
        _figure("held-out shrink ÷ the oracle's, median", shrinks, np.median, goal=0.99),
        _figure("  tenth percentile", shrinks, _quantile(0.1), goal=0.95),
        _calibration("calibration error, one or two effects", known, 0.02),
        _calibration("  with all that was named", results, None),
    ]


def _running(results: Sequence[Scored]) -> list[Row]:
    seconds = [r.seconds for r in results]
    return [
        _at_most("broken down", 0.0, results, lambda r: r.found.verdict == FAILED),
        _figure("seconds a diagnosis, median", seconds, np.median),
        _figure("  90 %", seconds, _quantile(0.9)),
    ]


def _sees_gap(scored: Scored) -> bool:
    return scored.found.verdict != "no_gap"


def _both_show(scored: Scored) -> bool:
    visible = [scored.label.visible[effect] for effect in scored.truth]
    return scored.nats > PLAIN and min(visible) >= SHOWN_SIZE


def _recorded(results: Sequence[Scored], recording: str) -> list[Scored]:
    return [r for r in results if r.label.recording == recording]


def _of(results: Sequence[Scored], case: str) -> list[Scored]:
    return [r for r in results if r.label.case == case]


def _at_least(title: str, goal: float | None, of: Sequence[Scored], hit: Which) -> Row:
    return _share(title, of, hit, goal, sense=1)


def _at_most(title: str, goal: float | None, of: Sequence[Scored], hit: Which) -> Row:
    return _share(title, of, hit, goal, sense=-1)


def _share(title: str, of: Sequence[Scored], hit: Which, goal: float | None, sense: int) -> Row:
    words = "" if goal is None else f"{'≥' if sense > 0 else '≤'} {100 * goal:.3g} %"
    if not of:
        return Row(title, float("nan"), None, 0, words, None)
    share = proportion(sum(map(hit, of)), len(of))
    met = None if goal is None else sense * share.value >= sense * goal
    return Row(title, share.value, share, len(of), words, met)


def _quantile(share: float) -> Callable[[Sequence[float]], float]:
    return lambda values: float(np.quantile(values, share))


def _figure(
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


def _calibration(title: str, results: Sequence[Scored], goal: float | None) -> Row:
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
