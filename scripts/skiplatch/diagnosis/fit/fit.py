"""Finding the parameters of an effect, and the effects of a campaign."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import accumulate, pairwise

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.fit.climb import WORST, climb
from skiplatch.diagnosis.likelihood.laws import AFTER_LATCH, LATCHES, law_under
from skiplatch.diagnosis.likelihood.likelihood import affected, likelihood, with_shared_datum
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.span import ALWAYS

WIDENINGS = (1.0, 0.1, 0.01, 0.0)
FINER, FINEST = WIDENINGS[1:], WIDENINGS[-1:]
HOPELESS_AFTER = 2
"""Widenings after which an effect that gains nothing is not looked into further."""
HOPELESS = 0.5
"""Nats."""
WORTH_A_REFINEMENT = 2.0
"""Nats that one more parameter has to gain; it is also what it gains by chance."""
WORTH_OF_AN_END = 3
"""Parameters that the touch counts for at which an effect begins or ends."""
NOTHING = Change()
KEPT_STARTS = 2
SLACKS = (0.0001, 0.001, 0.01, 0.05, 0.15, 0.4)
MOST_LEFT = 0.7
"""Of what touches are off by where a shift is large, what it may leave: else slack is scatter."""
SHORT_STEPS = (0.01, 0.001)
"""First steps of climbs that follow one with long steps, as shares of the parameters."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Effects with their best parameters."""

    candidates: tuple[Candidate, ...]
    parameters: tuple[FloatArray, ...]
    reached: frozenset[str]
    """Names of the streams that they can reach."""
    slack: float = 0.0
    """Scatter that their shift brings along, as a share of it."""

    def change(self, scene: Scene, given: Change = NOTHING) -> Change:
        """What they make of the physics, on top of what is given."""
        effects = zip(self.candidates, self.parameters, strict=True)
        changes = (candidate.acting(scene, parameters) for candidate, parameters in effects)
        if self.slack > given.slack:
            given = replace(given, slack=self.slack)
        return reduce(Change.joined, changes, given)

    @property
    def key(self) -> tuple[object, ...]:
        """Tell fits apart by what they are."""
        parameters = (values.tobytes() for values in self.parameters)
        effects = ((c.id, c.span) for c in self.candidates)
        return (*effects, *parameters, self.slack)

    @property
    def is_always(self) -> bool:
        """They act at all touches."""
        return all(candidate.span == ALWAYS for candidate in self.candidates)

    @property
    def is_loose(self) -> bool:
        """They need the most slack there is: their form is as far off as can be."""
        return self.slack == SLACKS[-1]

    @property
    def size(self) -> int:
        """Number of parameters that are not 0, which is what the others stay at; slack is one.

        Any touch may be the first: the best of so many counts for more than a parameter.
        """
        free = sum(int(np.count_nonzero(parameters)) for parameters in self.parameters)
        ends = sum(candidate.span.ends for candidate in self.candidates)
        return free + (self.slack > 0.0) + WORTH_OF_AN_END * ends


def _split(candidates: Sequence[Candidate], values: FloatArray) -> tuple[FloatArray, ...]:
    ends = list(accumulate((len(candidate.names) for candidate in candidates), initial=0))
    return tuple(values[begin:end] for begin, end in pairwise(ends))


