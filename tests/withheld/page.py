"""The table of the withheld check in docs/DIAGNOSIS.md, out of the figures that a check measured.

Example:
  python -m tests.withheld.check --seed 7 --count 200 --figures docs/withheld.json
  python -m tests.withheld.page
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from skiplatch.files import atomic_write_text, read_json
from skiplatch.marked_pages import with_part
from skiplatch.tables import compact, number
from tests.withheld import goals
from tests.withheld.rows import Row
from tests.withheld.scoring import Scored

FIGURES = Path("docs/withheld.json")
PAGE = Path("docs/DIAGNOSIS.md")
BEGIN = "<!-- withheld.json, by python -m tests.withheld.page -->\n"
END = "<!-- end of withheld.json -->\n"


def figures(results: Sequence[Scored], seed: int) -> str:
    """Give what was measured for the page: seed, version, and a row for each goal."""
    return figures_of(goals.rows(results), seed, len(results))


def figures_of(measured: Sequence[Row], seed: int, campaigns: int) -> str:
    """Give rows with a goal as the document of the figures; see `figures`."""
    document = {
        "version": version("skiplatch"),
        "seed": seed,
        "campaigns": campaigns,
        "table": [row.as_json() for row in measured if row.goal and row.count],
    }
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def table(document: Mapping[str, Any]) -> str:
    """Lay out the figures for the page, with what they were measured on."""
    campaigns, seed, made_by = (document[key] for key in ("campaigns", "seed", "version"))
    head = f"{campaigns} campaigns of seed {seed}, by version {made_by}:"
    rows = [f"| {row['title']} | {_measured(row)} | {row['goal']} |" for row in document["table"]]
    return "\n".join([head, "", "| | measured | goal |", "|---|---|---|", *rows]) + "\n"


def _measured(row: Mapping[str, Any]) -> str:
    if row["interval"] is None:
        return number(row["value"], 3)
    hits = round(row["value"] * row["of"])
    low, high = (compact(100.0 * end, 2) for end in row["interval"])
    return f"{hits} of {row['of']} ({low} … {high} %)"


def with_table(page: str, document: Mapping[str, Any]) -> str:
    """Give the page with the table between its marks.

    Raises:
        ValueError: The page has no marks.
    """
    return with_part(page, table(document), BEGIN, END)


def main() -> None:
    """Write the table into the page."""
    argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    ).parse_args()
    page = PAGE.read_text(encoding="utf-8")
    atomic_write_text(PAGE, with_table(page, read_json(FIGURES)))


if __name__ == "__main__":
    main()
