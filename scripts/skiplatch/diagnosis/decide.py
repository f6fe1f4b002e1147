"""Which effects a campaign shows: forward search, groups that cannot be told apart, strangers."""

from collections.abc import Callable, Collection, Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import BoolArray
from skiplatch.diagnosis.candidates import Candidate
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.generic import families
from skiplatch.diagnosis.likelihood import MISSED, affected, law_under, likelihood
from skiplatch.diagnosis.material import DEFAULT, Materiality, is_material
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.search import NOTHING, SLACKS, WORTH_A_REFINEMENT, Fit, fit, polish
from skiplatch.diagnosis.simulated import catalogue

ENOUGH_FIT = 5.0
"""Nats that an effect has to gain, beyond what its parameters are worth."""
ENOUGH_CHECK = 1.0
"""Nats of gain on touches that it was not fitted to."""
BETTER = 2.0
"""Nats by which a form found in a pair has to be better than the one found alone."""
CONTENDS = 0.25
"""Share of the best gain from which on other forms of an effect are tried."""
REFINED_PAIRS = 5
NEARLY = 30.0
"""Nats behind the best pair from which on a pair is not refined jointly."""
FINEST = (0.0,)
COARSE = (0.1, 0.0)
MISSING = 0.2
"""Share of the gain that rare events may cost where the check happens to have none."""
PLAIN = 15.0
"""Nats of gain that need no check to be believed, only that it does not speak against."""
PLAIN_SECOND = 0.2
"""Gain of a second effect over that of the first, whose form is never just the one fitted.

One that gains less is believed only where it mends all that the first one leaves."""
FAINTEST_SECOND = 0.03
"""The same below which it is not believed at all: that much any form is off."""
SMALLEST_LEFT = 0.1
"""The same of what no effect explains."""
NEXT_BEST = 0.5
"""Share of the best effect's gain from which on another is tried as the first of two."""
MOST_NEXT_BEST = 2
SCATTERED = 3.0
"""Times the believed spread from which on an effect explains by scatter."""
MOST_SWAPS = 2
MIMICRY = 0.99
"""Share of a family's gain that an effect has to reach to be named in its place."""
MAY_HIDE = 0.9
"""Share of an effect's gain from which on a family may be two effects that hide each other."""
LEFT_OVER = 1.5
"""What a family may gain on top of an effect, as a share of the effect's own gain."""
TEMPER = 0.5
"""How far differences in nats are believed: no real effect has just the form that is fitted."""
TIED = 6.0
"""Nats of difference that do not tell two effects apart: tempered, one in twenty."""


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """Which touches serve what; masks of shape (n,) that do not overlap."""

    fitting: BoolArray
    checking: BoolArray
    shrinking: BoolArray

    @property
    def naming(self) -> BoolArray:
        """Fitting and checking together."""
        return self.fitting | self.checking


def split(touches: int, seed: int) -> Split:
    """Draw half of the touches for fitting, a fifth for checking, the rest for the shrink."""
    lot = np.random.default_rng(seed).permutation(touches) / touches
    return Split(lot < 0.5, (lot >= 0.5) & (lot < 0.7), lot >= 0.7)


@dataclass(frozen=True, slots=True, eq=False)
class Scored:
    """A model with what it gains over the unchanged simulation, in nats."""

    fit: Fit
    fitted: float
    checked: float

    @property
    def score(self) -> float:
        """Gain in all, less what so many parameters gain by chance."""
        return self.fitted + self.checked - worth(self.fit.size)

    @property
    def ids(self) -> tuple[str, ...]:
        """Of its effects."""
        return tuple(candidate.id for candidate in self.fit.candidates)


def worth(parameters: int) -> float:
    """Nats that fitting so many parameters, of the best of all candidates, gains by chance."""
    return 2.0 * parameters


def _key(model: Fit | None) -> tuple[object, ...]:
    """Tell fits apart by what they are."""
    if model is None:
        return ()
    parameters = (values.tobytes() for values in model.parameters)
    return (*(c.id for c in model.candidates), *parameters, model.slack)


def _is_no_accident(fitted: float, checked: float, parameters: int) -> bool:
    """Tell whether gains of so many parameters are more than chance."""
    gained = fitted + checked - worth(parameters)
    is_checked = fitted - worth(parameters) > ENOUGH_FIT and checked > ENOUGH_CHECK
    is_plain = gained > PLAIN and checked > -MISSING * fitted
    return is_checked or is_plain


