"""``skiplatch demo`` as the user meets it, with fewer touches."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from skiplatch import cli
from skiplatch.commands import demo

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


def run(*arguments: str) -> Result:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(demo, "TOUCHES", 2000)
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
    last_lines = result.output.splitlines()[-len(PICTURES) :]
    for name in PICTURES:
        assert f"wrote {folder / 'demo' / name}.svg" in last_lines
        assert (folder / "demo" / f"{name}.svg").stat().st_size > 0
    document: dict[str, Any] = json.loads((folder / "a.json").read_text())
    assert document["seed_figures"]["agree"] is True
    assert document["plan"]["feasible"] is True
    assert set(document["comparisons"]) == {"bench_isr_latency", "machine_no_gap"}


def test_demo_can_be_shown_again_in_the_same_folder(shown: tuple[Path, Result]) -> None:
    folder, first = shown

    again = show(folder)

    assert again.exit_code == 0, again.output
    assert again.output == first.output


def test_folder_is_required() -> None:
    result = run()

    assert result.exit_code == 2
    assert "Missing option '-o' / '--out'" in result.output
