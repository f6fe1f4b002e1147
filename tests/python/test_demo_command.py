"""``skiplatch demo`` as the user meets it, with fewer touches."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from documents import ROOT, examples
from skiplatch import cli
from skiplatch.campaign import Campaign
from skiplatch.commands import demo, demo_fleet
from skiplatch.commands.diagnose_many import Told
from skiplatch.diagnosis.reported.schema import FORMATS
from skiplatch.latch.effort import Effort
from skiplatch.places import SAMPLES

PICTURES = (
    "latch_errors",
    "scan_position",
    "feeds",
    "one_point",
    "cycle_times",
    "bench_isr_latency/compare_deviation_um",
    "bench_isr_latency/compare_latch_after_edge_us",
    "bench_isr_latency/compare_report_after_latch_us",
    "machine_no_gap/compare_deviation_um",
)
PAGE = "fleet.html"


def measured(recorded: Sequence[Campaign], *_: object) -> Iterator[Told]:
    """Stands for the diagnoses, which take long: a gap of 4 µm where a rig has worn, else 0.3."""
    for number, campaign in enumerate(recorded):
        week, rig = divmod(number, len(demo_fleet.RIGS))
        is_worn = demo_fleet.RIGS[rig] == demo_fleet.WORN and week >= demo_fleet.WORN_SINCE
        before = (4.0 if is_worn else 0.3) + 0.01 * (campaign.touches.deviation_um[0] % 1.0)
        gap = {"unit": "µm", "before": before, "after": before, "noise_floor": 0.1}
        document = {"format": FORMATS[0], "verdict": "unknown", "gap": {"deviation": gap}}
        yield Told("", {**document, "effects": [], "where": []}, has_gap=True)


def run(*arguments: str) -> Result:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(demo, "TOUCHES", 2000)
        patch.setattr(demo_fleet, "tell_all", measured)
        return CliRunner().invoke(cli.group, ["demo", "--jobs", "2", *arguments])


def show(folder: Path) -> Result:
    return run("--out", str(folder / "demo"), "--json", str(folder / "a.json"))


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    """The folder of a demo, and what came of it."""
    folder = tmp_path_factory.mktemp("shown")
    return folder, show(folder)


def test_help_has_an_example() -> None:
    text = run("--help").output

    assert "Example:\n    skiplatch demo --" in text
    for option in ("--out", "--json", "--seed", "--jobs"):
        assert option in text


def test_demo_shows_everything_and_ends_with_its_pictures(shown: tuple[Path, Result]) -> None:
    folder, result = shown

    assert result.exit_code == 0, result.output
    for words in ("PLC task, 2 000 touches", "0.0849", "one touch would have to crawl"):
        assert words in result.output
    for sample in ("bench_isr_latency", "machine_no_gap"):
        assert f"Recorded sample {sample}" in result.output
    assert "mill-2: deviation gap grew from" in result.output
    last_lines = result.output.splitlines()[-len(PICTURES) - 1 :]
    assert f"wrote {folder / 'demo' / PAGE}" in last_lines
    assert "mill-3" in (folder / "demo" / PAGE).read_text()
    for name in PICTURES:
        assert f"wrote {folder / 'demo' / name}.svg" in last_lines
        assert (folder / "demo" / f"{name}.svg").stat().st_size > 0
    document: dict[str, Any] = json.loads((folder / "a.json").read_text())
    assert document["seed_figures"]["agree"] is True
    assert document["plan"]["feasible"] is True
    assert {change["rig"] for change in document["fleet"]["changed"]} == {"mill-2"}
    assert set(document["comparisons"]) == {"bench_isr_latency", "machine_no_gap"}


@pytest.mark.long
def test_demo_can_be_shown_again_in_the_same_folder(shown: tuple[Path, Result]) -> None:
    folder, first = shown

    again = show(folder)

    assert again.exit_code == 0, again.output
    assert again.output == first.output


@pytest.mark.long
def test_readme_shows_lines_of_a_million_touches(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (shown,) = [one for one in examples(ROOT / "README.md") if "make demo" in one.text]

    demo._Demo(tmp_path, Effort(demo.TOUCHES, seed=1, jobs=2)).latch()

    # Two tables of other widths stand in one there.
    said = {tuple(line.split()) for line in capsys.readouterr().out.splitlines()}
    assert [line for line in shown.output.splitlines() if tuple(line.split()) not in said] == []


def test_folder_is_required() -> None:
    result = run()

    assert result.exit_code == 2
    assert "Missing option '-o' / '--out'" in result.output


@pytest.mark.long
def test_the_fleet_is_diagnosed_and_the_worn_rig_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the rigs one that wears, and one that does not."""
    page = tmp_path / "fleet.html"
    monkeypatch.setattr(demo_fleet, "RIGS", demo_fleet.RIGS[:2])

    found = demo_fleet.show_fleet(SAMPLES / "machine_no_gap", page, seed=1, jobs=2)

    assert {change["rig"] for change in found["changed"]} == {demo_fleet.WORN}
    assert found["undiagnosed"] == 0
    assert demo_fleet.WEAR.id in page.read_text()
