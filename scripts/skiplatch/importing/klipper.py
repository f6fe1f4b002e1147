"""Klipper: klippy.log, or a console with PROBE, PROBE_ACCURACY or another probing command."""

import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from skiplatch.campaign.session_names import HOMING
from skiplatch.errors import InputError
from skiplatch.importing.console import CHANGING, CONTACT, Console, thermometer_name
from skiplatch.importing.dialects import advice
from skiplatch.importing.klipper_cartographer import PREFIX, Cartographer
from skiplatch.importing.klipper_commands import COMMAND, MOVED, PROBE_SPEED, TOOL
from skiplatch.importing.klipper_config import Config
from skiplatch.importing.klipper_starts import Starts
from skiplatch.importing.klipper_torn import PROBE, Lacking, without_torn_end
from skiplatch.importing.log_lines import Line, read_lines, read_text
from skiplatch.importing.model import Imported
from skiplatch.numbers import NUMBER
from skiplatch.tables import counted
from skiplatch.units import S_PER_MIN

_WRAPPED = re.compile(rf"\bprobe(?:: at| at) {NUMBER},\s*{NUMBER},?$", re.IGNORECASE)
"""Cut before its z, as a console does that is narrower than its lines."""
_ACCURACY = re.compile(
    rf"(?:PROBE|TOUCH)[_ ]ACCURACY:? at X:({NUMBER}) Y:({NUMBER}) Z:({NUMBER})"
    r"(?:\s*\((?P<options>[^)]*))?",
    re.IGNORECASE,
)
_ACCURACY_SPEED = re.compile(rf"^and read (\d+) times with speed of ({NUMBER}) mm/s")
"""What stood on a line of its own up to 2020."""
_MISSED = re.compile(r"No trigger on probe after full movement", re.IGNORECASE)
_FALSE = re.compile(r"Probe triggered prior to movement", re.IGNORECASE)
_OPTION = re.compile(rf"(\w+)=({NUMBER})")
_STATS = re.compile(rf"^Stats ({NUMBER}):")
_TEMPERATURE = re.compile(rf"([^\s:=]+): (?:target={NUMBER} )?temp=({NUMBER})")
_RESULTS = re.compile(
    rf"^(?:probe|touch) accuracy results(?:: maximum ({NUMBER}), minimum ({NUMBER}))?",
    re.IGNORECASE,
)
_RULER = re.compile(r"^={5,}(?:( Config file )=*)?$")
_HALF_DIGIT_MM_S = 0.0501  # of the speed that PROBE_ACCURACY prints
_DEFAULT_SPEED_MM_S = 5.0  # Config_Reference.md, [probe] speed


def read_klipper(path: Path, feed: float | None) -> Imported:
    """Read klippy.log or a console.

    Args:
        path: The log.
        feed: In mm/min, where the log does not say it.

    Raises:
        InputError: It cannot be read, or holds no touch.
    """
    reader = _Reader(feed)
    lines = read_lines(path)
    whole = without_torn_end(lines)
    for line in whole:
        reader.take(line)
    if not reader.has_touched:
        expected = 'expected lines such as "probe at 97.000,2.000 is z=1.320000"'
        if reader.has_results:
            expected += ", got results of a test alone: keep the lines above them too"
        raise InputError(path, None, None, advice(read_text(path)) or expected)
    found = reader.result()
    if len(whole) < len(lines):
        found.unread.append(f"a touch that the end of the log cuts off: line {lines[-1].number}")
    return found


