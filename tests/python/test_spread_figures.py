"""The tables of what spreading costs, in docs/FLEET.md, are what their figures make of them."""

import json
from pathlib import Path
from typing import Any

import pytest
import spread_figures
from spread_figures import Campaigns, Empty, Figures, Handed, Killed

from skiplatch.places import ROOT

TEXT = (ROOT / spread_figures.PAGE).read_text(encoding="utf-8")
MADE_UP = Figures(
    [Campaigns("processes", 2, 8, 400, plain_s=16.0, share=0.97, more_s=0.08)],
    Killed(24, 60, 5.0, kills=7, slower=2.0, is_same=True),
    [Empty("cluster", 1_000, 3.0, 2.0), Empty("cluster", 10_000, 3.0, 10.0)],
    [Handed("cluster", 200, 400, 12.34)],
)


def written(figures: Figures) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(figures.as_json())
    return document


@pytest.fixture
def document() -> dict[str, Any]:
    path = ROOT / spread_figures.FIGURES
    if not path.exists():
        how = f"make bench-spread OPTIONS='--figures {spread_figures.FIGURES}'"
        pytest.skip(f"nobody has measured what spreading costs yet: {how}")
    measured: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return measured


def test_the_page_has_the_tables_of_the_figures(document: dict[str, Any]) -> None:
    expected = spread_figures.with_tables(TEXT, document)

    assert expected == TEXT, "run python tests/perf/spread_figures.py"


def test_the_figures_hold_both_places_one_and_two_workers_and_what_was_killed(
    document: dict[str, Any],
) -> None:
    figures = Figures.read(document)
    both = {"processes", "cluster"}

    assert {(row.place, row.workers) for row in figures.campaigns} == {
        (place, workers) for place in both for workers in (1, 2)
    }
    assert {(row.place, row.tasks) for row in figures.empty} == {
        (place, tasks) for place in both for tasks in (1_000, 10_000)
    }
    assert {row.place for row in figures.handed} == both
    assert figures.killed is not None
    assert figures.killed.kills > 0
    assert figures.killed.is_same


def test_more_a_campaign_is_what_its_worker_takes_more() -> None:
    text = MADE_UP.as_text()

    assert "8 campaigns of 400 touches, processes, 2 workers\n  plain loops          30.0" in text
    assert "of plain loops       0.97" in text
    assert "more a campaign       +20 ms, with the start" in text


def test_what_is_done_beside_a_diagnosis_is_told() -> None:
    text, page = MADE_UP.as_text(), spread_figures.tables(written(MADE_UP))

    assert "200 campaigns of 400 touches handed to cluster\n  each                 12.3 ms" in text
    assert "| `--cluster local:2` | 200 of 400 touches | 12 ms |" in page


def test_what_is_not_measured_anew_stays(tmp_path: Path) -> None:
    (tmp_path / "before.json").write_text(MADE_UP.as_json())
    again = Figures([], None, [], [Handed("processes", 200, 400, 3.0)])

    kept = again.or_before(tmp_path / "before.json")

    assert kept == Figures(MADE_UP.campaigns, MADE_UP.killed, MADE_UP.empty, again.handed)
    assert again.or_before(tmp_path / "none.json") is again


def test_what_was_not_measured_is_not_told() -> None:
    text = Figures([], MADE_UP.killed, [], []).as_text()

    assert text.startswith("24 campaigns of 60 touches, a worker killed every 5 s")
    assert "empty tasks" not in text


def test_other_bytes_are_told() -> None:
    same, other = MADE_UP, Figures([], Killed(24, 60, 5.0, 7, 2.0, is_same=False), [], [])

    assert "7 in all: the same bytes" in same.as_text()
    assert "7 in all: OTHER BYTES" in other.as_text()
    assert "the answers are not" in spread_figures.tables(written(other))


def test_what_many_workers_give_follows_from_the_cost_of_most_tasks() -> None:
    text = spread_figures.tables(written(MADE_UP))

    assert "at 10 ms of the scheduler for each" in text
    assert "| 100 | 500 s | 100 s | 500 s | 100 % |" in text
    assert "| 1,000 | 50 s | 100 s | 100 s | 50 % |" in text


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match=r"spread\.json"):
        spread_figures.with_tables("no tables here", written(MADE_UP))


def test_the_page_has_a_place_for_the_tables() -> None:
    page = spread_figures.with_tables(TEXT, written(MADE_UP))

    assert spread_figures.tables(written(MADE_UP)) in page
    assert "### Three hosts" in page
    assert spread_figures.with_tables(page, written(MADE_UP)) == page