def _in_view(part: Scene, names: Collection[str]) -> set[str]:
    """Add the grid of the scans to the waits for them: what a scan does shows in both."""
    is_waiting = any(name in part.streams and part.streams[name].is_polled for name in names)
    return {*names, "lattice"} if is_waiting and "lattice" in part.streams else set(names)


def _gain_in(part: Scene, model: Fit, names: Collection[str]) -> float:
    """Give what a model gains over the unchanged simulation in some streams."""
    changed = likelihood(part, model.change(part), names=names).total
    return changed - likelihood(part, Change(), names=names).total


class Judge:
    """Fits and scores models on one campaign."""

    def __init__(
        self,
        scene: Scene,
        parts: Split,
        executor: Executor | None = None,
        materiality: Materiality = DEFAULT,
    ) -> None:
        self.scene = scene
        self.materiality = materiality
        self.parts = parts
        self._fitting = scene.select(parts.fitting)
        self._checking = scene.select(parts.checking)
        self._map: Callable[..., Iterable[Fit]] = executor.map if executor else map
        self._base = [likelihood(part, Change()).total for part in (self._fitting, self._checking)]
        self._families: dict[tuple[object, ...], list[Scored]] = {}

    def score(self, model: Fit) -> Scored:
        """Score a fitted model on both parts."""
        gains = [
            likelihood(part, model.change(part)).total - base
            for part, base in zip((self._fitting, self._checking), self._base, strict=True)
        ]
        return Scored(model, *gains)

    def singles(self) -> list[Scored]:
        """Every candidate alone, by falling score."""
        return self._ranked(self._contest(self._candidates(), NOTHING))

    def _contest(self, candidates: Sequence[Candidate], given: Change) -> list[Fit]:
        """Fit all candidates plainly, and those that come near the best of them in other forms."""
        fits = list(self._map(_fit, [(self._fitting, c, given) for c in candidates]))
        gains = [self._gain(found, given) for found in fits]
        least = max(WORTH_A_REFINEMENT, CONTENDS * max(gains))
        near = [i for i, gain in enumerate(gains) if gain >= least]
        for i, found in zip(
            near, self._map(_polish, [(self._fitting, fits[i], given) for i in near]), strict=True
        ):
            fits[i] = found
        return fits

    def _gain(self, found: Fit, given: Change) -> float:
        """Gain of a model, with its form left open or not, on the touches it was fitted to."""
        forms = (found, replace(found, slack=SLACKS[-1]))
        changes = (given.joined(form.change(self._fitting)) for form in forms)
        most = max(likelihood(self._fitting, change).total for change in changes)
        return most - likelihood(self._fitting, given).total

    def generic(self, given: Fit | None = None) -> list[Scored]:
        """Every family that names no effect, alone or on top of a model, by falling score."""
        key = _key(given)
        if key not in self._families:
            self._families[key] = self._fitted_families(given)
        return self._families[key]

    def _fitted_families(self, given: Fit | None) -> list[Scored]:
        change = given.change(self._fitting) if given else NOTHING
        return self._ranked(
            _both(given, found) if given else found
            for family in families(self._fitting, change)
            for found in [
                polish(
                    self._fitting,
                    fit(
                        self._fitting,
                        [family],
                        family.starts(self._fitting, change),
                        change,
                        COARSE,
                    ),
                    change,
                )
            ]
        )

    def pairs(self, first: Scored) -> list[Scored]:
        """The first effect with every other one: one by one on top of it, the best then jointly."""
        on_top = self.on_top(first)
        least = on_top[0].score - NEARLY
        near = [pair for pair in on_top[:REFINED_PAIRS] if pair.score > least]
        refined = self._map(_refine, [(self._fitting, pair.fit) for pair in near])
        jointly = [
            max(pair, self.score(joint), key=lambda scored: scored.score)
            for pair, joint in zip(near, refined, strict=True)
        ]
        return sorted(jointly + on_top[len(near) :], key=lambda scored: -scored.score)

    def on_top(self, first: Scored) -> list[Scored]:
        """Every other effect on top of a model that stays as it is, by falling score."""
        given = first.fit.change(self._fitting)
        others = [c for c in self._candidates() if c.id not in first.ids]
        return self._ranked(_both(first.fit, second) for second in self._contest(others, given))

    def again(self, model: Fit, position: int) -> Scored:
        """Fit one effect of a model alone, from the parameters that it has there."""
        candidates = (model.candidates[position],)
        start = model.parameters[position].tolist()
        found = fit(self._fitting, candidates, [start], widenings=FINEST)
        return self.score(polish(self._fitting, found))

    def _ranked(self, fits: Iterable[Fit]) -> list[Scored]:
        return sorted(map(self.score, fits), key=lambda scored: -scored.score)

    def _candidates(self) -> list[Candidate]:
        return [c for c in catalogue().values() if c.applies(self.scene)]

    def is_enough(self, scored: Scored, before: Scored | None = None) -> bool:
        """Tell whether a model is worth naming over a smaller one, or over none."""
        return self.is_significant(scored, before) and self.is_material(scored, before)

    def is_significant(self, scored: Scored, before: Scored | None = None) -> bool:
        """Tell whether a model does better than a smaller one, or than none, by no accident."""
        return _is_no_accident(
            scored.fitted - (before.fitted if before else 0.0),
            scored.checked - (before.checked if before else 0.0),
            scored.fit.size - (before.fit.size if before else 0),
        )

    def is_elsewhere(self, pair: Scored, first: Scored) -> bool:
        """Tell whether the second effect of a pair shows where the first one changes nothing.

        There the first one has no form that could be mended.
        """
        fitted, checked = (
            _gain_in(part, pair.fit, {*part.streams, MISSED} - affected(part, change))
            for part in (self._fitting, self._checking)
            for change in [first.fit.change(part)]
        )
        return _is_no_accident(fitted, checked, pair.fit.size - first.fit.size)

    def share(self, pair: Scored, first: Scored) -> float:
        """What the last of a model gains, over what the first gains in the streams it reaches.

        Only there can it but mend the first one's form.
        """
        there = 0.0
        for part in (self._fitting, self._checking):
            last = pair.fit.candidates[-1].change(part, pair.fit.parameters[-1])
            there += _gain_in(part, first.fit, _in_view(part, affected(part, last)))
        gained = pair.fitted + pair.checked - first.fitted - first.checked
        return gained / there if there > 0.0 else np.inf

    def is_scatter(self, scored: Scored) -> bool:
        """Tell whether a model leaves most touches of a stream as scattered as it finds them."""
        change, scene = scored.fit.change(self._fitting), self._fitting
        laws = [
            (law_under(scene, scene.streams[name], change), scene.streams[name].law)
            for name in affected(scene, change) & scene.streams.keys()
        ]
        return any(
            np.median(np.sqrt(law.variance) / believed.spread) > SCATTERED for law, believed in laws
        )

    def is_material(self, scored: Scored, before: Scored | None = None) -> bool:
        """Tell whether what a model has beyond a smaller one, or none, changes enough to matter."""
        gained = scored.fitted + scored.checked
        if before:
            gained -= before.fitted + before.checked
        position = len(before.ids) if before else 0
        candidate, parameters = scored.fit.candidates[position], scored.fit.parameters[position]
        change = candidate.change(self._fitting, parameters)
        touches = int(self.parts.naming.sum())
        is_seen = gained / touches > self.materiality.nats_a_touch
        return is_seen and is_material(self._fitting, change, self.materiality)


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """The effects that were found.

    Attributes:
        model: They and their parameters, or None for no effect.
        alternatives: For each effect, the ids that would do as well.
        confidences: For each effect, that of it or one of its alternatives being right.
        ranking: The models that were tried last, by falling score.
        small: An effect that is there, but too small to matter.
    """

    model: Scored | None
    alternatives: tuple[tuple[str, ...], ...] = ()
    confidences: tuple[float, ...] = ()
    ranking: tuple[Scored, ...] = ()
    small: Scored | None = None

    @property
    def rivals(self) -> tuple[Scored, ...]:
        """The models that cannot be told from the best one, which is the first of them."""
        if self.model is None:
            return ()
        others = [s for s in self.ranking if s is not self.model]
        return (self.model, *(s for s in others if s.score > self.model.score - TIED))


