"""A fleet as one page of HTML, for the shop floor: rigs by weeks, and what to do next."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from itertools import pairwise

from skiplatch.fleet.changes import Change
from skiplatch.fleet.findings import Findings, growth_text, shared_text, unlike_text
from skiplatch.fleet.history import Entry, History
from skiplatch.report import glossary
from skiplatch.report.layout import render
from skiplatch.report.words import Table
from skiplatch.tables import NOTHING, compact

TEMPLATE = "fleet.html"
DIGITS, GAP_DIGITS = 3, 2
DAY = "%Y\N{NON-BREAKING HYPHEN}%m\N{NON-BREAKING HYPHEN}%d"
KEY_DIGITS = 12
WEEK = timedelta(days=7)
STEPS_UM = (1.0, 2.0, 5.0, 10.0, 20.0)
"""Where the colour of a gap changes."""
NO_GAP = ("no_gap", "undecided")
VERDICTS = {
    "no_gap": "no gap",
    "undecided": "too few touches",
    "explained": "explained",
    "partly_explained": "explained in part",
    "unknown": "unknown cause",
    None: "not diagnosed",
}
ICONS = {
    "motion": "▶",
    "probe": "●",
    "link": "◇",
    "input": "▼",
    "latch": "◆",
    "scan": "■",
    "position": "▲",
    "report": "★",
}
"""Of the stages."""
NEXT = {
    "motion": "Check the feed override, and that the approach is long enough to reach the feed.",
    "probe": "Check stylus, tip and clamping of the probe; calibrate it again.",
    "link": "Check the battery of the probe, and what stands between it and its receiver.",
    "input": "Check the filter of the input, its plug and its cable.",
    "latch": "Ask what was changed on the controller; check the load of its interrupts.",
    "scan": "Ask what was changed in the PLC; check the period and load of its task.",
    "position": "Check the axes: play, scale, and whether the machine is warm.",
    "report": "Check the load of the bus.",
}
"""What to do where the gap of a stage grew."""
NEXT_UNKNOWN = "Run skiplatch design on the newest campaign: it says which touches would tell."
NEXT_BETTER = "Nothing, if somebody repaired it. If nobody did, ask what was changed."


@dataclass(frozen=True, slots=True)
class Cell:
    """A rig in a week: its campaign with the largest gap.

    Attributes:
        mark: Class of the style: g0 to g5 by the gap, gx without one.
        row: Number of its row of facts; None without a campaign.
        gap: The gap in µm.
        stage: The guilty one, if there is a gap.
        began: Whether a change began with it.
    """

    mark: str = ""
    row: int | None = None
    gap: str = ""
    stage: str = ""
    began: bool = False


@dataclass(frozen=True, slots=True)
class Fact:
    """A campaign in words."""

    row: int
    time: str
    gap: str
    stage: str
    verdict: str
    effects: str
    key: str


@dataclass(frozen=True, slots=True)
class Rig:
    """A rig with its weeks, newest first, and its campaigns, likewise."""

    number: int
    name: str
    has_changed: bool
    cells: Sequence[Cell]
    facts: Sequence[Fact]


@dataclass(frozen=True, slots=True)
class Task:
    """What to do about a change."""

    rig: int
    name: str
    happened: str
    stage: str
    next: str


def as_html(findings: Findings, *, store: str, weeks: int) -> str:
    """Lay out a fleet.

    Args:
        findings: What was found in it.
        store: What the store is called.
        weeks: How many of the newest weeks are shown.
    """
    shown = _weeks(findings.history, weeks)
    changed = {change.rig for change in findings.recent}
    order = sorted(findings.history, key=lambda rig: (rig not in changed, rig))
    began = {(change.rig, change.began) for change in findings.changes}
    rigs = _rigs({rig: findings.history[rig] for rig in order}, shown, changed, began)
    numbers = {rig.name: rig.number for rig in rigs}
    return render(
        TEMPLATE,
        name=store,
        headline=_headline(len(changed), len(rigs)),
        lead=_lead(findings),
        weeks=shown,
        rigs=rigs,
        tasks=[_task(change, numbers[change.rig]) for change in findings.recent],
        shared=[shared_text(shared) for shared in findings.shared],
        unlike=[unlike_text(unlike) for unlike in findings.unlike],
        steps=_steps(),
        icons=ICONS,
        stages=Table(("Stage", "If its gap grew"), list(NEXT.items())),
        glossary=glossary.words("effect", "gap", "latch", "scan", "PLC task", "95 % interval"),
    )


def _headline(changed: int, rigs: int) -> str:
    if changed == 0:
        return "No rig has changed"
    return f"{changed} of {rigs} rigs {'has' if changed == 1 else 'have'} changed"


def _lead(findings: Findings) -> str:
    newest = max(entries[-1].time for entries in findings.history.values())
    words = f"{len(findings.history)} rigs, as of {newest:%Y-%m-%d}."
    if findings.undiagnosed:
        words += f" {findings.undiagnosed} campaigns are not diagnosed: nothing is known of them."
    return words


def _weeks(history: History, most: int) -> list[date]:
    """Give the Mondays of the newest weeks, newest first."""
    times = [entry.time for entries in history.values() for entry in entries]
    first, last = _monday(min(times)), _monday(max(times))
    count = min((last - first) // WEEK + 1, most)
    return [last - back * WEEK for back in range(count)]


def _monday(time: datetime) -> date:
    return time.date() - timedelta(days=time.weekday())


def _rigs(
    history: History,
    weeks: Sequence[date],
    changed: set[str],
    began: set[tuple[str, datetime]],
) -> list[Rig]:
    rigs, row = [], 0
    for number, (name, entries) in enumerate(history.items()):
        newest = [one for one in reversed(entries) if _monday(one.time) >= weeks[-1]]
        rows = {one.campaign: row + place for place, one in enumerate(newest)}
        row += len(newest)
        by_week = _worst(newest)
        starts = {time for rig, time in began if rig == name}
        cells = [_cell(by_week.get(week), rows, starts) for week in weeks]
        facts = [_fact(one, rows[one.campaign]) for one in newest]
        rigs.append(Rig(number, name, name in changed, cells, facts))
    return rigs


def _worst(entries: Iterable[Entry]) -> dict[date, Entry]:
    """Give the campaign of each week with the largest gap."""
    found: dict[date, Entry] = {}
    for entry in entries:
        week = _monday(entry.time)
        if week not in found or (entry.gap_um or 0.0) > (found[week].gap_um or 0.0):
            found[week] = entry
    return found


def _cell(entry: Entry | None, rows: dict[str, int], began: set[datetime]) -> Cell:
    if entry is None:
        return Cell()
    return Cell(
        mark=_mark(entry.gap_um),
        row=rows[entry.campaign],
        gap=_gap(entry),
        stage=_guilty(entry),
        began=entry.time in began,
    )


def _mark(gap_um: float | None) -> str:
    return "gx" if gap_um is None else f"g{sum(gap_um >= step for step in STEPS_UM)}"


def _gap(entry: Entry) -> str:
    if entry.gap_um is not None:
        return compact(entry.gap_um, GAP_DIGITS)
    return "?" if entry.verdict is None else NOTHING


def _guilty(entry: Entry) -> str:
    return entry.stage or "" if entry.verdict not in NO_GAP else ""


def _fact(entry: Entry, row: int) -> Fact:
    parameters = (
        f"{one.effect}.{one.name} = {compact(one.value, DIGITS)} "
        f"({compact(one.low, DIGITS)} … {compact(one.high, DIGITS)})"
        for one in entry.parameters
    )
    return Fact(
        row=row,
        time=f"{entry.time:%Y-%m-%d %H:%M}",
        gap=_gap(entry),
        stage=_guilty(entry),
        verdict=VERDICTS.get(entry.verdict, str(entry.verdict)),
        effects="; ".join(parameters),
        key=entry.campaign[:KEY_DIGITS],
    )


def _task(change: Change, rig: int) -> Task:
    before, after = (compact(gap, GAP_DIGITS) for gap in (change.before, change.after))
    way = "grew" if change.is_worse else "shrank"
    words = (
        f"Its {change.observable} gap {way} from {before} to {after} {change.unit}, "
        f"some time between {change.last_before:{DAY}} and {change.began:{DAY}}."
    )
    if growth := growth_text(change):
        words += f" {growth}."
    stage = change.stage or ""
    what = NEXT.get(stage, NEXT_UNKNOWN) if change.is_worse else NEXT_BETTER
    return Task(rig, change.rig, words, stage, what)


def _steps() -> list[str]:
    """Say which gaps a colour stands for."""
    first, last = f"below {STEPS_UM[0]:g}", f"from {STEPS_UM[-1]:g}"
    middle = [f"{low:g} … {high:g}" for low, high in pairwise(STEPS_UM)]
    return [first, *middle, last]
