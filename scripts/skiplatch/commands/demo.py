"""``skiplatch demo``: all of it on simulated and recorded data, with pictures."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from skiplatch import comparison, latch, planner
from skiplatch.campaign import InputPath, read_campaign
from skiplatch.commands.demo_fleet import show_fleet
from skiplatch.commands.options import jobs_option, json_option, seed_option, write_json
from skiplatch.commands.outputs import OutputFolder
from skiplatch.figures.comparison import draw_comparison
from skiplatch.figures.cycle_times import draw_cycle_times
from skiplatch.figures.feeds import draw_feeds
from skiplatch.figures.latch_errors import draw_latch_errors
from skiplatch.figures.one_point import draw_one_point
from skiplatch.figures.scan_position import draw_scan_position
from skiplatch.latch import Effort, reference_figures
from skiplatch.latch.probing import DEFAULT_RIG
from skiplatch.places import SAMPLES
from skiplatch.planner.document import DOCUMENT_LIMITS

EPILOG = """\b
Example:
  skiplatch demo --out build/demo
"""
FEED_MM_MIN = 3000.0
WANTED_UM = 2.0
TOUCHES = 1_000_000  # on each path
TOUCHES_OF_A_FIGURE = 100_000
TOUCHES_OF_A_DOT = 10_000


class _Demo:
    """The steps of the demo; each prints what it finds and gives it as JSON."""

    def __init__(self, out: Path, effort: Effort) -> None:
        self._out = out
        self._effort = effort
        self.pictures: list[Path] = []

    def latch(self) -> Mapping[str, Any]:
        """Show how both input paths latch on a usual rig."""
        _heading("How each input path latches")
        results = {
            path: latch.examine(DEFAULT_RIG, path, FEED_MM_MIN, self._effort) for path in InputPath
        }
        click.echo(latch.as_text(DEFAULT_RIG, FEED_MM_MIN, results))
        errors = {path: result.errors for path, result in results.items()}
        draw_latch_errors(self._picture("latch_errors"), errors, FEED_MM_MIN)
        return latch.as_json(results)

    def seed_figures(self) -> Mapping[str, Any]:
        """Show that every figure of the reference document is found again."""
        _heading("Figures of probing strategies, simulated")
        found = reference_figures.play_figures(self._effort.at_most(TOUCHES_OF_A_FIGURE))
        click.echo(reference_figures.as_text(found))
        dots = self._effort.at_most(TOUCHES_OF_A_DOT)
        draw_scan_position(self._picture("scan_position"), seed=self._effort.seed)
        draw_feeds(self._picture("feeds"), dots)
        draw_one_point(self._picture("one_point"))
        draw_cycle_times(self._picture("cycle_times"), dots)
        return reference_figures.as_json(found)

    def plan(self) -> Mapping[str, Any]:
        """Show the best strategy for the document's 2 µm on its 4 ms scan."""
        _heading(f"The best strategy for {WANTED_UM:g} µm on a PLC with a scan of 4 ms")
        limits = replace(DOCUMENT_LIMITS, nominal=DEFAULT_RIG)
        effort = self._effort.at_most(TOUCHES_OF_A_FIGURE)
        plan = planner.make_plan(limits, WANTED_UM, effort)
        click.echo(planner.as_text(plan))
        return planner.as_json(plan)

    def compare(self, sample: str) -> Mapping[str, Any]:
        """Show by how much a recorded campaign and the nominal simulation differ."""
        _heading(f"Recorded sample {sample} beside the nominal simulation")
        campaign = read_campaign(SAMPLES / sample)
        found = comparison.compare(campaign, seed=self._effort.seed, jobs=self._effort.jobs)
        click.echo(comparison.as_text(found))
        self.pictures += draw_comparison(found, self._out / sample)
        return comparison.as_json(found)

    def fleet(self) -> Mapping[str, Any]:
        """Show a small fleet, of which one rig wears."""
        _heading("A fleet of simulated rigs, one of which wears: which has changed?")
        page = self._out / "fleet.html"
        found = show_fleet(
            SAMPLES / "machine_no_gap", page, seed=self._effort.seed, jobs=self._effort.jobs
        )
        self.pictures += [page] if found else []
        return found

    def _picture(self, name: str) -> Path:
        self.pictures.append(self._out / f"{name}.svg")
        return self.pictures[-1]


def _heading(text: str) -> None:
    click.echo(f"\n=== {text} ===\n")


@click.command(epilog=EPILOG)
@click.option(
    "-o",
    "--out",
    type=OutputFolder(),
    required=True,
    help="Folder for the pictures; those of an earlier demo are replaced.",
)
@seed_option
@jobs_option
@json_option
def command(out: Path, seed: int, jobs: int, json_path: Path | None) -> None:
    """Show the whole program at work, in about a minute, and draw the pictures.

    Latch errors of both input paths from a million touches each, figures of probing strategies
    beside what was stated of them, a plan, two recorded samples beside the simulation, and a small
    fleet with its page.
    """
    demo = _Demo(out, Effort(TOUCHES, seed, jobs))
    result = {
        "format": "skiplatch-demo/1",
        "seed": seed,
        "latch": demo.latch(),
        "seed_figures": demo.seed_figures(),
        "plan": demo.plan(),
        "comparisons": {
            sample: demo.compare(sample) for sample in ("bench_isr_latency", "machine_no_gap")
        },
        "fleet": demo.fleet(),
        "pictures": [str(path) for path in demo.pictures],
    }
    write_json(json_path, result)
    _heading("Pictures")
    for path in demo.pictures:
        click.echo(f"wrote {path}")
