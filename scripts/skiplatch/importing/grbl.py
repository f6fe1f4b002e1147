"""grbl, grblHAL, FluidNC, Grbl_Esp32: ``[PRB:…]``, the commands before it, and `$` settings."""

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.importing.gcode import AXES, Machine, ProbeMove
from skiplatch.importing.grbl_dialogue import Dialogue, command_in, probes
from skiplatch.importing.log_lines import Line, read_lines, spread_times
from skiplatch.importing.model import NO_TIMES, Imported, Touch
from skiplatch.importing.presets import PRESETS, Preset
from skiplatch.units import MM_PER_INCH, UM_PER_MM

_PRB = re.compile(r"\[PRB:\s*([-\d.,\s]+?):\s*([01])\s*\]", re.IGNORECASE)
_SETTING = re.compile(r"\$(\d{1,3})\s*=\s*(-?\d+\.?\d*)")
_MODES = re.compile(r"\[GC:([^\]]*)\]")
_FEED_0 = re.compile(r"\bF0(?:\.0*)?\b")
_ANSWERED = re.compile(r"^\[ (?!\[)(.+?) \]\s+(?:ok|\[|error|ALARM)")
_IN_MACHINE = re.compile(r"G53\b", re.IGNORECASE)
_OFFSETS = re.compile(r"G(?:10|92|5[4-9])\b", re.IGNORECASE)
_GRBL_HAL = re.compile(r"grblhal|fluidnc|esp32|\[MSG:INFO", re.IGNORECASE)
_PARAMETERS = re.compile(r"\[(?:G5[4-9](?:\.\d)?|G28|G30|G92|TLO|TLR|HOME):", re.IGNORECASE)
_ASKS = re.compile(r"\[?\s*\$#")
_RANGE = re.compile(r"\bAxis ([XYZABC]) \((-?\d+\.?\d*),\s*(-?\d+\.?\d*)\)", re.ASCII)
_HOMED = re.compile(r"\$H\b|Grbl \d|FluidNC v", re.IGNORECASE)
_STEPS, _ACCEL, _INCHES = 100, 120, 13
DIGIT_MM = 1e-3  # the last that is printed
DIGIT_INCH = 1e-4
HALF_A_DIGIT_MM = 0.51 * DIGIT_MM
FARTHEST_MM = 1e6  # that any machine goes
MOST_STEPS_PER_MM = 800.0  # with more of them, any printed number is near a step


def read_grbl(path: Path, feed: float | None, *, inch: bool = False) -> Imported:
    """Read the log of a serial line.

    Args:
        path: The log.
        feed: In mm/min, where the log has no commands.
        inch: Whether commands and replies are in inches, where the log does not say it.

    Raises:
        InputError: It cannot be read, or holds no ``[PRB:…]``.
    """
    reader = _Reader(feed, inch=inch)
    for line in read_lines(path):
        reader.take(line)
    if not reader.touches:
        raise InputError(path, None, None, "expected replies such as [PRB:0.000,0.000,-5.123:1]")
    if all(touch.coordinate is None for touch in reader.touches):
        message = (
            f"expected a touch, got {len(reader.touches)} probing moves that ended without one"
        )
        raise InputError(path, None, None, message)
    return reader.result()


