"""Something that a hypothesis leaves of an observable."""

from dataclasses import dataclass

import scipy

from skiplatch.diagnosis.fit.material import Materiality
from skiplatch.diagnosis.scene.covariates import in_words

SIGNIFICANT = 4.5
"""Standard errors from which on a look is no accident: in a thousand campaigns of some sixty looks
that are not quite normal, one or two."""
CHANCE = 4.0
"""Standard errors from which on something is kept as evidence."""
RESOLVED = 0.5
"""Steps that a difference has to exceed where hardly more than rounding scatters: so much may each
value be off, and all of them alike."""
EVERYWHERE = "everywhere"


@dataclass(frozen=True, slots=True)
class Left:
    """Something that a hypothesis may leave.

    Attributes:
        observable: In which it shows.
        path: "skip" or "plc".
        kind: "shift", "scatter", "shape", "wave", "steps" or "share".
        conditions: What it goes with, the most telling first; or that it is everywhere.
        size: Of the difference: by condition, half of that between touches that are predicted high
            and low.
        unit: Of the size.
        relative: The same in units of what the plays scatter by, but of no less than what a touch
            repeats to: a machine measures no finer.
        noise: What the plays of a touch scatter by, in the middle.
        step: What the observable is rounded to.
        z: How many standard errors it is from nothing.
    """

    observable: str
    path: str
    kind: str
    conditions: tuple[str, ...]
    size: float
    unit: str
    relative: float
    noise: float
    step: float
    z: float

    def is_material(self, materiality: Materiality) -> bool:
        """It is large enough to matter, and to be told from rounding, which need not be random.

        What is lost always matters.
        """
        if self.is_share:
            return True
        if self.size <= RESOLVED * self.step and self.noise < self.step:
            return False
        return materiality.is_exceeded(self.size, self.relative, self.unit)

    @property
    def p_value(self) -> float:
        """Chance of as much where nothing is left."""
        return float(scipy.stats.norm.sf(self.z))

    @property
    def is_share(self) -> bool:
        """It is a share of touches, as of those that were missed, and no length or time."""
        return self.kind == "share"

    @property
    def is_shift(self) -> bool:
        """It is off in the middle, and not in what it scatters by."""
        return self.kind in ("shift", "wave")

    @property
    def is_predicted(self) -> bool:
        """It goes with something known; otherwise it is everywhere."""
        return self.conditions != (EVERYWHERE,)

    def is_of(self, other: "Left") -> bool:
        """It shows in the same observable on the same path."""
        return (self.observable, self.path) == (other.observable, other.path)

    def is_like(self, other: "Left") -> bool:
        """It shows in the same way, of what shows in the same observable."""
        ways = [(left.is_shift, left.is_predicted) for left in (self, other)]
        return ways[0] == ways[1]

    @property
    def is_significant(self) -> bool:
        """It is no accident of the touches, nor of the many looks."""
        return self.z > SIGNIFICANT

    @property
    def looks_like(self) -> str:
        """Give it in words."""
        what = "" if self.is_shift else f"{self.kind} "
        words = dict.fromkeys(map(in_words, self.conditions))
        return (
            f"{what}goes with {' and '.join(words)}"
            if self.is_predicted
            else f"{self.kind} everywhere"
        )


Memo = dict[bytes, list[Left]]
"""What was left of an observable, by its record and its plays: many hypotheses leave it alone."""
