"""Lines of a probe log told to their moves, where LinuxCNC has dropped some.

LinuxCNC writes no line for a touch that ends exactly where the one before did, as happens with a
coarse encoder. So in their order each move has the line after that of the move before it, or has
none and ended where that move did. Either way it ended on its own way, between start and target.
Where some move did not, the program may have been stopped before it.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, repeat
from typing import TypeVar

import numpy as np

from skiplatch.importing.gcode_program import Row
from skiplatch.importing.probe_move import AXES, BESIDE_MM, LINEAR, ProbeMove

MOST_PAIRS = 300_000
"""Of a line and a move; more are not tried."""
FEWEST_REPEATS = 5.0
"""That are to be expected before it tells anything that there is none."""
MOST_ROWS = 500
"""That are looked at for it."""
ONE_SURFACE = 0.1
"""Within which touches are of one surface, in units of the program."""
MOST_WAYS = 16
"""To give the lines to the moves; each is tried by running the program, and more are not."""
Value = TypeVar("Value", str, int, float)
Ways = list[set[int]]
"""Of each move, the lines that it may have ended at."""


@dataclass(frozen=True, slots=True)
class Told:
    """Touches in their order, also those that have no line of their own.

    Attributes:
        lines: Of each touch, the line where it ended, from 0.
        moves: Its move; what is not the same in all moves that may have made it is not known.
        said: How they were told.
    """

    lines: Sequence[int]
    moves: Sequence[ProbeMove]
    said: str


def told_apart(
    rows: Sequence[Row],
    moves: Sequence[ProbeMove],
    unit: float,
    again: Callable[[Sequence[Row]], Sequence[ProbeMove]],
) -> Told | None:
    """Tell the lines to more moves than there are lines; None where they do not fit.

    Args:
        rows: The lines, in units of the program.
        moves: The moves, as far as they are known without the log.
        unit: That of the program, in mm.
        again: Gives the moves of the program once more, from where each of them ended.
    """
    missing = len(moves) - len(rows)
    if missing <= 0 or len(rows) * (missing + 1) > MOST_PAIRS:
        return None
    if any(move.is_release for move in moves):  # it begins where a touch ended: no way to hold to
        return None
    fitting = [
        {i for i in range(max(0, j - missing), min(j + 1, len(rows))) if _fits(rows[i], move, unit)}
        for j, move in enumerate(moves)
    ]
    reached = _reached(fitting, 0, 1)
    onward = _reached(fitting[::-1], len(rows) - 1, -1)[::-1]
    possible = [a & b for a, b in zip(reached, onward, strict=True)]
    if not all(possible):
        return _stopped(rows, moves, unit, again)
    ways = list(islice(_ways(possible), MOST_WAYS + 1))
    known = again([rows[i] for i in ways[0]])
    if len(known) != len(moves):
        known = moves
    elif 1 < len(ways) <= MOST_WAYS:
        held = [way for way in ways if _holds([rows[i] for i in way], unit, again)]
        if held:
            known = again([rows[i] for i in held[0]])
            possible = [set(lines) for lines in zip(*held, strict=True)]
    return _told(rows, known, possible)


def say_dropped(rows: Sequence[Row]) -> list[str]:
    """Say that lines are missing where none is as the one before, though many are alike.

    Without a program nobody knows how many moves there were. Of a line and the next only those
    tell anything that are of one surface.
    """
    places = np.array(rows[:MOST_ROWS])
    apart = np.abs(places[:, None] - places).max(axis=-1)
    is_near = apart < ONE_SURFACE
    next_is_near, alike, near = np.diag(is_near, 1).sum(), (apart == 0.0).sum(), is_near.sum()
    expected = next_is_near * (alike - len(places)) / max(near - len(places), 1)
    if expected < FEWEST_REPEATS or (np.diag(apart, 1) == 0.0).any():
        return []
    missing = (
        "no line is as the one before, though many are alike: LinuxCNC writes none for a touch "
        "that ends exactly where the one before did, so touches are missing, and the rest may "
        "scatter more than all do"
    )
    return [missing]


def _stopped(
    rows: Sequence[Row],
    moves: Sequence[ProbeMove],
    unit: float,
    again: Callable[[Sequence[Row]], Sequence[ProbeMove]],
) -> Told | None:
    """Give each line the move of its number, as where a program was stopped, if all lie on it."""
    followed = again([*rows, *[rows[-1]] * (len(moves) - len(rows))])
    known = (followed if len(followed) == len(moves) else moves)[: len(rows)]
    if not all(map(_fits, rows, known, repeat(unit))):
        return None
    said = f"the log ends with move {len(rows)} of {len(moves)} of the program, as if stopped there"
    return Told(range(len(rows)), known, said)


def _holds(
    log: Sequence[Row], unit: float, again: Callable[[Sequence[Row]], Sequence[ProbeMove]]
) -> bool:
    """Tell whether moves end on their ways; many begin where the move before them ended."""
    moves = again(log)
    return len(moves) == len(log) and all(map(_fits, log, moves, repeat(unit)))


def _fits(row: Row, move: ProbeMove, unit: float) -> bool:
    """Tell whether a move may have ended at a line; what is not known of it bars nothing."""
    for axis, value in zip(AXES, row, strict=False):
        start, target = move.start.get(axis), move.targets.get(axis, move.start.get(axis))
        if start is None or target is None:
            continue
        ended = value * (unit if axis in LINEAR else 1.0)
        if not min(start, target) - BESIDE_MM <= ended <= max(start, target) + BESIDE_MM:
            return False
    return True


def _reached(fitting: Sequence[set[int]], first: int, step: int) -> Ways:
    """Give the lines that each move may have ended at, by the moves before it alone."""
    reached = [fitting[0] & {first}]
    for lines in fitting[1:]:
        reached.append(lines & (reached[-1] | {i + step for i in reached[-1]}))
    return reached


def _ways(possible: Ways) -> Iterator[list[int]]:
    """Give the ways to give each move a line, one after the other."""
    way = [0]
    while True:
        while len(way) < len(possible):
            way.append(way[-1] if way[-1] in possible[len(way)] else way[-1] + 1)
        yield list(way)
        # The last move that could have had the next line as well takes it.
        while len(way) > 1:
            last = way.pop()
            if last == way[-1] and last + 1 in possible[len(way)]:
                way.append(last + 1)
                break
        else:
            return


def _told(rows: Sequence[Row], moves: Sequence[ProbeMove], possible: Ways) -> Told:
    writers: list[list[int]] = [[] for _ in rows]
    for j, lines in enumerate(possible):
        for i in lines:
            if (j == 0 and i == 0) or (j > 0 and i - 1 in possible[j - 1]):
                writers[i].append(j)
    touches = [(of[0], i, _in_common([moves[j] for j in of])) for i, of in enumerate(writers)]
    repeats = [
        (j, next(iter(lines)), moves[j])
        for j, lines in enumerate(possible)
        if j > 0 and len(lines) == 1 and lines == possible[j - 1]
    ]
    # A repeat comes behind the line that it repeats, whichever of its moves wrote that.
    touches = sorted([*touches, *repeats], key=lambda touch: (touch[1], touch[0]))
    open_lines = sum(len({_kind(moves[j]) for j in of}) > 1 for of in writers)
    said = _said(len(rows), len(moves), len(repeats), open_lines)
    return Told([i for _, i, _ in touches], [move for _, _, move in touches], said)


def _said(lines: int, moves: int, repeats: int, open_lines: int) -> str:
    said = (
        f"the log has {lines} lines and the program {moves} probing moves, as LinuxCNC writes no "
        "line for a touch that ends exactly where the one before did: each line is that of a move "
        "on whose way it lies, in their order"
    )
    if repeats:
        said += f"; {repeats} touches without a line are where the one before is"
    if left := moves - lines - repeats:
        said += (
            f"; {left} are left out, as it cannot be told which they repeat, so the rest may "
            "scatter more than all do"
        )
    if open_lines:
        said += (
            f"; {open_lines} lines fit moves that differ, and only what is the same in these was "
            "taken"
        )
    return said


def _kind(move: ProbeMove) -> tuple[object, ...]:
    return move.axis, move.sign, move.share, move.feed


def _in_common(moves: Sequence[ProbeMove]) -> ProbeMove:
    """Give what is the same in all of these moves."""
    axis = only(move.axis for move in moves)
    return ProbeMove(
        line=moves[0].line,
        axis=axis,
        sign=only(move.sign for move in moves),
        share=only(move.share for move in moves),
        start={
            a: at for a in AXES if (at := only(move.start.get(a) for move in moves)) is not None
        },
        feed=only(move.feed for move in moves),
        targets={a: only(move.targets.get(a) for move in moves) for a in moves[0].targets},
    )


def only(values: Iterable[Value | None]) -> Value | None:
    """Give the value that all are, or None."""
    found = set(values)
    return found.pop() if len(found) == 1 else None
