"""grbl, grblHAL, FluidNC, Grbl_Esp32: ``[PRB:…]``, the commands before it, and `$` settings."""

import re
from collections.abc import Sequence
from pathlib import Path

from skiplatch.campaign.session_names import HOMING, session_after
from skiplatch.errors import InputError
from skiplatch.importing.dialects import advice
from skiplatch.importing.gcode import without_comments
from skiplatch.importing.grbl_commands import Commands
from skiplatch.importing.grbl_dialogue import Dialogue, command_in, probes
from skiplatch.importing.grbl_digits import DIGIT_INCH, DIGIT_MM, are_finer_than, put_on_steps
from skiplatch.importing.grbl_finding import Finding
from skiplatch.importing.grbl_guesses import Guesses
from skiplatch.importing.grbl_replies import Reply, Unit, reply_in
from skiplatch.importing.grbl_settings import ACCEL, INCHES, STEPS, say_missing, settings_in
from skiplatch.importing.grbl_speed import Speeds, limit
from skiplatch.importing.log_lines import Line, read_lines, read_text
from skiplatch.importing.model import NO_TIMES, Imported, Touch, refuse_all_missed
from skiplatch.importing.presets import PRESETS, Preset
from skiplatch.importing.probe_move import AXES, LINEAR, ProbeMove
from skiplatch.importing.touch_times import begun_before
from skiplatch.numbers import NUMBER
from skiplatch.tables import counted
from skiplatch.units import MM_PER_INCH, UM_PER_MM

_MODES = re.compile(r"\[GC:([^\]]*)\]")
_ANSWERED = re.compile(r"^\[ (?!\[)(.+?) \]\s+(?:ok|\[|error|ALARM)")
_GRBL_HAL = re.compile(
    r"grblhal|fluidnc|esp32|'\$HELP'|\[(?:MSG:(?:INFO|WARN|ERR|DBG)\b|NEWOPT:|BOARD:)"
    r"|^\W*\$[3-9]\d\d ?=",
    re.IGNORECASE,
)
_PARAMETERS = re.compile(r"\[(?:G5[4-9](?:\.\d)?|G28|G30|G92|TL[O0R]|HOME):", re.IGNORECASE)
_ASKS = re.compile(r"\[?\s*\$#")
_RANGE = re.compile(rf"\bAxis ([XYZABC]) \(({NUMBER}),\s*({NUMBER})\)")
_HOMED = re.compile(r"(?<!')\$H[XYZABC]?\b(?!')|Grbl(?:HAL)? \d|FluidNC v", re.IGNORECASE)
"""Homed or switched on; an alarm only names '$H' among what would unlock."""


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
        message = f"expected replies such as [PRB:0.000,0.000,-5.123:1]{reader.instead}"
        raise InputError(path, None, None, advice(read_text(path)) or message)
    refuse_all_missed(path, reader.touches)
    return reader.result()