class _Target:
    """Minus the log-likelihood of parameters, counting only the streams they can reach."""

    def __init__(
        self,
        scene: Scene,
        candidates: Sequence[Candidate],
        starts: Sequence[FloatArray],
        given: Change,
    ) -> None:
        self._scene = scene
        self._given = given
        self.slack = 0.0
        self._candidates = tuple(candidates)
        self._found: dict[tuple[bytes, float, float], float] = {}
        self._names = frozenset[str]()
        self._names = frozenset[str]().union(
            *(affected(scene, self.fit(start).change(scene)) for start in starts)
        )
        if given.slack and self._names & LATCHES:
            # What comes after a latch is read beside it, as far as the slack leaves it open.
            self._names |= AFTER_LATCH & scene.streams.keys()
        self._names |= with_shared_datum(scene, self._names)
        # By what is off still: a share of what is explained already would blur the rest.
        self._sizes = {
            name: stream.off(law_under(scene, stream, given))
            for name, stream in scene.streams.items()
            if name in self._names and stream.rows.any()
        }

    def fit(self, values: FloatArray) -> Fit:
        return Fit(self._candidates, _split(self._candidates, values), self._names, self.slack)

    def taken_up(self, candidate: Candidate) -> frozenset[int]:
        """Number the parameters of an effect that the datum of these touches takes up."""
        return candidate.taken_up(self._scene)

    def without(self, widening: float) -> float:
        """Give the same for what is given alone."""
        return self._of(self._given, widening)

    def __call__(self, values: FloatArray, widening: float) -> float:
        point = (values.tobytes(), widening, self.slack)
        if point not in self._found:
            change = self.fit(values).change(self._scene, self._given)
            self._found[point] = self._of(change, widening)
        return self._found[point]

    def takes_away(self, values: FloatArray) -> bool:
        """Tell whether the shift in some stream is one that the touches show themselves."""
        change = replace(self.fit(values).change(self._scene, self._given), slack=0.0)
        return any(
            _is_shown(stream, *(law_under(self._scene, stream, c) for c in (self._given, change)))
            for name, stream in self._scene.streams.items()
            if name in self._names - {"lattice"} and stream.rows.any()
        )

    def _of(self, change: Change, widening: float) -> float:
        sizes = {name: widening * size for name, size in self._sizes.items()} if widening else {}
        total = likelihood(self._scene, change, self._names, sizes).total
        return -total if np.isfinite(total) else WORST


def _is_shown(stream: Stream, before: Law, after: Law) -> bool:
    """Tell whether touches are much less off after a shift than before, where it is large."""
    shift = (after.mean - before.mean)[stream.rows]
    off = (stream.residuals - before.mean)[stream.rows]
    large = (shift != 0.0) & (np.abs(shift) >= np.sqrt(np.mean(shift**2)))
    if not large.any():
        return False
    return bool(np.median(np.abs(off - shift)[large]) < MOST_LEFT * np.median(np.abs(off)[large]))


def fit(
    scene: Scene,
    candidates: Sequence[Candidate],
    starts: Iterable[Sequence[float]],
    given: Change = NOTHING,
    widenings: Sequence[float] = WIDENINGS,
) -> Fit:
    """Fit parameters from several starts, coarse to fine, on top of what is given."""
    begun = [np.asarray(start, dtype=float) for start in starts]
    target = _Target(scene, candidates, begun, given)
    forms: dict[tuple[int, ...], list[FloatArray]] = {}
    for start in begun:
        forms.setdefault(tuple(np.flatnonzero(start)), []).append(start)
    found = [_fit_form(target, points, widenings) for points in forms.values()]
    # What a parameter more gains by chance is no reason to prefer a form that has it.
    return target.fit(
        min(found, key=lambda p: target(p, 0.0) + WORTH_A_REFINEMENT * np.count_nonzero(p))
    )


def _fit_form(
    target: _Target, begun: Sequence[FloatArray], widenings: Sequence[float]
) -> FloatArray:
    """Climb from starts in which the same parameters are 0; the coarsest stage keeps a few."""
    points = list(begun)
    for stage, widening in enumerate(widenings):
        kept = KEPT_STARTS if stage == 0 else 1
        points = sorted(points, key=lambda point: target(point, widening))[:kept]
        if stage == HOPELESS_AFTER and target(points[0], widening) > (
            target.without(widening) - HOPELESS
        ):
            break
        points = [climb(target, point, widening) for point in points]
    # A start may sit on a peak too sharp to be found from afar.
    near = min(begun, key=lambda point: target(point, 0.0))
    if target(near, 0.0) < min(target(point, 0.0) for point in points):
        points = [*points, near, climb(target, near, 0.0)]
    return min(points, key=lambda point: target(point, 0.0))


