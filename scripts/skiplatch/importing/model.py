"""What the readers of logs give."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from skiplatch.campaign import DatumFreedom, Kind, Touches
from skiplatch.errors import InputError

KeyPath = tuple[str, str]
NO_TIMES = "no times in the log: the order of the lines is that of the touches"


@dataclass(slots=True, kw_only=True)
class Touch:
    """One touch as a log tells it; None is what it does not tell.

    Lengths in mm and feeds in mm/min; of rotary axes degrees.
    """

    axis: str
    """X, Y, Z, A, B or C."""
    coordinate: float | None
    """Where the axis was latched; None where it was not."""
    sign: int | None = None
    place: tuple[float, ...] = ()
    """What else tells this surface from others: the coordinates of the other axes."""
    feed: float | None = None
    share: float | None = 1.0
    """Of the feed that the axis has, less than 1 where others move with it; None: not known."""
    start: float | None = None
    """Where the axis began to move towards the surface."""
    approach: float | None = None
    """Where the start is not known: from it to the surface."""
    time_s: float | None = None
    session: str = ""
    temperatures: dict[str, float] = field(default_factory=dict)
    """In °C by the names of their places."""
    also: Mapping[str, float] = field(default_factory=dict)
    """Columns of a campaign that a table has beside these, by name."""
    is_release: bool = False
    """Whether the probe let go there, by G38.4 or G38.5, rather than touched."""
    line: int | None = None
    """Of the log, where it stands in one."""
    is_false: bool = False
    """Whether the probe triggered before it could have touched anything; without a coordinate."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A number of nominal.toml and where it is from."""

    value: float
    source: str
    u: float | None = None


@dataclass(slots=True, kw_only=True)
class Imported:
    """What a log holds.

    Attributes:
        kind: Of the campaign.
        touches: What was touched, on a machine.
        columns: In place of touches: columns that need no reference surface.
        lines: With columns: the line of each touch in the log, if it has lines.
        free: With columns: what shares an unknown datum, if not what is usual for the kind.
        place_is_surface: Whether touches at one place in one session met one surface, however far
            apart they were latched.
        preset: Name of the figures that such a rig has where the log says nothing else.
        figures: What the log says of the rig.
        known: What is known, a sentence each.
        assumed: What was assumed, by `assume` where an option would tell it.
        options: Of `skiplatch import`, those that sentences of `assumed` name.
        unread: What could not be read.
    """

    kind: Kind = Kind.MACHINE
    touches: list[Touch] = field(default_factory=list)
    columns: Touches | None = None
    lines: Sequence[int] = ()
    free: DatumFreedom | None = None
    preset: str
    path_is_plc: bool = False
    place_is_surface: bool = False
    figures: dict[KeyPath, Figure] = field(default_factory=dict)
    known: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    options: list[str] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)

    def assume(self, words: str, *options: str, by: str = "else give") -> None:
        """Note what was assumed, and by which options of `skiplatch import` it would be told."""
        self.assumed.append(f"{words}; {by} {' or '.join(options)}" if options else words)
        self.options += [option for option in options if option not in self.options]

    def figure(self, section: str, name: str, value: float, source: str) -> None:
        """Note what the log says of the rig."""
        self.figures[section, name] = Figure(value, source)

    def add(self, other: "Imported") -> None:
        """Take what a further log of the same rig holds; its lines are those of another file."""
        self.touches += [replace(touch, line=None) for touch in other.touches]
        self.figures |= other.figures
        for said, more in (
            (self.known, other.known),
            (self.assumed, other.assumed),
            (self.options, other.options),
            (self.unread, other.unread),
        ):
            said += [line for line in more if line not in said]

    def leave_out_releases(self) -> None:
        """Leave out where the probe let go, as that is another place than where it triggers.

        A log of nothing else is of a probe that is wired the other way round.
        """
        touched = [touch for touch in self.touches if not touch.is_release]
        left_out = len(self.touches) - len(touched)
        if touched and left_out:
            self.touches = touched
            self.known.append(
                f"{left_out} moves away from the surface (G38.4, G38.5), which are left out: the "
                "probe lets go elsewhere than it triggers"
            )

    def share_feeds(self) -> None:
        """Give each touch the feed of its axis, in place of that along the way of all axes."""
        shared = [t for t in self.touches if t.share is not None and t.share < 1.0]
        for touch in shared:
            touch.feed = None if touch.feed is None else touch.feed * (touch.share or 1.0)
            touch.share = 1.0
        unknown = sum(touch.share is None for touch in self.touches)
        if shared:
            self.known.append(
                f"{len(shared)} touches by moves of several axes: deviation and feed are those of "
                "the axis that moved most"
            )
        if unknown:
            self.assumed.append(
                f"{unknown} touches by moves of several axes in a direction that is not known: the "
                "axis measured had the whole feed"
            )

    def reach(self, least_mm: float, greatest_mm: float, source: str) -> None:
        """Note between which ends the axis can move, where they are in order."""
        if least_mm < greatest_mm:
            self.figure("axis", "min_mm", least_mm, source)
            self.figure("axis", "max_mm", greatest_mm, source)


Figures = Mapping[KeyPath, Figure]


def refuse_all_missed(path: Path, touches: Sequence[Touch]) -> None:
    """Refuse a log none of whose moves met anything.

    Raises:
        InputError: It is one.
    """
    if all(touch.coordinate is None for touch in touches):
        message = f"expected a touch, got {len(touches)} probing moves that ended without one"
        raise InputError(path, None, None, message)
