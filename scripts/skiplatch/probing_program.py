"""Touches as programs for a controller, which logs them so that ``skiplatch import`` reads them.

Each surface has a program of its own, as no controller knows a safe way to another one. It moves
along the axis that probes only. From where the operator has set the probe it finds the surface by
a slow touch; where it meets nothing, it ends. No rapid move leads where no slow one has led before.
"""

import re
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from textwrap import wrap

from skiplatch.campaign import NOMINAL_FILE, Touches
from skiplatch.errors import quoted
from skiplatch.probing_klartext import LOGGED, klartext, masks
from skiplatch.probing_touches import (
    BESIDE_MM,
    BEYOND_MM,
    LOCATING_MM,
    SAME_SURFACE_MM,
    Touch,
    as_logged,
    as_made,
    by_surface,
    farthest,
    locating_mm,
    locating_mm_min,
    path_of,
    taken_for_one,
)
from skiplatch.units import S_PER_MIN

LIFT_MM_MIN = 600.0
MS_PER_S = 1e3
WIDTH = 100
FILES: Mapping[str, Sequence[str]] = {
    "linuxcnc": (".ngc",),
    "grbl": (".nc",),
    "klipper": (".gcode",),
    "heidenhain": (".h", "_head.a", "_row.a", "_miss.a"),
}
"""What the names of a controller's files have behind that of the program."""
KINDS = tuple(FILES)
_NAME = re.compile(r"[A-Za-z0-9_-]+")
_UNSAFE = re.compile(r"[^ -}]|[!?]")  # in a comment too: grbl obeys !, ? and ~ wherever they stand
_PROBED = {axis: f"#{5061 + i}" for i, axis in enumerate("XYZABC")}  # parameters of LinuxCNC


@dataclass(frozen=True, slots=True)
class Programs:
    """What a controller is given.

    Attributes:
        texts: Of the programs and of what they need, by the name of the file.
        then: The command that imports what it logs.
        doubts: What cannot be known of the surfaces.
    """

    texts: Mapping[str, str]
    then: str
    doubts: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class _Part:
    """The program of one surface.

    Attributes:
        touches: Of the surface.
        stem: Name of all programs without ending.
        name: Of this one.
        then: The command that imports what all log.
        number: Of this one, from 1.
        of: How many there are.
    """

    touches: Sequence[Touch]
    stem: str
    name: str
    then: str
    number: int
    of: int

    @property
    def head(self) -> list[str]:
        """Say where the probe has to be, and what comes afterwards."""
        first = self.touches[0]
        side = "smaller" if first.sign > 0 else "greater"
        back = f"{first.axis}{farthest(self.touches).start:.3f}"
        way = locating_mm(self.touches)
        why = ", as the axis ends so far behind it" if way < LOCATING_MM else ""
        return [
            f"{first.title}, program {self.number} of {self.of}",
            f"before the start: set the probe in front of it, at {side} {first.axis},",
            f"nearer than {way:g} mm{why}; a slow touch finds the surface",
            f"the probe is drawn back to {back}, slowly at first: keep that way free",
            *_then(self.then),
        ]


def refuse_name(stem: str) -> None:
    """Raise ValueError for a name of a program that a controller cannot hold."""
    if not _NAME.fullmatch(stem):
        expected = "expected a name of A-Z, a-z, 0-9, _ and - alone, which controllers hold"
        raise ValueError(f"{expected}, got {quoted(stem)}")


def programs(
    kind: str,
    touches: Touches,
    rest_s: Sequence[float],
    reach_mm: tuple[float, float],
    stem: str,
    campaign: Path,
) -> Programs:
    """Give a program for each surface, or the one that Klipper needs.

    Args:
        kind: One of `KINDS`.
        touches: n touches to make.
        rest_s: How long to wait before each; n values.
        reach_mm: Least and greatest coordinate of the axis.
        stem: Name of the program without its ending; a number follows where there are several.
        campaign: What the touches are to settle; its nominal.toml is that of their log, too.

    Raises:
        ValueError: The controller cannot make one of the touches, or too little is known of it.
    """
    refuse_name(stem)
    path, made = path_of(touches), as_made(as_logged(kind, touches), rest_s, reach_mm)
    if kind == "klipper" and any((touch.axis, touch.sign) != ("Z", -1) for touch in made):
        raise ValueError("Klipper's PROBE touches along Z from above only, other touches are asked")
    groups = by_surface(made)
    names = _names(kind, stem, len(groups))
    then = _import(kind, stem, names, path, campaign / NOMINAL_FILE)
    if kind == "klipper":
        return Programs({f"{stem}.gcode": _text(_klipper(groups, then))}, then, _doubts(made))
    texts = {
        name + FILES[kind][0]: _WRITERS[kind](_Part(group, stem, name, then, number, len(names)))
        for number, (group, name) in enumerate(zip(groups, names, strict=True), 1)
    }
    texts |= masks(stem, path) if kind == "heidenhain" else {}
    return Programs(texts, then, _doubts(made))


def _doubts(touches: Sequence[Touch]) -> list[str]:
    """Say where several surfaces may have been taken for one."""
    return [
        f"{touch.title}: places within {SAME_SURFACE_MM:g} mm along {touch.axis} count as one, as "
        "the campaign does not say where they lie on the other axes"
        for touch in taken_for_one(touches)
    ]


def _names(kind: str, stem: str, surfaces: int) -> list[str]:
    if surfaces == 1 or kind == "klipper":
        return [stem]
    return [f"{stem}-{number}" for number in range(1, surfaces + 1)]


