"""Figures of `spread_bench`: as it prints them, and as docs/FLEET.md shows them.

Example:
  python tests/perf/spread_bench.py --figures docs/spread.json
  python tests/perf/spread_figures.py
"""

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from skiplatch.files import atomic_write_text, read_json
from skiplatch.marked_pages import with_part
from skiplatch.tables import compact

FIGURES, PAGE = Path("docs/spread.json"), Path("docs/FLEET.md")
BEGIN = "<!-- spread.json, by python tests/perf/spread_figures.py -->\n"
END = "<!-- end of spread.json -->\n"
SHARE_AIM, OVERHEAD_AIM_MS = 0.95, 50
ON_PAPER = (100, 500, 1_000)
PAPER_CAMPAIGNS, PAPER_CAMPAIGN_S = 10_000, 5.0
TWO = {"processes": "`--jobs 2`", "cluster": "`--cluster local:2`"}
PLACES = {"processes": "`--jobs {}`", "cluster": "`--cluster`, {} at work"}


@dataclass(frozen=True, slots=True)
class Campaigns:
    """Campaigns spread over workers, beside as many plain loops; medians over the rounds.

    Attributes:
        place: `processes` or `cluster`.
        workers: How many there are.
        campaigns: How many were diagnosed.
        touches: Of a campaign.
        plain_s: What plain loops take.
        share: Their time over that of spreading.
        more_s: The time that spreading takes more.
    """

    place: str
    workers: int
    campaigns: int
    touches: int
    plain_s: float
    share: float
    more_s: float

    @property
    def plain_per_min(self) -> float:
        """Campaigns that plain loops diagnose in a minute."""
        return 60.0 * self.campaigns / self.plain_s

    @property
    def overhead_ms(self) -> float:
        """What a worker takes more for a campaign."""
        return 1e3 * self.more_s * self.workers / self.campaigns


@dataclass(frozen=True, slots=True)
class Handed:
    """Campaigns handed to two workers that have the answer ready: all but the diagnosis.

    Attributes:
        place: `processes` or `cluster`.
        campaigns: How many there were.
        touches: Of a campaign.
        each_ms: Time of each.
    """

    place: str
    campaigns: int
    touches: int
    each_ms: float


@dataclass(frozen=True, slots=True)
class Killed:
    """Campaigns on a cluster whose workers were killed.

    Attributes:
        campaigns: How many were diagnosed.
        touches: Of a campaign.
        every_s: How often a worker was killed.
        kills: How many were.
        slower: The time it took, over that of as many plain loops.
        is_same: All answers are those of plain loops, byte for byte.
    """

    campaigns: int
    touches: int
    every_s: float
    kills: int
    slower: float
    is_same: bool


@dataclass(frozen=True, slots=True)
class Empty:
    """Tasks that do nothing.

    Attributes:
        place: `processes` or `cluster`.
        tasks: How many there were.
        wall_ms: Time of each.
        cpu_ms: Processor time of the command for each; of the cluster, the scheduler is in it.
    """

    place: str
    tasks: int
    wall_ms: float
    cpu_ms: float


@dataclass(frozen=True, slots=True)
class Figures:
    """All that was measured; nothing of a cluster where Dask is not installed."""

    campaigns: Sequence[Campaigns]
    killed: Killed | None
    empty: Sequence[Empty]
    handed: Sequence[Handed]

    @classmethod
    def read(cls, document: Mapping[str, Any]) -> "Figures":
        """Take them from their document."""
        killed = document["killed"]
        return cls(
            [Campaigns(**row) for row in document["campaigns"]],
            Killed(**killed) if killed else None,
            [Empty(**row) for row in document["empty"]],
            [Handed(**row) for row in document.get("handed", [])],
        )

    def or_before(self, path: Path) -> "Figures":
        """Take what was not measured from a document of before, if there is one."""
        if not path.exists():
            return self
        before = Figures.read(read_json(path))
        return Figures(
            self.campaigns or before.campaigns,
            self.killed or before.killed,
            self.empty or before.empty,
            self.handed or before.handed,
        )

    def as_json(self) -> str:
        """Give their document."""
        return json.dumps({"version": version("skiplatch"), **asdict(self)}, indent=1) + "\n"

    def as_text(self) -> str:
        """Lay them out as `make bench` prints them."""
        lines = []
        for row in self.campaigns:
            lines += [
                f"{row.campaigns} campaigns of {row.touches} touches, {_place(row)}",
                f"  plain loops     {row.plain_per_min:9.1f} campaigns/min",
                f"  of plain loops  {row.share:9.2f}   aim: at least {SHARE_AIM}",
                f"  more a campaign {row.overhead_ms:+9.0f} ms, with the start",
            ]
        for given in self.handed:
            lines += [
                f"{given.campaigns} campaigns of {given.touches} touches handed to {given.place}",
                f"  each            {given.each_ms:9.1f} ms   aim: at most {OVERHEAD_AIM_MS} ms",
            ]
        if self.killed is not None:
            same = "the same bytes" if self.killed.is_same else "OTHER BYTES"
            lines += [
                f"{_deaths(self.killed)}: {same}   aim: the same bytes",
                f"  time over plain loops {self.killed.slower:9.2f}",
            ]
        if self.empty:
            lines.append("empty tasks, cost of each")
        for task in self.empty:
            what = f"  {task.place:10} {task.tasks:7,} tasks {task.wall_ms:7.2f} ms"
            lines.append(f"{what}, {task.cpu_ms:.2f} ms of processor   aim: the same at both")
        return "\n".join(lines)