def find(judge: Judge) -> Finding:
    """Search forward for one effect, then for a second one."""
    ranked = judge.singles()
    best = ranked[0]
    if not judge.is_significant(best):
        return Finding(None, ranking=tuple(ranked))
    hidden = _hidden(judge, ranked)
    if hidden:
        return hidden
    pairs = judge.pairs(best)
    again = max((judge.again(pairs[0].fit, i) for i in (0, 1)), key=lambda scored: scored.score)
    if again.score > best.score + BETTER:
        # The pair has shown the way to a better form of one of its effects alone.
        best = again
        ranked = [best, *(scored for scored in ranked if scored.ids != best.ids)]
        pairs = judge.pairs(best)
    has_second = _is_second(judge, pairs[0], best)
    if not judge.is_material(best):
        # What is too small to matter may still hide what is not.
        if has_second:
            return _second(judge, pairs)
        return Finding(None, ranking=tuple(ranked), small=best)
    if has_second:
        return _two(judge, pairs)
    group, confidence = _group(ranked, position=0)
    return Finding(best, (group,), (confidence,), tuple(ranked))


def _hidden(judge: Judge, ranked: Sequence[Scored]) -> Finding | None:
    """Find two effects behind one that takes what both do for scatter.

    The next best ones, each of which is mended less by itself, may do far better together.
    """
    best = ranked[0]
    if not judge.is_scatter(best):
        return None
    near = [s for s in ranked[1:] if NEXT_BEST * best.score < s.score < best.score - TIED]
    for first in near[:MOST_NEXT_BEST]:
        pairs = judge.pairs(first)
        is_better = pairs[0].score > best.score + PLAIN and judge.is_enough(pairs[0], best)
        if is_better and best.ids[0] not in pairs[0].ids and _is_second(judge, pairs[0], first):
            return _two(judge, pairs)
    return None


