"""What `fleet check` and the page say of a fleet, found once."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import datetime, timedelta
from typing import Any

from skiplatch.fleet import clock
from skiplatch.fleet.alike import SharedCause, Unlike, shared_causes, unlike_others
from skiplatch.fleet.changes import Change, find_changes
from skiplatch.fleet.chart import FEWEST
from skiplatch.fleet.history import Entry, History
from skiplatch.tables import compact, counted

SHOWN_DIGITS = 3
MOST_NAMED = 10
"""Rigs in one line; the JSON names all."""


@dataclass(frozen=True, slots=True)
class Findings:
    """A fleet and what is found in it.

    Attributes:
        history: All campaigns, but for those that are still to come on a few of the rigs.
        changes: Of all time, in the order in which they were seen.
        recent: Those seen lately, or of which it was seen lately that they are over.
        shared: Causes of several changes seen lately.
        unlike: Rigs unlike the others now.
        alarms_a_month: False alarms that are expected of the whole fleet in a month, at most.
        to_come: Campaigns that are left out, as by the clock of this machine they are to come.
        unjudged: Rigs on which no change could have been found, and why.
        rigs: Number of all rigs, also of those with nothing but campaigns that are to come.
    """

    history: History
    changes: list[Change]
    recent: list[Change]
    shared: list[SharedCause]
    unlike: list[Unlike]
    alarms_a_month: float
    to_come: int = 0
    unjudged: Mapping[str, str] = field(default_factory=dict)
    rigs: int = 0

    @property
    def undiagnosed(self) -> int:
        """Campaigns without a diagnosis, which nothing is said of."""
        return sum(entry.verdict is None for entries in self.history.values() for entry in entries)


def find(history: History, *, days: float, alarms_a_month: float) -> Findings:
    """Look for changes, shared causes and unlike rigs.

    Args:
        history: All campaigns.
        days: How long before the newest diagnosed campaign of the fleet a change is seen lately.
        alarms_a_month: False alarms that may be expected of the whole fleet in a month.
    """
    now = clock.now()
    past = _past(history, now)
    changes = find_changes(past, alarms_a_month)
    since = _newest_diagnosed(past, now) - timedelta(days=days)
    recent = [change for change in changes if change.news >= since]
    to_come = _count(history) - _count(past)
    return Findings(
        *(past, changes, recent, shared_causes(recent), unlike_others(past)),
        alarms_a_month=alarms_a_month,
        to_come=to_come,
        unjudged=_unjudged(history, past),
        rigs=len(history),
    )


def _unjudged(history: History, past: History) -> dict[str, str]:
    """Give the rigs that have too little for a change to be found, and what they lack."""
    found = {}
    for rig in history:
        charted = Counter(name for entry in past.get(rig, ()) for name in entry.gaps)
        if rig not in past:
            found[rig] = "all campaigns are later than the clock of this machine"
        elif not charted:
            found[rig] = "no campaign has a diagnosis"
        elif max(charted.values()) < FEWEST:
            found[rig] = f"fewer than {FEWEST} campaigns have a diagnosis"
    return found


def _past(history: History, now: datetime) -> History:
    """Leave out what is still to come, even if a store says its local time.

    Where half of the rigs have such campaigns the clock of this machine is the wrong one.
    """
    latest = now + clock.EASTERNMOST
    kept = {
        rig: [entry for entry in entries if entry.time <= latest]
        for rig, entries in history.items()
    }
    ahead = sum(len(entries) > len(kept[rig]) for rig, entries in history.items())
    if 2 * ahead >= len(history):
        return history
    return {rig: entries for rig, entries in kept.items() if entries}


def _newest_diagnosed(history: History, otherwise: datetime) -> datetime:
    """Give the newest time of which something is known: what nobody diagnosed has no changes."""
    times = [
        entry.time for entries in history.values() for entry in entries if entry.verdict is not None
    ]
    return max(times, default=otherwise)


def _count(history: History) -> int:
    return sum(map(len, history.values()))


def left_out_text(findings: Findings) -> str:
    """Say of how many campaigns nothing is said, and why; nothing if there are none."""
    reasons = {
        "not diagnosed": findings.undiagnosed,
        "later than the clock of this machine": findings.to_come,
    }
    said = [
        f"{counted(number, 'campaign')} {'is' if number == 1 else 'are'} {reason}"
        for reason, number in reasons.items()
        if number
    ]
    if number := len(findings.unjudged):
        said.append(f"{counted(number, 'rig')} {'is' if number == 1 else 'are'} not judged")
    return "; ".join(said)


def unjudged_texts(findings: Findings) -> list[str]:
    """Name the rigs on which no change could have been found, a line for each reason."""
    by_reason: dict[str, list[str]] = {}
    for rig, reason in findings.unjudged.items():
        by_reason.setdefault(reason, []).append(rig)
    return [f"{reason}: {_some(rigs)}" for reason, rigs in by_reason.items()]


def _some(rigs: Sequence[str]) -> str:
    more = len(rigs) - MOST_NAMED
    return ", ".join(rigs[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def change_text(change: Change) -> str:
    """Say a change in one line."""
    words = [
        f"{change.rig}: {moved_text(change, SHOWN_DIGITS)}",
        f"began {change.last_before:%Y-%m-%d} … {change.began:%Y-%m-%d}",
        f"seen {change.seen:%Y-%m-%d}",
    ]
    words += filter(None, [_back_text(change), _now_text(change)])
    if change.growth:
        words.append(f"{change.stage} stage, {growth_text(change)}")
    elif change.stage:
        words.append(f"{change.stage} stage")
    return "; ".join(words)


def moved_text(change: Change, digits: int) -> str:
    """Say how a gap moved, in steps or steadily."""
    before, after = (compact(gap, digits) for gap in (change.before, change.after))
    way = "grew" if change.is_worse else "shrank"
    return (
        f"{change.observable} gap {way}{_rate_text(change)} from {before} to {after} {change.unit}"
    )


def _rate_text(change: Change) -> str:
    if change.rate is None:
        return ""
    ends = sorted((abs(change.rate.low), abs(change.rate.high)))
    rate, low, high = (compact(one, SHOWN_DIGITS) for one in (abs(change.rate.value), *ends))
    until = f" until {change.ended:%Y-%m-%d}" if change.ended else ""
    return f" steadily{until}, by {rate} ({low} … {high}) {change.unit} a month,"


def details(change: Change) -> list[str]:
    """Say what is known beyond the change itself: whether it is over, and which effect grew."""
    return [text for text in (_back_text(change), _now_text(change), growth_text(change)) if text]


def _now_text(change: Change) -> str:
    if change.newest is None or change.back is not None:  # the way back tells what it is now
        return ""
    return f"now {_in_unit(change, change.newest)}"


def _in_unit(change: Change, gap: float) -> str:
    return f"{compact(gap, SHOWN_DIGITS)} {change.unit}"


def _back_text(change: Change) -> str:
    if change.back is None:
        return ""
    words = f"{_in_unit(change, change.back.gap)} since {change.back.since:%Y-%m-%d}"
    if change.back.seen is None:
        words += f", by {counted(change.back.campaigns, 'campaign')}, too few to be sure"
    return f"back to {words}"


def growth_text(change: Change) -> str:
    """Say which parameter of which effect changed; nothing if none did clearly."""
    growth = change.growth
    if growth is None:
        return ""
    before, after, low, high = (
        compact(value, SHOWN_DIGITS)
        for value in (growth.before.value, growth.after.value, growth.after.low, growth.after.high)
    )
    unit = f" {growth.turned}" if growth.turned else ""
    return f"{growth.effect}.{growth.parameter} {before} → {after} ({low} … {high}){unit}"


def shared_text(shared: SharedCause) -> str:
    """Say a shared cause in one line."""
    rigs, days = ", ".join(shared.rigs), counted((shared.last - shared.first).days, "day")
    return f"{shared.effect} ({shared.stage} stage) grew on {rigs}, began within {days}"


def unlike_text(unlike: Unlike) -> str:
    """Say in one line what a rig has that others have not."""
    gap, usual = (compact(value, SHOWN_DIGITS) for value in (unlike.gap, unlike.usual))
    unit = unlike.unit
    return f"{unlike.rig}: {unlike.observable} gap {gap} {unit}, usual is {usual} {unit}"


def as_json(findings: Findings) -> dict[str, Any]:
    """Give all of it as mappings and lists; times are still times."""
    return {
        "format": "skiplatch-fleet-check/1",
        "rigs": findings.rigs,
        "campaigns": _count(findings.history),
        "undiagnosed": findings.undiagnosed,
        "later_than_clock": findings.to_come,
        "not_judged": [{"rig": rig, "why": why} for rig, why in findings.unjudged.items()],
        "alarms_a_month": findings.alarms_a_month,
        "changed": [_change_json(change, findings.history) for change in findings.recent],
        "earlier": [
            _change_json(change, findings.history)
            for change in findings.changes
            if change not in findings.recent
        ],
        "shared_causes": [asdict(shared) for shared in findings.shared],
        "unlike": [asdict(unlike) for unlike in findings.unlike],
    }


def _change_json(change: Change, history: History) -> dict[str, Any]:
    growth = change.growth
    key = (growth.effect, growth.parameter) if growth else None
    return {**asdict(change), "course": _course(history[change.rig], key)}


def _course(entries: list[Entry], key: tuple[str, str] | None) -> list[dict[str, Any]]:
    """Give a parameter against time, where a diagnosis named its effect."""
    return [
        {"time": entry.time, "value": one.value, "low": one.low, "high": one.high}
        for entry in entries
        for one in entry.parameters
        if one.key == key
    ]
