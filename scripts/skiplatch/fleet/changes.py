"""What has changed on a rig, when it began, and which effect grew."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from statistics import median

import numpy as np

from skiplatch.fleet import budget, chart
from skiplatch.fleet.drift import drift
from skiplatch.fleet.growth import Growth, grown
from skiplatch.fleet.history import Entry, Gap, History
from skiplatch.statistics import Interval

FINEST = 1e-6
"""In µm or µs: finer than anything is recorded, so that the logarithm has a value."""


@dataclass(frozen=True, slots=True)
class Back:
    """A change did not last: the gap went back, all the way or in part.

    Attributes:
        gap: What it is since then.
        since: Time of the first campaign with it, UTC.
        campaigns: From that one on, to the next change.
        seen: Time of the campaign with which it was found; None where there are too few to tell.
    """

    gap: float
    since: datetime
    campaigns: int
    seen: datetime | None


@dataclass(frozen=True, slots=True)
class Change:
    """A rig's gap has changed.

    Attributes:
        rig: Its name.
        observable: The one whose gap showed it first.
        unit: Of the gap.
        before: The gap before: exp of the mean of its logarithm.
        after: The gap after it, as long as it lasted.
        last_before: Time of the last campaign before the change, UTC.
        began: Time of the first one after it.
        seen: Time of the campaign with which it was found.
        campaigns: From the first after the change to that one.
        stage: Where it acts; None if no diagnosis says so.
        growth: The effect's parameter that changed most; None if none changed clearly.
        back: Whether it was over after a few campaigns, or seems to be by the newest ones.
        newest: The gap of the newest campaign: after a drift it is not that of the mean.
        rate: By how much the gap moves in a month, if it does so steadily and not in steps. Then
            it may have begun at any time between the two dates.
        confirmed: Time of the campaign with which it was last found to move on.
        ended: Time of the campaign with which it stood still; None if it goes on.
    """

    rig: str
    observable: str
    unit: str
    before: float
    after: float
    last_before: datetime
    began: datetime
    seen: datetime
    campaigns: int
    stage: str | None
    growth: Growth | None
    back: Back | None = None
    newest: float | None = None
    rate: Interval | None = None
    confirmed: datetime | None = None
    ended: datetime | None = None

    @property
    def is_worse(self) -> bool:
        """Whether the gap grew."""
        return self.after > self.before

    @property
    def is_over(self) -> bool:
        """Whether it was found that the gap went back."""
        return self.back is not None and self.back.seen is not None

    @property
    def news(self) -> datetime:
        """When it was seen, or that it goes on, or that it is over."""
        return (self.back.seen if self.back else None) or self.confirmed or self.seen


def find_changes(history: History, alarms_a_month: float = budget.ALARMS_A_MONTH) -> list[Change]:
    """Find the changes of all rigs, in the order in which they are seen.

    What several observables of a rig show from one campaign on is one change, told by the
    observable that shows it first.
    """
    watched = {
        rig: {name: _series(entries, name) for name in _observables(entries)}
        for rig, entries in history.items()
    }
    charts = sum(map(len, watched.values()))
    found: list[Change] = []
    for rig, charted in watched.items():
        single = [
            change
            for name, series in charted.items()
            for change in _changes(rig, name, series, charts, alarms_a_month)
        ]
        found += _joined(single)
    return sorted(found, key=lambda change: (change.seen, change.rig))


def _observables(entries: Sequence[Entry]) -> list[str]:
    return sorted({name for entry in entries for name in entry.gaps})


def _series(entries: Sequence[Entry], observable: str) -> list[Entry]:
    return [entry for entry in entries if observable in entry.gaps]


def _changes(
    rig: str, observable: str, series: Sequence[Entry], charts: int, alarms_a_month: float
) -> Iterator[Change]:
    gaps = [entry.gaps[observable] for entry in series]
    times = [entry.time for entry in series]
    values = np.array([started_log(gap) for gap in gaps])
    found = chart.shifts(values, budget.levels(times, charts, alarms_a_month))
    for run in _runs(values, found):
        for shift, change in _told(rig, observable, series, run):
            old = gaps[shift.start : shift.began]
            if abs(change.after - change.before) >= median(gap.noise_floor for gap in old):
                yield change  # less is nothing that a single diagnosis can tell


def _runs(values: np.ndarray, found: Sequence[chart.Shift]) -> list[list[chart.Shift]]:
    """Put together the shifts that follow each other in one direction."""
    runs: list[list[chart.Shift]] = []
    for shift in found:
        last = runs[-1][-1] if runs else None
        if last and last.end == shift.began and _is_up(values, last) == _is_up(values, shift):
            runs[-1].append(shift)
        else:
            runs.append([shift])
    return runs


def _is_up(values: np.ndarray, shift: chart.Shift) -> bool:
    after, before = values[shift.began : shift.end], values[shift.start : shift.began]
    return bool(after.mean() > before.mean())


def _told(
    rig: str, observable: str, series: Sequence[Entry], run: Sequence[chart.Shift]
) -> Iterator[tuple[chart.Shift, Change]]:
    """Give what a run of shifts is: one steady drift, or each of them a step."""
    first, last = run[0], run[-1]
    part = series[first.start : last.end]
    steady = drift(
        [entry.time for entry in part],
        np.array([entry.gaps[observable].before for entry in part]),
        [shift.began - first.start for shift in run],
        first.seen - first.start,
    )
    if steady is None:
        for shift in run:
            yield shift, _change(rig, observable, series, shift, shift.began)
        return
    whole = replace(last, start=first.start, began=first.start + steady.latest + 1, seen=first.seen)
    change = _change(rig, observable, series, whole, last.began)
    yield (
        whole,
        replace(
            change,
            before=max(steady.before, 0.0),
            after=max(steady.after, 0.0),
            last_before=part[steady.earliest].time,
            rate=steady.rate,
            confirmed=series[last.seen].time,
            ended=None if steady.end is None else part[steady.end].time,
        ),
    )


def _change(
    rig: str, observable: str, series: Sequence[Entry], shift: chart.Shift, newest: int
) -> Change:
    """Give a change; `newest` is where the campaigns begin whose parameters are those after it."""
    gaps = [entry.gaps[observable] for entry in series]
    old, new = slice(shift.start, shift.began), slice(newest, shift.end)
    growth = grown(series[old], series[new])
    return Change(
        rig=rig,
        observable=observable,
        unit=gaps[0].unit,
        before=level(gaps[old]),
        after=level(gaps[new]),
        last_before=series[shift.began - 1].time,
        began=series[shift.began].time,
        seen=series[shift.seen].time,
        campaigns=shift.seen - shift.began + 1,
        stage=growth.stage if growth else _stage([*series[new], *series[old]]),
        growth=growth,
        back=_back(series, observable, shift),
        newest=gaps[-1].before,
    )


def _back(series: Sequence[Entry], observable: str, shift: chart.Shift) -> Back | None:
    entries = series[shift.end : shift.until]
    if not entries:
        return None
    seen = None if shift.back_seen is None else series[shift.back_seen].time
    gap = level([entry.gaps[observable] for entry in entries])
    return Back(gap, entries[0].time, len(entries), seen)


def started_log(gap: Gap) -> float:
    """Give the logarithm of a gap and its noise floor.

    So scatter that goes with the gap is the same everywhere, and a gap within the noise is near
    to none.
    """
    return float(np.log(max(gap.before + gap.noise_floor, FINEST)))


def level(gaps: Sequence[Gap]) -> float:
    """Give the gap that stands for several, in their unit; see `started_log`."""
    mean = float(np.exp(np.mean([started_log(gap) for gap in gaps])))
    return max(mean - median(gap.noise_floor for gap in gaps), 0.0)


def _stage(entries: Sequence[Entry]) -> str | None:
    return next((entry.stage for entry in entries if entry.stage), None)


def _joined(found: Sequence[Change]) -> list[Change]:
    """Leave out what another observable told before: it began before that was seen."""
    told: list[Change] = []
    for change in sorted(found, key=lambda change: (change.seen, -_factor(change))):
        if not told or change.began > told[-1].seen:
            told.append(change)
    return told


def _factor(change: Change) -> float:
    """Give the logarithm of the factor by which a gap changed, which has no unit."""
    return abs(float(np.log((change.after + FINEST) / (change.before + FINEST))))