def only(judge: Judge, single: Scored) -> Finding:
    """Name one effect of the two that were found."""
    ranked = [single, *(scored for scored in judge.singles() if scored.ids != single.ids)]
    group, confidence = _group(ranked, position=0)
    return Finding(single, (group,), (confidence,), tuple(ranked))


def _is_second(judge: Judge, pair: Scored, first: Scored) -> bool:
    """Tell whether the second effect of a pair is one of its own, and no form of the first."""
    if not judge.is_enough(pair, first):
        return False
    if judge.is_elsewhere(pair, first):
        # The first one may well have another form: it cannot be that of what shows elsewhere.
        return not _is_a_form(judge, pair, ENOUGH_FIT, instead_of=(1,))
    share = judge.share(pair, first)
    if share >= PLAIN_SECOND:
        return not _is_a_form(judge, pair, -TIED)
    if share < FAINTEST_SECOND:
        return False
    return _mends_all(judge, pair) and not _is_a_form(judge, pair, -PLAIN)


def _mends_all(judge: Judge, pair: Scored) -> bool:
    """Tell whether a pair leaves nothing: an effect that but mends another's form seldom does."""
    return pair.fit.slack == 0.0 and judge.generic(pair.fit)[0].score <= pair.score


def _is_a_form(
    judge: Judge, pair: Scored, margin: float, instead_of: Sequence[int] = (0, 1)
) -> bool:
    """Tell whether a family in place of one of the effects does better than a pair by a margin."""
    others = (_alone(judge, pair, 1 - position) for position in instead_of)
    on_top = (judge.generic(other.fit)[0] for other in others)
    return any(scored.score > pair.score + margin for scored in on_top)


def weigh(judge: Judge, finding: Finding) -> tuple[Finding, str]:
    """Hold a finding against the families that name no effect.

    Returns:
        The finding, without a model if a family does clearly better than it, and the family that
        is left over, alone or on top of the finding; empty for none.
    """
    generic = judge.generic()
    plain = next((g for g in generic if judge.is_enough(g)), None)
    if finding.model is None:
        # An effect too small to matter explains as well what a family does with more.
        is_new = plain is not None and plain.score > finding.ranking[0].score
        return finding, plain.ids[0] if plain and is_new else ""
    score = finding.model.score
    if plain and plain.score > MAY_HIDE * score:
        is_beaten = plain.score > score + ENOUGH_FIT and score < MIMICRY * plain.score
        is_single = len(finding.model.ids) == 1
        hidden = _behind(judge, plain, score) if is_beaten or is_single else None
        if hidden or is_beaten:
            return hidden or Finding(None, ranking=finding.ranking), "" if hidden else plain.ids[0]
    on_top = [
        g
        for g in judge.generic(finding.model.fit)
        if judge.is_enough(g, finding.model) and judge.share(g, finding.model) >= SMALLEST_LEFT
    ]
    if on_top and on_top[0].score - score > score * LEFT_OVER:
        return Finding(None, ranking=finding.ranking), on_top[0].ids[-1]
    return finding, on_top[0].ids[-1] if on_top else ""


