"""Finding the parameters of an effect, and the effects of a campaign."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from itertools import accumulate, pairwise

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.density.datum import BY_STAMPS
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.fit.climb import NATS, STEP, WORST, climb
from skiplatch.diagnosis.likelihood.laws import AFTER_LATCH, LATTICE, TINY, law_under
from skiplatch.diagnosis.likelihood.likelihood import affected, likelihood, with_shared_datum
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.span import ALWAYS

NARROWER = 0.1
"""Of the widening before is the next, down to what touches scatter by. The first is as much of all
that they are off by: with all of it a search forgets its starts, which know better."""
USUAL = 0.005
"""Widening down to which any search goes: what comes now and then is sharper than the rest."""
REACH = 3.0
"""First step where it goes further, as a share of the parameters, over the widening before."""
SMALL = 0.1
"""Of what touches scatter by, below which a widening makes no difference."""
FINEST = (0.0,)
HOPELESS_AFTER = 2
"""Widenings after which an effect that gains nothing is not looked into further."""
HOPELESS = 0.5
"""Nats."""
WORTH_A_REFINEMENT = 2.0
"""Nats that one more parameter has to gain; it is also what it gains by chance."""
WORTH_OF_AN_END = 3
"""Parameters that the touch counts for at which an effect begins or ends."""
SLACKS = (0.0001, 0.001, 0.01, 0.05, 0.15, 0.4)
"""At which a search for slack begins; the last is the most there is."""
LOOSE = math.sqrt(SLACKS[-2] * SLACKS[-1])
"""Slack from which on it is nearer to the most than to any other."""
MOST_LEFT = 0.7
"""Of what touches are off by where a shift is large, what it may leave: else slack is scatter."""


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

    def alone(self, position: int) -> "Fit":
        """Give one of the effects as it is here."""
        return self._with([position])

    def without(self, position: int) -> "Fit":
        """Give the other effects as they are here."""
        return self._with([i for i in range(len(self.candidates)) if i != position])

    def kept(self, wanted: Sequence[bool]) -> "Fit":
        """Give those of the effects that are wanted, as they are here."""
        return self if all(wanted) else self._with(np.flatnonzero(wanted).tolist())

    def _with(self, positions: Sequence[int]) -> "Fit":
        candidates = tuple(self.candidates[i] for i in positions)
        parameters = tuple(self.parameters[i] for i in positions)
        return replace(self, candidates=candidates, parameters=parameters)

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
        return self.slack > LOOSE

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


class Target:
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
        self.reached = frozenset[str]()
        """Names of the streams that they can reach, and that count."""
        self.reached = frozenset[str]().union(
            *(affected(scene, self.fit(start).change(scene)) for start in starts)
        )
        if given.slack and self.reached.intersection(BY_STAMPS):
            # What comes after a latch is read beside it, as far as the slack leaves it open.
            self.reached |= AFTER_LATCH & scene.streams.keys()
        self.reached |= with_shared_datum(scene, self.reached)
        # By what is off still: a share of what is explained already would blur the rest.
        self._sizes = {
            name: stream.off(law_under(scene, stream, given))
            for name, stream in scene.streams.items()
            if name in self.reached and stream.rows.any()
        }

    @cached_property
    def widenings(self) -> Sequence[float]:
        """The stages of a search, coarse to fine: as many as the sharpest stream asks for."""
        return tuple(self._widenings())

    def _widenings(self) -> Iterator[float]:
        widening, streams = NARROWER, self._scene.streams
        spreads = [
            size / max(streams[name].law.select(streams[name].rows).usual_spread, TINY)
            for name, size in self._sizes.items()
        ]
        while widening > USUAL or widening * max(spreads, default=0.0) > SMALL:
            yield widening
            widening *= NARROWER
        yield from FINEST

    @property
    def roughness(self) -> float:
        """Nats by which a climb may end on a bump of the likelihood that says nothing."""
        is_rough = LATTICE in self.reached and any(c.is_rough for c in self._candidates)
        return WORTH_A_REFINEMENT if is_rough else NATS

    def fit(self, values: FloatArray) -> Fit:
        """Give the effects with parameters, shape (p,)."""
        return Fit(self._candidates, _split(self._candidates, values), self.reached, self.slack)

    def taken_up(self, candidate: Candidate) -> frozenset[int]:
        """Number the parameters of an effect that the datum of these touches takes up."""
        return candidate.taken_up(self._scene)

    def without(self, widening: float) -> float:
        """Give the same for what is given alone."""
        return self._of(self._given, widening)

    def __call__(self, values: FloatArray, widening: float = 0.0) -> float:
        """Give it at parameters, shape (p,), with the laws widened by a share of what is off."""
        point = (values.tobytes(), widening, self.slack)
        if point not in self._found:
            change = self.fit(values).change(self._scene, self._given)
            self._found[point] = self._of(change, widening)
        return self._found[point]

    def at(self, values: FloatArray) -> tuple[Scene, Change]:
        """Give the touches, and what parameters, shape (p,), change."""
        return self._scene, self.fit(values).change(self._scene, self._given)

    def believed(self, values: FloatArray) -> BoolArray:
        """Tell which of these are beliefs, shape (p,): none is."""
        return np.zeros(len(values), bool)

    def takes_away(self, values: FloatArray) -> bool:
        """Tell whether the shift in some stream is one that the touches show themselves."""
        change = replace(self.fit(values).change(self._scene, self._given), slack=0.0)
        return any(
            _is_shown(stream, *(law_under(self._scene, stream, c) for c in (self._given, change)))
            for name, stream in self._scene.streams.items()
            if name in self.reached - {LATTICE} and stream.rows.any()
        )

    def _of(self, change: Change, widening: float) -> float:
        sizes = {name: widening * size for name, size in self._sizes.items()} if widening else {}
        total = likelihood(self._scene, change, self.reached, sizes).total
        return -total if np.isfinite(total) else WORST


def _is_shown(stream: Stream, before: Law, after: Law) -> bool:
    """Tell whether touches are much less off after a shift than before, where it is large."""
    shift = (after.mean - before.mean)[stream.rows]
    off = (stream.residuals - before.mean)[stream.rows]
    large = (shift != 0.0) & (np.abs(shift) >= np.sqrt(np.mean(shift**2)))
    if not large.any():
        return False
    return bool(np.median(np.abs(off - shift)[large]) < MOST_LEFT * np.median(np.abs(off)[large]))


def starts_of(scene: Scene, candidate: Candidate, given: Change) -> list[list[float]]:
    """Give the starts of a candidate without what the datum takes up, which is none of its own."""
    taken = list(candidate.taken_up(scene))
    starts = [np.array(start, dtype=float) for start in candidate.starts(scene, given)]
    for start in starts:
        start[taken] = 0.0
    return [start.tolist() for start in starts if start.any()]


def fit(
    scene: Scene,
    candidates: Sequence[Candidate],
    starts: Iterable[Sequence[float]],
    given: Change = NOTHING,
    widenings: Sequence[float] | None = None,
) -> Fit:
    """Fit parameters from several starts, coarse to fine, on top of what is given."""
    forms = list(fits_by_form(scene, candidates, starts, given, widenings))
    # What a parameter more gains by chance is no reason to prefer a form that has it.
    return min(forms, key=lambda form: form[1] + WORTH_A_REFINEMENT * form[0].size)[0]


def fits_by_form(
    scene: Scene,
    candidates: Sequence[Candidate],
    starts: Iterable[Sequence[float]],
    given: Change = NOTHING,
    widenings: Sequence[float] | None = None,
) -> Iterator[tuple[Fit, float]]:
    """Fit them to each form of the starts, by what is 0 in them, and give minus the nats of it."""
    begun = [np.asarray(start, dtype=float) for start in starts]
    target = Target(scene, candidates, begun, given)
    forms: dict[tuple[int, ...], list[FloatArray]] = {}
    for start in begun:
        forms.setdefault(tuple(np.flatnonzero(start)), []).append(start)
    for points in forms.values():
        found = fit_form(target, points, widenings or target.widenings)
        yield target.fit(found), target(found, 0.0)


def _sharper(target: Target, point: FloatArray, widenings: Sequence[float]) -> FloatArray:
    """Climb on through narrower widenings: what is known to one is not looked for further off."""
    known = widenings[0] / NARROWER
    for widening in widenings:
        point = climb(target, point, widening, min(STEP, REACH * known))
        known = widening
    return point


def fit_form(target: Target, begun: Sequence[FloatArray], widenings: Sequence[float]) -> FloatArray:
    """Climb from the best of starts in which the same parameters are 0, coarse to fine."""
    usual = [widening for widening in widenings if widening == 0.0 or widening >= USUAL]
    further = [widening for widening in widenings if widening < USUAL]
    point, coarse = min(begun, key=lambda start: target(start, usual[0])), None
    for stage, widening in enumerate(usual):
        hopeless = target.without(widening) - HOPELESS if stage == HOPELESS_AFTER else np.inf
        if target(point, widening) > hopeless:
            break
        coarse = point if widening == 0.0 else None
        point = climb(target, point, widening)
    ends = [point]
    if coarse is not None and len(further) > 1:
        ends.append(_sharper(target, coarse, further))
    # A start may sit on a peak too sharp to be found from afar.
    near = min(begun, key=lambda start: target(start, 0.0))
    if target(near, 0.0) < min(target(end, 0.0) for end in ends):
        ends += [near, climb(target, near, widenings[-1])]
    best = min(ends, key=lambda end: target(end, 0.0))
    # Where all of some range is as likely, a start may know where in it; a climb ends anywhere.
    return near if target(near, 0.0) <= target(best, 0.0) + target.roughness else best
