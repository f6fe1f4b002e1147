"""The store that the bench makes is one that skiplatch takes for whole."""

from pathlib import Path

import fleet_bench
import pytest

from skiplatch.fleet.reading import opened
from test_fleet_told import fleet

RIGS, WEEKS, TOUCHES = 3, 2, 10


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return fleet_bench.fill(tmp_path, RIGS, WEEKS, TOUCHES)


def test_history_of_a_rig_is_read(store: Path) -> None:
    with opened(store, with_touches=False) as reader:
        rows = reader.history("rig-000").mappings()

    assert [row["touches"] for row in rows] == [TOUCHES] * WEEKS


def test_no_file_is_taken_for_damaged(store: Path) -> None:
    result = fleet("verify", "--store", store)

    assert result.exit_code == 0, result.output
    assert f"{RIGS * WEEKS} campaigns, 0 with lost or damaged files" in result.output
