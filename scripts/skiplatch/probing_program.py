"""Touches as a program for a controller, which logs them so that ``skiplatch import`` reads them.

Touches of one surface run one after the other, the surfaces in the order of their first touch.
Only the axis that probes is moved. Before each further surface the program stops by M0, so that a
gauge, or the probe, can be set in front of it.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from skiplatch.campaign import Axis, Touches
from skiplatch.units import S_PER_MIN

SAME_SURFACE_MM = 0.5
BEYOND_MM = 2.0
"""How far behind the surface a probing move would end."""
LIFT_MM_MIN = 600.0
MS_PER_S = 1e3
FILES: Mapping[str, Sequence[str]] = {
    "linuxcnc": (".ngc",),
    "grbl": (".nc",),
    "klipper": (".gcode",),
    "heidenhain": (".h", "_head.a", "_row.a"),
}
"""What the names of a controller's files have behind that of the program."""
KINDS = tuple(FILES)
LOGGED = ("axis", "sign", "feed_mm_min", "approach_mm", "position_mm", "coordinate_mm")
"""Columns that a Heidenhain control writes by FN 16, by which ``import csv`` calls them."""


@dataclass(frozen=True, slots=True)
class _Touch:
    """One touch: places in mm along its axis, feed in mm/min, rest before it in s."""

    axis: str
    sign: int
    start: float
    surface: float
    end: float
    feed: float
    rest_s: float

    @property
    def title(self) -> str:
        """Say which surface it is."""
        return f"surface {self.axis}{'+' if self.sign > 0 else '-'} at {self.surface:g} mm"

    def is_of(self, other: "_Touch") -> bool:
        """Tell whether it touches the same surface."""
        near = abs(self.surface - other.surface) <= SAME_SURFACE_MM
        return near and (self.axis, self.sign) == (other.axis, other.sign)


def program(
    kind: str, touches: Touches, rest_s: Sequence[float], reach_mm: tuple[float, float], stem: str
) -> dict[str, str]:
    """Give the texts of the program and of what it needs, by the name of the file.

    Args:
        kind: One of `KINDS`.
        touches: n touches to make.
        rest_s: How long to wait before each; n values.
        reach_mm: Least and greatest coordinate of the axis.
        stem: Name of the program without its ending.

    Raises:
        ValueError: The controller cannot make one of the touches, or too little is known of it.
    """
    made = [_touch(touches, i, float(rest_s[i]), reach_mm) for i in range(len(touches))]
    if kind == "klipper" and any((touch.axis, touch.sign) != ("Z", -1) for touch in made):
        raise ValueError("Klipper's PROBE touches along Z from above only, other touches are asked")
    return _WRITERS[kind](_by_surface(made), stem)


def _touch(touches: Touches, i: int, rest_s: float, reach_mm: tuple[float, float]) -> _Touch:
    known = (
        touches.sign[i],
        touches.position_mm[i],
        touches.approach_mm[i],
        touches.feed_mm_min[i],
    )
    if touches.axis[i] not in (Axis.X, Axis.Y, Axis.Z) or np.isnan(known).any():
        raise ValueError(f"touch {i}: a program needs linear axis, sense, place, approach and feed")
    sign, surface, approach, feed = (float(value) for value in known)
    start, end = np.clip([surface - sign * approach, surface + sign * BEYOND_MM], *reach_mm)
    axis = Axis(int(touches.axis[i])).name
    return _Touch(axis, int(sign), float(start), surface, float(end), feed, rest_s)


def _by_surface(touches: Sequence[_Touch]) -> list[_Touch]:
    groups: list[list[_Touch]] = []
    for touch in touches:
        for group in groups:
            if touch.is_of(group[0]):
                group.append(touch)
                break
        else:
            groups.append([touch])
    return [touch for group in groups for touch in group]


def _with_stops(touches: Sequence[_Touch]) -> Iterator[tuple[_Touch, bool]]:
    """Give each touch, and whether its surface is another than that of the one before."""
    yield touches[0], False
    for before, touch in pairwise(touches):
        yield touch, not touch.is_of(before)


def _moves(touches: Sequence[_Touch], move: Callable[[_Touch], tuple[str, ...]]) -> Iterator[str]:
    """Give the G-code of all touches, with a stop before each other surface."""
    for touch, is_other in _with_stops(touches):
        if is_other:
            yield f"(MSG, {touch.title})"
            yield "M0"
        yield f"G4 P{touch.rest_s:.1f}"
        yield from move(touch)


def _text(lines: Iterable[str]) -> str:
    return "\n".join(lines) + "\n"


def _linuxcnc(touches: Sequence[_Touch], stem: str) -> Iterator[str]:
    """Log by PROBEOPEN, in the program's coordinates."""
    yield f"(begin in front of {touches[0].title})"
    yield f"(then: skiplatch import linuxcnc {stem}.txt --program {stem}.ngc -o made)"
    yield f"(PROBEOPEN {stem}.txt)"
    yield "G21 G90 G94 G40 G49"

    def move(touch: _Touch) -> tuple[str, ...]:
        start = f"G0 {touch.axis}{touch.start:.3f}"
        return start, f"G38.2 {touch.axis}{touch.end:.3f} F{touch.feed:g}", start

    yield from _moves(touches, move)
    yield "(PROBECLOSE)"
    yield "M2"


