"""Columns of touches that one campaign has and another has not."""

from pathlib import Path

import duckdb
import pytest

from skiplatch.fleet.reading import opened
from skiplatch.fleet.tables import TEXTS
from test_fleet_store import add, ask, rewritten

CELLS = {"path": "plc", "axis": "X", "status": "ok", "session": "noon"}


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "store"


def recorded(folder: Path, **cells: str) -> Path:
    """Make a campaign of a touch with these cells."""
    folder.mkdir(parents=True)
    (folder / "nominal.toml").write_text('format = "skiplatch-campaign/2"\nkind = "machine"\n')
    names = ",".join(["touch", "feed_mm_min", "deviation_um", *cells])
    (folder / "touches.csv").write_text(
        f"{names}\n{','.join(['1', '100', '2', *cells.values()])}\n"
    )
    return folder


def untyped(store: Path, name: str, kind: str) -> None:
    """Let a column without texts stand in all files as a store of before has it."""
    for path in store.glob("touches/*/*/*"):
        other = path.with_name("other")
        touches = duckdb.read_parquet(str(path), hive_partitioning=False)
        if touches.aggregate(f"count({name})").fetchall() == [(0,)]:
            touches.project(f"* REPLACE (NULL::{kind} AS {name})").write_parquet(str(other))
            other.replace(path)
    rewritten(store / "campaigns.parquet", "* EXCLUDE (touches_sha256, index_sha256)")


def test_every_text_has_a_cell_here() -> None:
    assert set(TEXTS) == set(CELLS)


@pytest.mark.parametrize("kind", ["VARCHAR", '"NULL"', "INTEGER"])
@pytest.mark.parametrize("name", TEXTS)
def test_what_one_campaign_did_not_record_is_null(
    store: Path, tmp_path: Path, name: str, kind: str
) -> None:
    without = recorded(tmp_path / "a" / "without")
    add(store, without, recorded(tmp_path / "b" / "with", **{name: CELLS[name]}))
    untyped(store, name, kind)

    rows = ask(store, f"SELECT {name} FROM touches ORDER BY rig")  # noqa: S608 - a column
    unrecorded = {"path": "skip"}.get(name)
    assert rows == [(unrecorded,), (CELLS[name],)]


def test_a_text_that_no_campaign_recorded_is_one_all_the_same(store: Path, tmp_path: Path) -> None:
    add(store, recorded(tmp_path / "a" / "one"))
    untyped(store, "session", "INTEGER")

    assert ask(store, "SELECT coalesce(session, 'none') FROM touches") == [("none",)]


def test_a_rig_is_shown_that_did_not_always_record_the_axis(store: Path, tmp_path: Path) -> None:
    campaigns = recorded(tmp_path / "a" / "one"), recorded(tmp_path / "a" / "two", axis="X")
    add(store, *campaigns)
    untyped(store, "axis", "INTEGER")

    with opened(store, with_touches=False) as reader:
        assert [row[4] for row in reader.history("a").rows] == [2.0, 2.0]
