"""What a diagnosis is worth against the sealed label of its campaign."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from skiplatch.diagnosis.verdict.reliability import standing
from tests.withheld.sealed import Label

FAILED = "failed"
"""The verdict of a diagnosis that broke down."""
SURE = 0.9
"""Confidence from which on a wrong name is the worst outcome."""
HALF = 0.5
BINS = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)


@dataclass(frozen=True, slots=True)
class Name:
    """An effect that was named.

    Attributes:
        id: Of the effect.
        group: It, and those that would do as well.
        stage: Where it is said to lie.
        confidence: Of one of the group being right.
    """

    id: str
    group: frozenset[str]
    stage: str
    confidence: float


@dataclass(frozen=True, slots=True)
class Shrink:
    """By how much a diagnosis says that the gap of an observable shrinks: 1 is all of it.

    Attributes:
        observable: As the diagnosis calls it.
        value: The share; NaN if it does not say.
        low: Where its interval begins.
        high: Where that ends.
        has_gap: Whether there is a gap beyond the noise, as it says.
    """

    observable: str
    value: float
    low: float
    high: float
    has_gap: bool

    @classmethod
    def of(cls, observable: str, gap: Mapping[str, Any]) -> "Shrink":
        """Take it from an entry of the gap in the JSON of a diagnosis."""
        low, high = gap.get("shrink_interval") or (None, None)
        ends = (_number(gap.get("shrink")), _number(low), _number(high))
        return cls(observable, *ends, bool(gap.get("beyond_noise")))


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)


@dataclass(frozen=True, slots=True)
class Found:
    """What a diagnosis says, as far as it is scored."""

    verdict: str
    names: tuple[Name, ...]
    places: tuple[str, ...]
    """Stages where the gap is said to sit, the first one first."""
    shrinks: tuple[Shrink, ...] = ()
    outliers: frozenset[int] = frozenset()
    """Serial numbers of touches that it lists as gross outliers."""
    failed: frozenset[str] = frozenset()
    """Rules that kept it from a better verdict."""

    @classmethod
    def of(cls, diagnosis: Mapping[str, Any]) -> "Found":
        """Take it from the JSON of a diagnosis."""
        names = tuple(
            Name(e["id"], frozenset({e["id"], *e["alternatives"]}), e["stage"], e["confidence"])
            for e in diagnosis["effects"]
        )
        return cls(
            diagnosis["verdict"],
            names,
            tuple(p["stage"] for p in diagnosis["where"]),
            tuple(Shrink.of(name, gap) for name, gap in diagnosis.get("gap", {}).items()),
            frozenset(int(touch) for touch in diagnosis.get("outliers", ())),
            frozenset(one["rule"] for one in diagnosis.get("failed", ())),
        )

    @property
    def standing(self) -> str:
        """What its names are counted by."""
        return standing(self.verdict, self.failed, len(self.names))

    @property
    def shrinks_by_half(self) -> bool:
        """Whether it says of any gap that it shrinks by half at least."""
        return any(s.has_gap and s.value >= HALF for s in self.shrinks)


@dataclass(frozen=True, slots=True)
class Scored:
    """One campaign: what was sealed, what was found.

    Attributes:
        label: What it has.
        found: What the diagnosis says.
        seconds: How long it took.
        nats: By how much the truth beats the unchanged chain, about; see `nats`.
        shrink: Of what the oracle's simulation takes away of the gap, the share that the diagnosed
            one does; NaN where there is too little to take away.
        guesses: What each baseline named, by its title.
        name: Of the campaign: the seed, a slash, and its name in the set.
    """

    label: Label
    found: Found
    seconds: float
    nats: float
    shrink: float
    guesses: Mapping[str, str | None]
    name: str = ""

    @property
    def truth(self) -> frozenset[str]:
        """Ids of the effects in it."""
        return frozenset(self.label.effects)

    @property
    def covered(self) -> frozenset[str]:
        """True effects that were named, or given as an alternative."""
        return self.truth & frozenset[str]().union(*(name.group for name in self.found.names))

    @property
    def wrong_names(self) -> list[Name]:
        """Named effects that are not in the campaign, nor is any that would do as well."""
        return [name for name in self.found.names if not name.group & self.truth]

    @property
    def strays(self) -> int:
        """How many names are wrong."""
        return len(self.wrong_names)

    @property
    def names_exactly(self) -> bool:
        """Whether the true effects were named, and nothing else."""
        return sorted(name.id for name in self.found.names) == sorted(self.truth)

    @property
    def names_in_group(self) -> bool:
        """Whether each true effect was named or is in a group, and nothing else was named."""
        return bool(self.truth) and self.covered == self.truth and not self.strays

    @property
    def is_right(self) -> bool:
        """All effects covered and nothing else named; for none, dull and strangers, no name."""
        return self.names_in_group if self.truth else not self.found.names

    @property
    def has_right_stage(self) -> bool:
        """Whether the gap is said to lie in the stages of the true effects and no others."""
        stages = {name.stage for name in self.found.names} or set(self.found.places[:1])
        return stages == self.label.stages

    @property
    def is_sure(self) -> bool:
        """Whether something was named with great confidence."""
        return any(name.confidence >= SURE for name in self.found.names)

    @property
    def is_surely_wrong(self) -> bool:
        """Whether a wrong name was given with great confidence."""
        return any(name.confidence >= SURE for name in self.wrong_names)

    def as_json(self) -> dict[str, Any]:
        """Give it in plain types."""
        return {
            "name": self.name,
            "case": self.label.case,
            "recording": self.label.recording,
            "touches": self.label.touches,
            "effects": sorted(self.truth),
            "visible": dict(self.label.visible),
            "nats": round(self.nats, 1),
            "verdict": self.found.verdict,
            "named": [{**asdict(name), "group": sorted(name.group)} for name in self.found.names],
            "right": self.is_right,
            "shrink_to_oracle": None if np.isnan(self.shrink) else round(self.shrink, 4),
            "seconds": round(self.seconds, 2),
            "baselines": dict(self.guesses),
        }


def calibration_error(results: Sequence[Scored]) -> tuple[float, int]:
    """Give the expected calibration error of all named effects, and their number.

    Named effects are sorted into bins by confidence; the error is the mean over the names of the
    distance of the mean confidence of their bin from the share that is right. It is NaN without
    names, and never quite 0 with few of them.
    """
    pairs = [
        (name.confidence, bool(name.group & r.truth)) for r in results for name in r.found.names
    ]
    if not pairs:
        return float("nan"), 0
    confidence, right = np.array(pairs, float).T
    which = np.digitize(confidence, BINS[1:-1])
    error = 0.0
    for one in np.unique(which):
        inside = which == one
        error += inside.mean() * abs(float(confidence[inside].mean() - right[inside].mean()))
    return float(error), len(pairs)
