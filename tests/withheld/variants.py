"""Variants of a campaign: an effect for a part of it, few touches at one place, gross outliers."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.withheld.chain import BoolArray, FloatArray, Hook, Outcomes, Setup, State
from tests.withheld.conditions import log_uniform
from tests.withheld.effects import EFFECTS, PLACE, SENSE, TABLE, WARMTH
from tests.withheld.forms import Form
from tests.withheld.sizes import spreads

# ---- an effect that begins or ends ---------------------------------------------------------------

WITHIN = (0.15, 0.85)
NO_ONSET = frozenset({"timer_drift"})
"""A clock that begins to run fast has not been fast before; the forms count from the start."""


@dataclass(frozen=True, eq=False)
class Onset:
    """When an effect is there.

    Attributes:
        number: Of the touch, in the order of time, at which it begins or ends.
        begins: Whether it begins there.
        active: In which touches it is there, shape (n,).
    """

    number: int
    begins: bool
    active: BoolArray

    def of(self, form: Form) -> Form:
        """Let a form be there at these touches only."""
        hooks = {step: self._gated(hook) for step, hook in form.hooks.items()}
        delay_s = None if form.delay_s is None else form.delay_s * self.active
        words = f"{form.words}, {'from' if self.begins else 'until'} touch {self.number}"
        return replace(form, words=words, hooks=hooks, delay_s=delay_s)

    def _gated(self, hook: Hook) -> Hook:
        def gated(s: State) -> None:
            before = dict(vars(s))
            hook(s)
            for name, old in before.items():
                new = getattr(s, name)
                if new is not old:
                    setattr(s, name, _where(self.active, new, old))

        return gated

    def as_json(self) -> dict[str, Any]:
        """Give it in plain types, for the label."""
        return {"touch": self.number, "begins": self.begins}


def _where(active: BoolArray, new: FloatArray, old: FloatArray) -> FloatArray:
    columns = max(np.ndim(new), np.ndim(old)) > 1
    return np.where(active[:, None] if columns else active, new, old)


def draw_onset(rng: np.random.Generator, n: int) -> Onset:
    """Draw when an effect begins or ends."""
    number, begins = int(n * rng.uniform(*WITHIN)), bool(rng.random() < 0.5)
    later = np.arange(n) >= number
    return Onset(number, begins, later if begins else ~later)


# ---- few touches at one place --------------------------------------------------------------------

FEW = (40, 90)
_OF_PLACES = SENSE | PLACE | TABLE | WARMTH
AT_ONE_PLACE = tuple(
    effect
    for effect, entry in EFFECTS.items()
    if not entry.needs & _OF_PLACES and effect != "pretravel_lobing"
)
"""Effects that show there: the others are an offset, or nothing."""


def at_one_place(rng: np.random.Generator, setup: Setup) -> Setup:
    """Make all touches where one of them is made, from the same side."""
    touches = setup.touches
    i = int(rng.integers(len(touches)))
    kept = ("axis", "sign", "alpha_deg", "beta_deg", "position_mm", "rotary_deg")
    here = {name: np.full_like(getattr(touches, name), getattr(touches, name)[i]) for name in kept}
    return replace(setup, touches=replace(touches, **here))


# ---- gross outliers ------------------------------------------------------------------------------

SHARES = (0.005, 0.05)
OFF_UM = (10.0, 300.0)
PLAIN = 10.0
"""Spreads from which an outlier has to be seen."""


@dataclass(frozen=True, eq=False)
class Outliers:
    """Touches whose deviation is grossly off.

    Attributes:
        off_um: By how much, shape (n,); 0 of the others.
        plain: Which of them nobody can overlook, shape (n,).
    """

    off_um: FloatArray
    plain: BoolArray

    def of(self, outcomes: Outcomes) -> Outcomes:
        """Spoil what was recorded."""
        return replace(outcomes, deviation_um=np.round(outcomes.deviation_um + self.off_um, 3))

    def as_json(self, touch: np.typing.NDArray[np.int64]) -> list[dict[str, Any]]:
        """Give them in plain types, for the label, by their serial numbers, shape (n,)."""
        return [
            {"touch": int(touch[i]), "off_um": float(self.off_um[i]), "plain": bool(self.plain[i])}
            for i in np.flatnonzero(self.off_um)
        ]


def draw_outliers(rng: np.random.Generator, setup: Setup, among: BoolArray) -> Outliers:
    """Draw outliers among some of the touches, shape (n,): one at least, one in twenty at most."""
    candidates = np.flatnonzero(among)
    share = log_uniform(rng, *SHARES)
    hit = rng.permutation(candidates)[: max(1, int(share * len(candidates)))]
    off = np.zeros(len(among))
    sizes = np.array([log_uniform(rng, *OFF_UM) for _ in hit])
    step = setup.nominal.axis.resolution_um
    off[hit] = np.round(sizes * rng.choice([-1.0, 1.0], len(hit)) / step) * step
    return Outliers(off, np.abs(off) > PLAIN * spreads(setup)["deviation_um"])
