"""Programs of G-code: loops, branches and subroutines, with what is known of parameters.

A probing move is taken for one that has touched, unless the log says that it went on to its
target, and a condition that is not known for true.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from skiplatch.importing.gcode import HAS_TOUCHED, Machine, bracketed, without_comments
from skiplatch.importing.probe_move import ProbeMove

MOST_LINES = 10_000  # executed, and so many more a touch, so that a loop that never ends does
MOST_LINES_A_TOUCH = 100
MOST_CALLS = 20  # within each other
LAST_LOCAL = 30  # parameters from #1 to this belong to a subroutine
BRANCHES = ("IF", "ELSEIF", "ELSE", "ENDIF")

_OFFSETS = re.compile(
    r"(?<![A-Z#<])G\s*0*(5[4-9]|59\.[123]|43|43\.[12]|49|52|92|92\.[123])(?![\d.])", re.IGNORECASE
)
_FLOW = re.compile(
    r"^\s*O\s*(<[^>]*>|[0-9]+)\s*"
    r"(REPEAT|ENDREPEAT|WHILE|ENDWHILE|DO|SUB|ENDSUB|CALL|RETURN|IF|ELSEIF|ELSE|ENDIF)\b\s*(.*)$",
    re.IGNORECASE,
)
_LOGGING = re.compile(r"^[^;]*\(\s*PROBE(OPEN|CLOSE)\b\s*([^)]*)", re.IGNORECASE)
_ENDS = re.compile(r"(?<![A-Z#<\d])M\s*0*(?:2|30)(?![\d.])", re.IGNORECASE)
_SKIPPED = re.compile(r"^[ \t]*/.*$", re.MULTILINE)

Row = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Run:
    """What a program does.

    Attributes:
        moves: The probing moves that are logged, loops and calls carried out.
        not_found: Names of subroutines that are called and not in the program.
    """

    moves: Sequence[ProbeMove]
    not_found: Sequence[str]


def offsets_of(text: str) -> list[str]:
    """Give the words by which a program selects offsets, G54 and G43 among them."""
    lines = map(without_comments, text.splitlines())
    words = (match for line in lines for match in _OFFSETS.finditer(line))
    return list(dict.fromkeys(f"G{match[1]}" for match in words))


def logs_parts(text: str) -> bool:
    """Tell whether a program says which of its probing moves are logged."""
    return any(_LOGGING.search(line) for line in text.splitlines())


def run(text: str, log: Sequence[Row], *, inch: bool = False, name: str = "") -> Run:
    """Run a program, where it has as many probing moves as its log has lines with these.

    Lines that begin with a slash are skipped, unless the log shows that they were not.

    Args:
        text: The program.
        log: Where its moves were latched, in its units. It bounds what is executed.
        inch: Whether it begins in inches.
        name: Of the log's file; where the program opens one of this name, others do not count.
    """
    without = _SKIPPED.sub("", text)
    for written in dict.fromkeys((without, text)):
        with_log = _Program(written, log, len(log), name).run(Machine(is_inch=inch), len(log) + 1)
        if len(with_log.moves) == len(log):
            return with_log
    return _Program(without, (), len(log), name).run(Machine(is_inch=inch))


class _Program:
    """Lines, and which of them belong together; lines are counted from 0."""

    def __init__(self, text: str, log: Sequence[Row], touches: int, name: str) -> None:
        self._lines = text.splitlines()
        self._most_lines = MOST_LINES + MOST_LINES_A_TOUCH * touches
        self._log = iter(log)
        self._logging = [_logged(line, name) for line in self._lines]
        if True not in self._logging:  # the log may have been renamed
            self._logging = [_logged(line) for line in self._lines]
        self._is_logged = set(self._logging) == {None}
        self._not_found: list[str] = []
        self._flow = [_FLOW.match(without_comments(line)) for line in self._lines]
        self._end_of: dict[int, int] = {}
        self._branch_after: dict[int, int] = {}
        self._subs: dict[str, int] = {}
        self._executed = 0
        self._end = self._last_line()
        self._has_ended = False
        self._pair()
        self._begin_of = {end: begin for begin, end in self._end_of.items()}

    def _last_line(self) -> int:
        """Give where a program ends that stands between lines of %."""
        filled = [i for i, line in enumerate(self._lines) if line.strip()]
        ends = (i for i in filled[1:] if self._lines[i].strip() == "%")
        return next(ends, len(self._lines))

    def _pair(self) -> None:
        """Find the ends of loops and subroutines, and of each branch the next one."""
        begun: dict[str, int] = {}
        for at, flow in enumerate(self._flow):
            if not flow:
                continue
            name, word = flow[1].lower(), flow[2].upper()
            if word in BRANCHES:
                if word != "IF" and name in begun:
                    self._branch_after[begun.pop(name)] = at
                if word != "ENDIF":
                    begun[name] = at
            elif word.startswith("END") or (word == "WHILE" and name in begun):
                if name in begun:
                    self._end_of[begun.pop(name)] = at
            elif word in ("REPEAT", "WHILE", "DO", "SUB"):
                begun[name] = at
                if word == "SUB":
                    self._subs[name] = at

    def run(self, machine: Machine, most_moves: int | None = None) -> Run:
        """Carry out the whole program, once."""
        moves = self._stretch(machine, 0, self._end, 0)
        return Run(list(islice(moves, most_moves)), self._not_found)

    def _stretch(self, machine: Machine, at: int, end: int, depth: int) -> Iterator[ProbeMove]:
        left: dict[int, int] = {}
        while at < end and self._executed < self._most_lines and not self._has_ended:
            self._executed += 1
            flow = self._flow[at]
            if flow is None:
                yield from self._execute(machine, at)
                at += 1
                continue
            word = flow[2].upper()
            if word == "RETURN":
                return
            if word == "CALL":
                yield from self._call(machine, flow, depth)
            at = self._next(machine, at, flow, left)

    def _execute(self, machine: Machine, at: int) -> Iterator[ProbeMove]:
        """Carry out a line and give the probing move in it, if it is logged."""
        if (is_logged := self._logging[at]) is not None:
            self._is_logged = is_logged
        self._has_ended = bool(_ENDS.search(without_comments(self._lines[at])))
        move = machine.execute(self._lines[at], at + 1)
        if move is None:
            return
        machine.touched(next(self._log, ()) if self._is_logged else ())
        if self._is_logged:
            move = move.latched_at(machine.position)
            axis = move.axis or ""
            if axis in machine.position and move.met_nothing(axis, machine.position[axis]):
                machine.parameters[HAS_TOUCHED] = 0.0
            yield move

    def _next(self, machine: Machine, at: int, flow: re.Match[str], left: dict[int, int]) -> int:
        """Give the line to go on at."""
        word = flow[2].upper()
        if word in BRANCHES:
            return self._branch(machine, at) if word == "IF" else self._after_branches(at)
        if word == "SUB":
            return self._end_of.get(at, len(self._lines)) + 1
        if word in ("REPEAT", "WHILE") and at in self._end_of:
            return at + 1 if _goes_on(machine, at, flow, left) else self._end_of[at] + 1
        if word == "WHILE" and at in self._begin_of:  # the end of a DO
            return self._begin_of[at] + 1 if _condition(machine, flow) else at + 1
        if word in ("ENDREPEAT", "ENDWHILE") and at in self._begin_of:
            return self._begin_of[at]
        return at + 1

    def _branch(self, machine: Machine, at: int) -> int:
        """Give where the first branch begins whose condition holds, or is not known."""
        while at in self._branch_after:
            flow = self._flow[at]
            held = machine.value(next(bracketed(flow[3]), "1")) if flow else None
            if held is None or held:
                break
            at = self._branch_after[at]
        return at + 1

    def _after_branches(self, at: int) -> int:
        """Give where the program goes on after the branch that was taken."""
        while at in self._branch_after:
            at = self._branch_after[at]
        return at + 1

    def _call(self, machine: Machine, flow: re.Match[str], depth: int) -> Iterator[ProbeMove]:
        """Carry out a subroutine with parameters of its own."""
        begin = self._subs.get(flow[1].lower())
        if begin is None or begin not in self._end_of:
            machine.position.clear()
            if flow[1] not in self._not_found:
                self._not_found.append(flow[1])
            return
        if depth >= MOST_CALLS:
            return
        caller = machine.parameters
        values = [machine.value(text) for text in bracketed(flow[3])]
        arguments = {str(i): v for i, v in enumerate(values, 1)}
        machine.parameters = {**_global(caller), **arguments}
        yield from self._stretch(machine, begin + 1, self._end_of[begin], depth + 1)
        local = {name: v for name, v in caller.items() if name not in _global(caller)}
        machine.parameters = {**local, **_global(machine.parameters)}


def _logged(line: str, name: str = "") -> bool | None:
    """Tell whether moves are logged from a line on, into a file of a name; None: as before."""
    if not (logging := _LOGGING.search(line)):
        return None
    opened = logging[2].strip().replace("\\", "/").rpartition("/")[2]
    return logging[1].upper() == "OPEN" and (not name or opened.lower() == name.lower())


def _global(parameters: dict[str, float | None]) -> dict[str, float | None]:
    """Give the parameters that all subroutines share."""
    return {
        name: value
        for name, value in parameters.items()
        if name.startswith("<_") or (name.isdecimal() and float(name) > LAST_LOCAL)
    }


def _condition(machine: Machine, flow: re.Match[str]) -> bool:
    return bool(machine.value(next(bracketed(flow[3]), "0")))


def _goes_on(machine: Machine, at: int, flow: re.Match[str], left: dict[int, int]) -> bool:
    if flow[2].upper() == "WHILE":
        return _condition(machine, flow)
    if at not in left:
        left[at] = int(machine.value(next(bracketed(flow[3]), "0")) or 0)
    left[at] -= 1
    if left[at] < 0:
        del left[at]
        return False
    return True
