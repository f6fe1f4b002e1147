"""What `fleet check` and the page say of a fleet, found once."""

from dataclasses import asdict, dataclass
from datetime import timedelta
from typing import Any

from skiplatch.fleet.alike import SharedCause, Unlike, shared_causes, unlike_others
from skiplatch.fleet.changes import Change, find_changes
from skiplatch.fleet.history import Entry, History
from skiplatch.tables import compact

SHOWN_DIGITS = 3


@dataclass(frozen=True, slots=True)
class Findings:
    """A fleet and what is found in it.

    Attributes:
        history: All campaigns.
        changes: Of all time, in the order in which they were seen.
        recent: Those seen lately.
        shared: Causes of several changes of all time.
        unlike: Rigs unlike the others now.
        alarms_a_month: False alarms that are expected of the whole fleet in a month, at most.
    """

    history: History
    changes: list[Change]
    recent: list[Change]
    shared: list[SharedCause]
    unlike: list[Unlike]
    alarms_a_month: float

    @property
    def undiagnosed(self) -> int:
        """Campaigns without a diagnosis, which nothing is said of."""
        return sum(entry.verdict is None for entries in self.history.values() for entry in entries)


def find(history: History, *, days: float, alarms_a_month: float) -> Findings:
    """Look for changes, shared causes and unlike rigs.

    Args:
        history: All campaigns.
        days: How long before the newest campaign of the fleet a change is seen lately.
        alarms_a_month: False alarms that may be expected of the whole fleet in a month.
    """
    changes = find_changes(history, alarms_a_month)
    newest = max(entries[-1].time for entries in history.values())
    recent = [change for change in changes if newest - change.seen <= timedelta(days=days)]
    return Findings(
        history, changes, recent, shared_causes(changes), unlike_others(history), alarms_a_month
    )


def change_text(change: Change) -> str:
    """Say a change in one line."""
    before, after = (compact(gap, SHOWN_DIGITS) for gap in (change.before, change.after))
    way = "grew" if change.is_worse else "shrank"
    words = [
        f"{change.rig}: {change.observable} gap {way} from {before} to {after} {change.unit}",
        f"began {change.last_before:%Y-%m-%d} … {change.began:%Y-%m-%d}",
        f"seen {change.seen:%Y-%m-%d}",
    ]
    if change.growth:
        words.append(f"{change.stage} stage, {growth_text(change)}")
    elif change.stage:
        words.append(f"{change.stage} stage")
    return "; ".join(words)


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
    rigs, days = ", ".join(shared.rigs), (shared.last - shared.first).days
    return f"{shared.effect} ({shared.stage} stage) grew on {rigs}, within {days} days"


def unlike_text(unlike: Unlike) -> str:
    """Say in one line what a rig has that others have not."""
    gap, usual = (compact(value, SHOWN_DIGITS) for value in (unlike.gap, unlike.usual))
    unit = unlike.unit
    return f"{unlike.rig}: {unlike.observable} gap {gap} {unit}, usual is {usual} {unit}"


def as_json(findings: Findings) -> dict[str, Any]:
    """Give all of it as mappings and lists; times are still times."""
    return {
        "format": "skiplatch-fleet-check/1",
        "rigs": len(findings.history),
        "campaigns": sum(map(len, findings.history.values())),
        "undiagnosed": findings.undiagnosed,
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
