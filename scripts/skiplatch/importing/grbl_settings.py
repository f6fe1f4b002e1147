"""`$` settings of grbl and its kin: which numbers they have, and which a log lacks."""

import re
from collections.abc import Collection, Iterator, Mapping

from skiplatch.importing.gcode import without_comments
from skiplatch.importing.model import Imported, KeyPath
from skiplatch.numbers import NUMBER

INCHES, STEPS, ACCEL = 13, 100, 120
"""The unit of replies; of X, steps per mm and acceleration: those of other axes follow."""
_FIGURES: Mapping[KeyPath, tuple[int, str]] = {
    ("axis", "resolution_um"): (STEPS, "steps per mm"),
    ("axis", "accel_mm_s2"): (ACCEL, "acceleration"),
}
_SETTING = re.compile(rf"\$([0-9]{{1,3}})\s*=\s*({NUMBER})")
_JOINT = re.compile(r"(\$[0-9]{1,3}\s*=[^;$]*);(?=\s*\$[0-9]{1,3}\s*=)")
"""Between the replies that Candle puts in one line: `$100=800.000; $101=800.000; ok`."""


def settings_in(text: str) -> Iterator[tuple[int, float]]:
    """Give the settings of a line, with their numbers; those of comments are none."""
    for number, value in _SETTING.findall(without_comments(_JOINT.sub(r"\1 ", text))):
        yield int(number), float(value)


def say_missing(found: Imported, there: Collection[int], axis: int) -> None:
    """Say which figures of an axis stand at their defaults, for want of which settings.

    Args:
        found: With the figures that the log says.
        there: Numbers of the settings in the log.
        axis: 0 for X, 1 for Y, 2 for Z.
    """
    missing = [of for figure, of in _FIGURES.items() if figure not in found.figures]
    if not missing:
        return
    none = "no $ settings in the log"
    if there:
        none = f"no {' and '.join(f'${number + axis}' for number, _ in missing)} in the log"
    names = " and ".join(name for _, name in missing)
    found.assumed.append(f"{none}: {names} as grbl has it by default; type $$ before probing")
