"""Programs of probing moves for a Heidenhain control, in Klartext.

Cycle 4 goes on where it meets nothing, and then gives -1 as the fourth of its results.
"""

from collections.abc import Iterator, Sequence

from skiplatch.probing_touches import BEYOND_MM, Touch, farthest, locating_mm, locating_mm_min

COLUMNS = ("axis", "path", "sign", "feed_mm_min", "approach_mm", "position_mm")
LOGGED = (*COLUMNS, "coordinate_mm", "status")
"""Columns of the table that FN 16 writes, by which ``import csv`` calls them."""
LOCATED_BACK_MM = 1.0
"""How far cycle 4 goes back from a surface that is not yet known for the right one."""
_VALUES = "%S,{path},%.0lf,%.3lf,%.3lf,%.3lf"


def masks(stem: str, path: str) -> dict[str, str]:
    """Give the masks of FN 16: of the header, of a touch, and of one that met nothing."""
    values = _VALUES.format(path=path)
    touched = f'"{values},%.4lf,ok",QS1,Q11,Q12,Q13,Q14,Q15;'
    missed = f'"{values},,missed",QS1,Q11,Q12,Q13,Q14;'
    return {
        f"{stem}_head.a": f'"{",".join(LOGGED)}";\n',
        f"{stem}_row.a": f"M_APPEND;\n{touched}\n",
        f"{stem}_miss.a": f"M_APPEND;\n{missed}\n",
    }


def klartext(
    touches: Sequence[Touch], stem: str, name: str, head: Sequence[str], *, is_first: bool
) -> str:
    """Give the program of one surface, with its blocks numbered.

    Args:
        touches: Of the surface.
        stem: Name of the log and of the masks.
        name: Of the program.
        head: What is said at its beginning.
        is_first: Whether it begins the log.
    """
    blocks = [f"BEGIN PGM {name} MM", *(f"; {line}" for line in head)]
    if is_first:
        blocks.append(_print(stem, "head"))
    blocks += _located(touches)
    for touch in touches:
        blocks += _touched(touch)
    blocks += [*_end(stem), f"END PGM {name} MM"]
    return "".join(f"{number} {block}\n" for number, block in enumerate(blocks))


def _located(touches: Sequence[Touch]) -> Iterator[str]:
    """Find the surface from where the probe stands, or end the program."""
    first = touches[0]
    result = f"+Q{_number(first)}"
    back = farthest(touches)
    back_mm = min(LOCATED_BACK_MM, back.approach)
    yield from _cycle_4(first, locating_mm(touches), locating_mm_min(touches), back_mm)
    yield "FN 9: IF +Q4 EQU -1 GOTO LBL 9"
    yield f"FN 11: IF {result} GT {first.surface + BEYOND_MM:+.3f} GOTO LBL 9"
    yield f"FN 12: IF {result} LT {first.surface - BEYOND_MM:+.3f} GOTO LBL 9"
    yield f"L {back.axis}{back.start:+.3f} R0 F{locating_mm_min(touches):g}"


def _touched(touch: Touch) -> Iterator[str]:
    yield "CYCL DEF 9.0 DWELL TIME"
    yield f"CYCL DEF 9.1 DWELL {touch.rest_s:.1f}"
    yield f"L {touch.axis}{touch.start:+.3f} R0 FMAX"
    yield from _cycle_4(touch, abs(touch.end - touch.start), touch.feed, touch.approach)
    yield f'QS1 = "{touch.axis}"'
    values = (touch.sign, touch.feed, touch.approach, touch.surface)
    for number, value in enumerate(values, 11):
        yield f"Q{number} = {value:+.3f}"
    yield f"Q15 = Q{_number(touch)}"
    yield "CALL LBL 1"


def _cycle_4(touch: Touch, way_mm: float, feed_mm_min: float, back_mm: float) -> Iterator[str]:
    way = " ".join(f"I{axis}{touch.sign * (axis == touch.axis):+d}" for axis in "XYZ")
    yield "Q4 = +0"
    yield "TCH PROBE 4.0 MEASURING IN 3-D"
    yield "TCH PROBE 4.1 Q1"
    yield f"TCH PROBE 4.2 {way}"
    yield (f"TCH PROBE 4.3 ABST{way_mm:+.3f} F{feed_mm_min:g} MB{back_mm:.3f} REFERENCE SYSTEM:0")


def _end(stem: str) -> Iterator[str]:
    """End the program; LBL 1 writes a row."""
    yield "LBL 9"
    yield "M30"
    yield "LBL 1"
    yield "FN 9: IF +Q4 EQU -1 GOTO LBL 2"
    yield _print(stem, "row")
    yield "FN 9: IF +0 EQU +0 GOTO LBL 3"
    yield "LBL 2"
    yield _print(stem, "miss")
    yield "LBL 3"
    yield "LBL 0"


def _print(stem: str, mask: str) -> str:
    return rf"FN 16: F-PRINT TNC:\{stem}_{mask}.a/TNC:\{stem}.txt"


def _number(touch: Touch) -> int:
    """Give the number of the Q parameter that holds the result along the axis."""
    return "XYZ".index(touch.axis) + 1