def _place(row: Campaigns) -> str:
    plural = "" if row.workers == 1 else "s"
    return f"{row.place}, {row.workers} worker{plural}"


def _deaths(killed: Killed) -> str:
    return (
        f"{killed.campaigns:,} campaigns of {killed.touches} touches, a worker killed every "
        f"{killed.every_s:g} s, {killed.kills} in all"
    )


def tables(document: Mapping[str, Any]) -> str:
    """Lay the figures out for the page."""
    figures = Figures.read(document)
    blocks = [_campaigns_table(figures.campaigns), _handed_table(figures.handed)]
    if figures.killed is not None:
        blocks.append(_killed_line(figures.killed))
    blocks += [_empty_table(figures.empty), _paper_table(figures.empty)]
    return f"Measured by version {document['version']}.\n\n" + "\n".join(blocks)


def _campaigns_table(rows: Sequence[Campaigns]) -> str:
    lines = [
        f"| {PLACES[row.place].format(row.workers)} | {row.campaigns} of {row.touches} touches "
        f"| {row.share:.2f} | {row.overhead_ms:+.0f} ms |"
        for row in rows
    ]
    heads = f"of the speed of plain loops (≥ {SHARE_AIM}) | more a campaign, with the start"
    return "\n".join([f"| workers | campaigns | {heads} |", "|---|---|---|---|", *lines, ""])


def _handed_table(rows: Sequence[Handed]) -> str:
    lines = [
        f"| {TWO[row.place]} | {row.campaigns} of {row.touches} touches "
        f"| {compact(row.each_ms, 2)} ms |"
        for row in rows
    ]
    head = f"| all but the diagnosis | campaigns | time of each (≤ {OVERHEAD_AIM_MS} ms) |"
    return "\n".join([head, "|---|---|---|", *lines, ""])


def _killed_line(killed: Killed) -> str:
    same = "all answers are" if killed.is_same else "the answers are not"
    return (
        f"{_deaths(killed)}: {same}\nthe same to the byte, in {killed.slower:.1f} times the time "
        "of two plain loops.\n"
    )


def _empty_table(rows: Sequence[Empty]) -> str:
    lines = [
        f"| {TWO[row.place]} | {row.tasks:,} "
        f"| {compact(row.wall_ms, 2)} ms | {compact(row.cpu_ms, 2)} ms |"
        for row in rows
    ]
    heads = "| empty tasks | how many | time of each | processor time of client and scheduler |"
    return "\n".join([heads, "|---|---|---|---|", *lines, ""])


def _paper_table(rows: Sequence[Empty]) -> str:
    of_cluster = [row for row in rows if row.place == "cluster"]
    if not of_cluster:
        return ""
    cost_ms = max(of_cluster, key=lambda row: row.tasks).cpu_ms
    head = (
        f"So on paper, for {PAPER_CAMPAIGNS:,} campaigns of {PAPER_CAMPAIGN_S:g} s each, "
        f"at {compact(cost_ms, 2)} ms of the scheduler for each:\n\n"
        "| workers | work | scheduler, beside it | together | of what so many could do |\n"
        "|---|---|---|---|---|\n"
    )
    return head + "\n".join(_on_paper(cost_ms)) + "\n"


def _on_paper(cost_ms: float) -> Iterator[str]:
    scheduler_s = 1e-3 * cost_ms * PAPER_CAMPAIGNS
    for workers in ON_PAPER:
        work_s = PAPER_CAMPAIGNS * PAPER_CAMPAIGN_S / workers
        together_s = max(work_s, scheduler_s)
        cells = f"{work_s:.0f} s | {scheduler_s:.0f} s | {together_s:.0f} s"
        yield f"| {workers:,} | {cells} | {100.0 * work_s / together_s:.0f} % |"


def with_tables(page: str, document: Mapping[str, Any]) -> str:
    """Give the page with the tables between its marks.

    Raises:
        ValueError: The page has no marks.
    """
    return with_part(page, tables(document), BEGIN, END)


def main() -> None:
    """Write the tables into the page."""
    argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    ).parse_args()
    page = PAGE.read_text(encoding="utf-8")
    atomic_write_text(PAGE, with_tables(page, read_json(FIGURES)))


if __name__ == "__main__":
    main()
