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
    "cycle_times",
    "bench_isr_latency/compare_deviation_um",
    "bench_isr_latency/compare_latch_after_edge_us",
    "bench_isr_latency/compare_report_after_latch_us",
    "machine_no_gap/compare_deviation_um",
)


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> Result:
    monkeypatch.setattr(demo, "TOUCHES", 2000)
    return CliRunner().invoke(cli.group, ["demo", "--jobs", "2", *arguments])


def test_help_has_an_example(monkeypatch: pytest.MonkeyPatch) -> None:
    text = run(monkeypatch, "--help").output

    assert "Example:\n    skiplatch demo --" in text
    for option in ("--out", "--json", "--seed", "--jobs"):
        assert option in text


def test_demo_shows_everything_and_ends_with_its_pictures(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    result = run(monkeypatch, "--out", str(tmp_path / "demo"), "--json", str(tmp_path / "a.json"))

    assert result.exit_code == 0, result.output
    for words in ("PLC task, 2 000 touches", "0.0849", "one touch would have to crawl"):
        assert words in result.output
    for sample in ("bench_isr_latency", "machine_no_gap"):
        assert f"Recorded sample {sample}" in result.output
    last_lines = result.output.splitlines()[-len(PICTURES) :]
    for name in PICTURES:
        assert f"wrote {tmp_path / 'demo' / name}.svg" in last_lines
        assert (tmp_path / "demo" / f"{name}.svg").stat().st_size > 0
    document: dict[str, Any] = json.loads((tmp_path / "a.json").read_text())
    assert document["seed_figures"]["agree"] is True
    assert document["plan"]["feasible"] is True
    assert set(document["comparisons"]) == {"bench_isr_latency", "machine_no_gap"}


def test_demo_can_be_shown_again_in_the_same_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    results = [run(monkeypatch, "--out", str(tmp_path)) for _ in range(2)]

    assert [result.exit_code for result in results] == [0, 0]
    assert results[0].output == results[1].output


def test_folder_is_required(monkeypatch: pytest.MonkeyPatch) -> None:
    result = run(monkeypatch)

    assert result.exit_code == 2
    assert "Missing option '--out'" in result.output