def anew(scene: Scene, candidates: Sequence[Candidate], starts: Sequence[FloatArray]) -> Fit:
    """Fit effects from parameters that are close already, and give them another form or slack."""
    begun = [start.tolist() for start in starts]
    return polish(scene, fit(scene, candidates, begun, widenings=FINEST))


def refine(scene: Scene, found: Fit) -> Fit:
    """Fit effects jointly, from where they are."""
    start = np.concatenate(found.parameters)
    target = _Target(scene, found.candidates, [start], NOTHING)
    best = _sharpened(target, _fit_form(target, [start], FINER))
    return target.fit(_loosened(target, best))


def _sharpened(target: _Target, best: FloatArray) -> FloatArray:
    """Climb on with smaller and smaller steps, as long as that is worth it.

    Two effects that make up for each other share a ridge, as two parameters of one may, along which
    a climb with long steps ends too soon.
    """
    for step in SHORT_STEPS:
        further = climb(target, best, 0.0, step)
        gained = target(best, 0.0) - target(further, 0.0)
        best = further if gained > 0.0 else best
        if gained < WORTH_A_REFINEMENT:
            break
    return best


def polish(scene: Scene, found: Fit, given: Change = NOTHING) -> Fit:
    """Give a fit of one effect another form, and any fit slack, where that is worth it."""
    best = np.concatenate(found.parameters)
    target = _Target(scene, found.candidates, [best], given)
    if len(found.candidates) > 1:
        return target.fit(_loosened(target, best))
    (candidate,) = found.candidates
    # Forms come first: slack would swallow what a jitter of its own explains.
    best = _loosened(target, _sharpened(target, _refined(target, candidate, best)))
    return target.fit(_pruned(target, candidate, best) if target.slack > 0.0 else best)


def _loosened(target: _Target, best: FloatArray) -> FloatArray:
    """Let the effect have another form than the one fitted, if that is worth it."""
    plain, values = target(best, 0.0), []
    for target.slack in SLACKS:
        values.append(target(best, 0.0))
    target.slack = SLACKS[int(np.argmin(values))]
    found = climb(target, best, 0.0)
    if target(found, 0.0) < plain - WORTH_A_REFINEMENT and target.takes_away(found):
        return found
    target.slack = 0.0
    return best


def _refined(target: _Target, candidate: Candidate, best: FloatArray) -> FloatArray:
    """Free more parameters, the most worthwhile first, as long as that is worth it."""

    def cost(values: FloatArray) -> float:
        return target(values, 0.0) + WORTH_A_REFINEMENT * np.count_nonzero(values)

    promising = [r for r in candidate.refinements if not target.taken_up(candidate) & r.keys()]
    while promising:
        starts = [_freed(target, best, refinement) for refinement in promising]
        found = [_fit_form(target, [start], FINER) if start.any() else best for start in starts]
        costs = [cost(values) for values in found]
        promising = [r for r, c in zip(promising, costs, strict=True) if c < cost(best)]
        if promising:
            best = found[int(np.argmin(costs))]
    return best


def _pruned(target: _Target, candidate: Candidate, best: FloatArray) -> FloatArray:
    """Take parameters away that slack has made worthless: what they shift would have some, too."""
    for index in sorted({index for refinement in candidate.refinements for index in refinement}):
        less = best.copy()
        less[index] = 0.0
        if less.any() and target(less, 0.0) <= target(best, 0.0) + WORTH_A_REFINEMENT:
            best = less
    return best


def _freed(target: _Target, values: FloatArray, refinement: Mapping[int, float]) -> FloatArray:
    """Give parameters that matter a first value; all 0 where none of them stood at 0."""
    start = values.copy()
    for index, value in refinement.items():
        freed = start.copy()
        freed[index] = start[index] or value
        # That of an axis without a touch changes nothing, seen from as far as may be.
        start = freed if target(freed, WIDENINGS[0]) != target(start, WIDENINGS[0]) else start
    return np.zeros_like(start) if np.array_equal(start, values) else start
