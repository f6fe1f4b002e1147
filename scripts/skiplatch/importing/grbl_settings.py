"""`$` settings of grbl and its kin: which numbers they have, and which a log lacks."""

from collections.abc import Collection, Mapping

from skiplatch.importing.model import Imported, KeyPath

INCHES, STEPS, ACCEL = 13, 100, 120
"""The unit of replies; of X, steps per mm and acceleration: those of other axes follow."""
_FIGURES: Mapping[KeyPath, tuple[int, str]] = {
    ("axis", "resolution_um"): (STEPS, "steps per mm"),
    ("axis", "accel_mm_s2"): (ACCEL, "acceleration"),
}


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
