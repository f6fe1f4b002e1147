"""Where the gap sits: the stretch of the chain, its size, and the conditions that it goes with."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.laws import LATTICE, law_under
from skiplatch.diagnosis.likelihood.likelihood import MISSED, likelihood
from skiplatch.diagnosis.likelihood.scan_wait import scan_period_us
from skiplatch.diagnosis.plays.left import EVERYWHERE, Left
from skiplatch.diagnosis.plays.leftover import STREAMS
from skiplatch.diagnosis.scene.grid import off_grid
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.simulator.effects import effects

LEAST_NATS = 5.0
LEAST_SHARE = 0.01
"""Gain in a stretch, over that in the one that gains most, from which on the gap shows in it."""
MOST_CONDITIONS = 2
MOST_LEFT = 3
OBSERVABLES = {stream: observable for observable, streams in STREAMS.items() for stream in streams}
"""What is observed, by the stream that shows it."""
STAGES = {"edge": "motion", "latch": "input", "grid": "scan", MISSED: "input"}
"""Where something that no effect explains may sit at the latest; else as the observable."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where the gap sits.

    Attributes:
        stage: Of the chain.
        paths: "skip", "plc" or "both".
        observable: Stretch of the chain in which it shows.
        conditions: What it goes with; or that it is everywhere.
        size: Root mean square of what the effects shift and scatter there; of what is left, see
            `Left`.
        unit: Of the size; "1" for a share of the touches.
        effects: Ids of the effects found that show there; none where something is left of the gap.
    """

    stage: str
    paths: str
    observable: str
    conditions: str
    size: float
    unit: str
    effects: tuple[str, ...] = ()

    @property
    def stretch(self) -> str:
        """What it shows in, as what is left is told; `paths` says on which path."""
        return OBSERVABLES.get(self.observable, self.observable)


def places(
    scene: Scene, finding: Finding, before: Sequence[Left], left: Sequence[Left]
) -> list[Place]:
    """Name where the effects found show, the clearest first, and then what they leave.

    Args:
        scene: The touches.
        finding: The effects.
        before: What the believed chain leaves, the most significant first.
        left: What the finding leaves that matters, likewise.
    """
    found = []
    if finding.model:
        change = finding.model.fit.change(scene)
        gained, base = likelihood(scene, change).streams, likelihood(scene, NOTHING).streams
        nats = {name: float((gained[name] - base[name]).sum()) for name in gained}
        least = max(LEAST_NATS, LEAST_SHARE * max(nats.values()))
        stages = {effects()[i].stage for i in finding.model.ids}
        ordered = sorted(nats, key=lambda name: -nats[name])
        showing = _showing(scene, finding.model, gained)
        found = [
            _place(scene, name, change, stages, before, showing(name))
            for name in ordered
            if nats[name] > least
        ]
    return found + [_rest(one) for one in left[:MOST_LEFT]]


def _showing(
    scene: Scene, model: Scored, gained: Mapping[str, FloatArray]
) -> Callable[[str], tuple[str, ...]]:
    """Tell of each stream which effects it needs; all of them where none by itself."""
    without = [
        likelihood(scene, model.fit.without(number).change(scene)).streams
        for number in range(len(model.ids))
        if len(model.ids) > 1
    ]

    def showing(name: str) -> tuple[str, ...]:
        lost = [float((gained[name] - others[name]).sum()) for others in without]
        needed = [one for one, nats in zip(model.ids, lost, strict=False) if nats > LEAST_NATS]
        return tuple(dict.fromkeys(needed or model.ids))

    return showing


def _place(
    scene: Scene,
    name: str,
    change: Change,
    stages: set[str],
    before: Sequence[Left],
    showing: tuple[str, ...],
) -> Place:
    stream = scene.streams.get(name)
    if stream is None:
        share = float(scene.touches.missed.mean())
        return Place("input", "both", MISSED, EVERYWHERE, share, "1", showing)
    shared = [stage for stage in stream.stages if stage in stages]
    return Place(
        stage=shared[0] if shared else stream.stages[-1],
        paths=_paths(name),
        observable=name,
        conditions=_conditions(name, before),
        size=max(
            _changed(stream, law_under(scene, stream, change)), _regridded(scene, name, change)
        ),
        unit=stream.unit,
        effects=showing,
    )


def _regridded(scene: Scene, name: str, change: Change) -> float:
    """Give the root mean square by which stamps lie off the believed grid, and not off the changed.

    Another period, or scans that edges begin, move no stamp by themselves: the law is the same.
    """
    if name != LATTICE:
        return 0.0
    stamps = scene.touches.latch_us[scene.streams[name].rows]
    periods = scene.nominal.plc.scan_us, scan_period_us(scene, change)
    was, still = (float(np.mean(off_grid(stamps, period) ** 2)) for period in periods)
    return float(np.sqrt(was if change.wait else max(was - still, 0.0)))


def _changed(stream: Stream, law: Law) -> float:
    """Give the root mean square of how far a law shifts and scatters touches off the nominal one.

    What they scatter by anyhow, as in the wait for a scan, is none of it.
    """
    shift, scatter = law.mean - stream.law.mean, np.abs(law.variance - stream.law.variance)
    return float(np.sqrt(np.mean((shift**2 + scatter)[stream.rows])))


def _conditions(name: str, before: Sequence[Left]) -> str:
    """Say what the gap of a stream goes with."""
    observable, path = OBSERVABLES[name], _paths(name)
    for one in before:
        is_here = one.observable == observable and path in (one.path, "both")
        if is_here and one.is_predicted and one.is_significant:
            return f"goes with {' and '.join(one.conditions[:MOST_CONDITIONS])}"
    return EVERYWHERE


def _rest(left: Left) -> Place:
    """Describe something that is left over."""
    stage = STAGES.get(left.observable, left.observable)
    return Place(stage, left.path, left.observable, left.looks_like, left.size, left.unit)


def _paths(name: str) -> str:
    if name.endswith("skip"):
        return "skip"
    return "plc" if name.endswith("plc") or name == LATTICE else "both"
