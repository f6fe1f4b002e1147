"""What an effect changes in the physics: a delay, a position, an extra that some touches get."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.density.law import Extra
from skiplatch.span import Span

Number = FloatArray | float
Gaps = tuple[tuple[float, float], ...]
"""Shares of the edges that fall into gaps between scans, with how long these are in periods."""
MOST_GAPS = 12
"""Lengths of gaps that are told apart."""


@dataclass(frozen=True, slots=True)
class Wait:
    """How long edges wait for a scan where the two are bound to each other.

    Attributes:
        points: Waits that they fall about, as shares of the period, and what share falls there.
        spread: Standard deviation about each, as a share of the period.
        unlocked: Share of the touches that wait anyhow.
    """

    points: tuple[tuple[float, float], ...]
    spread: float
    unlocked: float


@dataclass(frozen=True, slots=True)
class Change:
    """The physics that differs from the nominal chain; arrays of shape (n,), or numbers."""

    contact_us: Number = 0.0
    """By how much the contact comes later."""
    surface_um: Number = 0.0
    """By how much farther the surface lies: it is met later by the way to it at the real speed."""
    speed_ratio: Number = 1.0
    """Real over believed speed at the contact."""
    pretravel_um: Number = 0.0
    pin_us: Number = 0.0
    """Later at the pin, on both paths."""
    skip_us: Number = 0.0
    plc_us: Number = 0.0
    period_us: float = 0.0
    """Added to the scan period."""
    wait: Wait | None = None
    stamp_us: Number = 0.0
    """Added to the stamp alone."""
    position_um: Number = 0.0
    position_us: Number = 0.0
    """Added to the position as well: the way in this time, at the real speed."""
    position_box_us: Number = 0.0
    """Width of a box by which the time of the position is scattered further, from 0 up."""
    position_sigma_us: Number = 0.0
    """Standard deviation by which it is scattered further."""
    position_extra: tuple[Extra, ...] = ()
    coarse_um: float = 0.0
    """Resolution of the position, if coarser than believed."""
    line_um: Number = 0.0
    """The deviation at a line of the coarse position, 0 of a coarse distance; NaN if not known."""
    coarse_us: float = 0.0
    """Tick of the skip path's stamps, if coarser than believed."""
    tick_line_us: float = 0.0
    """A stamp at such a tick, 0 where coarse and believed ticks have the same origin."""
    slots: tuple[float, float] | None = None
    """Period and phase in µs of the slots in which triggers arrive, on a clock without drift."""
    report_us: Number = 0.0
    pin_extra: tuple[Extra, ...] = ()
    skip_extra: tuple[Extra, ...] = ()
    lattice_extra: tuple[Extra, ...] = ()
    """Stamps of scans that begin late."""
    scan_extra: tuple[Extra, ...] = ()
    """What is added to the wait for a scan."""
    gaps: Gaps = ()
    """Gaps between scans that are not one period long."""
    report_extra: tuple[Extra, ...] = ()
    lost: float = 0.0
    """Share of touches that are never seen."""
    slack: float = 0.0
    """What scatter a shift brings along, as a share of its root mean square: no real effect has
    just the form that is fitted."""
    passing: tuple[tuple[Span, "Change"], ...] = ()
    """What differs besides, for some touches only."""

    def at_times(self, touch: NDArray[np.integer]) -> Iterator[tuple[BoolArray, "Change"]]:
        """Give all that differs, with the touches, a mask of shape (n,), for which it does.

        Args:
            touch: Their numbers; shape (n,).
        """
        parts = [(np.full(len(touch), fill_value=True), replace(self, passing=()))]
        for span, change in self.passing:
            acts = span.holds(touch)
            parts = [
                half
                for rows, there in parts
                for half in ((rows & ~acts, there), (rows & acts, there.joined(change)))
            ]
        yield from (part for part in parts if part[0].any())

    def joined(self, other: "Change") -> "Change":
        """Give both changes together."""
        if self is NOTHING or other is NOTHING:
            return other if self is NOTHING else self
        return Change(
            contact_us=self.contact_us + other.contact_us,
            surface_um=self.surface_um + other.surface_um,
            speed_ratio=self.speed_ratio * other.speed_ratio,
            pretravel_um=self.pretravel_um + other.pretravel_um,
            pin_us=self.pin_us + other.pin_us,
            skip_us=self.skip_us + other.skip_us,
            plc_us=self.plc_us + other.plc_us,
            period_us=self.period_us + other.period_us,
            wait=self.wait or other.wait,
            stamp_us=self.stamp_us + other.stamp_us,
            position_um=self.position_um + other.position_um,
            position_us=self.position_us + other.position_us,
            position_box_us=self.position_box_us + other.position_box_us,
            position_sigma_us=np.hypot(self.position_sigma_us, other.position_sigma_us),
            position_extra=both(self.position_extra, other.position_extra),
            coarse_um=max(self.coarse_um, other.coarse_um),
            line_um=self.line_um if self.coarse_um >= other.coarse_um else other.line_um,
            coarse_us=max(self.coarse_us, other.coarse_us),
            tick_line_us=(
                self.tick_line_us if self.coarse_us >= other.coarse_us else other.tick_line_us
            ),
            slots=self.slots or other.slots,
            report_us=self.report_us + other.report_us,
            pin_extra=both(self.pin_extra, other.pin_extra),
            skip_extra=both(self.skip_extra, other.skip_extra),
            lattice_extra=both(self.lattice_extra, other.lattice_extra),
            scan_extra=both(self.scan_extra, other.scan_extra),
            gaps=gaps_of_both(self.gaps, other.gaps),
            report_extra=both(self.report_extra, other.report_extra),
            slack=max(self.slack, other.slack),
            lost=1.0 - (1.0 - self.lost) * (1.0 - other.lost),
            passing=self.passing + other.passing,
        )


