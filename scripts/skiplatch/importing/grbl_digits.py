"""Digits of grbl's replies: how fine they are, and those that printing cut off."""

from collections.abc import Mapping, Sequence

from skiplatch.importing.model import Touch
from skiplatch.importing.probe_move import LINEAR

DIGIT_MM = 1e-3  # the last that is printed
DIGIT_INCH = 1e-4
HALF_A_DIGIT_MM = 0.51 * DIGIT_MM
FARTHEST_MM = 1e6  # that any machine goes
MOST_STEPS_PER_MM = 800.0  # with more of them, any printed number is near a step


def are_finer_than(step_mm: float, touches: Sequence[Touch]) -> bool:
    """Tell whether the replies fall between such steps."""
    latched = [place for touch in touches if (place := touch.coordinate) is not None]
    beside = (abs(z - round(z / step_mm) * step_mm) for z in latched if abs(z) < FARTHEST_MM)
    return any(way > HALF_A_DIGIT_MM for way in beside)


def put_on_steps(touches: Sequence[Touch], steps_per_mm: Mapping[str, float]) -> None:
    """Give the coordinates the digits that three decimals cut off: grbl counts whole steps."""
    for axis in {touch.axis for touch in touches} & set(LINEAR):
        latched = [t for t in touches if t.axis == axis and t.coordinate is not None]
        steps = steps_per_mm.get(axis, 0.0)
        told = [touch.coordinate or 0.0 for touch in latched]
        if not 0.0 < steps < MOST_STEPS_PER_MM or any(abs(z) > FARTHEST_MM for z in told):
            continue
        whole = [round(z * steps) / steps for z in told]
        if all(abs(w - z) <= HALF_A_DIGIT_MM for w, z in zip(whole, told, strict=True)):
            for touch, coordinate in zip(latched, whole, strict=True):
                touch.coordinate = coordinate
