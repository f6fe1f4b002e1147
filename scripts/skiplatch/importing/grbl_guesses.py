"""Along which axis a touch of grbl was made, where no command before its reply says it."""

from collections.abc import Sequence
from dataclasses import replace

from skiplatch.importing.model import Touch
from skiplatch.importing.probe_move import AXES


class Guesses:
    """Axes that were guessed.

    Attributes:
        count: How many.
    """

    def __init__(self, touches: list[Touch]) -> None:
        self.count = 0
        self._touches = touches

    def axis(self, position: Sequence[float], last: Sequence[float] | None) -> str:
        """Take the axis that moved since the touch before, or Z.

        A first touch, with none before it, is of the axis that alone moved up to the second one.

        Args:
            position: Where a touch was latched; empty where its reply is broken.
            last: Where the one before was.
        """
        if not position:
            return "Z"
        self.count += 1
        if last is None or len(last) != len(position):
            return "Z"
        ways = [abs(a - b) for a, b in zip(position, last, strict=True)]
        if max(ways) == 0:
            return self._touches[-1].axis
        axis = AXES[ways.index(max(ways))]
        if self.count == len(self._touches) + 1 == 2 and sum(way > 0 for way in ways) == 1:
            self._touches[0] = _along(self._touches[0], axis, last)
        return axis


def _along(touch: Touch, axis: str, position: Sequence[float]) -> Touch:
    """Give a touch without a command as one of another axis."""
    index = AXES.index(axis)
    return replace(
        touch,
        axis=axis,
        sign=-1 if axis == "Z" else None,
        coordinate=None if touch.coordinate is None else position[index],
        place=tuple(v for i, v in enumerate(position) if i != index),
    )
