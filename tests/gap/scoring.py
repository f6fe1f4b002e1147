"""What a diagnosis is worth against the sealed label of its campaign."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from tests.gap.sealed import Label

FAILED = "failed"
"""The verdict of a diagnosis that broke down."""
SURE = 0.9
"""Confidence from which on a wrong name is the worst outcome."""
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
class Found:
    """What a diagnosis says, as far as it is scored."""

    verdict: str
    names: tuple[Name, ...]
    places: tuple[str, ...]
    """Stages where the gap is said to sit, the first one first."""

    @classmethod
    def of(cls, diagnosis: Mapping[str, Any]) -> "Found":
        """Take it from the JSON of a diagnosis."""
        names = tuple(
            Name(e["id"], frozenset({e["id"], *e["alternatives"]}), e["stage"], e["confidence"])
            for e in diagnosis["effects"]
        )
        return cls(diagnosis["verdict"], names, tuple(p["stage"] for p in diagnosis["where"]))


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
    """

    label: Label
    found: Found
    seconds: float
    nats: float
    shrink: float
    guesses: Mapping[str, str | None]

    @property
    def truth(self) -> frozenset[str]:
        """Ids of the effects in it."""
        return frozenset(self.label.effects)

    @property
    def covered(self) -> frozenset[str]:
        """True effects that were named, or given as an alternative."""
        return self.truth & frozenset[str]().union(*(name.group for name in self.found.names))

    @property
    def strays(self) -> int:
        """Named effects whose group holds no true one."""
        return sum(not name.group & self.truth for name in self.found.names)

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

    def as_json(self) -> dict[str, Any]:
        """Give it in plain types."""
        return {
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
