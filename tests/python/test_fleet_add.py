"""An add of many campaigns holds the touches of one."""

import gc
import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from conftest import SAMPLES
from skiplatch.campaign import Touches
from skiplatch.cli import group
from skiplatch.fleet.intake import Intake
from skiplatch.fleet.store import Writer


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
