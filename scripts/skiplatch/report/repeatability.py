"""How touches repeat, as one page of HTML: no script, nothing from elsewhere, light and dark."""

from collections.abc import Sequence

from skiplatch.figures.repeatability import repeatability_panel
from skiplatch.repeatability_words import OfPath
from skiplatch.report import glossary
from skiplatch.report.layout import Table, render
from skiplatch.tables import number

TEMPLATE = "repeatability.html"


def as_html(shown: Sequence[OfPath], *, name: str) -> str:
    """Lay it out.

    Args:
        shown: What the touches of each input path show.
        name: What the log or campaign is called.
    """
    return render(
        TEMPLATE,
        name=name,
        touches=sum(len(one.found.touches) for one in shown),
        headline="; ".join(map(_scatter, shown)),
        leads=[f"{one.title}: {one.sentence}" if one.title else one.sentence for one in shown],
        paths=[
            {
                "id": one.path.name.lower(),
                "title": one.title,
                "drawing": repeatability_panel(f"touches-{one.path.name.lower()}", one),
                "figures": Table(("", "found", "95 % interval"), one.figures),
                "outliers": ", ".join(map(str, one.found.outliers)),
            }
            for one in shown
        ],
        glossary=glossary.words(
            *("95 % interval", "deviation", "drift", "outlier", "slope with the feed", "σ"),
            *(("PLC task", "skip input") if shown[0].title else ()),
        ),
    )


def _scatter(one: OfPath) -> str:
    scatter = f"σ = {number(one.found.sigma.value, 3)} {one.found.unit}"
    return f"{one.title}: {scatter}" if one.title else scatter
