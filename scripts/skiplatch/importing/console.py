"""Consoles of 3D printers: what those of Klipper and of Marlin have in common.

Both touch the bed along Z from above, print temperatures as ``B:60.1 /60.0 T0:24.3 /0.0``, and
latch elsewhere once Z was homed anew, or the gantry or the bed was adjusted.
"""

import re
from collections.abc import Mapping

from skiplatch.campaign.session_names import HOMING, begun_by, session_after
from skiplatch.importing.log_lines import Line
from skiplatch.importing.model import NO_TIMES, Imported, Touch
from skiplatch.importing.touch_times import begun_before
from skiplatch.numbers import NUMBER

_TEMPERATURE = re.compile(rf"\b(B|T[0-9]?):\s*({NUMBER})\s*/")
_PLACES = {"B": "bed", "T": "nozzle", "T0": "nozzle"}
ADJUSTING, TURNING = "adjusting Z", "turning screws"
CHANGING = "a tool change"
CONTACT = "by contact"
OFFSET = "setting the probe's offset"
"""What begins a session, as the touches after it latch elsewhere than those before."""

_METHOD = re.compile(r"\b(?:PROBE_)?METHOD\s*=\s*[\"']?(\w+)", re.IGNORECASE)
_CONTACTS = {"contact", "tap", "touch"}  # of Beacon, of Klipper's eddy current probe, of others
_NOT_IN_NAMES = re.compile(r"[^a-z0-9_.-]")
_LONGEST_NAME = 60
NAMED = 5
"""Lines that are named at most."""


def thermometer_name(name: str) -> str:
    """Give what a column temp_NAME_c calls a thermometer that somebody named."""
    return _NOT_IN_NAMES.sub("_", name.lower())[:_LONGEST_NAME]


def decimals(text: str) -> int:
    """Count those that a number is printed with."""
    return len(text.partition(".")[2])


def half_digit(text: str) -> float:
    """Give by how much a number that is printed so may be off, and a little more."""
    return 0.51 * 10.0 ** -decimals(text)


class Console:
    """Touches that a console tells, with the temperatures and the homing before each."""

    def __init__(self, feed: float | None) -> None:
        self.touches: list[Touch] = []
        self.feed = feed
        self.temperatures: dict[str, float] = {}
        self._session = ""
        self._sessions = 0
        self._method = ""
        self._has_touches = False
        self._tested: list[float] = []
        self._disagreeing: list[int] = []

    def take_temperatures(self, text: str) -> None:
        """Remember the temperatures of a line, if there are some."""
        for name, value in _TEMPERATURE.findall(text):
            self.temperatures[_PLACES.get(name, name.lower())] = float(value)

    def take_moved(self, text: str, signs: Mapping[str, re.Pattern[str]]) -> str:
        """Begin a session where a line tells that Z or the bed moved, and give by what.

        Two of them with no touch in between begin one.
        """
        what = next((what for what, sign in signs.items() if sign.search(text)), "")
        if what and self._has_touches:
            self._sessions += 1
            self._session = session_after({what: self._sessions})
            self._has_touches = False
        return what

    def take_method(self, command: str) -> None:
        """Take how a command probes: what is met by contact is none that is read from above."""
        method = _METHOD.search(command)
        self._method = CONTACT if method and method[1].lower() in _CONTACTS else ""

    def test_begins(self) -> None:
        """Begin a series of touches, whose extremes the log may tell once more."""
        self._tested = []

    def take_extremes(self, low: str, high: str, line: Line) -> None:
        """Hold what the log itself says of a series against its touches."""
        told = [(float(text), half_digit(text)) for text in (low, high)]
        if self._tested:
            found = min(self._tested), max(self._tested)
            if any(abs(f - z) > half for f, (z, half) in zip(found, told, strict=True)):
                self._disagreeing.append(line.number)
        self._tested = []

    def add(
        self,
        z: float | None,
        place: tuple[float, ...],
        line: Line,
        *,
        feed: float | None,
        start: float | None = None,
        time_s: float | None = None,
        is_false: bool = False,
    ) -> None:
        """Take a touch of the bed; its time is that of the line where no other is given.

        Without z it is an attempt that latched nothing, or that triggered before it moved.
        """
        if z is not None:
            self._tested.append(z)
        self._has_touches = True
        self.touches.append(
            Touch(
                axis="Z",
                sign=-1,
                coordinate=z,
                place=place,
                feed=feed,
                start=start,
                time_s=line.time_s if time_s is None else time_s,
                session=" ".join(filter(None, (self._session, self._method))),
                temperatures=dict(self.temperatures),
                line=line.number,
                is_false=is_false,
            )
        )

    @property
    def has_touched(self) -> bool:
        """Whether any attempt latched something."""
        return any(touch.coordinate is not None for touch in self.touches)

    def say_temperatures(self, found: Imported) -> bool:
        """Say whose temperatures are known, if any."""
        names = sorted({name for touch in self.touches for name in touch.temperatures})
        if names:
            found.known.append(f"temperatures of {', '.join(names)} from the lines before")
        return bool(names)

    def imported(self, preset: str) -> Imported:
        """Give the touches, their times those at which the moves began."""
        found = Imported(preset=preset, touches=self.touches, place_is_surface=True)
        found.assumed += begun_before(self.touches)
        self._say_failed(found)
        self._say_adjusted(found)
        if self._disagreeing:
            lines = ", ".join(map(str, self._disagreeing[:NAMED]))
            more = ", …" if len(self._disagreeing) > NAMED else ""
            found.unread.append(
                f"touches that the log's own minimum and maximum count, line {lines}{more}: those "
                "above are cut, or not read"
            )
        if all(touch.time_s is None for touch in self.touches):
            found.assumed.append(NO_TIMES)
        return found

    def _say_failed(self, found: Imported) -> None:
        """Say how many attempts there were that are no touches."""
        false = sum(touch.is_false for touch in self.touches)
        missed = sum(touch.coordinate is None for touch in self.touches) - false
        attempts = f"of {len(self.touches)} attempts to touch"
        if missed:
            found.known.append(f"missed touches, as the probe did not trigger: {missed} {attempts}")
        if false:
            found.known.append(f"false triggers, before the axis moved: {false} {attempts}")

    def _say_adjusted(self, found: Imported) -> None:
        """Say which sessions begin, and where what moved."""
        sessions = {touch.session for touch in self.touches}
        if len({session.endswith(CONTACT) for session in sessions}) == 2:
            found.assumed.append("touches by contact are none of the surface that others read")
        for what, why in (
            (HOMING, "homing (G28) or a restart, as touches are compared within a session only"),
            (ADJUSTING, "an adjustment of Z, as it moves the gantry or the bed"),
            (TURNING, "a list of how far to turn screws of the bed, as if they were turned"),
            (CHANGING, "a change of the tool, as each has a length of its own"),
            (OFFSET, "a new offset of the probe (M851), which moves where z is 0"),
        ):
            times = sum(begun_by(session, what) is not None for session in sessions)
            if times:
                found.assumed.append(f"sessions of their own after {why}: {times}")
