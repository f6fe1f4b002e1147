"""LinuxCNC: the file that ``(PROBEOPEN …)`` makes, and the program that made it.

A line a touch, nine coordinates X Y Z A B C U V W in units of the program. LinuxCNC writes no line
for a touch that ends exactly where the one before did. A move by G38.3 that meets nothing has a
line as well, with its target.
"""

import re
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.importing.dropped_lines import only, say_dropped, told_apart
from skiplatch.importing.gcode import without_comments
from skiplatch.importing.gcode_program import Row, Run, logs_parts, offsets_of, run
from skiplatch.importing.linuxcnc_ini import Ini, read_ini
from skiplatch.importing.linuxcnc_rows import ProbeRows, read_rows
from skiplatch.importing.linuxcnc_units import probed_axis, unit_begun
from skiplatch.importing.model import Imported, Touch, refuse_all_missed
from skiplatch.importing.nc_text import read_program
from skiplatch.importing.probe_move import AXES, LINEAR, ProbeMove
from skiplatch.tables import counted
from skiplatch.units import MM_PER_INCH

FROM_ABOVE = "Z was touched from above"

_PROBES = re.compile(r"G38\.[2-5]", re.IGNORECASE)


def read_linuxcnc_logs(
    logs: Sequence[Path],
    programs: Sequence[Path],
    axis: str | None,
    feed: float | None,
    *,
    inch: bool | None,
    ini: Path | None = None,
) -> Imported:
    """Read logs of one rig in their order, each with its program where programs are given.

    Raises:
        InputError: As of `read_linuxcnc`, or there is not a program for each log.
    """
    if programs and len(programs) != len(logs):
        expected = f"expected a program for each of {len(logs)} logs, got {len(programs)}"
        raise InputError(logs[0], None, None, expected)
    pairs = zip_longest(logs, programs)
    rig = read_ini(ini) if ini else None
    first, *others = (read_linuxcnc(log, of, axis, feed, inch=inch, ini=rig) for log, of in pairs)
    for other in others:
        first.add(other)
    return first


def read_linuxcnc(
    path: Path,
    program: Path | None,
    axis: str | None,
    feed: float | None,
    *,
    inch: bool | None,
    ini: Ini | None = None,
) -> Imported:
    """Read a probe log.

    Args:
        path: The log.
        program: The program, whose G38.x moves give feeds, axes and senses.
        axis: The axis that probed, if the program is not at hand.
        feed: The feed in mm/min, likewise.
        inch: Whether the program began in inches, where that is told.
        ini: Of the machine, likewise.

    Raises:
        InputError: A file cannot be read, or holds no touch, or could be in no unit.
    """
    read = read_rows(path)
    rows, lines = read.rows, read.lines
    text = read_program(program) if program else ""
    runs = {begins: run(text, rows, inch=begins, name=path.name) for begins in (False, True)}
    told_by = runs if program else {}
    begun = unit_begun(path, read, told_by, axis or probed_axis(rows), inch=inch, ini=ini)
    done = runs[begun.is_inch]
    if program and not done.moves:
        raise InputError(program, None, None, _without_moves(text, done))
    found = Imported(preset="linuxcnc-1ms", path_is_plc=True)
    read.say(found)
    moves = _of_whole_lines(done.moves, read, found)
    is_inch = _are_in_inches(program, moves) if program else begun.is_inch
    unit = MM_PER_INCH if is_inch else 1.0
    told = None
    if not (read.broken or read.stumps):  # a line that cannot be read is missing for another reason
        name = path.name
        told = told_apart(
            rows, moves, unit, lambda log: run(text, log, inch=begun.is_inch, name=name).moves
        )
    if told:
        rows, lines = [rows[i] for i in told.lines], [lines[i] for i in told.lines]
        found.assumed.append(told.said)
    matched = list(told.moves) if told else _matched(path, rows, moves, found)
    fallback = axis or probed_axis(rows)
    guessed = sum(not (move and move.axis) for move in matched)
    if guessed and not axis:
        untold = (
            f"the program does not tell the axis of {counted(guessed, 'touch')}: " if moves else ""
        )
        found.assume(f"{untold}axis {fallback}, whose coordinates look touched", "--axis")
    if done.not_found:
        found.assumed.append(f"{_subroutines(done)}: taken for without probing moves and feeds")
    for line, row, move in zip(lines, rows, matched, strict=True):
        found.touches.append(_touch(row, move, fallback, feed, unit))
        found.touches[-1].line = line
    found.assumed += [] if moves else say_dropped(rows)
    _say_offsets(found, text)
    refuse_all_missed(path, found.touches)
    found.leave_out_releases()
    found.share_feeds()
    _say(found, moves, feed, ini)
    begun.say(found, inch=is_inch)
    return found


def _of_whole_lines(
    moves: Sequence[ProbeMove], read: ProbeRows, found: Imported
) -> Sequence[ProbeMove]:
    """Leave out the last move where the end of the log cuts its line off."""
    if not read.is_cut or len(moves) != len(read.rows) + 1:
        return moves
    found.assumed.append("the line that the end of the log cuts off is that of the last move")
    return moves[:-1]