class _Reader:
    """Follows commands and replies."""

    def __init__(self, feed: float | None, *, inch: bool) -> None:
        self.touches: list[Touch] = []
        self.broken = 0
        self._commands = Commands(inch=inch)
        self._unit = Unit(inch=inch)
        self._speeds = Speeds()
        self._finding = Finding()
        self._dialogue = Dialogue(self._execute)
        self._feed = feed
        self._settings: dict[int, float] = {}
        self._last: tuple[float, ...] | None = None
        self._session = 0
        self._is_hal = False
        self._lists_parameters = False
        self._listed = 0
        self._ranges: dict[str, tuple[float, float]] = {}
        self._guessed = Guesses(self.touches)
        self._beside_ok = 0
        self._without_sense = 0

    def take(self, line: Line) -> None:
        """Take in a line: settings, a command, a reply, or several of them in one."""
        plain = without_comments(line.text)
        for number, value in settings_in(line.text):
            self._settings[number] = value
            if number == INCHES:
                self._unit.tell(inch=value == 1)
        if ends := _RANGE.search(line.text):
            self._ranges[ends[1]] = (float(ends[2]), float(ends[3]))
        self._is_hal = self._is_hal or bool(_GRBL_HAL.search(line.text))
        if _HOMED.search(plain):
            self._session += bool(self.touches)
            self._commands.homed()
        if modes := _MODES.search(line.text):
            self._commands.take_modes(modes[1], line)
            return
        self._speeds.take(line.text, is_probing=self._dialogue.is_probing)
        self._take_dialogue(line)

    def _take_dialogue(self, line: Line) -> None:
        """Take in a line that is a command, a reply, another answer, or several in one."""
        reply = reply_in(line.text)
        if self._repeats_the_last(line, is_reply=reply is not None):
            return
        if self._dialogue.started(line.text):
            self._speeds.restarted()
            self._commands.restarted()
        if not self._answered(line, has_reply=reply is not None):
            before = line.text[: reply.begin] if reply else line.text
            if command := command_in(before):
                self._dialogue.sent(command, line)
        if reply:
            self._reply(reply, line)
            self._dialogue.catch_up()
        elif move := self._dialogue.answered(line.text):
            self._not_begun(move, line)

    @property
    def instead(self) -> str:
        """What a log without a touch holds in its place, for a message; empty if nothing."""
        if self.broken:
            return f", got {self.broken} cut or garbled"
        if self._listed:
            return ", got only the last one again, as $# lists it: log the probing itself"
        if self._dialogue.is_probing:
            return ", got probing commands without them: log what the controller answers, too"
        return ""

    def _repeats_the_last(self, line: Line, *, is_reply: bool) -> bool:
        """Tell the last touch in the list of parameters that $# asks for."""
        if is_reply:
            is_listed = self._lists_parameters or bool(_PARAMETERS.search(line.text))
            is_listed = is_listed or bool(_ASKS.match(line.text))
            self._lists_parameters = False  # it ends with the last touch
            self._listed += is_listed
            return is_listed
        self._lists_parameters = bool(_PARAMETERS.match(line.text))
        return False

    def _execute(self, command: str, line: Line) -> ProbeMove | None:
        """Carry out a command, once what was sent before it is done."""
        self._finding.sent(command, len(self.touches))
        return self._commands.execute(command, line)

    def _answered(self, line: Line, *, has_reply: bool) -> bool:
        """Take a line with a command and its answer, ``[ G38.2 X62 F80 ] [PRB:…]``.

        The command stands there again with each further answer, so one that probes counts only
        with its reply.
        """
        answered = _ANSWERED.match(line.text)
        if answered is None:
            return False
        command = without_comments(answered[1])
        if has_reply or not probes(command):
            self._dialogue.sent(command, line, is_answered=True)
        else:
            self._beside_ok += 1
        return True

    def _reply(self, reply: Reply, line: Line) -> None:
        """Take what a probing move ended with; one that is broken answers its move all the same."""
        move = self._dialogue.touched()
        position = self._unit.position(reply)[: len(AXES)] if reply.numbers else ()
        is_told = reply.has_touched or bool(move and move.ended_at(position))
        # Where an alarm ended it, the reply has the place of a touch before, or zeros.
        place = position if is_told or not position else self._last or ()
        feed = self._speeds.feed(move.feed if move else None, self._unit.mm)
        axis = (move.axis if move else None) or self._guessed.axis(place, self._last)
        index = AXES.index(axis)
        if index >= len(position):
            self.broken += 1
            return
        start = move.start_to(axis, position[index]) if move else None
        self._without_sense += bool(move and move.sign is None and axis != "Z")
        self.touches.append(
            Touch(
                axis=axis,
                coordinate=position[index] if reply.has_touched else None,
                sign=(move.sign if move else None) or (-1 if axis == "Z" else None),
                place=_beside(place, axis),
                feed=feed or self._feed,
                share=move.share if move else 1.0,
                start=start if reply.has_touched else None,
                time_s=line.time_s,
                session=self._session_name(),
                line=line.number,
                is_release=bool(move and move.is_release),
            )
        )
        if is_told:
            self._last = position
            self._commands.touched(position)

    def _not_begun(self, move: ProbeMove, line: Line) -> None:
        """Take a move that the controller refused, as the probe was triggered before (ALARM:4)."""
        axis = move.axis or "Z"
        self.touches.append(
            Touch(
                axis=axis,
                coordinate=None,
                sign=move.sign or (-1 if axis == "Z" else None),
                place=_beside(self._last or (), axis),
                feed=move.feed or self._feed,
                share=move.share,
                time_s=line.time_s,
                session=self._session_name(),
                line=line.number,
                is_false=True,
            )
        )

    def _session_name(self) -> str:
        return session_after({HOMING: self._session, "tool change": self._commands.tools})

    def result(self) -> Imported:
        """Say what was found."""
        found = Imported(preset="grblhal" if self._is_hal else "grbl-avr", touches=self.touches)
        found.assumed += begun_before(self.touches)
        self._finding.leave_out(found)
        axis = AXES.index(self.touches[-1].axis) if self.touches[-1].axis in "XYZ" else 2
        if steps := self._settings.get(STEPS + axis):
            found.figure("axis", "resolution_um", UM_PER_MM / steps, f"${STEPS + axis} of the log")
        if accel := self._settings.get(ACCEL + axis):
            found.figure("axis", "accel_mm_s2", accel, f"${ACCEL + axis} of the log")
        steps_per_mm = {name: self._settings.get(STEPS + i, 0.0) for i, name in enumerate(LINEAR)}
        put_on_steps(self.touches, steps_per_mm)
        found.leave_out_releases()
        found.share_feeds()
        found.known += limit(found.touches, self._settings)
        step = found.figures.get(("axis", "resolution_um"))
        digit_um = DIGIT_INCH * MM_PER_INCH * UM_PER_MM
        if self._unit.is_inch and (step is None or step.value < digit_um):
            found.figure("axis", "resolution_um", digit_um, "a digit of the replies in inches")
        elif step is None and are_finer_than(_step_mm(PRESETS[found.preset]), self.touches):
            found.figure("axis", "resolution_um", DIGIT_MM * UM_PER_MM, "a digit of the replies")
        if ends := self._ranges.get(self.touches[-1].axis):
            found.reach(*ends, "the range that FluidNC tells at its start")
        self._say(found, axis)
        return found

    def _say(self, found: Imported, axis: int) -> None:
        found.known.append("where each touch was latched, in machine coordinates")
        false = sum(touch.is_false for touch in self.touches)
        missed = sum(touch.coordinate is None for touch in self.touches) - false
        if missed:
            found.known.append(f"probing moves that ended without a touch (:0]): {missed}")
        if false:
            found.known.append(f"false triggers, before the axis moved (ALARM:4): {false}")
        found.known += self._speeds.known()
        if self.broken:
            found.unread.append(f"replies ([PRB:…]) that are cut or garbled: {self.broken}")
        say_missing(found, self._settings, axis)
        for words, *options in self._unit.assumed(self._commands.units):
            found.assume(words, *options)
        found.assumed += self._speeds.assumed()
        self._say_moves(found)
        if any(touch.feed is None for touch in self.touches):
            found.assume("the feed is not known: log the commands too", "--feed", by="or give")
        if all(touch.time_s is None for touch in self.touches):
            found.assumed.append(NO_TIMES)
        found.assumed.append(
            f"a controller as {found.preset!r} stands for (skiplatch init --preset)"
        )

    def _say_moves(self, found: Imported) -> None:
        if self._guessed.count:
            found.assumed.append(
                f"{self._guessed.count} replies have no command before them: their axis is the one "
                "that moved, else Z, their sense is not known"
            )
        if self._commands.tools:
            found.assumed.append(
                f"sessions of their own after a change of the tool (M6): {self._commands.tools}"
            )
        if self._guessed.count and self._beside_ok:
            found.assumed.append("probing commands beside an ok do not tell which reply is theirs")
        if self._without_sense:
            found.assumed.append(
                f"the sense of {counted(self._without_sense, 'touch')} is not known, as no G91 and "
                "no place before tells it: log the commands from the beginning"
            )
        if any(touch.axis == "Z" for touch in self.touches):
            found.assumed.append("Z was touched from above where no command says otherwise")


def _beside(position: Sequence[float], axis: str) -> tuple[float, ...]:
    return tuple(v for i, v in enumerate(position) if i != AXES.index(axis))


def _step_mm(preset: Preset) -> float:
    return preset.figures["axis", "resolution_um"].value / UM_PER_MM
