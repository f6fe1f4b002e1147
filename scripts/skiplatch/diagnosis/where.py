"""Where the gap sits: the stretch of the chain, its size, and the conditions that it goes with."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.decide import Finding
from skiplatch.diagnosis.likelihood import likelihood
from skiplatch.diagnosis.scene import Scene, Stream
from skiplatch.diagnosis.structure import ALPHA, LEAST_CORRELATION, Structure, features
from skiplatch.simulator import effects

LEAST_NATS = 5.0
LEAST_SHARE = 0.01
"""Gain in a stretch, over that in the one that gains most, from which on the gap shows in it."""
MOST_CONDITIONS = 2
MOST_LEFT = 3


@dataclass(frozen=True, slots=True)
class Place:
    """Where the gap sits.

    Attributes:
        stage: Of the chain.
        paths: "skip", "plc" or "both".
        observable: Stretch of the chain in which it shows.
        conditions: What it goes with, corrected for looking at many; or that it is everywhere.
        size: Root mean square of what the nominal chain is off by there.
        unit: Of the size; "1" for a share of the touches.
    """

    stage: str
    paths: str
    observable: str
    conditions: str
    size: float
    unit: str


def places(scene: Scene, finding: Finding, left: Sequence[Structure]) -> list[Place]:
    """Name where the effects found show, the clearest first, and then what they leave."""
    found = []
    if finding.model:
        change = finding.model.fit.change(scene)
        gained, base = likelihood(scene, change).streams, likelihood(scene, Change()).streams
        nats = {name: float((gained[name] - base[name]).sum()) for name in gained}
        least = max(LEAST_NATS, LEAST_SHARE * max(nats.values()))
        stages = {effects()[i].stage for i in finding.model.ids}
        ordered = sorted(nats, key=lambda name: -nats[name])
        found = [_place(scene, name, stages) for name in ordered if nats[name] > least]
    return found + [_rest(structure) for structure in left[:MOST_LEFT]]


def _place(scene: Scene, name: str, stages: set[str]) -> Place:
    stream = scene.streams.get(name)
    if stream is None:
        share = float(scene.touches.missed.mean())
        return Place("input", "both", "missed", "everywhere", share, "1")
    off = (stream.residuals - stream.law.mean)[stream.rows]
    shared = [stage for stage in stream.stages if stage in stages]
    return Place(
        stage=shared[0] if shared else stream.stages[-1],
        paths=_paths(name),
        observable=name,
        conditions=_conditions(scene, stream),
        size=float(np.sqrt(np.mean(off**2))),
        unit=stream.unit,
    )


def _conditions(scene: Scene, stream: Stream) -> str:
    """Say what the residuals go with, by ranks; each look counts."""
    off = ((stream.residuals - stream.law.mean) / stream.law.spread)[stream.rows]
    looks = {name: values[stream.rows] for name, values in features(scene, stream).items()}
    strength: dict[str, float] = {}
    for name, values in looks.items():
        if np.ptp(values) > 0.0 and np.ptp(off) > 0.0:
            found = stats.spearmanr(off, values)
            rho, p_value = float(found.statistic), float(found.pvalue)
            if p_value < ALPHA / len(looks) and abs(rho) > LEAST_CORRELATION:
                strength[name] = abs(rho)
    ordered = sorted(strength, key=lambda name: -strength[name])[:MOST_CONDITIONS]
    return f"goes with {' and '.join(ordered)}" if ordered else "everywhere"


def _rest(structure: Structure) -> Place:
    """Describe something that is left over."""
    stream = structure.stream
    goes_with = structure.is_condition and not structure.looks_like.startswith("scatter")
    return Place(
        stage=stream.stages[-1],
        paths=_paths(stream.name),
        observable=stream.name,
        conditions=f"goes with {structure.looks_like}" if goes_with else structure.looks_like,
        size=structure.moves,
        unit=structure.unit,
    )


def _paths(name: str) -> str:
    if name.endswith("skip"):
        return "skip"
    return "plc" if name.endswith("plc") or name == "lattice" else "both"
