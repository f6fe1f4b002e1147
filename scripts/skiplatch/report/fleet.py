"""A fleet as one page of HTML, for the shop floor: rigs by weeks, and what to do next."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from itertools import pairwise

from skiplatch.fleet.changes import Change
from skiplatch.fleet.findings import (
    Findings,
    details,
    left_out_text,
    moved_text,
    shared_text,
    unlike_text,
)
from skiplatch.fleet.history import Entry, History, Parameter
from skiplatch.fleet.layout import KEY_DIGITS
from skiplatch.report import glossary
from skiplatch.report.layout import Table, render
from skiplatch.tables import NOTHING, compact, counted
from skiplatch.ways import ARCSEC, LENGTH, Ways

TEMPLATE = "fleet.html"
DIGITS, GAP_DIGITS = 3, 2
DAY = "%Y\N{NON-BREAKING HYPHEN}%m\N{NON-BREAKING HYPHEN}%d"
WEEK = timedelta(days=7)
STEPS_UM, STEPS_ARCSEC = (1.0, 2.0, 5.0, 10.0, 20.0), (3.0, 6.0, 15.0, 30.0, 60.0)
"""Where the colour of a gap changes: 3″ are 1 µm some 70 mm from the axis."""
UNITS = {Ways.LINEAR: [LENGTH], Ways.ROTARY: [ARCSEC], Ways.MIXED: [LENGTH, ARCSEC]}
"""In which gaps are, by what the axes of all rigs do."""
UNIT_WORDS = {
    Ways.LINEAR: "µm",
    Ways.ROTARY: "arcsec (″)",
    Ways.MIXED: "µm, of rotary axes in arcsec (″)",
}
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
        gap: The gap in µm, or in arcsec with its sign.
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
    rigs = _rigs({rig: findings.history[rig] for rig in order}, shown, began)
    numbers = {rig.name: rig.number for rig in rigs}
    ways = _ways(findings.history)
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
        unit=UNIT_WORDS[ways],
        legends=[(unit, _ranges(_steps(unit))) for unit in UNITS[ways]],
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
    words = f"{counted(findings.rigs, 'rig')}, as of {newest:%Y-%m-%d}."
    if left := left_out_text(findings):
        words += f" {left}: nothing is told of them."
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
        rigs.append(Rig(number, name, cells, facts))
    return rigs


def _worst(entries: Iterable[Entry]) -> dict[date, Entry]:
    """Give the campaign of each week with the largest gap."""
    found: dict[date, Entry] = {}
    for entry in entries:
        week = _monday(entry.time)
        if week not in found or _severity(entry) > _severity(found[week]):
            found[week] = entry
    return found


def _cell(entry: Entry | None, rows: dict[str, int], began: set[datetime]) -> Cell:
    if entry is None:
        return Cell()
    return Cell(
        mark=_mark(entry),
        row=rows[entry.campaign],
        gap=_gap(entry, is_short=True),
        stage=_guilty(entry),
        began=entry.time in began,
    )


def _severity(entry: Entry) -> float:
    """Give the gap by the first step of its unit, to tell which of several is the largest."""
    if entry.gap is None:
        return 0.0
    size, unit = entry.gap
    return size / _steps(unit)[0]


def _steps(unit: str) -> tuple[float, ...]:
    return STEPS_ARCSEC if unit == ARCSEC else STEPS_UM


def _mark(entry: Entry) -> str:
    if entry.gap is None:
        return "gx"
    size, unit = entry.gap
    return f"g{sum(size >= step for step in _steps(unit))}"


def _gap(entry: Entry, *, is_short: bool) -> str:
    """Give the gap with its unit, in short the sign of arcsec alone; or what stands for no gap."""
    if entry.gap is None:
        return "?" if entry.verdict is None else NOTHING
    size, unit = entry.gap
    text = compact(size, GAP_DIGITS)
    if is_short:
        return f"{text}″" if unit == ARCSEC else text
    return f"{text} {unit}"


def _guilty(entry: Entry) -> str:
    return entry.stage or "" if entry.verdict not in NO_GAP else ""


def _fact(entry: Entry, row: int) -> Fact:
    return Fact(
        row=row,
        time=f"{entry.time:%Y-%m-%d %H:%M}",
        gap=_gap(entry, is_short=False),
        stage=_guilty(entry),
        verdict=VERDICTS.get(entry.verdict, str(entry.verdict)),
        effects="; ".join(map(_parameter, entry.parameters)),
        key=entry.campaign[:KEY_DIGITS],
    )


def _parameter(one: Parameter) -> str:
    value, low, high = (compact(number, DIGITS) for number in (one.value, one.low, one.high))
    unit = f" {one.turned}" if one.turned else ""
    return f"{one.effect}.{one.name} = {value} ({low} … {high}){unit}"


def _task(change: Change, rig: int) -> Task:
    began = "some time between" if change.rate is None else "beginning some time between"
    words = (
        f"Its {moved_text(change, GAP_DIGITS)}, "
        f"{began} {change.last_before:{DAY}} and {change.began:{DAY}}"
    )
    words = "; ".join([words, *details(change)]) + "."
    stage = change.stage or ""
    what = NEXT.get(stage, NEXT_UNKNOWN) if change.is_worse != change.is_over else NEXT_BETTER
    return Task(rig, change.rig, words, stage, what)


def _ways(history: History) -> Ways:
    found = {Ways(entry.axes) for entries in history.values() for entry in entries}
    return found.pop() if len(found) == 1 else Ways.MIXED


def _ranges(steps: Sequence[float]) -> list[str]:
    """Say which gaps a colour stands for."""
    first, last = f"below {steps[0]:g}", f"from {steps[-1]:g}"
    middle = [f"{low:g} … {high:g}" for low, high in pairwise(steps)]
    return [first, *middle, last]