class _Reader:
    """Follows commands and replies."""

    def __init__(self, feed: float | None, *, inch: bool) -> None:
        self.touches: list[Touch] = []
        self._machine = Machine(is_inch=inch)
        self._program: dict[str, float] = {}  # where its absolute moves went, as it counts
        self._inch = inch
        self._dialogue = Dialogue(self._execute)
        self._feed = feed
        self._settings: dict[int, float] = {}
        self._last: tuple[float, ...] | None = None
        self._session = 0
        self._is_hal = False
        self._lists_parameters = False
        self._ranges: dict[str, tuple[float, float]] = {}
        self._guessed = 0

    def take(self, line: Line) -> None:
        """Take in a line: settings, a command, a reply, or several of them in one."""
        for number, value in _SETTING.findall(line.text):
            self._settings[int(number)] = float(value)
        if ends := _RANGE.search(line.text):
            self._ranges[ends[1]] = (float(ends[2]), float(ends[3]))
        self._is_hal = self._is_hal or bool(_GRBL_HAL.search(line.text))
        if _HOMED.search(line.text) and self.touches:
            self._session += 1
        if modes := _MODES.search(line.text):
            self._machine.execute(_FEED_0.sub("", modes[1]), line.number)
            return
        reply = _PRB.search(line.text)
        if self._repeats_the_last(line, is_reply=reply is not None):
            return
        self._dialogue.started(line.text)
        if not self._answered(line, has_touched=reply is not None):
            before = line.text[: reply.start()] if reply else line.text
            if command := command_in(before):
                self._dialogue.sent(command, line)
        if reply:
            self._reply(reply, line)
        elif move := self._dialogue.answered(line.text):
            self._not_begun(move, line)

    def _repeats_the_last(self, line: Line, *, is_reply: bool) -> bool:
        """Tell the last touch in the list of parameters that $# asks for."""
        if is_reply:
            return self._lists_parameters or bool(_ASKS.match(line.text))
        self._lists_parameters = bool(_PARAMETERS.match(line.text))
        return False

    def _answered(self, line: Line, *, has_touched: bool) -> bool:
        """Take a line with a command and its answer, ``[ G38.2 X62 F80 ] [PRB:…]``.

        The command stands there again with each further answer, so one that probes counts only
        with a touch.
        """
        answered = _ANSWERED.match(line.text)
        if answered is None:
            return False
        if has_touched or not probes(answered[1]):
            self._dialogue.sent(answered[1], line, is_answered=True)
        return True

    def _execute(self, text: str, line: Line) -> ProbeMove | None:
        """Carry out a command and give the probing move in it."""
        before = dict(self._machine.position)
        move = self._machine.execute(text, line.number)
        places = {n: v for n, v in self._machine.words(text) if n in AXES and v is not None}
        if _IN_MACHINE.search(text):
            unit = MM_PER_INCH if self._machine.is_inch else 1.0
            self._machine.position = before | {n: v * unit for n, v in places.items()}
            self._program = {n: v for n, v in self._program.items() if n not in places}
        elif self._machine.is_relative or _OFFSETS.search(text):
            self._program.clear()
        else:
            move = self._in_unknown_offset(move, places)
        return move

    def _in_unknown_offset(
        self, move: ProbeMove | None, places: dict[str, float]
    ) -> ProbeMove | None:
        """Forget what hangs on the offset between the program's coordinates and the machine's.

        What is left is the sense, from the place that the program named before.
        """
        senses = {n: v - self._program[n] for n, v in places.items() if n in self._program}
        self._program |= places
        for letter in places:
            self._machine.position.pop(letter, None)
        if move is None:
            return None
        self._program.clear()  # it ends at the surface
        way = senses.get(move.axis or "", 0.0)
        fallback = -1 if move.axis == "Z" else None
        return replace(move, sign=int(math.copysign(1, way)) if way else fallback)

    @property
    def _replies_in_inches(self) -> bool:
        return self._settings.get(_INCHES, self._inch) == 1

    def _reply(self, reply: re.Match[str], line: Line) -> None:
        try:
            numbers = [float(value) for value in reply[1].split(",")]
        except ValueError:
            return
        unit = MM_PER_INCH if self._replies_in_inches else 1.0
        position = tuple(v * (unit if i < 3 else 1.0) for i, v in enumerate(numbers[: len(AXES)]))
        move = self._dialogue.touched()
        axis = (move.axis if move else None) or self._guess(position)
        index = AXES.index(axis)
        if index >= len(position):
            return
        missed = reply[2] == "0"
        start = move.start.get(axis) if move else None
        self.touches.append(
            Touch(
                axis=axis,
                coordinate=None if missed else position[index],
                sign=(move.sign if move else None) or (-1 if axis == "Z" else None),
                place=tuple(v for i, v in enumerate(position) if i != index),
                feed=(move.feed if move else None) or self._feed,
                start=None if missed else start,
                time_s=line.time_s,
                session=self._session_name(),
                is_release=bool(move and move.is_release),
            )
        )
        self._last = position
        # The reply is in machine coordinates; the program goes on from there in its own, which
        # are the same only where no offset is set. Relative moves need no more than this.
        self._machine.position = dict(zip(AXES, position, strict=False))
        self._dialogue.catch_up()

    def _not_begun(self, move: ProbeMove, line: Line) -> None:
        """Take a move that the controller refused, as the probe was triggered before (ALARM:4)."""
        axis = move.axis or "Z"
        self.touches.append(
            Touch(
                axis=axis,
                coordinate=None,
                sign=move.sign or (-1 if axis == "Z" else None),
                place=tuple(v for i, v in enumerate(self._last or ()) if i != AXES.index(axis)),
                feed=move.feed or self._feed,
                time_s=line.time_s,
                session=self._session_name(),
                is_false=True,
            )
        )

    def _session_name(self) -> str:
        return f"after homing {self._session}" if self._session else ""

    def _guess(self, position: Sequence[float]) -> str:
        """Take the axis that moved since the touch before, or Z."""
        self._guessed += 1
        if self._last is None or len(self._last) != len(position):
            return "Z"
        ways = [abs(a - b) for a, b in zip(position, self._last, strict=True)]
        return AXES[ways.index(max(ways))] if max(ways) > 0 else self.touches[-1].axis

    def result(self) -> Imported:
        """Say what was found."""
        found = Imported(preset="grblhal" if self._is_hal else "grbl-avr", touches=self.touches)
        for touch, time_s in zip(
            self.touches, spread_times([t.time_s for t in self.touches]), strict=True
        ):
            touch.time_s = time_s
        axis = AXES.index(self.touches[-1].axis) if self.touches[-1].axis in "XYZ" else 2
        if steps := self._settings.get(_STEPS + axis):
            found.figure("axis", "resolution_um", UM_PER_MM / steps, f"${_STEPS + axis} of the log")
        if accel := self._settings.get(_ACCEL + axis):
            found.figure("axis", "accel_mm_s2", accel, f"${_ACCEL + axis} of the log")
        self._put_on_steps()
        found.leave_out_releases()
        has_settings = bool(found.figures)
        step = found.figures.get(("axis", "resolution_um"))
        if self._replies_in_inches and (
            step is None or step.value < DIGIT_INCH * MM_PER_INCH * UM_PER_MM
        ):
            digit_um = DIGIT_INCH * MM_PER_INCH * UM_PER_MM
            found.figure("axis", "resolution_um", digit_um, "a digit of the replies in inches")
        if not has_settings and self._is_finer_than(PRESETS[found.preset]):
            found.figure("axis", "resolution_um", DIGIT_MM * UM_PER_MM, "a digit of the replies")
        if ends := self._ranges.get(self.touches[-1].axis):
            found.reach(*ends, "the range that FluidNC tells at its start")
        self._say(found, has_settings=has_settings)
        return found

    def _is_finer_than(self, preset: Preset) -> bool:
        """Tell whether the replies fall between the steps that such a controller has."""
        step_mm = preset.figures["axis", "resolution_um"].value / UM_PER_MM
        latched = [place for touch in self.touches if (place := touch.coordinate) is not None]
        beside = (abs(z - round(z / step_mm) * step_mm) for z in latched if abs(z) < FARTHEST_MM)
        return any(way > HALF_A_DIGIT_MM for way in beside)

    def _put_on_steps(self) -> None:
        """Give the coordinates the digits that three decimals cut off: grbl counts whole steps."""
        for axis in {touch.axis for touch in self.touches} & set("XYZ"):
            latched = [t for t in self.touches if t.axis == axis and t.coordinate is not None]
            steps = self._settings.get(_STEPS + AXES.index(axis), 0.0)
            told = [touch.coordinate or 0.0 for touch in latched]
            if not 0.0 < steps < MOST_STEPS_PER_MM or any(abs(z) > FARTHEST_MM for z in told):
                continue
            whole = [round(z * steps) / steps for z in told]
            if all(abs(w - z) <= HALF_A_DIGIT_MM for w, z in zip(whole, told, strict=True)):
                for touch, coordinate in zip(latched, whole, strict=True):
                    touch.coordinate = coordinate

    def _say(self, found: Imported, *, has_settings: bool) -> None:
        found.known.append("where each touch was latched, in machine coordinates")
        false = sum(touch.is_false for touch in self.touches)
        missed = sum(touch.coordinate is None for touch in self.touches) - false
        if missed:
            found.known.append(f"probing moves that ended without a touch (:0]): {missed}")
        if false:
            found.known.append(f"false triggers, before the axis moved (ALARM:4): {false}")
        if not has_settings:
            steps = "" if found.figures else "steps per mm and "
            found.assumed.append(
                f"no $ settings in the log: {steps}acceleration as grbl has it by default; "
                "type $$ before probing"
            )
        if self._guessed:
            found.assumed.append(
                f"{self._guessed} replies have no command before them: their axis is the one that "
                "moved, else Z, their sense is not known"
            )
        if any(touch.axis == "Z" for touch in self.touches):
            found.assumed.append("Z was touched from above where no command says otherwise")
        if any(touch.feed is None for touch in self.touches):
            found.assumed.append("the feed is not known: log the commands too, or give --feed")
        if all(touch.time_s is None for touch in self.touches):
            found.assumed.append(NO_TIMES)
        found.assumed.append(
            f"a controller as {found.preset!r} stands for (skiplatch init --preset)"
        )
