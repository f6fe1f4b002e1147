"""What has changed on a rig, when it began, and which effect grew."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from statistics import median

import numpy as np

from skiplatch.fleet import budget, chart
from skiplatch.fleet.growth import Growth, grown
from skiplatch.fleet.history import Entry, Gap, History

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
        """When it was seen, or that it is over."""
        return (self.back.seen if self.back else None) or self.seen


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
    for shift in chart.shifts(values, budget.levels(times, charts, alarms_a_month)):
        old = slice(shift.start, shift.began)
        new = slice(shift.began, shift.end)
        before, after = level(gaps[old]), level(gaps[new])
        if abs(after - before) < median(gap.noise_floor for gap in gaps[old]):
            continue  # less than what a single diagnosis can tell is no reason to walk to a rig
        growth = grown(series[old], series[new])
        yield Change(
            rig=rig,
            observable=observable,
            unit=gaps[0].unit,
            before=before,
            after=after,
            last_before=times[shift.began - 1],
            began=times[shift.began],
            seen=times[shift.seen],
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
