"""What a rule of `skiplatch check` finds."""

from dataclasses import dataclass

from skiplatch.arrays import BoolArray
from skiplatch.campaign.touches import SerialArray, Touches

SHOWN = 6


@dataclass(frozen=True, slots=True)
class Oddity:
    """Something that cannot be as it stands.

    Attributes:
        what: One sentence without the touches.
        touches: Serial numbers of the touches it is about; empty where it is about all.
    """

    what: str
    touches: tuple[int, ...] = ()

    @property
    def line(self) -> str:
        """The sentence with the touches, some of them where they are many."""
        if not self.touches:
            return self.what
        shown = ", ".join(str(touch) for touch in self.touches[:SHOWN])
        more = len(self.touches) - SHOWN
        rest = f" and {more} more" if more > 0 else ""
        return f"{self.what}: touch{'es' if len(self.touches) > 1 else ''} {shown}{rest}"


def serials(touches: Touches, rows: BoolArray) -> tuple[int, ...]:
    """Give the numbers of the touches in those rows; shape (n,)."""
    found: SerialArray = touches.touch[rows]
    return tuple(found.tolist())
