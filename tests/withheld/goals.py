"""The table of goals: what is measured, of which campaigns, and what is wanted."""

from collections.abc import Sequence

import numpy as np

from tests.withheld.nats import FAINT, PLAIN
from tests.withheld.rows import (
    Row,
    as_text,
    at_least,
    at_most,
    calibration,
    figure,
    quantile,
    share,
)
from tests.withheld.scoring import FAILED, SURE, Scored

__all__ = ["Row", "as_text", "rows"]

SHOWN_SIZE = 1.0
"""Of each of two or three effects, in units of the expected spread, to count as above the noise."""


def rows(results: Sequence[Scored]) -> list[Row]:
    """Measure everything."""
    return [
        *_one(results),
        *_more(results),
        *_abstention(results),
        *_sureness(results),
        *_worth(results),
        *_running(results),
    ]


def _one(results: Sequence[Scored]) -> list[Row]:
    """Campaigns of one effect."""
    plain = [r for r in _of(results, "single") if r.nats > PLAIN]
    faint = [r for r in _of(results, "single") if FAINT <= r.nats <= PLAIN]
    bench, stamped, position = (_recorded(plain, k) for k in ("bench", "stamped", "position"))
    grouped = [len(name.group) for r in plain for name in r.found.names if name.group & r.truth]
    with_edges = [len(n.group) for r in bench for n in r.found.names if n.group & r.truth]
    return [
        at_least("one effect that shows: name or group", 0.97, plain, _is_named),
        at_least("  bench", None, bench, _is_named),
        at_least("  machine with stamps", None, stamped, _is_named),
        at_least("  position only", None, position, _is_named),
        at_least("  the very name", None, plain, lambda r: r.names_exactly),
        at_least("  the very name, bench", 0.99, bench, lambda r: r.names_exactly),
        at_least("  faint (10–30 nats)", 0.85, faint, _is_named),
        at_least("right stage", 0.99, plain, lambda r: r.has_right_stage),
        at_least("truth in the reported group", 0.99, plain, lambda r: bool(r.covered)),
        figure("  median size of the group", grouped, np.median),
        figure("  the same with edges", with_edges, np.median, goal=1.0),
        at_least("nothing named of one effect", None, plain, lambda r: not r.found.names),
        at_least("name or group, beliefs uncertain", 0.97, _plain(results, "uncertain"), _is_named),
        at_least("name or group, begins or ends", 0.9, _plain(results, "onset"), _is_named),
        at_least("name or group, few touches", None, _plain(results, "small"), _is_named),
    ]


def _more(results: Sequence[Scored]) -> list[Row]:
    """Campaigns of several effects, and of outliers."""
    pairs = [r for r in _of(results, "two") if _all_show(r)]
    three = [r for r in _of(results, "three") if _all_show(r)]
    outliers = [r for r in _of(results, "outliers") if r.nats > PLAIN or not r.truth]
    listed = sum(len(r.found.outliers & r.label.plain_outliers) for r in outliers)
    said = [touch in r.label.outliers for r in results for touch in r.found.outliers]
    there = sum(len(r.label.plain_outliers) for r in outliers)
    return [
        at_least("both of two effects", 0.9, pairs, _is_named),
        at_least("  bench", None, _recorded(pairs, "bench"), _is_named),
        at_most("  a wrong name beside them", 0.02, pairs, lambda r: r.strays > 0),
        at_least("all of three effects", 0.75, three, _is_named),
        at_most("  a wrong name beside them", None, three, lambda r: r.strays > 0),
        at_least("outliers: right all the same", 0.97, outliers, _is_right_verdict),
        share("  those of ten spreads that are listed", listed, there, None, sense=1),
        share("  listed ones that are some", sum(said), len(said), None, sense=1),
    ]


