"""What is to be drawn: the cases, what each of them is made of, and the plan of a set."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from tests.withheld.conditions import Recording
from tests.withheld.effects import EFFECTS
from tests.withheld.parts import recordings_for
from tests.withheld.strangers import DULL, STRANGERS
from tests.withheld.variants import AT_ONE_PLACE, NO_ONSET


class Case(StrEnum):
    """What is the matter with a campaign."""

    SINGLE = "single"
    TWO = "two"
    NONE = "none"
    STRANGER = "stranger"
    """One of those that were written down by hand."""
    DULL = "dull"
    STRANGERS = "strangers"
    """One of the grammar."""
    DATUM = "datum"
    """A surface that is not where it is believed to be."""
    WRONG_NOISE = "wrong_noise"
    """A repeatability or a jitter that is not as large as believed."""
    OUTLIERS = "outliers"
    """Gross ones, beside one effect or none."""
    UNCERTAIN = "uncertain"
    """One effect, and other beliefs that are off by about their stated uncertainty."""
    ONSET = "onset"
    """One effect that begins or ends within the campaign."""
    THREE = "three"
    SMALL = "small"
    """One effect, few touches at one place."""


@dataclass(frozen=True)
class Order:
    """What is to be drawn: of effects and strangers, by id, and the kind of recording."""

    case: Case
    recording: Recording
    ids: Sequence[str]

    @property
    def verdict(self) -> str:
        """What a diagnosis should say."""
        if self.case in {Case.STRANGER, Case.STRANGERS}:
            return "unknown"
        return "explained" if EFFECTS.keys() & set(self.ids) else "no_gap"


@dataclass(frozen=True)
class Menu:
    """What campaigns of a case are made of.

    Attributes:
        parts: Ids to take in turns; none if the case draws what it needs.
        together: So many of them in one campaign.
        of_all_stages: They lie in different stages.
        without: Share of the campaigns that have none.
        kinds: Of recordings.
    """

    parts: Collection[str] = ()
    together: int = 1
    of_all_stages: bool = False
    without: float = 0.0
    kinds: Collection[Recording] = tuple(Recording)


MENUS: Mapping[Case, Menu] = {
    Case.SINGLE: Menu(EFFECTS),
    Case.TWO: Menu(EFFECTS, together=2),
    Case.NONE: Menu(),
    Case.STRANGER: Menu(STRANGERS),
    Case.DULL: Menu(DULL),
    Case.STRANGERS: Menu(),
    Case.DATUM: Menu(kinds=(Recording.STAMPED, Recording.POSITION)),
    Case.WRONG_NOISE: Menu(),
    Case.OUTLIERS: Menu(EFFECTS, without=0.5),
    Case.UNCERTAIN: Menu(EFFECTS),
    Case.ONSET: Menu([effect for effect in EFFECTS if effect not in NO_ONSET]),
    Case.THREE: Menu(EFFECTS, together=3, of_all_stages=True),
    Case.SMALL: Menu(AT_ONE_PLACE),
}


def orders(
    rng: np.random.Generator, count: int, kinds: Sequence[Recording], cases: Sequence[Case]
) -> list[Order]:
    """Plan the campaigns: the cases in turns, their effects in turns, all of it shuffled."""
    planned: list[Order] = []
    turns = {case: _turns(rng, case, kinds) for case in cases}
    for i in range(count):
        case = cases[i % len(cases)]
        first = turns[case][i // len(cases) % len(turns[case])]
        planned.append(_order(rng, case, first, kinds))
    return [planned[i] for i in rng.permutation(count)]


def is_for(case: Case, kinds: Collection[Recording]) -> bool:
    """Tell whether a case can be seen in one of the kinds of recording."""
    menu = MENUS[case]
    seen = any(set(recordings_for(part)) & set(kinds) for part in menu.parts) or not menu.parts
    return seen and bool(set(menu.kinds) & set(kinds))


def _turns(rng: np.random.Generator, case: Case, kinds: Sequence[Recording]) -> list[list[str]]:
    if not is_for(case, kinds):
        raise SystemExit(f"no {case} for {', '.join(kinds)}")
    parts = MENUS[case].parts
    possible = [[part] for part in parts if set(recordings_for(part)) & set(kinds)]
    return [possible[i] for i in rng.permutation(len(possible))] if parts else [[]]


def _order(
    rng: np.random.Generator, case: Case, parts: list[str], kinds: Sequence[Recording]
) -> Order:
    menu = MENUS[case]
    usable = [
        kind
        for kind in kinds
        if kind in menu.kinds and all(kind in recordings_for(part) for part in parts)
    ]
    recording = usable[rng.integers(len(usable))]
    while len(parts) < menu.together and parts:
        others = _others(menu, parts, recording)
        parts = [*parts, others[rng.integers(len(others))]]
    if menu.without and rng.random() < menu.without:
        parts = []
    return Order(case, recording, [part for part in MENUS[case].parts if part in parts])


def _others(menu: Menu, parts: Collection[str], recording: Recording) -> list[str]:
    """Name what may stand beside parts."""
    stages = {EFFECTS[part].stage for part in parts} if menu.of_all_stages else set[str]()
    return [
        part
        for part in menu.parts
        if part not in parts
        and EFFECTS[part].stage not in stages
        and recording in recordings_for(part)
    ]
