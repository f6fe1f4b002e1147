"""A comparison as one page of HTML: no script, nothing from elsewhere, light and dark."""

from dataclasses import dataclass

from skiplatch.campaign import Campaign
from skiplatch.comparison.model import Comparison
from skiplatch.comparison.observables import ALL_OBSERVABLES, Observable
from skiplatch.comparison.text import FREE_DATUM, header, missed_line, row, verdict
from skiplatch.figures.comparison import cell_panel, shown_feeds
from skiplatch.figures.inline import Drawing
from skiplatch.report import glossary
from skiplatch.report.layout import Table, render

TEMPLATE = "comparison.html"


@dataclass(frozen=True, slots=True)
class _Part:
    """One observable: its pictures and its table."""

    id: str
    title: str
    caption: str
    drawings: list[Drawing]
    table: Table


def as_html(campaign: Campaign, comparison: Comparison, *, name: str) -> str:
    """Lay out a comparison.

    Args:
        campaign: What was compared.
        comparison: What came of it.
        name: What the campaign is called.
    """
    agrees = not comparison.differing
    return render(
        TEMPLATE,
        name=name,
        kind=campaign.nominal.kind.value,
        touches=len(campaign.touches),
        headline=f"Recorded and simulated {'agree' if agrees else 'differ'}",
        lead=verdict(comparison) if comparison.gaps else "There is nothing to compare.",
        parts=[part for one in ALL_OBSERVABLES if (part := _part(comparison, one)).drawings],
        free_datum=FREE_DATUM if comparison.is_datum_free else "",
        missed=[missed_line(missed) for missed in comparison.missed],
        glossary=glossary.words(
            *("95 % interval", "cell", "deviation", "distance", "latch", "noise floor"),
            *("nominal", "p", "PLC task", "skip input", "spread"),
        ),
    )


def _part(comparison: Comparison, observable: Observable) -> _Part:
    pairs = comparison.of(observable)
    feeds = shown_feeds(pairs)
    drawings = [
        cell_panel(f"{observable.name}-{i}", cell, gap)
        for i, (cell, gap) in enumerate(pairs)
        if cell.feed_mm_min in feeds
    ]
    rows = [
        tuple(cell.replace("± ", "±\N{NO-BREAK SPACE}") for cell in row(gap, comparison.alpha))
        for _, gap in pairs
    ]
    return _Part(
        id=observable.name,
        title=observable.title,
        caption=f"{observable.title} in {observable.unit}: mean ± spread; recorded minus simulated "
        "± half of the 95 % interval",
        drawings=drawings,
        table=Table(header(observable), rows),
    )
