"""The store that the bench makes is one that skiplatch takes for whole."""

import subprocess
import sys
from pathlib import Path

import fleet_bench
import pytest

from skiplatch.fleet.alike import FEWEST_RIGS
from skiplatch.fleet.chart import FEWEST
from skiplatch.fleet.reading import opened
from test_fleet_told import fleet

RIGS, WEEKS, TOUCHES = 5, 7, 10


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


def test_page_loads_nothing_that_takes_as_long_as_itself(store: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    words = ["fleet", "report", "--store", str(store), "--html", str(page)]
    code = f"""
import sys
from skiplatch.cli import group
group({words}, standalone_mode=False)
print({{"scipy.special", "scipy.stats", "matplotlib"}} & set(sys.modules))
"""

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert RIGS >= FEWEST_RIGS
    assert WEEKS > FEWEST  # so all of the judging is done
    assert '<a href="#c0">' in page.read_text()
    assert done.stdout.splitlines()[-1] == "{'scipy.special'}"