def _import(kind: str, stem: str, names: Sequence[str], path: str, nominal: Path) -> str:
    """Give the command that imports the log of all programs."""
    rig = ["--nominal", str(nominal), "-o", "made"]
    if kind == "linuxcnc":
        of = [word for name in names for word in ("--program", f"{name}.ngc")]
        words = ["linuxcnc", *(f"{name}.txt" for name in names), *of, "--path", path]
    elif kind == "heidenhain":
        maps = [word for name in LOGGED for word in ("--map", f"{name}={name}")]
        words = ["csv", f"{stem}.txt", *maps]
    else:
        log = "klippy.log" if kind == "klipper" else f"{stem}.log"
        words = [kind, log, "--path", path]
    return shlex.join(["skiplatch", "import", *words, *rig])


def _then(command: str) -> list[str]:
    lines = wrap(f"then: {command}", WIDTH, break_long_words=False, break_on_hyphens=False)
    return [_UNSAFE.sub("_", line) for line in lines]


def _text(lines: Iterator[str]) -> str:
    return "\n".join(lines) + "\n"


def _linuxcnc(part: _Part) -> Iterator[str]:
    """Log by PROBEOPEN, in the coordinates that are active: M2 would go back to those of G54."""
    first, back = part.touches[0], farthest(part.touches)
    yield "%"
    yield from (f"; {line}" for line in part.head)
    yield "; in the coordinates of the log that the campaign was imported from:"
    yield "; with the same G54 to G59.3, G92 and tool offset (G43) as its program"
    yield "G21 G90 G94 G40"
    yield from _located(part.touches)
    yield f"o1 if {_is_there(first)}"
    yield f"G1 {back.axis}{back.start:.3f} F{locating_mm_min(part.touches):g}"
    yield f"(PROBEOPEN {part.name}.txt)"
    for touch in part.touches:
        yield f"G4 P{touch.rest_s:.1f}"
        yield f"G0 {touch.axis}{touch.start:.3f}"
        yield f"G38.2 {touch.axis}{touch.end:.3f} F{touch.feed:g}"
        yield f"G0 {touch.axis}{touch.start:.3f}"
    yield "(PROBECLOSE)"
    yield "o1 else"
    yield f"(MSG, this is not {first.title}, or not in its coordinates)"
    yield "o1 endif"
    yield "%"


def _is_there(touch: Touch) -> str:
    """Give the condition that the surface which was found is the one that is meant."""
    near = f"[ABS[{_PROBED[touch.axis]} - [{touch.surface:.3f}]] LE {BEYOND_MM:g}]"
    for axis, value in touch.beside.items():
        near = f"[{near} AND [ABS[{_PROBED[axis]} - [{value:g}]] LE {BESIDE_MM:g}]]"
    return near


def _located(touches: Sequence[Touch]) -> Iterator[str]:
    """Find the surface from where the probe stands; without a contact the controller stops."""
    way = touches[0].sign * locating_mm(touches)
    yield f"G91 G38.2 {touches[0].axis}{way:g} F{locating_mm_min(touches):g}"
    yield "G90"


def _grbl(part: _Part) -> Iterator[str]:
    """Reply in the machine's coordinates, so G53 goes to starts and probing moves are relative."""
    back = farthest(part.touches)
    slow = f"F{locating_mm_min(part.touches):g}"
    yield from (f"; {line}" for line in part.head)
    yield "; log the serial line with commands and jogs, all programs in one log"
    yield "; in the coordinates of the machine, homed as for the campaign"
    yield "G21 G94"
    yield from _located(part.touches)
    yield f"G90 G53 G1 {back.axis}{back.start:.3f} {slow}"
    for touch in part.touches:
        start = f"G90 G53 G0 {touch.axis}{touch.start:.3f}"
        yield f"G4 P{touch.rest_s:.1f}"
        yield start
        yield f"G91 G38.2 {touch.axis}{touch.end - touch.start:.3f} F{touch.feed:g}"
        yield start


def _klipper(groups: Sequence[Sequence[Touch]], then: str) -> Iterator[str]:
    """Stop before each further surface: a printer can be jogged while it pauses."""
    touches = [touch for group in groups for touch in group]
    yield "; home, and go to where the bed is to be touched"
    yield "; speeds are multiples of 0.1 mm/s, as Klipper's log prints one decimal"
    yield from (f"; {line}" for line in _then(then))
    yield "G90"
    if touches[0].place:
        yield f"; begins with {touches[0].title}"
    for before, touch in pairwise([touches[0], *touches]):
        if not touch.is_of(before):
            yield f"M117 {touch.title}"
            yield "PAUSE"
        yield f"G4 P{touch.rest_s * MS_PER_S:.0f}"
        yield f"G1 Z{touch.start:.3f} F{LIFT_MM_MIN:g}"
        retract = touch.start - touch.surface
        speed = touch.feed / S_PER_MIN
        yield (
            f"PROBE_ACCURACY PROBE_SPEED={speed:.1f} SAMPLES=1 SAMPLE_RETRACT_DIST={retract:.3f}"
        )


def _heidenhain(part: _Part) -> str:
    copied = " and ".join(f"{part.stem}{ending}" for ending in FILES["heidenhain"][1:])
    is_first = part.number == 1
    order = [] if is_first else [f"after {part.stem}-1, whose log it goes on with"]
    head = [*part.head, f"copy {copied} to TNC:\\", "with the datum of the campaign", *order]
    return klartext(part.touches, part.stem, part.name, head, is_first=is_first)


_WRITERS: Mapping[str, Callable[[_Part], str]] = {
    "linuxcnc": lambda part: _text(_linuxcnc(part)),
    "grbl": lambda part: _text(_grbl(part)),
    "heidenhain": _heidenhain,
}
