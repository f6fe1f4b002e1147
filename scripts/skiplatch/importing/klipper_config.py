"""The configuration that klippy.log begins with, as far as it tells of probing."""

import re

from skiplatch.importing.model import Imported
from skiplatch.numbers import NUMBER, number
from skiplatch.units import UM_PER_MM

_SECTION = re.compile(r"^\[([^\]]+)\]$")
_WHOLE = re.compile(NUMBER)
_ENTRY = re.compile(r"^(\w+)\s*[=:]\s*([^#]+)")
_PROBES = {"probe", "bltouch", "smart_effector", "probe_eddy_current", "load_cell_probe"}
_PROBES |= {"dockable_probe", "beacon", "cartographer", "scanner"}  # of forks and plugins
_ELECTRONICS = {"temperature_mcu", "temperature_host"}
"""Sensors within a processor, which tell nothing of the machine."""


class Config:
    """Sections and their entries, the last one of each name."""

    def __init__(self) -> None:
        self._section = ""
        self._entries: dict[tuple[str, str], str] = {}

    def take(self, text: str) -> None:
        """Take in a line."""
        if match := _SECTION.match(text):
            self._section = match[1].strip()
        elif match := _ENTRY.match(text):
            self._entries[self._section, match[1]] = match[2].strip()

    def is_of_machine(self, sensor: str) -> bool:
        """Tell whether a sensor is none within a processor."""
        kind = self._entries.get((f"temperature_sensor {sensor}", "sensor_type"))
        return kind not in _ELECTRONICS

    def probing_speed(self) -> float | None:
        """Give the speed of the probe in mm/s."""
        return next(iter(self._of_probes("speed")), None)

    def z_offset(self) -> float | None:
        """Give how far below the nozzle the probe triggers, in mm; None where probes differ."""
        told = set(self._of_probes("z_offset"))
        return told.pop() if len(told) == 1 else None

    def _of_probes(self, wanted: str) -> list[float]:
        """Give the numbers of a name in sections of probes."""
        return [
            float(value)
            for (section, name), value in self._entries.items()
            if name == wanted and section.partition(" ")[0] in _PROBES and _WHOLE.fullmatch(value)
        ]

    def fastest_z(self) -> tuple[float, str] | None:
        """Give how fast Z may move in mm/s, and what says so."""
        names = ("max_z_velocity", "max_velocity")
        told = [(value, name) for name in names if (value := self._number("printer", name))]
        return min(told, default=None)

    def _number(self, section: str, name: str) -> float | None:
        value = self._entries.get((section, name), "")
        return float(value) if _WHOLE.fullmatch(value) else None

    def put_into(self, found: Imported) -> None:
        """Note the step, the acceleration and the ends of Z."""
        get = self._entries.get
        try:
            distance = number(get(("stepper_z", "rotation_distance"), ""))
            microsteps = number(get(("stepper_z", "microsteps"), ""))
            full = number(get(("stepper_z", "full_steps_per_rotation"), "200"))
            ratio = _gear_ratio(get(("stepper_z", "gear_ratio"), "1:1"))
            step_um = UM_PER_MM * distance / (full * microsteps * ratio)
        except (ValueError, ZeroDivisionError):
            found.assumed.append("no [stepper_z] in the log: the step of Z is not known")
        else:
            found.figure("axis", "resolution_um", step_um, "[stepper_z] of the log")
        accel = self._number("printer", "max_z_accel")
        if accel is not None:
            found.figure("axis", "accel_mm_s2", accel, "[printer] max_z_accel of the log")
        least, greatest = (self._number("stepper_z", f"position_{end}") for end in ("min", "max"))
        if least is not None and greatest is not None:  # no touch is asked for beyond them
            found.reach(least, greatest, "[stepper_z] of the log")


def _gear_ratio(text: str) -> float:
    ratio = 1.0
    for pair in text.split(","):
        driven, driving = pair.split(":")
        ratio *= number(driven) / number(driving)
    return ratio