class _Reader(Console):
    """Follows a log line by line."""

    def __init__(self, feed: float | None) -> None:
        super().__init__(feed)
        self.has_results = False
        self._options: dict[str, float] = {}
        self._starts = Starts()
        self._stats_s: float | None = None
        self._is_config = False
        self._config = Config()
        self._command_speed: float | None = None
        self._last_place: tuple[float, float] | None = None
        self._feeds_from: list[str] = []
        self._at_default = 0
        self._tool = ""
        self._begun = ""
        self._limited: Counter[str] = Counter()
        self._tested_place: tuple[float, float] | None = None
        self._lacking = Lacking()
        self._cartographer = Cartographer()
        self._standing = 0

    def take(self, line: Line) -> None:
        """Take in a line; one that is wrapped goes on in the next."""
        if self._begun:
            line = replace(line, text=f"{self._begun}{line.text}")
        self._begun = f"{line.text} " if _WRAPPED.search(line.text) else ""
        text = line.text.removeprefix(PREFIX)
        self.take_temperatures(text)
        is_by_contact = self._cartographer.begins(text)
        if match := PROBE.search(text):
            self._touch(match, line)
        elif match := _ACCURACY.search(text):
            self._test_begins(match, is_by_contact=is_by_contact)
        elif touches := self._cartographer.touches(text):
            self._contacts(touches, line)
        elif match := _ACCURACY_SPEED.match(text):
            self._options |= {"samples": float(match[1]), "speed": float(match[2])}
        elif _MISSED.search(text) or _FALSE.search(text):
            self._failed(line)
        elif not self._is_of_log(text):
            self._config.take(text)
            if not self._is_config:  # whose macros hold commands that nobody gave
                self._happened(text)
                self._tested_to_end(line)

    def _is_of_log(self, text: str) -> bool:
        """Take a line of statistics or around the configuration, if it is one."""
        if match := _STATS.match(text):
            self._stats_s = float(match[1])
            self._take_sensors(text)
        elif match := _RULER.match(text):
            self._is_config = match[1] is not None
        return match is not None

    def _take_sensors(self, text: str) -> None:
        """Take the temperatures of a statistics line; 0 is that of a sensor not read yet."""
        for name, value in _TEMPERATURE.findall(text):
            if self._config.is_of_machine(name) and float(value) != 0.0:
                self.temperatures[thermometer_name(name)] = float(value)

    def _happened(self, text: str) -> None:
        """Take a command without its comment, or what one prints beside touches."""
        text = text.partition(";")[0].rstrip()  # parentheses are none of Klipper's comments
        is_homed = self.take_moved(text, MOVED) == HOMING
        speed = PROBE_SPEED.search(text)
        if tool := TOOL.match(text):
            self._takes_tool(tool)
        if speed or is_homed or tool or COMMAND.match(text):
            self._command_ends()
            self.take_method(text)
            self._command_speed = float(speed[1]) if speed else None

    def _takes_tool(self, command: re.Match[str]) -> None:
        """Take which tool is asked for; the one that is there is no change."""
        name = " ".join(command.groups()).split(";")[0].split("*")[0].strip().upper()
        if name != self._tool:
            self.take_moved(command[0], {CHANGING: TOOL})
        self._tool = name

    def _tested_to_end(self, line: Line) -> None:
        """Take the results of PROBE_ACCURACY."""
        if not (results := _RESULTS.match(line.text)):
            return
        self.has_results = True
        self._lacking.ends(self._options.get("samples"), f"line {line.number}")
        if results[1]:
            self.take_extremes(results[2], results[1], line)
        self._command_ends()

    def _command_ends(self) -> None:
        """Forget what was said of a command, as the next one goes by its own words."""
        self._options, self._command_speed = {}, None
        self._starts.command_ends()
        self._tested_place = None

    def _contacts(self, touches: Sequence[float], line: Line) -> None:
        """Take touches by the nozzle, whose speed has no default."""
        method, self._method = self._method, CONTACT
        for z in touches:
            place = self._tested_place or ()
            self.add(z, place, line, feed=self._speed(default=None), time_s=self._stats_s)
        self._method = method
        if self._cartographer.shows_touches:
            self._tested = []  # as the extremes of the test are those of its readings

    def _test_begins(self, match: re.Match[str], *, is_by_contact: bool) -> None:
        """Take what PROBE_ACCURACY says that it will do; its speed has one decimal only."""
        self._options = {k: float(v) for k, v in _OPTION.findall(match["options"] or "")}
        typed = self._command_speed
        if typed and abs(self._options.get("speed", math.inf) - typed) <= _HALF_DIGIT_MM_S:
            self._options["speed"] = typed
        self.test_begins()
        self._lacking.begins()
        self._starts.test_begins(float(match[3]))
        if is_by_contact:  # it says how many readings, each of which takes several touches
            self._options.pop("samples", None)
        self._tested_place = (float(match[1]), float(match[2]))

    def _touch(self, match: re.Match[str], line: Line) -> None:
        x, y, z = (float(match[group]) for group in (1, 2, 4))
        if match[3] is not None:
            self._distance(float(match[3]) - z, (x, y), line)
            return
        if self._lacking.sampled == self._options.get("samples"):
            self._command_ends()  # by its number, as a delta prints other X and Y each time
        start = self._starts.touched(match[0], z, self._options.get("retract"), self._config)
        self.add(z, (x, y), line, feed=self._speed(), start=start, time_s=self._stats_s)
        self._last_place, self._tested_place = (x, y), None
        self._lacking.sampled += 1

    def _failed(self, line: Line) -> None:
        """Take an attempt without a touch, which ends its command, where the last one was."""
        self.add(
            None,
            self._tested_place or self._last_place or (),
            line,
            feed=self._speed(),
            time_s=self._stats_s,
            is_false=bool(_FALSE.search(line.text)),
        )
        self._command_ends()
        self._starts.failed()

    def _distance(self, z: float, place: tuple[float, float], line: Line) -> None:
        """Take what a probe reads that stands still: the bed lies so far below where it stands."""
        self._standing += 1
        self.add(z, place, line, feed=self.feed, time_s=self._stats_s)

    def _speed(self, default: float | None = _DEFAULT_SPEED_MM_S) -> float | None:
        """Give the feed in mm/min: as asked for, unless the configuration allows Z less."""
        speed = self._asked_speed()
        if speed is None:
            if default is None:
                return None
            self._at_default += 1
            speed = default
        limit = self._config.fastest_z()
        if limit and speed > limit[0]:
            self._limited[f"[printer] {limit[1]} is {limit[0]:g} mm/s"] += 1
            speed = limit[0]
        return speed * S_PER_MIN

    def _asked_speed(self) -> float | None:
        """Give the speed in mm/s, if it is known, and remember where it is from."""
        for speed, source in (
            (self._options.get("speed"), "PROBE_ACCURACY"),
            (self._command_speed, "PROBE_SPEED"),
            (self.feed / S_PER_MIN if self.feed else None, "--feed"),
            (self._config.probing_speed(), "the configuration in the log"),
        ):
            if speed is not None:
                if source not in self._feeds_from:
                    self._feeds_from.append(source)
                return speed
        return None

    def result(self) -> Imported:
        """Say what was found."""
        self._lacking.ends(self._options.get("samples"), "at the end")
        found = self.imported("klipper")
        self._lacking.say(found)
        self._starts.say(found)
        self._cartographer.say(found)
        self._feeds(found)
        self._config.put_into(found)
        found.known.append("where each touch was latched, and at which X and Y")
        if any(touch.time_s is not None for touch in self.touches) and self._stats_s is not None:
            found.assumed.append(
                "times are those of the statistics lines before, 1 s apart, spread evenly"
            )
        if not self.say_temperatures(found):
            found.assumed.append("no temperatures before a touch: klippy.log has them")
        return found

    def _feeds(self, found: Imported) -> None:
        if self._standing:
            found.known.append(
                f"{self._standing} distances that a probe read at rest, such as Beacon: no feed, "
                "and nothing of a delay"
            )
            if self.feed is None:
                needed = "diagnose needs a feed all the same, by which nothing is found"
                found.assume(needed, "--feed", by="give")
            return
        if self._feeds_from:
            found.known.append(f"feeds from {' and '.join(self._feeds_from)}")
        found.known += [
            f"{counted(touches, 'touch')} slower than asked for, as {why}"
            for why, touches in self._limited.items()
        ]
        if self._at_default:
            found.assume(
                f"{counted(self._at_default, 'touch')} at Klipper's default of "
                f"{_DEFAULT_SPEED_MM_S:g} mm/s: the log does not say their speed",
                "--feed",
            )