def _abstention(results: Sequence[Scored]) -> list[Row]:
    """Campaigns without an effect of the catalogue."""
    none, dull, datum = (_of(results, case) for case in ("none", "dull", "datum"))
    by_hand, strangers = _of(results, "stranger"), _of(results, "strangers")
    noise = _of(results, "wrong_noise")
    return [
        at_least("no gap: said so", 0.995, none, _sees_none),
        at_least("dull base: no gap", 0.98, dull, _sees_none),
        at_least("wrong noise believed: no gap", 0.98, noise, _sees_none),
        at_least("datum off: no gap", 0.99, datum, _sees_none),
        at_most("  named all the same", None, datum, _names),
        at_most("strangers of the grammar named", 0.05, strangers, _names),
        at_most("  strangers of the grammar explained", 0.01, strangers, _explains),
        at_most("  named with confidence ≥ 0.9", None, strangers, lambda r: r.is_sure),
        at_least("  told as unknown", None, strangers, lambda r: r.found.verdict == "unknown"),
        at_most("strangers by hand named", 0.05, by_hand, _names),
        at_most("  strangers by hand explained", 0.01, by_hand, _explains),
        at_least("  told as unknown", None, by_hand, lambda r: r.found.verdict == "unknown"),
    ]


def _sureness(results: Sequence[Scored]) -> list[Row]:
    """Whether what is said for certain is true, over all campaigns."""
    sure = [(r, name) for r in results for name in r.found.names if name.confidence >= SURE]
    unsure = [(r, name) for r in results for name in r.found.names if name.confidence < SURE]
    wrong, unsure_wrong = (
        sum(not name.group & r.truth for r, name in named) for named in (sure, unsure)
    )
    return [
        share("wrong of the names with confidence ≥ 0.9", wrong, len(sure), 0.02, sense=-1),
        share("wrong of the other names", unsure_wrong, len(unsure), 0.02, sense=-1),
        at_most("campaigns with such a name", 0.01, results, lambda r: r.is_surely_wrong),
        at_most("explained, and nothing shrinks by half", 0.0, results, _explains_nothing),
        calibration("calibration error, all that was named", results, 0.02),
        calibration("  where there are effects", [r for r in results if r.truth], None),
    ]


def _worth(results: Sequence[Scored]) -> list[Row]:
    plain = [r for r in results if r.truth and r.nats > PLAIN]
    shrinks = [r.shrink for r in plain if not np.isnan(r.shrink)]
    return [
        figure("held-out shrink ÷ the oracle's, median", shrinks, np.median, goal=0.99),
        figure("  tenth percentile", shrinks, quantile(0.1), goal=0.95),
    ]


def _running(results: Sequence[Scored]) -> list[Row]:
    seconds = [r.seconds for r in results]
    return [
        at_most("broken down", 0.0, results, lambda r: r.found.verdict == FAILED),
        at_most("undecided", None, results, lambda r: r.found.verdict == "undecided"),
        figure("seconds a diagnosis, median", seconds, np.median, goal=1.5),
        figure("seconds a diagnosis, 90 %", seconds, quantile(0.9), goal=8.0),
    ]


def _is_named(scored: Scored) -> bool:
    return scored.names_in_group


def _names(scored: Scored) -> bool:
    return bool(scored.found.names)


def _sees_none(scored: Scored) -> bool:
    return scored.found.verdict == "no_gap"


def _explains(scored: Scored) -> bool:
    return scored.found.verdict == "explained"


def _explains_nothing(scored: Scored) -> bool:
    return _explains(scored) and not scored.found.shrinks_by_half


def _is_right_verdict(scored: Scored) -> bool:
    """Whether the effect is named, or no gap is seen where there is none."""
    return scored.names_in_group if scored.truth else _sees_none(scored)


def _all_show(scored: Scored) -> bool:
    visible = [scored.label.visible[effect] for effect in scored.truth]
    return scored.nats > PLAIN and min(visible) >= SHOWN_SIZE


def _plain(results: Sequence[Scored], case: str) -> list[Scored]:
    return [r for r in _of(results, case) if r.nats > PLAIN]


def _recorded(results: Sequence[Scored], recording: str) -> list[Scored]:
    return [r for r in results if r.label.recording == recording]


def _of(results: Sequence[Scored], case: str) -> list[Scored]:
    return [r for r in results if r.label.case == case]
