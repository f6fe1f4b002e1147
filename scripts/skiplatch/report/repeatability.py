"""How touches repeat, as one page of HTML: no script, nothing from elsewhere, light and dark."""

from collections.abc import Sequence

from skiplatch.figures.repeatability import repeatability_panel
from skiplatch.repeatability import Repeatability
from skiplatch.report import glossary
from skiplatch.report.layout import render
from skiplatch.report.words import Table
from skiplatch.tables import number

TEMPLATE = "repeatability.html"


def as_html(
    found: Repeatability, *, name: str, sentence: str, figures: Sequence[Sequence[str]]
) -> str:
    """Lay it out.

    Args:
        found: What the touches show.
        name: What the log or campaign is called.
        sentence: All of it in one sentence.
        figures: Rows of name, value and interval.
    """
    return render(
        TEMPLATE,
        name=name,
        touches=len(found.touches),
        headline=f"σ = {number(found.sigma.value, 3)} {found.unit}",
        lead=sentence,
        drawings=[repeatability_panel("touches", found, sentence)],
        found=Table(("", "found", "95 % interval"), figures),
        outliers=", ".join(map(str, found.outliers)),
        glossary=glossary.words(
            "95 % interval", "deviation", "drift", "outlier", "slope with the feed", "σ"
        ),
    )
