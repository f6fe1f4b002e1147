"""An add that is cut or goes on for long: it ends in one line, and holds no touches."""

import gc
import json
import os
import shutil
import signal
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from conftest import SAMPLES
from skiplatch import undo
from skiplatch.campaign import Touches
from skiplatch.cli import group
from skiplatch.fleet import store as stores
from skiplatch.fleet.intake import Intake
from skiplatch.fleet.store import Writer

ENDLESS = "SELECT count(*) FROM range(1000000000000) AS numbers(n) WHERE hash(n) = 3;"


@pytest.fixture
def campaigns(tmp_path: Path) -> list[Path]:
    """Campaigns of the same touches, in other bytes."""
    folders = [tmp_path / "mill-7" / day for day in ("monday", "tuesday", "friday")]
    for folder in folders:
        shutil.copytree(SAMPLES / "bench_isr_latency", folder)
        with (folder / "nominal.toml").open("a") as file:
            file.write(f"# {folder.name}\n")
    return folders


def fleet(*words: str | Path) -> Result:
    return CliRunner().invoke(group, ["fleet", *map(str, words)])


@pytest.fixture
def python_interrupts() -> Iterator[None]:
    """Whoever runs the tests in the background may have had SIGINT ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("python_interrupts")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_a_query_is_one_line_and_leaves_the_store_whole(
    number: int, campaigns: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = tmp_path / "store"
    assert fleet("add", campaigns[0], "--store", store).exit_code == 0
    timer = threading.Timer(1.0, os.kill, [os.getpid(), number])
    with monkeypatch.context() as slow:
        slow.setattr(stores, "MERGE", ENDLESS + stores.MERGE)
        timer.start()
        result = fleet("add", *campaigns, "--store", store)
    timer.join()

    assert result.exit_code == (undo.INTERRUPTED if number == signal.SIGINT else undo.TERMINATED)
    assert result.output == "interrupted\n"
    assert fleet("verify", "--store", store).exit_code == 0
    assert not list(store.rglob(".skiplatch-*"))
    assert (
        "2 campaigns of 1 rig added, 1 known" in fleet("add", *campaigns, "--store", store).output
    )


def test_an_add_holds_the_touches_of_one_campaign(
    campaigns: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    add, held = Writer.add, []

    def counted(writer: Writer, folder: Path, rig: str | None) -> Intake | None:
        gc.collect()
        held.append(sum(isinstance(one, Touches) for one in gc.get_objects()))
        return add(writer, folder, rig)

    monkeypatch.setattr(Writer, "add", counted)
    result = fleet(
        "add", *campaigns, "--store", tmp_path / "store", "--json", tmp_path / "out.json"
    )

    assert result.exit_code == 0, result.output
    assert len(held) == len(campaigns)
    assert max(held) - held[0] <= 1  # that of the last campaign, until the next is there
    added = json.loads((tmp_path / "out.json").read_text())["added"]
    assert [one["folder"] for one in added] == ["monday", "tuesday", "friday"]