def _are_in_inches(program: Path, moves: Sequence[ProbeMove]) -> bool:
    """Tell the unit of the log, which is the one that its moves were programmed in."""
    inch, mm = ([m.line for m in moves if m.is_inch is inch] for inch in (True, False))
    if inch and mm:
        message = (
            f"expected probing moves in one unit, got inches in line {inch[0]} and mm in line "
            f"{mm[0]}: log each by a (PROBEOPEN …) of its own"
        )
        raise InputError(program, max(inch[0], mm[0]), None, message)
    return bool(inch)


def _without_moves(text: str, done: Run) -> str:
    """Say that no probing move was found, and why that may be."""
    where = ", between (PROBEOPEN …) and (PROBECLOSE)," if logs_parts(text) else ""
    why = _subroutines(done) if done.not_found else ""
    if not why and any(_PROBES.search(without_comments(line)) for line in text.splitlines()):
        why = "no part of the program that is carried out has one"
    instead = f"; {why}: give --axis and --feed instead" if why else ""
    return f"expected moves by G38.2 to G38.5{where or ','} found none{instead}"


def _subroutines(done: Run) -> str:
    names = ", ".join(f"o{name}" for name in done.not_found)
    return f"the program calls {names}, not in its own file"


def _matched(
    path: Path, rows: Sequence[Row], moves: Sequence[ProbeMove], found: Imported
) -> list[ProbeMove | None]:
    """Give each line its move, where there are as many; else what all moves share.

    Raises:
        InputError: They do not share what a line is by, as touch or release, or as their axis.
    """
    if len(rows) == len(moves):
        return list(moves)
    if moves:
        differ = f"the log has {len(rows)} lines and the program {len(moves)} probing moves"
        releases = sum(move.is_release for move in moves)
        if 0 < releases < len(moves):
            raise InputError(
                path,
                None,
                None,
                f"{differ}, {releases} of them away from the surface (G38.4, G38.5): which lines "
                "are touches cannot be told; back off by G0 or G1 instead",
            )
        axes = sorted({move.axis for move in moves if move.axis})
        if len(axes) > 1:
            told = f"{differ} along {', '.join(axes)}: which line is of which cannot be told"
            raise InputError(path, None, None, f"{told}; log each axis into a file of its own")
        found.assumed.append(
            f"{differ}, so only what is the same in all of them was taken from it (LinuxCNC "
            "writes no line for a touch that ends exactly where the one before did)"
        )
    axis = only(move.axis for move in moves)
    same = ProbeMove(
        line=0,
        axis=axis,
        sign=_shared_sense(moves, axis, found),
        share=only(move.share for move in moves),
        start={},
        feed=only(move.feed for move in moves),
        targets={axis: only(move.targets.get(axis) for move in moves) for axis in AXES},
    )
    return [same if moves else None] * len(rows)


def _shared_sense(moves: Sequence[ProbeMove], axis: str | None, found: Imported) -> int | None:
    """Give the sense of all moves; one that the program does not tell is that of the others.

    It does not where a move starts where the one before was latched.
    """
    untold = sum(move.sign is None for move in moves)
    told = {move.sign for move in moves} - {None}
    if not untold or axis is None or len(told) > 1:
        return only(move.sign for move in moves)
    if told:
        found.assumed.append(f"{untold} moves whose sense the program does not tell: as the others")
        return told.pop()
    if axis == "Z":
        found.assumed.append(FROM_ABOVE)
        return -1
    return None


def _touch(
    row: Row, move: ProbeMove | None, fallback: str, feed: float | None, unit: float
) -> Touch:
    axis = (move.axis if move else None) or fallback
    number = AXES.index(axis)
    scale = [unit if letter in LINEAR else 1.0 for letter in AXES]
    coordinate = row[number] * scale[number]
    is_missed = bool(move and move.met_nothing(axis, coordinate))
    return Touch(
        axis=axis,
        coordinate=None if is_missed else coordinate,
        sign=move.sign if move and move.sign else (-1 if axis == "Z" and not move else None),
        place=tuple(v * scale[i] for i, v in enumerate(row[: len(AXES)]) if i != number),
        feed=(move.feed if move else None) or feed,
        share=move.share if move else 1.0,
        start=move.start_to(axis, coordinate) if move else None,
        is_release=bool(move and move.is_release),
    )


def _say_offsets(found: Imported, text: str) -> None:
    if offsets := offsets_of(text):
        found.assumed.append(
            f"coordinates by the program's {', '.join(offsets)}: a program for the same surfaces "
            "needs the same"
        )


def _say(found: Imported, moves: Sequence[ProbeMove], feed: float | None, ini: Ini | None) -> None:
    found.known.append("where each touch was latched, in the order of the touches; no times")
    missed = sum(touch.coordinate is None for touch in found.touches)
    if missed:
        found.known.append(f"missed touches, as the move ended at its target: {missed}")
    if not moves:
        found.assume("no program was given, so no senses are known", "--program", by="give")
        if any(touch.axis == "Z" for touch in found.touches):
            found.assumed.append(FROM_ABOVE)
    if feed is None and any(touch.feed is None for touch in found.touches):
        found.assume("the feed is not known", "--program", "--feed", by="give")
    if ini and ini.servo_us is not None:
        found.figure("plc", "scan_us", ini.servo_us, "SERVO_PERIOD of the .ini, [EMCMOT]")
    else:
        found.assume("a servo period of 1 ms (SERVO_PERIOD in the .ini)", "--ini")
