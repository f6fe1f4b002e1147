"""The table of the withheld check in docs/DIAGNOSIS.md is what its figures make of it."""

import json
from typing import Any

import pytest

from skiplatch.places import ROOT
from tests.withheld import page
from tests.withheld.rows import Row, at_least, share

DOCUMENT = json.loads((ROOT / page.FIGURES).read_text(encoding="utf-8"))
TEXT = (ROOT / page.PAGE).read_text(encoding="utf-8")


def written(*rows: Row) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(page.figures_of(rows, seed=7, campaigns=20))
    return document


def test_the_page_has_the_table_of_the_figures() -> None:
    assert page.with_table(TEXT, DOCUMENT) == TEXT, "run python -m tests.withheld.page"


def test_a_share_is_shown_as_a_count_with_its_interval() -> None:
    document = written(share("named", 4, 11, 0.05, sense=-1))

    assert "20 campaigns of seed 7" in page.table(document)
    assert "| named | 4 of 11 (11 … 69 %) | ≤ 5 % |" in page.table(document)


def test_what_was_not_measured_and_what_has_no_goal_are_left_out() -> None:
    nothing, aimless = at_least("nothing", 0.9, [], bool), share("aimless", 1, 2, None, sense=1)

    assert written(nothing, aimless, share("all", 2, 2, 0.9, sense=1))["table"] == [
        share("all", 2, 2, 0.9, sense=1).as_json()
    ]


def test_another_figure_changes_the_page() -> None:
    other = {**DOCUMENT, "seed": DOCUMENT["seed"] + 1}

    assert page.with_table(TEXT, other) != TEXT


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match=r"withheld\.json"):
        page.with_table("no table here", DOCUMENT)