def _behind(judge: Judge, family: Scored, score: float) -> Finding | None:
    """Find two effects that look like a family together, each hiding what the other looks like.

    On top of the family the stronger of them shows, for the family stands for the other one. That
    two effects leave nothing, and do far better than one of them with the family, is no accident.

    Args:
        judge: Fits and scores.
        family: It does nearly as well as what was found, or better.
        score: Of what was found.
    """
    shown = judge.on_top(family)[0]
    if not judge.is_enough(shown, family):
        return None
    first = _alone(judge, shown, position=1)
    pairs = judge.pairs(first)
    best = pairs[0]
    is_better = best.score > max(shown.score, score) + PLAIN and judge.is_enough(best, first)
    return _two(judge, pairs) if is_better and _mends_all(judge, best) else None


def _second(judge: Judge, pairs: list[Scored]) -> Finding:
    """Name only the second effect of the best pair."""
    alone = _alone(judge, pairs[0], position=1)
    group, confidence = _group(pairs, 1)
    return Finding(alone, (group,), (confidence,), tuple(pairs))


def _two(judge: Judge, pairs: list[Scored]) -> Finding:
    """Settle two effects: each is searched for anew, given the other, until neither changes."""
    best, other = pairs[0], pairs
    for _ in range(MOST_SWAPS):
        swapped = judge.pairs(_alone(judge, best, position=1))
        if set(swapped[0].ids) == set(best.ids) or swapped[0].score <= best.score:
            break
        best, other = swapped[0], swapped
    else:
        swapped = judge.pairs(_alone(judge, best, position=1))
    second = _group([best, *(pair for pair in other if pair is not best)], 1)
    rest = (pair for pair in swapped if pair.ids[1] != best.ids[0])
    first = _group([best, *rest], 1, best.ids[0])
    return Finding(best, (first[0], second[0]), (first[1], second[1]), tuple(other))


def _alone(judge: Judge, pair: Scored, position: int) -> Scored:
    """Give one effect of a pair with the parameters it has there."""
    model = pair.fit
    single = Fit(
        (model.candidates[position],),
        (model.parameters[position],),
        model.reached,
        model.slack,
    )
    return judge.score(single)


def _group(ranked: Sequence[Scored], position: int, own: str = "") -> tuple[tuple[str, ...], float]:
    """Name the effects tied with the best of a ranking, and how sure the group is.

    Args:
        ranked: The best first.
        position: Of the effect in question in the models.
        own: Its id in the best one, where that stands elsewhere.
    """
    own = own or ranked[0].ids[position]
    scores = np.array([scored.score for scored in ranked])
    weights = np.exp(TEMPER * np.minimum(scores - scores[0], 0.0))
    tied = scores > scores[0] - TIED
    names = tuple(
        scored.ids[position]
        for scored, is_tied in zip(ranked[1:], tied[1:], strict=True)
        if is_tied and scored.ids[position] != own
    )
    return names, float(weights[tied].sum() / weights.sum())


def _both(first: Fit, second: Fit) -> Fit:
    return Fit(
        first.candidates + second.candidates,
        first.parameters + second.parameters,
        first.reached | second.reached,
        max(first.slack, second.slack),
    )


def _refine(pair: tuple[Scene, Fit]) -> Fit:
    """Fit both effects of a pair jointly, from where they are."""
    scene, found = pair
    start = np.concatenate(found.parameters).tolist()
    return polish(scene, fit(scene, found.candidates, [start], widenings=FINEST))


def _polish(model: tuple[Scene, Fit, Change]) -> Fit:
    return polish(*model)


def _fit(model: tuple[Scene, Candidate, Change]) -> Fit:
    scene, candidate, given = model
    return fit(scene, [candidate], candidate.starts(scene, given), given)