NOTHING = Change()


def gaps_of_both(first: Gaps, second: Gaps) -> Gaps:
    """Give the gaps between scans that are late for two independent reasons.

    What makes them longer or shorter adds up, and the longer a gap, the more edges it meets.
    """
    if not first or not second:
        return first + second
    found = sorted(
        (one + other - 1.0, share * part / (one * other) * (one + other - 1.0))
        for share, one in _with_usual(first)
        for part, other in _with_usual(second)
        if one + other > 1.0
    )
    while len(found) > MOST_GAPS:
        _merge(found, min(range(len(found)), key=lambda i: found[i][1]))
    whole = sum(share for _, share in found)
    return tuple((share / whole, length) for length, share in found if length != 1.0 and share)


def _with_usual(gaps: Gaps) -> Gaps:
    """Add the gaps of one period."""
    return (*gaps, (max(0.0, 1.0 - sum(share for share, _ in gaps)), 1.0))


def _merge(gaps: list[tuple[float, float]], at: int) -> None:
    """Take a length with its share, of some by length, for one with that which is nearest."""
    (length, share), near = gaps[at], (i for i in (at - 1, at + 1) if 0 <= i < len(gaps))
    other = min(near, key=lambda i: abs(gaps[i][0] - length))
    whole = share + gaps[other][1]
    mean = (share * length + gaps[other][1] * gaps[other][0]) / whole if whole else length
    gaps[min(at, other) : max(at, other) + 1] = [(mean, whole)]


def both(first: tuple[Extra, ...], second: tuple[Extra, ...]) -> tuple[Extra, ...]:
    """Give the extras of two independent causes, with the touches that get both."""
    if not first or not second:
        return first + second
    rest_first = 1.0 - sum(extra.share for extra in first)
    rest_second = 1.0 - sum(extra.share for extra in second)
    alone = [e.with_share(e.share * rest_second) for e in first]
    alone += [e.with_share(e.share * rest_first) for e in second]
    return tuple(extra for extra in (*alone, *together(first, second)) if extra.share > 0.0)


def together(first: tuple[Extra, ...], second: tuple[Extra, ...]) -> tuple[Extra, ...]:
    """Give what the touches get that get an extra of each of two independent causes."""
    return tuple(_sum(a, b) for a in first for b in second)


def _sum(a: Extra, b: Extra) -> Extra:
    """Give both extras on the same touch.

    An extra has one box and one exponential: the smaller of two counts by its mean and variance.
    """
    box, is_longer = np.minimum(a.width, b.width), np.abs(a.mean) > np.abs(b.mean)
    tail = np.where(is_longer, b.mean, a.mean)
    return Extra(
        a.share * b.share,
        offset=np.asarray(a.offset) + b.offset + box / 2.0 + tail,
        width=np.maximum(a.width, b.width),
        mean=np.where(is_longer, a.mean, b.mean),
        sigma=np.sqrt(np.square(a.sigma) + np.square(b.sigma) + box**2 / 12.0 + tail**2),
        boxless=np.maximum(a.boxless, b.boxless),
    )
