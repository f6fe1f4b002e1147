"""The program skiplatch-sim: what it plays, refuses, and does without memory."""

import re
import subprocess
from pathlib import Path

import pytest

PROGRAM = Path("build/host/skiplatch-sim")
TOUCHES = 100_000  # 19 MB of arrays
STEP_KB = 4_000


def run(*options: str, limit_kb: int | str = "unlimited") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["/bin/sh", "-c", f'ulimit -v {limit_kb}; exec "$@"', "sh", str(PROGRAM), *options],
        check=False,
        capture_output=True,
        text=True,
    )


def test_a_touch_is_a_row() -> None:
    done = run("--path", "plc", "--touches", "3")

    assert done.returncode == 0
    header, *rows = done.stdout.splitlines()
    assert header.startswith("touch,edge_us,latch_us")
    assert [row.split(",")[0] for row in rows] == ["0", "1", "2"]
    assert all(row.endswith(",ok") for row in rows)


@pytest.mark.parametrize("options", [("--touches", "0"), ("--scan", "no"), ("--tick", "0"), ("x",)])
def test_what_cannot_be_played_is_refused(options: tuple[str, ...]) -> None:
    done = run(*options)

    assert (done.returncode, done.stdout) == (2, "")
    assert re.fullmatch(r"skiplatch-sim: .+\n", done.stderr)


def test_without_memory_it_says_so() -> None:
    """Whichever of its arrays there is no room for, from the least it starts with to enough."""
    limit_kb = STEP_KB
    while run("--touches", "1", limit_kb=limit_kb).returncode != 0:
        limit_kb += STEP_KB
    refused = 0
    while (done := run("--touches", str(TOUCHES), limit_kb=limit_kb)).returncode != 0:
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr == "skiplatch-sim: out of memory\n"
        refused += 1
        limit_kb += STEP_KB
    assert refused >= 3


def test_no_allocation_of_the_simulation_is_without_a_test() -> None:
    """Those of the library fail in tests/scenario/test_out_of_memory.c."""
    folders = (Path("host_sim"), Path("scripts/skiplatch"))
    sources = [source for folder in folders for source in folder.rglob("*.[ch]")]
    places = {source.name: source.read_text().count("alloc(") for source in sources}

    assert {name: count for name, count in places.items() if count} == {
        "batch.c": 1,
        "five_axis_setup.c": 1,
        "kinematics_memory.c": 1,
        "datum.c": 3,
        "grid_table.c": 2,
        "scan_grid.c": 2,
        "stream_law.c": 2,
        "streams.c": 5,
        "tick_rest.c": 2,
        "main.c": 2,
    }