def _grbl(touches: Sequence[_Touch], stem: str) -> Iterator[str]:
    """Reply in the machine's coordinates, so G53 goes to starts and probing moves are relative."""
    yield f"(begin in front of {touches[0].title}, and log the serial line with its commands)"
    yield f"(then: skiplatch import grbl {stem}.log -o made)"
    yield "G21 G94"

    def move(touch: _Touch) -> tuple[str, ...]:
        start = f"G90 G53 G0 {touch.axis}{touch.start:.3f}"
        way = touch.end - touch.start
        return start, f"G91 G38.2 {touch.axis}{way:.3f} F{touch.feed:g}", start

    yield from _moves(touches, move)
    yield "M2"


def _klipper(touches: Sequence[_Touch], stem: str) -> Iterator[str]:
    yield f"; home, and go to where the bed is to be touched; {stem}"
    yield "; then: skiplatch import klipper klippy.log -o made"
    yield "G90"
    for touch, is_other in _with_stops(touches):
        if is_other:
            yield f"M117 {touch.title}"
            yield "PAUSE"
        yield f"G4 P{touch.rest_s * MS_PER_S:.0f}"
        yield f"G1 Z{touch.start:.3f} F{LIFT_MM_MIN:g}"
        retract = touch.start - touch.surface
        speed = touch.feed / S_PER_MIN
        yield (
            f"PROBE_ACCURACY PROBE_SPEED={speed:.4g} SAMPLES=1 SAMPLE_RETRACT_DIST={retract:.3f}"
        )


def _heidenhain(touches: Sequence[_Touch], stem: str) -> Iterator[str]:
    """Touch by cycle 4, whose feed is programmed, and write a row of a table by FN 16."""
    maps = " ".join(f"--map {name}={name}" for name in LOGGED)
    yield f"; begin in front of {touches[0].title}"
    yield f"; copy {stem}_head.a and {stem}_row.a to TNC:\\"
    yield f"; then: skiplatch import csv {stem}.txt {maps} -o made"
    yield rf"FN 16: F-PRINT TNC:\{stem}_head.a/TNC:\{stem}.txt"
    for touch, is_other in _with_stops(touches):
        if is_other:
            yield f"; {touch.title}"
            yield "STOP"
        yield "CYCL DEF 9.0 DWELL TIME"
        yield f"CYCL DEF 9.1 DWELL {touch.rest_s:.1f}"
        yield from _cycle_4(touch)
        yield rf"FN 16: F-PRINT TNC:\{stem}_row.a/TNC:\{stem}.txt"


def _cycle_4(touch: _Touch) -> Iterator[str]:
    approach = abs(touch.surface - touch.start)
    way = " ".join(f"I{axis}{touch.sign * (axis == touch.axis):+d}" for axis in "XYZ")
    yield f"L {touch.axis}{touch.start:+.3f} R0 FMAX"
    yield "TCH PROBE 4.0 MEASURING IN 3-D"
    yield "TCH PROBE 4.1 Q1"
    yield f"TCH PROBE 4.2 {way}"
    yield (
        f"TCH PROBE 4.3 ABST{abs(touch.end - touch.start):+.3f} F{touch.feed:g} "
        f"MB{approach:.3f} REFERENCE SYSTEM:0"
    )
    yield f'QS1 = "{touch.axis}"'
    values = (touch.sign, touch.feed, approach, touch.surface)
    for number, value in enumerate(values, 11):
        yield f"Q{number} = {value:+.3f}"
    yield f"Q15 = Q{'XYZ'.index(touch.axis) + 1}"


def _heidenhain_files(touches: Sequence[_Touch], stem: str) -> dict[str, str]:
    """Give the program with its blocks numbered, and the masks of the header and of a row."""
    blocks = [f"BEGIN PGM {stem} MM", *_heidenhain(touches, stem), f"END PGM {stem} MM"]
    row = '"%S,%.0lf,%.3lf,%.3lf,%.3lf,%.4lf",QS1,Q11,Q12,Q13,Q14,Q15;'
    return {
        f"{stem}.h": _text(f"{number} {block}" for number, block in enumerate(blocks)),
        f"{stem}_head.a": _text([f'"{",".join(LOGGED)}";']),
        f"{stem}_row.a": _text(["M_APPEND;", row]),
    }


_WRITERS: Mapping[str, Callable[[Sequence[_Touch], str], dict[str, str]]] = {
    "linuxcnc": lambda touches, stem: {f"{stem}.ngc": _text(_linuxcnc(touches, stem))},
    "grbl": lambda touches, stem: {f"{stem}.nc": _text(_grbl(touches, stem))},
    "klipper": lambda touches, stem: {f"{stem}.gcode": _text(_klipper(touches, stem))},
    "heidenhain": _heidenhain_files,
}
