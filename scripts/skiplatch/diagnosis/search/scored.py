"""A fitted model with what it gains, and whether that is more than chance."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.fit import SLACKS, Fit
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene

ENOUGH_FIT = 5.0
"""Nats that an effect has to gain, beyond what its parameters are worth."""
ENOUGH_CHECK = 1.0
"""Nats of gain on touches that it was not fitted to."""
MISSING = 0.2
"""Share of the gain that rare events may cost where the check happens to have none."""
PLAIN = 15.0
"""Nats of gain that need no check to be believed, only that it does not speak against."""
IMPOSSIBLE = 10.0
"""Nats against an effect that cannot be, unless the believed chain is wrong there as well."""


@dataclass(frozen=True, slots=True, eq=False)
class Scored:
    """A model with what it gains over the unchanged simulation, in nats."""

    fit: Fit
    fitted: float
    checked: float
    impossible: int = 0
    """Effects that no chain can have, as something would come before its cause."""

    @property
    def score(self) -> float:
        """Gain in all, less what so many parameters gain by chance, and what speaks against it."""
        chance = worth(self.fit.size) + IMPOSSIBLE * self.impossible
        return self.fitted + self.checked - chance

    @property
    def ids(self) -> tuple[str, ...]:
        """Of its effects."""
        return tuple(candidate.id for candidate in self.fit.candidates)


Noticed = Callable[[Scored | None], frozenset[str]]
"""Names the streams in which something can still be seen once a model, or nothing, is played."""


def worth(parameters: int) -> float:
    """Nats that fitting so many parameters, of the best of all candidates, gains by chance."""
    return 2.0 * parameters


def is_no_accident(fitted: float, checked: float, parameters: int) -> bool:
    """Tell whether gains of so many parameters are more than chance."""
    gained = fitted + checked - worth(parameters)
    is_checked = fitted - worth(parameters) > ENOUGH_FIT and checked > ENOUGH_CHECK
    is_plain = gained > PLAIN and checked > -MISSING * fitted
    return is_checked or is_plain


def without_twins(ranked: Iterable[Scored]) -> list[Scored]:
    """Leave out models whose last effect does just what that of one before them does."""
    kept: dict[object, Scored] = {}
    for scored in ranked:
        kept.setdefault(scored.fit.candidates[-1].change, scored)
    return list(kept.values())


def gain_of(scene: Scene, found: Fit, given: Change) -> float:
    """Give what a model gains on top of a change, with its form left open or not."""
    forms = (found, replace(found, slack=SLACKS[-1]))
    most = max(likelihood(scene, given.joined(form.change(scene))).total for form in forms)
    return most - likelihood(scene, given).total


def falling(gains: Sequence[float]) -> list[int]:
    """Give the places of gains, the largest first."""
    return sorted(range(len(gains)), key=lambda i: -gains[i])
